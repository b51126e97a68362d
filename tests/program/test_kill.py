# SPDX-License-Identifier: MIT
"""Runs killed at any moment. SLIDELINE_KILLS=200 makes it long (tests/lab/README.md)."""
import importlib.util
import os

import kill_runs
import pytest

#: scenes of the short form: small, with and without contact, plastic, rigid and implicit
SHORT = ("drop", "plate_8x4_elastoplastic", "block_2", "patch_static", "oblique")


def test_killed_runs_leave_whole_files(exe, tmp_path):
    kills = int(os.environ.get("SLIDELINE_KILLS", "10"))
    seed = int(os.environ.get("SLIDELINE_SEED", "1"))
    sums = kill_runs.run_kills(exe, tmp_path, kills, seed, names=None if kills > 10 else SHORT,
                               vtk=importlib.util.find_spec("vtk") is not None, say=print)
    print(sums)
    assert sums["killed"] == kills and sums["states"] > 0 and sums["went on"] > 0


@pytest.fixture
def job(exe, tmp_path):
    return kill_runs.Job(exe, "drop", tmp_path)


@pytest.mark.parametrize("damage", ["state", "line", "restart"])
def test_the_checks_notice_damage(job, damage):
    """A state that was reported and is not there, half a line, a restart file with a wrong byte."""
    if damage == "state":
        with pytest.raises(AssertionError, match="reported"):
            kill_runs.check_results(job, job.whole, kill_runs.REPORTED * (len(job.times) + 1))
    elif damage == "line":
        path = job.whole / "job.glstat.csv"
        path.write_bytes(path.read_bytes()[:-7])
        with pytest.raises(AssertionError, match="within a line"):
            kill_runs.check_tables(job, job.whole)
    else:
        path = job.whole / "job.runrsf.h5"
        data = bytearray(path.read_bytes())
        data[3000] ^= 1
        path.write_bytes(data)
        with pytest.raises(AssertionError, match="runrsf"):
            kill_runs.check_restarts(job.whole, "")
