# SPDX-License-Identifier: MIT
"""The scripts of tools/batch are plain shell."""
import os
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BATCH = ROOT / "tools" / "batch"


@pytest.mark.parametrize("script", sorted(BATCH.glob("*.sh")), ids=lambda path: path.name)
def test_scripts_are_plain_shell(script):
    if os.access(script, os.X_OK):  # the others are sourced
        assert script.read_text().startswith("#!/bin/sh\n")
        assert "set -eu" in script.read_text()
    assert subprocess.run(["sh", "-n", str(script)], check=False).returncode == 0
