# SPDX-License-Identifier: MIT
"""The runner of refused decks must notice every way in which a deck is not refused as it should be."""
import subprocess
import sys

import pytest

from fortran_source import ROOT

RUNNER = ROOT / "tests/rejected/run_rejected.py"


def run(tmp_path, program, deck="$ expect: no such part\n*KEYWORD\n"):
    """Run the runner on one deck with a program that is the shell script `program`."""
    (tmp_path / "bad.k").write_text(deck)
    executable = tmp_path / "program"
    executable.write_text("#!/bin/sh\nfor a in \"$@\"; do case $a in d=*) d=${a#d=};; esac; done\n" + program)
    executable.chmod(0o755)
    return subprocess.run([sys.executable, RUNNER, "--program", executable, tmp_path / "bad.k"],
                          capture_output=True, text=True, check=False)


def test_refused_for_its_reason(tmp_path):
    done = run(tmp_path, "echo 'bad.k:3: no such part: 7' >&2; exit 1\n")
    assert done.returncode == 0
    assert done.stdout.splitlines()[-1] == "1 passed, 0 failed"


@pytest.mark.parametrize("program, deck, why", [
    ("exit 0\n", None, "exit status 0"),
    ("echo 'no such part' >&2; exit 2\n", None, "exit status 2"),
    ("echo 'no such set' >&2; exit 1\n", None, "not said: no such part"),
    ("echo 'no such part'; exit 1\n", None, "not said: no such part"),
    ("echo 'no such part' >&2; echo AddressSanitizer: heap >&2; exit 1\n", None, "crashed"),
    ("echo 'no such part' >&2; : >\"$d/x.vtkhdf\"; exit 1\n", None, "left behind: x.vtkhdf"),
    ("echo 'no such part' >&2; exit 1\n", "*KEYWORD\n", "no line"),
    ("echo 'no such part' >&2; exit 1\n", "$ expect: no such part\n$ expect: field 3\n",
     "not said: field 3"),
])
def test_anything_else_fails(tmp_path, program, deck, why):
    done = run(tmp_path, program, deck) if deck else run(tmp_path, program)
    assert done.returncode == 1
    assert why in done.stdout
    assert done.stdout.splitlines()[-1] == "0 passed, 1 failed"
