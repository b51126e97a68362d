# SPDX-License-Identifier: MIT
"""Helpers of the documentation tests: SLIDELINE names the program."""
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/docs"))


@pytest.fixture(scope="session")
def exe():
    path = os.environ.get("SLIDELINE")
    if not path:
        pytest.exit("set SLIDELINE to the program to test", returncode=2)
    return pathlib.Path(path).resolve()
