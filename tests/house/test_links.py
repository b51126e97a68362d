# SPDX-License-Identifier: MIT
"""Links of all Markdown files: what they point to in the repository is there, anchors too."""
import re

import pytest

from fortran_source import ROOT
from test_house import tracked_files

LINK = re.compile(r"(?<!\\)\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\s*\)")
PAGES = [name for name in tracked_files() if name.endswith(".md")]
#: names of Markdown files in backquotes, which the site turns into links
NAMED = re.compile(r"`((?:[\w.-]+/)+[\w.-]+\.md)`")


def prose(name):
    """(line number, text) of a page, code blocks and code spans left out."""
    in_code = False
    for number, line in enumerate((ROOT / name).read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            in_code = not in_code
        elif not in_code and not line.startswith("    "):
            yield number, line


def anchors(path):
    """The anchors of the headings of a page, as GitHub and MkDocs make them."""
    found = set()
    for _, line in prose(path.relative_to(ROOT)):
        heading = re.match(r"#+ (.*)", line)
        if heading:
            text = re.sub(r"[^\w\- ]", "", heading.group(1).strip().lower())
            found.add(text.replace(" ", "-"))
    return found


@pytest.mark.parametrize("name", PAGES)
def test_links(name):
    wrong = []
    for number, line in prose(name):
        for target in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            if re.match(r"(https?|mailto):", target):
                continue
            file, _, anchor = target.partition("#")
            path = (ROOT / name).parent / file if file else ROOT / name
            path = path.resolve()
            if not path.exists():
                wrong.append(f"{name}:{number}: {target}: no such file")
            elif anchor and path.suffix == ".md" and anchor not in anchors(path):
                wrong.append(f"{name}:{number}: {target}: no such heading")
    assert not wrong


@pytest.mark.parametrize("name", PAGES)
def test_named_pages(name):
    """A page that is named by its path is there, from the top, from doc/ or from the page."""
    wrong = [f"{name}:{number}: {target}" for number, line in prose(name)
             for target in NAMED.findall(line)
             if not any((base / target).exists()
                        for base in (ROOT, ROOT / "doc", (ROOT / name).parent))]
    assert not wrong


def test_every_page_of_doc_is_reached():
    """From README.md and doc/index.md, by links or names, every page of doc/ can be reached."""
    reached, ahead = set(), ["README.md", "doc/index.md"]
    while ahead:
        name = ahead.pop()
        if name in reached or not (ROOT / name).is_file():
            continue
        reached.add(name)
        text = "\n".join(line for _, line in prose(name))
        targets = LINK.findall(text) + re.findall(r"`([\w./-]+\.md)`", text)
        targets += [f"{folder}README.md" for folder in re.findall(r"`((?:[\w-]+/)+)`", text)]
        for folder in re.findall(r"`((?:doc/)(?:[\w-]+/)+)`", text):
            targets += [path.relative_to(ROOT).as_posix() for path in (ROOT / folder).glob("*.md")]
        for target in (target.split("#")[0] for target in targets):
            for base in (ROOT, ROOT / "doc", (ROOT / name).parent):
                path = (base / target).resolve()
                if target.endswith(".md") and path.is_file() and path.is_relative_to(ROOT):
                    ahead.append(path.relative_to(ROOT).as_posix())
    pages = {name for name in PAGES if name.startswith("doc/")}
    assert not pages - reached - {"doc/ford.md"}
