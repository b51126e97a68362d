# SPDX-License-Identifier: MIT
"""The scene of a falling block: its meshes, penalties and steps."""
import numpy as np
import pytest

from slideline_tools.studies.stability_shapes import study as shapes
from slideline_tools.studies.stability_shapes.study import Case, grids_of


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


def test_meshes_are_compared_at_one_stiffness_and_one_step():
    """PUNIT 3 made the interface 28 times as stiff on one mesh as on another."""
    cases = [Case(ratio=ratio, stiffness=shapes.STIFFNESS) for ratio in (0.125, 0.5, 1.0, 8.0)]
    assert {case.penalty(5) for case in cases} == {("punit=1", f"pen={shapes.STIFFNESS!r}")}
    assert {case.penalty(3) for case in cases} == {("punit=1", f"pen={shapes.STIFFNESS / 2!r}")}
    assert {case.step * 1.0 / max(case.counts) for case in cases} == {shapes.STEP / shapes.FINEST}
    assert Case().penalty(5) == ("punit=3",) and Case().step == shapes.STEP
