# SPDX-License-Identifier: MIT
"""Batches that are killed and taken up again lose nothing. SLIDELINE_JOBS=1000 makes it long (tests/lab/README.md)."""
import os

import load_runs
import pytest


def test_batches_lose_no_result(exe, tmp_path):
    jobs = int(os.environ.get("SLIDELINE_JOBS", "12"))
    seed = int(os.environ.get("SLIDELINE_SEED", "1"))
    sums = load_runs.run_load(exe, tmp_path, jobs, seed, cuts=6 if jobs > 12 else 3, say=print)
    print(sums)
    assert sums["cut off"] > 0 and sums["begun"] > jobs and sums["compared"] > 10 * jobs


@pytest.mark.parametrize("damage", ["number", "table", "state", "status"])
def test_the_checks_notice_damage(exe, tmp_path, damage):
    """Another digit, a table that is missing, another value of a state, a run that the table does not call well."""
    names = load_runs.write_decks(tmp_path / "decks", 2, 1)
    batch = load_runs.Batch(exe, tmp_path / "decks", tmp_path / "out")
    assert batch.whole("-j 2") == 2
    load_runs.check_all(batch, names, tmp_path / "alone")
    path = batch.out / names[1] / f"{names[1]}.glstat.csv"
    if damage == "number":
        path.write_bytes(path.read_bytes().replace(b"3", b"4", 1))
    elif damage == "table":
        path.unlink()
    elif damage == "state":
        with load_runs.h5py.File(path.with_name(f"{names[1]}.vtkhdf"), "r+") as stream:
            stream["VTKHDF/PointData/velocity"][-1, 0] += 1.0
    else:
        path.with_name("run.status").write_text("137\n")
        load_runs.subprocess.run([load_runs.BATCH / "run_folder.sh", "--collect", "-o", batch.out, batch.decks], check=False)
    with pytest.raises(AssertionError):
        load_runs.check_all(batch, names, tmp_path / "alone")
