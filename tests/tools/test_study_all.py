# SPDX-License-Identifier: MIT
"""`tools/study.sh all`: goes on where it was stopped, mixes nothing, copies nothing."""
import pytest

from slideline_tools import UserError
from slideline_tools.studies import __main__ as command
from slideline_tools.studies.framework import everything, pages
from slideline_tools.studies.framework.pages import Page

MAKER = """#!/bin/sh
echo "$1" >>log
[ "$1" != "$(cat broken 2>/dev/null)" ] || exit 1
mkdir -p "$SLIDELINE_RESULTS/doc/studies"
printf '# %s\\n\\nMade from source `%s` on a processor; digest of what it speaks of `0123456789ab`.\\n' "$1" "$(cat source)" \\
  >"$SLIDELINE_RESULTS/doc/studies/$1.md"
"""


class Tree:
    """A small tree with three pages."""

    def __init__(self, folder):
        self.root, self.results = folder, folder / "results" / "all"
        (folder / "make").write_text(MAKER)
        (folder / "make").chmod(0o755)
        self.source("abc")

    def source(self, name):
        (self.root / "source").write_text(name)

    def make(self, pattern=None):
        """Returns the pages that were made now."""
        (self.root / "log").write_text("")
        self.results.mkdir(parents=True, exist_ok=True)
        everything.make_all(self.results, pattern)
        return self.log()

    def log(self):
        return (self.root / "log").read_text().split()

    def made(self):
        return sorted(path.stem for path in (self.results / "doc" / "studies").glob("*.md"))


@pytest.fixture
def tree(tmp_path, monkeypatch):
    made = Tree(tmp_path)
    monkeypatch.setattr(everything, "ROOT", tmp_path)
    monkeypatch.setattr(everything, "PAGES", {
        "one": Page("a", ("make", "one")), "two": Page("a", ("make", "two")), "three": Page("a", ("make", "three"))})
    monkeypatch.setattr(everything, "processor", lambda: "a processor")
    monkeypatch.setattr(everything, "program_source", lambda _: (tmp_path / "source").read_text())
    return made


def test_all_pages_are_made_once(tree, capsys):
    assert tree.make() == ["one", "two", "three"]
    assert tree.made() == ["one", "three", "two"]
    assert tree.make() == []
    assert "2 of 3 pages: two has been made before" in capsys.readouterr().out


def test_it_goes_on_after_a_failure(tree):
    (tree.root / "broken").write_text("two")
    with pytest.raises(UserError, match="not made: two failed with status 1, see .*two.log"):
        tree.make()
    assert tree.log() == ["one", "two", "three"] and tree.made() == ["one", "three"]
    (tree.root / "broken").unlink()
    assert tree.make() == ["two"] and tree.made() == ["one", "three", "two"]


@pytest.mark.parametrize("what", ["source", "processor"])
def test_results_of_another_program_or_machine_are_refused(tree, monkeypatch, what):
    tree.make(pattern="one")
    if what == "source":
        tree.source("def")
    else:
        monkeypatch.setattr(everything, "processor", lambda: "another processor")
    with pytest.raises(UserError, match=f"one.md is of {what} .* not to be mixed"):
        tree.make()
    assert tree.log() == [] and tree.made() == ["one"]


def test_a_source_that_changes_meanwhile_is_noticed(tree, monkeypatch):
    monkeypatch.setattr(everything, "program_source", lambda _: "abc")
    tree.source("changed")
    with pytest.raises(UserError, match="one.md is of source changed, and this is abc"):
        tree.make(pattern="one")


@pytest.mark.parametrize("name", ["abc-dirty", "unknown"])
def test_what_is_not_committed_is_refused(tree, name):
    tree.source(name)
    with pytest.raises(UserError, match="committed"):
        tree.make()
    assert tree.made() == []


def test_the_command_knows_all(tmp_path, monkeypatch, capsys):
    asked = []
    monkeypatch.setattr(everything, "make_all", lambda *words: asked.append(words))
    assert command.main(["all", "--folder", str(tmp_path / "x"), "--only", "b*"]) == 0
    assert asked == [(tmp_path / "x", "b*")]
    assert command.main(["all", "--folder", str(tmp_path / "x"), "--levels", "1"]) == 2
    assert "takes no levels" in capsys.readouterr().err


def test_the_line_of_origin_is_one_that_is_understood():
    found = pages.ORIGIN.search(pages.with_origin("speed", "# Speed\n\nText\n"))
    assert found and found["digest"] == pages.digest(pages.PAGES["speed"].sources)
