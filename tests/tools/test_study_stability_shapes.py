# SPDX-License-Identifier: MIT
"""The study of shapes: its meshes, its decks, its page, and two runs of it."""
import subprocess

import numpy as np
import pytest

from slideline_tools.study import stability_shapes as shapes
from slideline_tools.study.job import Job, Options
from slideline_tools.study.stability_shapes import Case, deck_of, grids_of


@pytest.mark.parametrize("ratio, slave, master", [(0.125, 4, 32), (1.0, 4, 4), (8.0, 32, 4)])
def test_mesh_ratio(ratio, slave, master):
    lower, upper = grids_of(Case(ratio=ratio))
    assert (len(upper.lower) - 1, len(lower.upper) - 1) == (slave, 2 * master)


def test_overhang_counts_in_slave_elements():
    lower, upper = grids_of(Case(overhang=1.5))
    side = upper.points[1, 0, 0] - upper.points[0, 0, 0]
    assert upper.points[-1, 0, 0] - lower.points[-1, 0, 0] == pytest.approx(1.5 * side)


def test_tilt_and_turn():
    lower, upper = grids_of(Case(tilt=30.0))
    edge = upper.points[-1, 0] - upper.points[0, 0]
    assert np.degrees(np.arctan2(edge[1], edge[0])) == pytest.approx(30.0)
    assert upper.points[..., 1].min() - lower.points[..., 1].max() == pytest.approx(shapes.GAP)
    plain, moved = grids_of(Case()), grids_of(Case(turn=90.0))
    assert moved[0].points[..., 0] == pytest.approx(-plain[0].points[..., 1])
    assert moved[0].points[..., 1] == pytest.approx(plain[0].points[..., 0])


def test_jobs():
    jobs = shapes.jobs(Options(types=(1, 5)))
    assert len({job.name for job in jobs}) == len(jobs)
    assert {job.labels["sweep"] for job in jobs} == set(shapes.SWEEPS)
    quick = shapes.jobs(Options(types=(1,), quick=True))
    assert {job.labels["sweep"] for job in quick} == set(shapes.QUICK)


@pytest.mark.parametrize("sweep, value, ctype, verdict", [
    ("tilt", 15.0, 5, "stable"), ("hourglass_2", 1.0, 5, "stable"), ("overhang", 1.1, 2, "blown up"),
    ("overhang_srch", 1.1, 2, "stable")])
def test_runs_and_page(slideline, tmp_path, sweep, value, ctype, verdict):
    case = shapes.SWEEPS[sweep][1][value]
    folder = tmp_path / "runs" / "one"
    folder.mkdir(parents=True)
    (folder / "impact.k").write_text(deck_of(case, ctype))
    subprocess.run([slideline, "i=impact.k", "d=.", "punit=3"], cwd=folder, capture_output=True,
                   check=False)
    labels = {"sweep": sweep, "value": value, "type": ctype}
    row = {"run": "one", **labels, **shapes.measure(Job("one", "", "impact", (), labels), folder)}
    assert row["verdict"] == verdict
    shapes.chart([row], tmp_path)
    assert (tmp_path / "shapes.png").is_file()
    assert (tmp_path / "failing").is_dir() == (verdict != "stable")
    shapes.page([row], tmp_path / "doc")
    text = (tmp_path / "doc/studies/stability_shapes.md").read_text()
    assert ("No cell failed." in text) == (verdict == "stable")
