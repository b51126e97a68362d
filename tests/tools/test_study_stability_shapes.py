# SPDX-License-Identifier: MIT
"""The study of shapes: its meshes, its decks, its page, and two runs of it."""
import subprocess

import numpy as np
import pytest

from slideline_tools.studies.framework.job import Job, Options
from slideline_tools.studies.stability_shapes import study as shapes
from slideline_tools.studies.stability_shapes.page import draw_shapes, mesh_text, overhang_text, shape_text
from slideline_tools.studies.stability_shapes.study import Case, deck_of, grids_of


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


def test_meshes_are_compared_at_one_stiffness_and_one_step():
    """PUNIT 3 made the interface 28 times as stiff on one mesh as on another."""
    cases = shapes.SWEEPS["ratio"][1].values()
    assert {case.penalty(5) for case in cases} == {("punit=1", f"pen={shapes.STIFFNESS!r}")}
    assert {case.penalty(3) for case in cases} == {("punit=1", f"pen={shapes.STIFFNESS / 2!r}")}
    assert {case.step * 1.0 / max(case.counts) for case in cases} == {shapes.STEP / shapes.FINEST}
    assert Case().penalty(5) == ("punit=3",) and Case().step == shapes.STEP


def test_rebound_of_a_block_that_swings():
    """2 kg come with 3 m/s and go with 2 m/s: 10 N s, 5 of 9 J do not fly back, 3 J of them swing."""
    block = {"momentum_x": np.zeros(2), "momentum_y": np.array([-6.0, 4.0]), "mass": np.full(2, 2.0)}
    glstat = {"kinetic": np.array([9.0, 6.0]), "internal": np.array([0.0, 1.0])}
    found = shapes.rebound(block, glstat)
    assert found == {"impulse": pytest.approx(10.0), "vibration": pytest.approx(3.0 / 9.0)}


def run_case(slideline, folder, sweep, value, ctype):
    """The measures of one run."""
    case = shapes.SWEEPS[sweep][1][value]
    folder.mkdir(parents=True)
    (folder / "impact.k").write_text(deck_of(case, ctype))
    subprocess.run([slideline, "i=impact.k", "d=.", *case.penalty(ctype)], cwd=folder, capture_output=True,
                   check=False)
    return shapes.measure(Job("one", "", "impact", (), {"sweep": sweep, "value": value, "type": ctype}),
                          folder)


def test_a_finer_slave_loses_no_impulse(slideline, tmp_path):
    """It lost 6 % of it while PUNIT 3 chose another penalty for each mesh."""
    rows = [{"sweep": "ratio", "value": value, "type": 2,
             **run_case(slideline, tmp_path / f"{value}", "ratio", value, 2)} for value in (1.0, 8.0)]
    assert rows[0]["stiffness"] == rows[1]["stiffness"] == shapes.STIFFNESS
    assert rows[1]["impulse"] == pytest.approx(rows[0]["impulse"], rel=0.01)
    assert "lie within 0.5 % of each other" in mesh_text(rows)


@pytest.mark.parametrize("sweep, value, ctype, verdict", [
    ("tilt", 15.0, 5, "stable"), ("hourglass_2", 1.0, 5, "stable"), ("overhang", 1.1, 2, "stable"),
    ("overhang_srch", 1.1, 2, "stable")])
def test_runs_and_page(slideline, tmp_path, sweep, value, ctype, verdict):
    row = {"run": "one", "sweep": sweep, "value": value, "type": ctype,
           **run_case(slideline, tmp_path / "runs" / "one", sweep, value, ctype)}
    assert row["verdict"] == verdict
    shapes.chart([row], tmp_path)
    assert (tmp_path / "shapes.png").is_file()
    assert (tmp_path / "failing").is_dir() == (verdict != "stable")
    shapes.page([row], tmp_path / "doc")
    text = (tmp_path / "doc/studies/stability_shapes.md").read_text()
    assert ("No cell failed." in text) == (verdict == "stable")


def test_words_on_shapes_and_overhangs_follow_the_figures():
    """While contact made energy there the page said that places beyond an end fail; they went on failing in its words."""
    rows = [{"sweep": "overhang", "type": ctype, "value": value, "verdict": "stable", "created": created}
            for ctype, value, created in ((1, 0.02, 0.0137), (2, 1.1, 0.0339), (5, 1.1, 0.003))]
    rows += [{"sweep": "tilt", "type": 5, "value": value, "verdict": "stable"} for value in (0.1, 45.0)]
    text = overhang_text(rows)
    assert "Here all 3 cells are stable" in text and "at most 3.4 % of the energy (2 NTS-AR, overhang 1.1)" in text
    assert "SRCH a tenth" not in text and "failure" not in text
    assert shape_text(rows) == "- *Shapes*: a corner first at 0.1 to 45 degrees: all 2 cells are stable."
    rows[0].update(verdict="blown up", created=0.7)
    rows += [{"sweep": "overhang_srch", "type": 1, "value": 0.02, "verdict": "stable", "created": 0.001},
             {"sweep": "ratio", "type": 1, "value": 8.0, "verdict": "locked"}]
    text = overhang_text(rows)
    assert "Here 1 of 3 cells are not stable" in text and "at most 70 % of the energy (1 NTS, overhang 0.02)" in text
    assert "(*overhang, SRCH a tenth of its default*) it is at most 0.1 %." in text
    assert shape_text(rows).endswith("a corner first at 0.1 to 45 degrees: 1 of 3 cells are not stable.")


def test_picture_has_one_panel_with_what_fails():
    """A cell for each sweep and type; written in it what is not stable."""
    sweeps = {"overhang": ("overhang", {}), "tilt": ("tilt", {})}
    rows = [{"sweep": name, "type": ctype, "value": value,
             "verdict": "blown up" if (name, ctype) == ("overhang", 5) and value > 0.5 else "stable"}
            for name in sweeps for ctype in (1, 5) for value in (0.1, 1.1, 2.5)]
    figure = draw_shapes(rows, sweeps)
    assert len(figure.axes) == 1 and len(figure.axes[0].patches) == 4
    assert [text.get_text() for text in figure.axes[0].texts] == ["", "1.1, 2.5", "", ""]
    assert [text.get_text() for text in figure.axes[0].get_yticklabels()][0] == "overhang\n3 values from 0.1 to 2.5"
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["stable", "blown up"]
