# SPDX-License-Identifier: MIT
"""Pages of doc/studies keep up with the code that they speak of, or doc/studies/README.md says until when they need not.

A page names the digest of its sources (slideline_tools/studies/framework/pages.py); no history is asked, so that this judges a
shallow clone and an unpacked archive as well.
"""
import pathlib
import re
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from slideline_tools.studies.framework import pages  # noqa: E402

STUDIES = ROOT / "doc" / "studies"
ALLOWANCE = re.compile(r"^\| \[(\w+)\]\(\w+\.md\) \| release (\d+)\.(\d+) \| (\S.+?) \|$", re.MULTILINE)


def allowances(text):
    """{page: (major, minor) of the release with which it is published anew} of the table 'Behind the code'."""
    _, _, table = text.partition("## Behind the code")
    return {name: (int(major), int(minor)) for name, major, minor, _ in ALLOWANCE.findall(table)}


def version():
    """(major, minor) of the project."""
    found = re.search(r"project\(slideline VERSION (\d+)\.(\d+)", (ROOT / "CMakeLists.txt").read_text())
    return int(found[1]), int(found[2])


def is_behind(quoted, text):
    """Why a page of doc/studies is behind the code, or ''."""
    origin = pages.ORIGIN.search(text)
    if not origin:
        return "it does not name the source it was made from"
    sources = {folder for page in pages.PAGES.values() if page.quoted == quoted for folder in page.sources}
    return f"its sources have changed since {origin['source']}" * (origin["digest"] != pages.digest(sources))


def commands(name):
    """What makes the figures of a page."""
    return [" ".join(page.command) for page in pages.PAGES.values() if page.quoted == name]


def judge(texts, allowed, now):
    """What is wrong: `texts` {page: text}, `allowed` as of `allowances`, `now` the version."""
    trouble = []
    for name, text in texts.items():
        behind = is_behind(name, text)
        if behind and name not in allowed:
            trouble.append(f"{name}.md is behind the code ({behind}): make its figures anew "
                           f"({', '.join(commands(name))}), or allow it in doc/studies/README.md")
        elif behind and now >= allowed[name]:
            trouble.append(f"{name}.md was to be made anew with release {allowed[name][0]}.{allowed[name][1]}")
        elif not behind and name in allowed:
            trouble.append(f"{name}.md is up to date: take its line out of doc/studies/README.md")
    return trouble + [f"{name}: no such page" for name in allowed if name not in texts]


def written():
    return {path.stem: path.read_text(encoding="utf-8") for path in STUDIES.glob("*.md") if path.stem != "README"}


def test_every_page_has_its_figures_and_every_study_its_page():
    assert set(written()) == {page.quoted for page in pages.PAGES.values()}
    readme = (STUDIES / "README.md").read_text(encoding="utf-8")
    assert all(f"[{name}]({name}.md)" in readme for name in written())
    for page in pages.PAGES.values():
        assert (ROOT / page.command[0]).exists()
        assert pathlib.PurePath(page.command[0]).name in readme + written()[page.quoted]
        assert set(page.sources) <= {path.name for path in (ROOT / "src").iterdir()}


def test_pages_keep_up_with_the_code():
    allowed = allowances((STUDIES / "README.md").read_text(encoding="utf-8"))
    assert judge(written(), allowed, version()) == []


@pytest.fixture
def fresh():
    """A page made from the sources as they are."""
    return pages.with_origin("stability", "# Hertz\n\nText.\n", "0123456789ab", "a processor, 2 logical cores")


def test_a_page_that_is_behind_is_noticed(fresh):
    old = re.sub(r"speaks of `\w+`", "speaks of `000000000000`", fresh)
    assert judge({"stability": fresh}, {}, (0, 1)) == []
    assert "changed since 0123456789ab" in judge({"stability": old}, {}, (0, 1))[0]
    assert "does not name" in judge({"stability": "# Hertz\n\nText.\n"}, {}, (0, 1))[0]


def test_an_allowance_ends_with_its_release_and_is_not_kept_for_nothing(fresh):
    table = "## Behind the code\n\n| page | until | why |\n|---|---|---|\n| [stability](stability.md) | release 0.2 | words. |\n"
    allowed = allowances(table)
    assert allowed == {"stability": (0, 2)} and allowances(table.replace(" words. ", " ")) == {}
    assert judge({"stability": "# Hertz\n"}, allowed, (0, 1)) == []
    assert "release 0.2" in judge({"stability": "# Hertz\n"}, allowed, (0, 2))[0]
    assert "take its line out" in judge({"stability": fresh}, allowed, (0, 1))[0]
    assert judge({}, allowed, (0, 1)) == ["stability: no such page"]


def test_the_digest_is_that_of_the_code_and_not_of_its_comments(tmp_path):
    folder = tmp_path / "src" / "base"
    folder.mkdir(parents=True)
    found = []
    for text in ("x = 1\n", "! why\n\n  x = 1\n", "x = 2\n", "!$omp simd\nx = 1\n"):
        (folder / "a.f90").write_text(text)
        found.append(pages.digest(("base",), tmp_path))
    assert found[0] == found[1] and len(set(found)) == 3
    (folder / "b.f90").write_text("x = 1\n")
    assert pages.digest(("base",), tmp_path) != found[3]


def test_the_line_of_origin_stands_below_the_title(fresh):
    assert fresh.startswith("# Hertz\n\nMade from source `0123456789ab` on a processor, 2 logical cores;") and fresh.endswith("\n\nText.\n")
