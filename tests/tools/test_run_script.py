# SPDX-License-Identifier: MIT
"""tools/run.sh understands its words as the program does."""
import pathlib
import shutil
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: what the script sources, with nothing to install or to build
SETUP = """root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$root/venv
help_or_go_on() { :; }
say() { :; }
complain() { printf '%s\\n' "$*" >&2; }
lock() { :; }
unlock() { :; }
install_packages() { :; }
install_tools() { :; }
build() { :; }
"""
#: a program that says its words and leaves the states where they say
PROGRAM = """#!/bin/sh
printf '%s\\n' "$@" >words
mkdir -p "$FOLDER" && : >"$FOLDER/$JOB.vtkhdf"
"""


@pytest.fixture
def run(tmp_path):
    """run(folder, job, *words): the words of the program and of the tool that draws."""
    for name, text in (("tools/setup.sh", SETUP), ("build/release/slideline", PROGRAM),
                       ("venv/bin/slideline-tools", "#!/bin/sh\nprintf '%s\\n' \"$@\" >drawn\n")):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    shutil.copy(ROOT / "tools/run.sh", tmp_path / "tools")
    (tmp_path / "block.k").write_text("*KEYWORD\n")

    def call(folder, job, *words):
        done = subprocess.run([tmp_path / "tools/run.sh", *words], cwd=tmp_path, capture_output=True, text=True,
                              env={"PATH": "/usr/bin:/bin", "FOLDER": str(tmp_path / folder), "JOB": job})
        assert done.returncode == 0, done.stderr
        call.reported = done.stderr
        return [(tmp_path / name).read_text().split() if (tmp_path / name).exists() else None for name in ("words", "drawn")]
    return call


@pytest.mark.parametrize("words", [("i=block.k", "d=out", "jobid=first"), ("I=block.k", "D=out", "JOBID=first"),
                                   ("block.k", "D=out", "JobId=first")])
def test_names_in_either_case(run, words):
    said, drawn = run("out", "first", *words)
    assert said == ["i=block.k", *words[1:]]
    assert drawn == ["plot", "out/first.vtkhdf", "--output", "out/first.png"]


def test_folder_of_its_own_where_none_is_named(run, tmp_path):
    said, drawn = run("results/block", "block", "block.k", "ncpu=2")
    assert said == ["i=block.k", f"d={tmp_path}/results/block", "ncpu=2"]
    assert drawn[1] == f"{tmp_path}/results/block/block.vtkhdf"


def test_nodump_names_no_folder(run, tmp_path):
    said, drawn = run("results/block", "block", "block.k", "d=nodump")
    assert said == ["i=block.k", f"d={tmp_path}/results/block", "d=nodump"]
    assert drawn[1] == f"{tmp_path}/results/block/block.vtkhdf"


def test_no_picture_without_the_tools(run, tmp_path):
    (tmp_path / "venv/bin/slideline-tools").unlink()
    assert run("out", "block", "block.k", "d=out") == [["i=block.k", "d=out"], None]
    assert run.reported == "no picture without the Python tools; the results are complete\n"
