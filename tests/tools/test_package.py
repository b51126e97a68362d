# SPDX-License-Identifier: MIT
"""Man pages, completion and syntax files, made of the help of the program and of the reader's tables; the recipes."""
import json
import os
import re
import shutil
import subprocess
import sys

import pytest

from slideline_tools import __version__
from test_launcher import ROOT

RECIPES = {"CMakeLists.txt": rf"project\(slideline VERSION {__version__} ", "doc/CITATION.cff": rf"version: {__version__}\n",
           "tools/package/conda/meta.yaml": rf'version = "{__version__}"',
           "tools/package/spack/package.py": rf'version\("{__version__}"\)'}


@pytest.fixture(scope="module")
def share(tmp_path_factory, slideline):
    """The folder `share` of an installation."""
    folder = tmp_path_factory.mktemp("prefix")
    subprocess.run([sys.executable, ROOT / "tools/package/share.py", slideline, folder], check=True)
    return folder / "share"


@pytest.fixture
def offered(share, tmp_path):
    """offered(line): what bash offers at the end of a line."""
    (tmp_path / "deck.k").write_text("*KEYWORD\n*PARAMETER\n$ a comment\nR v0            -5.0I ctype            5\nR dtplot, 1e-5\n*END\n")
    (tmp_path / "run.dump01.h5").touch()
    (tmp_path / "folder").mkdir()

    def offer(line):
        script = ('source "$1"; COMP_LINE=$2; COMP_POINT=${#2}; _slideline 2>/dev/null; printf "%s\\n" "${COMPREPLY[@]}"')
        done = subprocess.run([shutil.which("bash"), "-c", script, "bash", share / "bash-completion/completions/slideline", line],
                              cwd=tmp_path, capture_output=True, text=True, check=True)
        assert not done.stderr
        return set(done.stdout.split())
    return offer


@pytest.mark.parametrize("line, expected", [
    ("slideline ct", {"ctype="}), ("slideline i=deck.k ctype=", set("01234567")), ("slideline timing=i", {"interface"}),
    ("slideline i=d", {"deck.k"}), ("slideline i=f", {"folder/"}), ("slideline r=", {"run.dump01.h5", "folder/"}),
    ("slideline i=deck.k p:", {"v0=", "ctype=", "dtplot="}), ("slideline i=deck.k p:v", {"v0="}),
    ("slideline --v", {"--version"}), ("slideline che", {"check"}), ("slideline de", {"deck.k"})])
def test_bash(offered, line, expected):
    assert offered(line) == expected


@pytest.mark.parametrize("shell, name", [("zsh", "zsh/site-functions/_slideline"), ("fish", "fish/vendor_completions.d/slideline.fish")])
def test_other_shells(share, shell, name):
    """Where the shell is installed it reads its script."""
    text = (share / name).read_text()
    assert all(word in text for word in ("ctype", "interface", "jobid=", "--version"))
    if found := shutil.which(shell):
        subprocess.run([found, "-n", share / name], check=True)


def test_tools(share, tmp_path):
    """The tools' own completion is loaded when the shell asks for it."""
    (tmp_path / "slideline-tools").write_text(f'#!/bin/sh\nexec "{sys.executable}" -m slideline_tools.cli "$@"\n')
    (tmp_path / "slideline-tools").chmod(0o755)
    said = {"bash": f'. {share}/bash-completion/completions/slideline-tools; COMP_WORDS=(slideline-tools rep); COMP_CWORD=1; '
                    '_shtab_slideline_tools 2>/dev/null; echo "${COMPREPLY[@]}"',
            "zsh": f"compdef() {{ echo $1; }}; . {share}/zsh/site-functions/_slideline-tools 2>/dev/null",
            "fish": f"set fish_complete_path {share}/fish/vendor_completions.d; complete -C 'slideline-tools rep'"}
    expected = {"bash": "report", "zsh": "_shtab_slideline_tools", "fish": "report"}
    path = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "HOME": str(tmp_path)}
    for shell, script in said.items():
        if shutil.which(shell):
            done = subprocess.run([shell, "-c", script], env=path, capture_output=True, text=True, check=False)
            assert done.stdout.split()[:1] == [expected[shell]], (shell, done)


def test_man_pages(share, slideline):
    """Every word of the help is on the page, and every command of the tools."""
    page = (share / "man/man1/slideline.1").read_text().replace("\\-", "-")
    reported = subprocess.run([slideline, "--help"], capture_output=True, text=True, check=True).stdout
    missing = {word for word in re.findall(r"[A-Za-z0-9=.]+", reported) if word not in page}
    assert missing <= {"usage", "overrides", "for", "sweeps", "while", "it", "runs", "results", "prints", "exit", "status"}
    tools = (share / "man/man1/slideline-tools.1").read_text()
    assert all(f".SH {name}" in tools for name in ("REPORT", "COMPARE", "DRAW"))


def test_syntax(share):
    """Every keyword of a deck that the program reads is one, a wrong one is none."""
    grammar = json.loads((share / "slideline/vscode/slideline.tmLanguage.json").read_text())
    first = [(name["name"].split(".")[0], re.compile(name["match"])) for name in grammar["patterns"]]

    def kind(line):
        return next((name for name, pattern in first if pattern.search(line)), None)
    lines = [line for line in (ROOT / "input/press_fit/press_fit.k").read_text().splitlines() if line.startswith("*")]
    assert lines and {kind(line) for line in lines} == {"keyword"}
    assert kind("*CONTACT_NONE_SUCH") == "invalid" and kind("$ a comment") == "comment"
    assert all(name.strip("*") in (share / "vim/vimfiles/syntax/slideline.vim").read_text() or name == "*KEYWORD" for name in lines)


@pytest.mark.parametrize("name", RECIPES)
def test_one_version(name):
    assert re.search(RECIPES[name], (ROOT / name).read_text(encoding="utf-8"))
