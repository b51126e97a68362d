# SPDX-License-Identifier: MIT
"""The blocks of code of README.md, doc/tutorial.md and other pages run as they stand there.

A copy of the tree stands in for a fresh clone: its build/ holds the program under test and the Python
of the tests, so that nothing is compiled or installed. Blocks with a title are the files that the
reader is reported to save; lines of `sh` blocks run one after the other, and must end with status 0, or
with the one that their comment gives ("ends with status 1"). A `text` block without a title is what
the block above it prints, on a page without commands a figure. `python` blocks without a title run
after the commands of their page, as one script. Other kinds of blocks there are not, and an indented
block is a formula: nothing that a reader would copy stands in one.
"""
import importlib.util
import os
import pathlib
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
#: a run of a deck of the gallery; other pages look at what the collision leaves
GALLERY = r"build/release/slideline i=input/(?!collision)\S+ d=results/\w+"
#: beginnings of commands that take too long for a test -> what runs in their place
SHORTER = {
    "build/venv/bin/slideline-tools animate results/collision/": f"{FEW_STATES} && {{command}}",
    "build/venv/bin/slideline-tools animate results/first/": FEW_OF_FIRST,
    "tools/run.sh input/taylor/": "{command} endtim=2e-5",
    "tools/test.sh": "test -x tools/test.sh",  # this test is part of it
    "tools/study.sh": "{command} --list",      # tests/tools runs studies
    "python3 tools/docs/messages.py": "test -f tools/docs/messages.py",  # reads src, which the copy is without
    "tools/docs.sh": "bash -n tools/docs.sh",  # installs from the network
    "tools/batch/run_folder.sh": "{command} endtim=1e-5",
    "cmake -S . -B build/mine": "grep -q SLIDELINE_TESTS CMakeLists.txt",  # compiles
    "cmake --build build/mine": "grep -q slideline CMakeLists.txt",
    "python3 -m venv build/venv": "test -x build/venv/bin/python",
    "build/venv/bin/python -m pip install -e ./tools": "test -f tools/pyproject.toml",
    "tar -xzf": "mkdir -p {package}/bin && ln -s $PWD/build/release/slideline {package}/bin && "
                "mkdir -p {package}/share/slideline && cp -r input {package}/share/slideline/examples && "
                "tar -czf {package}.tar.gz {package} && rm -r {package} && {command}",
    "slideline-0.4.0/bin/slideline": "{command} endtim=2e-5 && rm -r {package} {package}.tar.gz",
    "build/venv/bin/python results/hertz_mesh.py": "build/venv/bin/python {here}/coarse_hertz.py results/hertz.msh",  # gmsh
    "SLIDELINE=build/release/slideline build/venv/bin/python tests/lab/fuzz/": "test -f $(echo '{command}' | cut -d' ' -f3)",
    "SLIDELINE_FUZZ=600 tools/test.sh": "test -x tools/test.sh",
    "build/venv/bin/python tests/lab/fuzz/": "test -f $(echo '{command}' | cut -d' ' -f2)",
}
PACKAGE = "slideline-0.4.0"
#: what a page has the reader install first, if it is not there: its block is compiled only
EXTRAS = {"pyvista", "lasso"}
#: what may lie at the top of the tree after the commands
TOP = {"CMakeLists.txt", "build", "doc", "input", "results", "tests", "tools"}
NINJA = "rule nothing\n  command = true\nbuild slideline: nothing\ndefault slideline\n"
#: slideline-tools with pictures as those of draw_plainly of tests/tools, where others are drawn in full
PLAIN = """import sys
from unittest import mock

from slideline_tools import cli

if {"animate", "draw", "plot", "report"} & set(sys.argv[1:2]):
    import matplotlib
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    from slideline_tools import plots
    matplotlib.rcParams["text.parse_math"] = False
    plots.STYLE.update({"figure.dpi": 60, "savefig.dpi": 60, "text.parse_math": False})
    ConstrainedLayoutEngine.execute = mock.Mock()
sys.exit(cli.main())
"""
CACHE = """CMAKE_PROJECT_NAME:STATIC=slideline
CMAKE_GENERATOR:INTERNAL=Ninja
CMAKE_HOME_DIRECTORY:INTERNAL={root}
CMAKE_MAKE_PROGRAM:FILEPATH={ninja}
Python3_EXECUTABLE:FILEPATH={root}/build/venv/bin/python
"""


