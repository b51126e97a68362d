# SPDX-License-Identifier: MIT
"""Counted instructions: the profile that is read, two counts of one run, and counted jobs of a study."""
import os
import pathlib
import platform
import shutil
import subprocess
import sys

import pandas as pd
import pytest

from slideline_tools import UserError, counting, scenes
from slideline_tools.studies.framework import runner, table
from slideline_tools.studies.framework.job import Job, Study, counted_job
from slideline_tools.studies.framework.progress import Progress

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Contact calls itself, memcpy and the allocator; memcpy is called by others too.
PROFILE = """# callgrind format
events: Ir

fn=__run_m_MOD_run_deck
10 100
cfn=__interface_m_MOD_apply_contact.isra.0
calls=2 0
10 1700
cfn=memcpy
calls=1 0
11 50

fn=__interface_m_MOD_apply_contact.isra.0
20 1000
cfn=__points_nts_m_MOD_points_nts
calls=1 0
21 600
cfn=memcpy
calls=1 0
22 100
cfn=__wrap_malloc
calls=2 0
23 CHANCE

fn=__points_nts_m_MOD_points_nts
30 600

fn=memcpy
40 150

fn=__quad_m_MOD_advance_chunk
50 30
fn=__candidates_m_MOD_list_pairs
60 7

totals: 1887
"""


def test_parts_of_a_profile_hold_what_they_call_once(tmp_path):
    for chance in ("77", "463"):
        (tmp_path / "out").write_text(PROFILE.replace("CHANCE", chance))
        found = counting.read_profile(tmp_path / "out")
        contact = 1000 + 600 + 100 + 2 * counting.ALLOCATION + 7
        assert found == counting.Counts(1887, {"contact": contact, "elements": 30}, counting.CALLGRIND)
    (tmp_path / "out").write_text("nothing\n")
    with pytest.raises(UserError):
        counting.read_profile(tmp_path / "out")


def test_a_command_that_fails_says_why(tmp_path, monkeypatch):
    if not shutil.which("valgrind"):
        pytest.skip("valgrind is not installed")
    with pytest.raises(UserError, match="exit status 3\n(.*\n)*.*odd"):
        counting.count_instructions(["/bin/sh", "-c", "echo odd >&2; exit 3"], tmp_path)


def test_a_machine_that_can_not_count_says_so(monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(UserError, match="valgrind is not installed"):
        counting.require_counter()


def test_two_counts_of_a_run_agree(tmp_path):
    """Beside whatever else runs here; and contact is a small part of a short collision, but not nothing.

    The steps agree to 1e-6, all in all to 1e-2: the clock decides how often the file of the status is written, 73,000 of 3e7
    instructions each time, one or two more on a busy machine. Each has a folder of its own: files that are there already are replaced.
    """
    if "SLIDELINE" not in os.environ:
        pytest.skip("SLIDELINE is not set")
    try:
        counting.require_counter()
    except UserError as problem:
        pytest.skip(str(problem))
    deck = tmp_path / "collision.k"
    deck.write_text(scenes.collision(1))
    command = [os.environ["SLIDELINE"], f"i={deck}", "ctype=5", "ncpu=1", "endtim=2e-6", "p:dtplot=1"]
    try:
        first, second = (counting.count_instructions([*command, f"d={tmp_path / name}"], tmp_path / name) for name in ("a", "b"))
    except UserError as problem:
        if "unrecognised" not in str(problem) and "Illegal" not in str(problem) and "SIGILL" not in str(problem):
            raise
        pytest.skip("this program has instructions that callgrind does not know")
    assert first.total > 1e6 and abs(first.total / second.total - 1.0) < 1e-2
    for part, count in first.parts.items():
        assert abs(count / second.parts[part] - 1.0) < 1e-6, part
    if first.parts:
        assert 0 < first.parts["contact"] < 0.5 * first.total


@pytest.fixture(scope="module")
def yardstick():
    """The yardstick for x86-64-v3, which callgrind knows."""
    if not shutil.which("valgrind") or platform.machine() != "x86_64":
        pytest.skip("no valgrind for x86-64 here")
    subprocess.run([ROOT / "tests/lab/bench/yardstick/run.sh", "x86-64-v3"], check=True, stdout=subprocess.DEVNULL)
    return ROOT / "build/yardstick/x86-64-v3/yardstick"


def test_two_counts_of_the_yardstick_agree_and_follow_its_work(yardstick, tmp_path):
    """A round is 200 passes over 96 elements. What it costs changes with the compiler alone: a tenth is allowed for."""
    once, again, longer = (counting.count_instructions([yardstick, rounds], tmp_path).total
                           for rounds in ("4", "4", "8"))
    assert abs(once / again - 1.0) < 1e-4
    assert (longer - once) / (4 * 200 * 96) == pytest.approx(45.8, rel=0.1)


# ---- counted jobs ------------------------------------------------------------------------------

STAND_IN = """import json, pathlib, sys
folder, program = sys.argv[1:3]
pathlib.Path(folder, "counts.json").write_text(json.dumps(
    {"total": 1000, "parts": {"contact": 300}, "by": "callgrind, x86-64-v3"}))
"""


def test_counted_jobs_are_rows_of_their_own(tmp_path, monkeypatch):
    """They take the other program, are not timed, and are run anew when that program changes alone."""
    stand_in = tmp_path / "counting.py"
    stand_in.write_text(STAND_IN)
    plain = tmp_path / "program"
    plain.write_text("#!/bin/sh\n")
    plain.chmod(0o755)
    monkeypatch.setattr(runner.Sweep, "command", lambda sweep, job, deck: [str(plain)] if not job.counted else [
        sys.executable, str(stand_in), str(sweep.run_folder(job)), str(sweep.counted)])
    timed = Job("a", "deck", labels={"scene": "s", "level": 1, "type": 1}, alone=True, turns=3)
    jobs = [timed, counted_job(timed, ("endtim=1",))]
    assert (jobs[1].turns, jobs[1].alone, jobs[1].options) == (1, False, ("endtim=1",))
    study = Study("tiny", None, lambda job, folder: {"seconds": 1.0}, None)

    def rows(digest):
        sweep = runner.Sweep(tmp_path / "sweep", plain, "one", (pathlib.Path("other"), digest))
        sweep.run(jobs, 1, Progress())
        return table.table_of(study, jobs, sweep), {job.name: sweep.record(job) for job in jobs}

    found, before = rows("first")
    assert table.finished(found)["run"].tolist() == ["a"]
    row, = table.counted(found).to_dict("records")
    assert (row["instructions"], row["contact_instructions"], row["shortened"]) == (1000, 300, "endtim=1")
    _, after = rows("second")
    assert after["a"] == before["a"] and after["a_counted"]["fingerprint"] != before["a_counted"]["fingerprint"]


def test_who_counted_and_what_was_cut_short():
    runs = pd.DataFrame({"state": [table.COUNTED], "scene": ["s"], "shortened": ["endtim=1"], "counted_by": [counting.CALLGRIND]})
    text = table.who_counted(runs)
    assert "Counted by callgrind, x86-64-v3" in text and text.endswith("Cut short: s (endtim=1).")
    assert "No instructions were counted" in table.who_counted(runs[:0])
