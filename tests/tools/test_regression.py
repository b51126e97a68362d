# SPDX-License-Identifier: MIT
"""Regression cases with a stand-in program: agreement, deviation, breakdown, renewal."""
import stat
import subprocess
import sys

import conftest
import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.compare import compare
from slideline_tools.histories import History, read_csv

sys.path.append(str(conftest.ROOT / "tests" / "regression"))

from regression import (ROWS, Case, CaseError, at_times_of, digits_that_matter, kept_rows,  # noqa: E402
                        renew, run_case, tolerance, write_reference)

# A shell finds the Python, whose path may hold blanks; to Python the second line is a string.
STAND_IN = """#!/bin/sh
'''exec' "{python}" "$0" "$@"
'''
import pathlib, sys
values = dict(word.split("=", 1) for word in sys.argv[1:] if "=" in word)
if "--version" in sys.argv:
    print("stand-in 1.0")
    sys.exit(0)
factor = float(values.get("factor", "1"))
if factor < 0:
    print("Error: it broke", file=sys.stderr)
    sys.exit(2)
rows = ["time,part,kinetic,mass"]
for step in range(int(values.get("steps", "11"))):
    for part in (1, 2):
        rows.append("%r,%d,%r,1.0" % (0.1 * step, part, factor * part * step ** 2))
out = pathlib.Path(values["d"], values["jobid"] + ".matsum.csv")
out.write_text("\\n".join(rows) + "\\n")
"""

CASE = """deck = "input/none.k"
arguments = ["factor={factor}"]

[[table]]
name = "matsum"
columns = ["kinetic"]
where = {{ part = 2 }}
rtol = 1e-3
"""