def blocks(name):
    """(info string, text) of the code blocks of a page."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return re.findall(r"^```([^\n]*)\n(.*?)^```$", text, flags=re.M | re.S)


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
                           if "\n```" in path.read_text(encoding="utf-8"))})


@pytest.fixture(scope="module")
def clone(exe, tmp_path_factory):
    """The tree, with a build/ as tools/build.sh leaves it."""
    top = tmp_path_factory.mktemp("clone") / "slideline"
    top.mkdir()
    shutil.copy(ROOT / "CMakeLists.txt", top)
    for folder in ("doc", "input", "tools"):
        shutil.copytree(ROOT / folder, top / folder,
                        ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    (top / "tests").symlink_to(ROOT / "tests")
    release, venv = top / "build/release", top / "build/venv/bin"
    release.mkdir(parents=True)
    venv.mkdir(parents=True)
    (release / "slideline").symlink_to(exe)
    (release / "build.ninja").write_text(NINJA)
    (release / "CMakeCache.txt").write_text(
        CACHE.format(root=top, ninja=shutil.which("ninja") or "ninja"))
    (top / "build/plain.py").write_text(PLAIN)
    environment = f"PYTHONPATH='{top}/tools' MPLBACKEND=Agg exec '{sys.executable}'"
    for name, what in (("python", ""), ("slideline-tools", f"'{top}/build/plain.py'")):
        (venv / name).write_text(f'#!/bin/sh\n{environment} {what} "$@"\n')
        (venv / name).chmod(0o755)
    checksum = subprocess.run(["cksum"], stdin=open(top / "tools/pyproject.toml"),
                              capture_output=True, text=True, check=True).stdout.strip()
    (venv.parent / "installed").write_text(f"{top} {checksum}\n")
    (top / "build/useful.log").touch()
    return top


@pytest.mark.parametrize("name", PAGES)
def test_commands(name, clone):
    n_run, printed, scripts = 0, None, []
    for info, text in blocks(name):
        title = re.search(r'title="([^"]+)"', info)
        if title:
            (clone / title.group(1)).parent.mkdir(exist_ok=True)
            (clone / title.group(1)).write_text(text)
            if info.startswith("python"):
                compile(text, title.group(1), "exec")
        elif info.strip() == "text":
            assert printed is None or text in printed, f"the commands above it do not print\n{text}"
        elif info.strip() == "python":
            scripts.append(text)
        else:
            assert info.strip() == "sh", f"a block of '{info}' is not tried"
            printed = ""
            for command in commands_of(text):
                if name == "doc/gallery.md":  # tests/program runs these decks
                    command = re.sub(f"^({GALLERY})( ctype=.)?.*", r"\1\2 endtim=1e-5", command)
                printed += run_command(command, clone)
                n_run += 1
    run_python(scripts, clone)
    assert n_run >= FEWEST.get(name, 0)
    assert {path.name for path in clone.iterdir()} <= TOP, "files are left beside the sources"


def run_python(scripts, clone):
    """Run blocks of Python as one script; the runs of a sweep are short."""
    able = []
    for text in scripts:
        compile(text, "block", "exec")
        if all(importlib.util.find_spec(name) for name in EXTRAS & set(re.findall(r"^(?:import|from) (\w+)", text, re.M))):
            able.append(text)
    if not able:
        return
    short = clone / "build/short"
    short.write_text(f'#!/bin/sh\ncase "$*" in *-sweep/*) set -- "$@" endtim=4e-5;; esac\n'
                     f'exec "{clone}/build/release/slideline" "$@"\n')
    short.chmod(0o755)
    (clone / "build/blocks.py").write_text("\n".join(able))
    run_command("SLIDELINE=build/short build/venv/bin/python build/blocks.py", clone)


def run_command(command, clone):
    """Run one command; returns what it prints."""
    wanted = re.search(r"# .*ends with status (\d)", command)
    for beginning, instead in SHORTER.items():
        if command.startswith(beginning):
            command = instead.format(command=re.sub(r"\s+#.*", "", command), package=PACKAGE, here=pathlib.Path(__file__).parent)
            break
    done = subprocess.run(["bash", "-c", command], cwd=clone, capture_output=True, text=True,
                          timeout=200, env={**os.environ, "MPLBACKEND": "Agg",
                                            "PATH": f"{clone}/build/release:{clone}/build/venv/bin:{os.environ['PATH']}"})
    status = int(wanted.group(1)) if wanted else 0
    assert done.returncode == status, f"{command}\n{done.stdout[-1500:]}{done.stderr[-1500:]}"
    return done.stdout + done.stderr


#: what a line that a reader would copy begins with
COPIED = re.compile(r"(?:\w+=\S+ )*(?:[\w./-]*/)?(?:slideline(?:-tools)?|python3?|pip|cmake|ctest|tar|echo|export|apt\S*|git|cd|\w+\.sh)\s|"
                    r"(?:import|from) \w|(?:\w+ = )?slideline_tools\.|\*[A-Z]")
FORMULAS = ("doc/theory/", "doc/studies/", "tests/verification/")
WRITTEN = ["README.md", *(path.relative_to(ROOT).as_posix() for folder in ("doc", "tools", "tests")
                          for path in sorted((ROOT / folder).rglob("*.md")))]


def indented(text):
    """The lines of the indented blocks of a page."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S)
    return [line for block in re.findall(r"\n\n((?: {4}.*\n|\n(?= {4}))+)", text) for line in block.splitlines() if line.strip()]


def test_nothing_to_copy_is_indented():
    """An indented block is seen by no test, and was once filled anew as prose."""
    wrong = [f"{name}: {line.strip()}" for name in WRITTEN for line in indented((ROOT / name).read_text(encoding="utf-8"))
             if COPIED.match(line.strip()) or not name.startswith(FORMULAS)]
    assert not wrong
    assert indented("text\n\n    import this\n    x = 1\n\nmore\n") == ["    import this", "    x = 1"]


@pytest.mark.parametrize("name", [name for name in WRITTEN if name.startswith("tests/")
                                  and "\n```" in (ROOT / name).read_text(encoding="utf-8")])
def test_commands_of_the_tests_name_what_is_there(name, tmp_path):
    """They take hours or programs of others: their scripts are there, and a test in Fortran is translated."""
    for info, text in blocks(name):
        if info == "fortran":
            module = re.search(r"^module (\w+)", text, re.M)[1]
            (tmp_path / f"{module}.pf").write_text(re.sub(r"^(module \w+) .*", r"\1", text, flags=re.M))
            subprocess.run([sys.executable, ROOT / "tests/unit/support/pf2f90.py", tmp_path / f"{module}.pf", tmp_path / "out.f90"],
                           check=True)
            continue
        assert info == "sh"
        named = [word for command in commands_of(text) for word in command.split() if word.endswith(".py")]
        assert named and all((ROOT / word).is_file() or (ROOT / name).with_name(word).is_file() for word in named)
