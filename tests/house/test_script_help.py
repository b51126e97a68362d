# SPDX-License-Identifier: MIT
"""Every shell script explains itself when asked for help, and does nothing else then; and what scripts
say that can not go on."""
import shutil
import subprocess

import pytest

from fortran_source import ROOT
from test_house import tracked_files

#: what a script may need to print its head: with no more than this, work that it starts fails at once
TOOLS = ("sh", "bash", "awk", "dirname")
#: hand all words on to the programs
LAUNCHERS = ("tools/package/slideline", "tools/package/slideline-tools")


def is_shell_script(name):
    with open(ROOT / name, "rb") as stream:
        first = stream.readline().split()
    return bool(first) and first[0].startswith(b"#!") and first[-1].rsplit(b"/")[-1] in (b"sh", b"bash")


SCRIPTS = [name for name in tracked_files() if is_shell_script(name) and name not in LAUNCHERS]


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """The scripts with what they source, and nothing that they could build or run."""
    top = tmp_path_factory.mktemp("a tree")
    for name in [*SCRIPTS, *(name for name in tracked_files() if name.endswith(".sh"))]:
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, top / name)
    (top / "bin").mkdir()
    for tool in TOOLS:
        (top / "bin" / tool).symlink_to(shutil.which(tool))
    (top / "elsewhere").mkdir()
    return top


def ask(tree, name, *words):
    return subprocess.run([tree / name, *words], cwd=tree / "elsewhere", capture_output=True, text=True,
                          timeout=20, env={"PATH": str(tree / "bin")})


def test_there_are_scripts():
    assert len(SCRIPTS) > 12


@pytest.mark.parametrize("word", ["-h", "--help"])
@pytest.mark.parametrize("name", SCRIPTS)
def test_help_is_the_head_of_the_script(tree, name, word):
    before = {path: path.stat().st_mtime_ns for path in tree.rglob("*")}
    done = ask(tree, name, word)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert done.stdout.startswith("usage") and name in done.stdout
    assert len(done.stdout.splitlines()) > 1 and "SPDX" not in done.stdout
    assert {path: path.stat().st_mtime_ns for path in tree.rglob("*")} == before


def test_help_may_follow_other_words(tree):
    done = ask(tree, "tools/batch/run_folder.sh", "decks", "--help")
    assert done.returncode == 0 and done.stdout.startswith("usage")


def test_what_follows_the_deck_goes_to_the_program(tree):
    done = ask(tree, "tools/run.sh", "absent.k", "--help")
    assert done.returncode == 1 and "absent.k" in done.stderr


def test_help_of_studies_comes_from_the_studies_where_they_are_installed(tree, tmp_path):
    python = tmp_path / "build/venv/bin/python"
    shutil.copytree(tree / "tools", tmp_path / "tools")
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho python "$@"\n')
    python.chmod(0o755)
    done = subprocess.run([tmp_path / "tools/study.sh", "simplify", "--help"], capture_output=True,
                          text=True, timeout=20)
    assert done.stdout == "python -m slideline_tools.studies simplify --help\n"