@pytest.fixture
def world(tmp_path):
    """A repository with one case and a stand-in for the program."""
    folder = tmp_path / "tests" / "regression" / "small"
    folder.mkdir(parents=True)
    program = tmp_path / "program"
    program.write_text(STAND_IN.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    write_case(folder, 1)
    return tmp_path, folder, program


def write_case(folder, factor):
    (folder / "case.toml").write_text(CASE.format(factor=factor))


def judge(world, capsys):
    root, folder, program = world
    status = run_case(Case(folder, root), program, root / "work", sys.stdout)
    return status, capsys.readouterr().out


def bless(world, reason="first"):
    root, folder, program = world
    renew(Case(folder, root), program, root / "work", reason)


def test_blessed_reference_agrees_and_keeps_the_reason(world, capsys):
    bless(world, 'first "reference"')
    assert judge(world, capsys)[0] == 0
    case = Case(world[1], world[0])
    assert case.content["blessed"][0]["reason"] == 'first "reference"'
    assert case.content["blessed"][0]["version"] == "stand-in 1.0"
    lines = (world[1] / "matsum.csv").read_text().splitlines()
    assert lines[0] == "time,part,kinetic" and len(lines) == 12
    bless(world, "second")
    assert [note["reason"] for note in Case(world[1], world[0]).content["blessed"]] == [
        'first "reference"', "second"]


def test_entries_that_share_a_reference_are_all_renewed(world, capsys):
    """One file with the columns of both; the last entry alone was left before."""
    path = world[1] / "case.toml"
    path.write_text(path.read_text() + '\n[[table]]\nname = "matsum"\ncolumns = ["mass"]\nwhere = { part = 2 }\n'
                                       'rtol = 0.1\n')
    bless(world)
    assert (world[1] / "matsum.csv").read_text().splitlines()[0] == "time,part,kinetic,mass"
    assert judge(world, capsys)[0] == 0


def test_changed_result_fails_and_names_the_column(world, capsys):
    bless(world)
    write_case(world[1], 1.01)
    status, text = judge(world, capsys)
    assert status == 1
    assert "failed: kinetic" in text


@pytest.mark.parametrize("steps, why", [(9, "the run ends at 0.8, the reference at 1"), (13, "the run ends at 1.2, the reference at 1")])
def test_run_of_another_length_fails(world, capsys, steps, why):
    bless(world)
    path = world[1] / "case.toml"
    path.write_text(path.read_text().replace("factor=1", f"steps={steps}"))
    status, text = judge(world, capsys)
    assert status == 2 and why in text


def long_table(moved=None, by=0.0):
    """Two nodes, 500 rows each, at rest for the first 100 times; row `moved` of the second node deviates."""
    time = np.repeat(np.arange(500)/3.0, 2)
    vy = np.where(time < 100.0/3.0, 0.0, 1.0 + np.sin(time))
    if moved is not None:
        vy[moved] += by
    return History("nodout", {"time": time, "node": np.tile([7, 8], 500), "vy": vy})


def test_reference_keeps_rows_in_which_something_happens(tmp_path):
    table = long_table()
    rows = kept_rows(table, ["time", "node", "vy"])
    assert len(rows) == 20 and rows[0] == 0 and rows[-1] == 999 and rows[1] > 200
    assert set(np.diff(rows[1:])) <= {42, 43}
    write_reference(tmp_path / "nodout.csv", table.rows(rows), ["time", "node", "vy"], digits_that_matter({"rtol": 1e-5}))
    assert (tmp_path / "nodout.csv").read_text().splitlines()[2].split(",")[2] == f"{table['vy'][rows[1]]:.7g}"
    assert [digits_that_matter({"rtol": 1e-3, "tolerance": {"vy": {"rtol": rtol}}}) for rtol in (1e-2, 1e-6)] == [5, 8]


def test_only_the_kept_rows_are_compared_each_within_its_tolerance(tmp_path):
    rows = kept_rows(long_table(), ["vy"])
    write_reference(tmp_path / "nodout.csv", long_table().rows(rows), ["time", "node", "vy"], 7)
    reference, entry = read_csv(tmp_path / "nodout.csv"), tolerance({"rtol": 1e-5, "floor": 1e-5})

    def passes(*deviation):
        return compare(at_times_of(reference, long_table(*deviation)), reference, ["vy"], {}, entry).passed

    assert passes() and passes(rows[5] + 1, 1.0)
    for row in rows:
        allowed = 1e-5*(np.max(reference["vy"]) + abs(long_table()["vy"][row]))
        assert passes(row, 0.8*allowed) and not passes(row, 1.2*allowed)


def test_rows_of_other_entities_or_none_fail():
    reference = long_table().rows(kept_rows(long_table(), ["vy"]))
    for wrong in (long_table().where(node=7), long_table().rows(slice(0, 0))):
        with pytest.raises(UserError):
            at_times_of(reference, wrong)


def test_program_that_breaks_down(world, capsys):
    bless(world)
    write_case(world[1], -1)
    status, text = judge(world, capsys)
    assert status == 2
    assert "status 2" in text and "it broke" in text


def test_missing_reference_and_missing_program(world, capsys):
    status, text = judge(world, capsys)
    assert status == 2 and "cannot read" in text
    world[2].unlink()
    status, text = judge(world, capsys)
    assert status == 2 and "cannot start" in text


def test_old_results_are_not_judged(world, capsys):
    """A program that writes nothing must not pass with the files of an earlier run."""
    bless(world)
    assert judge(world, capsys)[0] == 0
    world[2].write_text("#!/bin/sh\n")
    status, text = judge(world, capsys)
    assert status == 2 and "cannot read" in text


@pytest.mark.parametrize("content", ["", 'deck = "x.k"', "deck = ", '[[table]]\nname = "a"'])
def test_broken_case(world, content):
    (world[1] / "case.toml").write_text(content)
    with pytest.raises(CaseError):
        Case(world[1], world[0])


def test_runner_script(world, slideline, tmp_path):
    """The script beside the cases refuses an unknown case."""
    script = conftest.ROOT / "tests" / "regression" / "run_case.py"
    finished = subprocess.run([sys.executable, str(script), "none", "--program", slideline,
                               "--work", str(tmp_path)], capture_output=True, text=True,
                              check=False)
    assert finished.returncode == 2 and "case.toml" in finished.stdout
    finished = subprocess.run([sys.executable, str(script), CASES[0].parent.name, "--bless", " "],
                              capture_output=True, text=True, check=False)
    assert finished.returncode == 2 and "reason" in finished.stdout


CASES = sorted((conftest.ROOT / "tests" / "regression").glob("*/case.toml"))


@pytest.mark.parametrize("file", CASES, ids=lambda file: file.parent.name)
def test_kept_case_is_complete(file):
    """Deck and references exist, agree with themselves, and somebody said why."""
    case = Case(file.parent, conftest.ROOT)
    assert (conftest.ROOT / case.content["deck"]).is_file()
    assert all(note["reason"].strip() for note in case.content["blessed"])
    for entry in case.content["table"]:
        reference = read_csv(case.reference_file(entry))
        assert compare(reference, reference, entry["columns"]).passed
        assert len(reference) <= ROWS
