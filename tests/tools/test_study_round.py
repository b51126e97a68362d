# SPDX-License-Identifier: MIT
"""The study of contact between bodies of revolution: its jobs, and a run of the press fit judged."""
import subprocess

import pytest

from slideline_tools.studies.framework import registry
from slideline_tools.studies.framework.job import Options, interleave
from slideline_tools.studies.framework.table import FINISHED
from slideline_tools.studies.round_contact import study as round_contact


def test_jobs_have_names_of_their_own_and_a_quick_form():
    study = registry.load("round-contact")
    quick, whole = (study.jobs(Options(types=(5, 7), quick=flag)) for flag in (True, False))
    assert interleave(whole, 2)  # refuses two jobs of one name
    assert {job.labels["type"] for job in quick} == {5, 7}
    assert {job.labels["scene"] for job in quick} == {"press_fit", "spheres"}
    assert {job.labels["scene"] for job in whole} == {"press_fit", "spheres", "collision"}
    assert not any(job.counted for job in quick)
    assert {(job.labels["scene"], job.labels["level"], job.labels["type"]) for job in whole if job.counted} == {
        (scene, 1, ctype) for scene in ("press_fit", "spheres") for ctype in (5, 7)}


@pytest.mark.parametrize("ctype", (2, 5))
def test_press_fit_tells_types_apart(slideline, tmp_path, ctype):
    job = next(one for one in round_contact.jobs(Options(types=(ctype,), quick=True)) if one.labels["scene"] == "press_fit")
    deck = tmp_path / "run.k"
    deck.write_text(job.deck_text, encoding="utf-8")
    subprocess.run([slideline, f"i={deck}", f"d={tmp_path}", "jobid=run", *job.options], capture_output=True, check=True)
    row = round_contact.measure(job, tmp_path)
    assert 0.0 < row["contact"] < row["computing"]
    worst = max(row["error_slave"], row["error_master"])
    assert worst < 1e-6 if ctype == 5 else 0.01 < worst < 0.2
    rows = [{**job.labels, **row, "state": FINISHED}]
    assert "below 1e-6" in round_contact.error_table(rows) if ctype == 5 else "%" in round_contact.error_table(rows)
