# SPDX-License-Identifier: MIT
"""The table of the batch jobs: deviations are found, missing things are refused."""
import importlib.util
import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BATCH = ROOT / "tools" / "batch"


@pytest.fixture
def table():
    spec = importlib.util.spec_from_file_location("table", BATCH / "table.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


ROW = {"plastic_strain": 0.24, "rebound": 12.0, "episodes": 9}


def judged(table, tmp_path, row, reference=None):
    path = tmp_path / "reference.csv"
    table.write_rows(path, reference or {"level_1_type_1": ROW})
    return table.judge({"level_1_type_1": row}, path)


def test_equal_rows_agree(table, tmp_path):
    assert judged(table, tmp_path, ROW) == 0


@pytest.mark.parametrize("name, value", [
    ("plastic_strain", 0.26), ("plastic_strain", np.nan), ("rebound", -12.0), ("episodes", 14)])
def test_deviation_is_found_and_named(table, tmp_path, capsys, name, value):
    assert judged(table, tmp_path, {**ROW, name: value}) == 1
    assert f"level_1_type_1: {name}" in capsys.readouterr().out


def test_run_without_reference(table, tmp_path):
    assert judged(table, tmp_path, ROW, {"other": ROW}) == 1
    assert table.judge({"level_1_type_1": ROW}, tmp_path / "none.csv") == 2


@pytest.mark.parametrize("script", sorted(BATCH.glob("*.sh")), ids=lambda path: path.name)
def test_scripts_are_plain_shell(script):
    if os.access(script, os.X_OK):  # the others are sourced
        assert script.read_text().startswith("#!/bin/sh\n")
        assert "set -eu" in script.read_text()
    assert subprocess.run(["sh", "-n", str(script)], check=False).returncode == 0
