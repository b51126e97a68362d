# SPDX-License-Identifier: MIT
"""The set-up on machines that lack something: the program comes first, and what is missing is said."""
import os
import pathlib
import shutil
import subprocess

import pytest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
#: cmake that configures and builds in no time, as far as the scripts can see
CMAKE = """#!/bin/sh
echo "cmake $*" >>"$LOG"
case $1 in
--version) echo "cmake version 3.25.1" ;;
-S) while [ "$1" != -B ]; do shift; done
  mkdir -p "$2" && printf 'CMAKE_HOME_DIRECTORY:INTERNAL=%s\\nPython3_EXECUTABLE:FILEPATH=%s\\n' "$TREE" "$TREE/build/venv/bin/python" >"$2/CMakeCache.txt" ;;
--build) printf '#!/bin/sh\\necho it works\\n' >"$2/slideline"; chmod +x "$2/slideline" ;;
esac
"""
#: Python whose environments have a pip that finds no network
PYTHON = """#!/bin/sh
echo "python $*" >>"$LOG"
case "$1 $2" in
"-m venv") [ -z "${NO_VENV:-}" ] || { echo "ensurepip is not available"; exit 1; }
  mkdir -p "$3/bin" && cp "$0" "$3/bin/python" ;;
"-m pip") echo "ERROR: no network"; exit 1 ;;
esac
"""


@pytest.fixture
def tree(tmp_path):
    """A tree with the scripts, and a folder of programs that stand for the machine's."""
    shutil.copytree(TOOLS, tmp_path / "tools", ignore=shutil.ignore_patterns("slideline_tools*", "docs", "batch"))
    machine = tmp_path / "machine"
    machine.mkdir()
    for name, text in (("cmake", CMAKE), ("python3", PYTHON), ("gfortran", "#!/bin/sh\ncat >/dev/null  # else the pipe to it may break\n"), ("ninja", "#!/bin/sh\n"), ("g++", "#!/bin/sh\n"),
                       ("h5fc", "#!/bin/sh\n"), ("id", "#!/bin/sh\necho 1000\n")):
        (machine / name).write_text(text)
        (machine / name).chmod(0o755)
    for name in ("bash", "sh", "awk", "cat", "cksum", "cp", "date", "dirname", "flock", "grep", "head", "mkdir", "nproc",
                 "rm", "sed", "tail", "tr", "chmod"):
        if shutil.which(name):
            (machine / name).symlink_to(shutil.which(name))
    return tmp_path


def build(tree, script="build.sh", **variables):
    environment = {"PATH": str(tree / "machine"), "LOG": str(tree / "calls.txt"), "TREE": str(tree), **variables}
    return subprocess.run([shutil.which("bash"), tree / "tools" / script], env=environment, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize("variables, said", [({}, "pip failed"), ({"NO_VENV": "1"}, "python3 -m venv failed")])
def test_a_failing_pip_leaves_a_program(tree, variables, said):
    done = build(tree, **variables)
    assert done.returncode == 0, done.stderr
    assert said in done.stderr and "The program works without the Python tools. Missing are slideline-tools" in done.stderr
    assert "the program is build/release/slideline" in done.stdout
    assert os.access(tree / "build" / "release" / "slideline", os.X_OK)
    calls = (tree / "calls.txt").read_text().splitlines()
    if not variables:
        pip = next(k for k, call in enumerate(calls) if "-m pip" in call)
        assert any("--build" in call for call in calls[:pip]), "the program is built before anything comes over the network"


@pytest.mark.parametrize("variables, said", [({}, "pip failed"), ({"NO_VENV": "1"}, "python3 -m venv failed")])
def test_tests_need_the_tools(tree, variables, said):
    """They come while the program is built; the tests wait for both."""
    done = build(tree, "test.sh", **variables)
    assert done.returncode == 1 and done.stderr.count(said) == 1, done.stderr
    assert "testing" not in done.stdout
    assert ("--build" in (tree / "calls.txt").read_text()) == (not variables)


def test_the_line_to_type_is_complete(tree):
    """Without apt-get: all packages, those that the program is only better with too."""
    for name in ("cmake", "gfortran", "g++", "ninja", "h5fc", "python3"):
        (tree / "machine" / name).unlink()
    done = build(tree)
    assert done.returncode == 1
    line = next(text for text in done.stderr.splitlines() if "apt-get install" in text)
    assert line.split("-y ", 1)[1].split() == ["gfortran", "libc6-dev", "liblapack-dev", "g++", "cmake", "ninja-build", "libhdf5-dev",
                                               "python3", "python3-venv", "libsuitesparse-dev"]
