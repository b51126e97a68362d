# SPDX-License-Identifier: MIT
"""The launcher of the package starts the fastest build that the processor can run."""
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Words of /proc/cpuinfo: an Opteron of 2003, a Nehalem, a Zen 2 and a Skylake server, shortened.
OPTERON = "fpu cx8 cmov mmx fxsr sse sse2 syscall lm pni cx16"
NEHALEM = OPTERON + " lahf_lm popcnt ssse3 sse4_1 sse4_2"
ZEN_2 = NEHALEM + " avx avx2 bmi1 bmi2 f16c fma abm movbe xsave clzero"
SKYLAKE = ZEN_2 + " avx512f avx512bw avx512cd avx512dq avx512vl"


@pytest.fixture
def start(tmp_path):
    """start(flags, level=None): run the launcher of a package of three builds that say their names."""
    (tmp_path / "a package" / "bin").mkdir(parents=True)
    launcher = shutil.copy(ROOT / "tools/package/slideline", tmp_path / "a package" / "bin")
    for level in ("x86-64-v2", "x86-64-v3", "x86-64-v4"):
        build = tmp_path / "a package" / "lib/slideline" / level / "slideline"
        build.parent.mkdir(parents=True)
        build.write_text(f'#!/bin/sh\necho {level} "$@"\nexit 3\n')
        build.chmod(0o755)
    (tmp_path / "link").symlink_to(launcher)

    def call(flags, *words, **variables):
        (tmp_path / "cpuinfo").write_text(f"processor\t: 0\nflags\t\t: {flags}\nbugs\t\t: avx2\n\n"
                                          f"processor\t: 1\nflags\t\t: {flags}\n")
        environment = {**os.environ, "SLIDELINE_CPUINFO": str(tmp_path / "cpuinfo"), **variables}
        return subprocess.run([tmp_path / "link", *words], env=environment, capture_output=True, text=True)
    return call


@pytest.mark.parametrize("flags, level", [(NEHALEM, "x86-64-v2"), (ZEN_2, "x86-64-v3"),
                                          (SKYLAKE, "x86-64-v4")])
def test_fastest_build_is_started(start, flags, level):
    done = start(flags, "i=my deck.k", "ncpu=2")
    assert done.stdout == f"{level} i=my deck.k ncpu=2\n"
    assert done.returncode == 3


@pytest.mark.parametrize("lacking", ["avx512vl", "fma", "movbe"])
def test_every_flag_counts(start, lacking):
    flags = " ".join(word for word in SKYLAKE.split() if word != lacking)
    assert start(flags).stdout.split() == ["x86-64-v3" if lacking == "avx512vl" else "x86-64-v2"]


def test_build_that_is_asked_for(start):
    assert start(SKYLAKE, SLIDELINE_LEVEL="x86-64-v2").stdout == "x86-64-v2\n"
    assert start(ZEN_2, SLIDELINE_LEVEL="x86-64-v4").returncode == 1


def test_old_processor_is_reported(start):
    done = start(OPTERON)
    assert done.returncode == 1 and done.stdout == ""
    assert "no build" in done.stderr


def test_unknown_processor_is_reported(start, tmp_path):
    done = start(ZEN_2, SLIDELINE_CPUINFO=str(tmp_path / "nowhere"))
    assert done.returncode == 1 and done.stderr == f"slideline: cannot read {tmp_path / 'nowhere'}, which says what this processor can run\n"


def test_tools_name_what_is_missing(tmp_path):
    """No Python, a Python without its packages, and one with them."""
    bare = tmp_path / "bare"
    bare.write_text(f'#!/bin/sh\nexec "{sys.executable}" -S "$@"\n')
    bare.chmod(0o755)
    for python, said in (("/none/such", "there is no /none/such"), (bare, "does not have numpy h5py matplotlib pandas jinja2 (pip")):
        done = subprocess.run([ROOT / "tools/package/slideline-tools", "info"], env={**os.environ, "PYTHON": str(python)},
                              capture_output=True, text=True)
        assert done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1 and not done.stdout
    (tmp_path / "bin").mkdir()
    shutil.copy(ROOT / "tools/package/slideline-tools", tmp_path / "bin")
    (tmp_path / "share/slideline").mkdir(parents=True)
    (tmp_path / "share/slideline/python").symlink_to(ROOT / "tools")
    done = subprocess.run([tmp_path / "bin/slideline-tools", "--version"], env={**os.environ, "PYTHON": sys.executable},
                          capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("slideline-tools ")
