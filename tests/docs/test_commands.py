# SPDX-License-Identifier: MIT
"""The commands of README.md, doc/tutorial.md and other pages run as they stand there.

A copy of the tree stands in for a fresh clone: its build/ holds the program under test and the Python
of the tests, so that nothing is compiled or installed. Blocks with a title are the files that the
reader is told to save; lines of `sh` blocks run one after the other, and must end with status 0, or
with the one that their comment gives ("ends with status 1"). A `text` block without a title is what
the block above it prints.
"""
import os
import re
import shutil
import subprocess
import sys

import pytest

from conftest import ROOT

#: page -> fewest commands that it is known to have: a page that loses its blocks fails
FEWEST = {"README.md": 4, "doc/first_steps.md": 12, "doc/tutorial.md": 12, "tools/README.md": 2}
FEW_STATES = "build/release/slideline i=input/collision/collision.k d=results/collision p:dtplot=2e-4"
FEW_OF_FIRST = ("build/release/slideline i=results/first.k d=results/few jobid=first endtim=4e-3 quiet=1 && "
                "$(echo '{command}' | sed 's,results/first/,results/few/,')")
#: beginnings of commands that take too long for a test -> what runs in their place
SHORTER = {
    "build/venv/bin/slideline-tools animate results/collision/": f"{FEW_STATES} && {{command}}",
    "build/venv/bin/slideline-tools animate results/first/": FEW_OF_FIRST,
    "tools/run.sh input/taylor/": "{command} endtim=2e-5",
    "tools/test.sh": "test -x tools/test.sh",  # this test is part of it
    "tools/study.sh": "{command} --list",      # tests/tools runs studies
    "tools/docs.sh": "bash -n tools/docs.sh",  # installs from the network
}
#: what may lie at the top of the tree after the commands
TOP = {"CMakeLists.txt", "build", "doc", "input", "results", "tools"}
NINJA = "rule nothing\n  command = true\nbuild slideline: nothing\ndefault slideline\n"
CACHE = """CMAKE_PROJECT_NAME:STATIC=slideline
CMAKE_GENERATOR:INTERNAL=Ninja
CMAKE_HOME_DIRECTORY:INTERNAL={root}
CMAKE_MAKE_PROGRAM:FILEPATH={ninja}
Python3_EXECUTABLE:FILEPATH={root}/build/venv/bin/python
"""


def blocks(name):
    """(info string, text) of the code blocks of a page."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.findall(r"^```(\S[^\n]*)\n(.*?)^```$", text, flags=re.M | re.S)


def commands_of(block):
    """The commands of a block: lines, with continuations and loops held together."""
    found, ahead = [], ""
    for line in block.splitlines():
        ahead = f"{ahead}\n{line}" if ahead else line
        check = subprocess.run(["bash", "-n", "-c", ahead], capture_output=True)
        if check.returncode == 0 and not line.endswith("\\"):
            if ahead.strip() and not ahead.lstrip().startswith("#"):
                found.append(ahead)
            ahead = ""
    assert not ahead, f"this is no command: {ahead}"
    return found


PAGES = sorted({*FEWEST, *(path.relative_to(ROOT).as_posix()
                           for path in (ROOT / "doc").rglob("*.md")
                           if "\n```sh" in path.read_text(encoding="utf-8"))})


@pytest.fixture(scope="module")
def clone(exe, tmp_path_factory):
    """The tree, with a build/ as tools/build.sh leaves it."""
    top = tmp_path_factory.mktemp("clone") / "slideline"
    top.mkdir()
    shutil.copy(ROOT / "CMakeLists.txt", top)
    for folder in ("doc", "input", "tools"):
        shutil.copytree(ROOT / folder, top / folder,
                        ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    release, venv = top / "build/release", top / "build/venv/bin"
    release.mkdir(parents=True)
    venv.mkdir(parents=True)
    (release / "slideline").symlink_to(exe)
    (release / "build.ninja").write_text(NINJA)
    (release / "CMakeCache.txt").write_text(
        CACHE.format(root=top, ninja=shutil.which("ninja") or "ninja"))
    environment = f"PYTHONPATH='{top}/tools' MPLBACKEND=Agg exec '{sys.executable}'"
    for name, what in (("python", ""), ("slideline-tools", "-m slideline_tools.cli")):
        (venv / name).write_text(f'#!/bin/sh\n{environment} {what} "$@"\n')
        (venv / name).chmod(0o755)
    checksum = subprocess.run(["cksum"], stdin=open(top / "tools/pyproject.toml"),
                              capture_output=True, text=True, check=True).stdout.strip()
    (venv.parent / "installed").write_text(f"{top} {checksum}\n")
    (top / "build/useful.log").touch()
    return top


@pytest.mark.parametrize("name", PAGES)
def test_commands(name, clone):
    n_run, printed = 0, ""
    for info, text in blocks(name):
        title = re.search(r'title="([^"]+)"', info)
        if title:
            (clone / title.group(1)).parent.mkdir(exist_ok=True)
            (clone / title.group(1)).write_text(text)
        elif info.strip() == "text":
            assert text in printed, f"the commands above it do not print\n{text}"
        elif info.split()[0] == "sh":
            printed = ""
            for command in commands_of(text):
                printed += run_command(command, clone)
                n_run += 1
    assert n_run >= FEWEST.get(name, 1)
    assert {path.name for path in clone.iterdir()} <= TOP, "files are left beside the sources"


def run_command(command, clone):
    """Run one command; returns what it prints."""
    wanted = re.search(r"# .*ends with status (\d)", command)
    for beginning, instead in SHORTER.items():
        if command.startswith(beginning):
            command = instead.format(command=re.sub(r"\s+#.*", "", command))
    done = subprocess.run(["bash", "-c", command], cwd=clone, capture_output=True, text=True,
                          timeout=200, env={**os.environ, "MPLBACKEND": "Agg"})
    status = int(wanted.group(1)) if wanted else 0
    assert done.returncode == status, f"{command}\n{done.stdout[-1500:]}{done.stderr[-1500:]}"
    return done.stdout + done.stderr
