# SPDX-License-Identifier: MIT
"""The Hertz scene and study: mesh, closed form, penalty layer, measures of a pressure profile."""
import numpy as np
import pandas as pd
import pytest

from slideline_tools import UserError, scenes
from slideline_tools.scenes.common import ALUMINIUM, STEEL
from slideline_tools.scenes.hertz import BLOCK_CELL, CYLINDER_CELL, RADIUS, graded
from slideline_tools.studies import __main__ as command
from slideline_tools.studies import hertz
from slideline_tools.studies.hertz import lines
from test_decks import Model, areas


def test_graded_lines_grow_and_nest():
    coarse, fine = graded(1.0, 10.0, 0.5, 6, 1), graded(1.0, 10.0, 0.5, 6, 3)
    steps = np.diff(coarse)
    np.testing.assert_allclose(steps[1:] / steps[:-1], steps[0] / 0.5, rtol=1e-9)
    np.testing.assert_allclose(fine[::3], coarse, rtol=1e-12)
    assert (coarse[0], coarse[-1]) == (1.0, 10.0)


@pytest.mark.parametrize("level", [1, 2, 3])
def test_mesh(level):
    model = Model(scenes.hertz(level))
    assert np.all(areas(model.corners()) > 0.0)
    round_face, flat_face = model.chain(3), model.chain(4)
    centre = np.array([0.0, RADIUS])
    np.testing.assert_allclose(np.linalg.norm(round_face - centre, axis=1), RADIUS, rtol=1e-12)
    assert np.all(flat_face[:, 1] == 0.0) and np.all(np.diff(flat_face[:, 0]) < 0.0)
    np.testing.assert_allclose(np.diff(round_face[:, 0]), CYLINDER_CELL / level, rtol=1e-9)
    np.testing.assert_allclose(-np.diff(flat_face[:, 0]), BLOCK_CELL / level, rtol=1e-9)
    # They touch at one point to begin with.
    middle = round_face[len(round_face) // 2]
    assert abs(middle[0]) < 1e-15 and middle[1] == 0.0
    edges = {(a, b) for row in model.elements for a, b in zip(row[2:6], np.roll(row[2:6], -1))}
    for number in (3, 4):
        nodes = model.node_set(number)
        assert all(pair in edges for pair in zip(nodes[:-1], nodes[1:]))


def test_finest_mesh_numbers_every_node_once():
    block, cylinder, _, _ = scenes.hertz_grids(8)
    assert not np.intersect1d(block.node, cylinder.node).size
    assert not np.intersect1d(block.element, cylinder.element).size


def test_exchanged_deck_differs_in_the_two_surfaces_alone():
    plain, swapped = (scenes.hertz(1, exchanged=flag).splitlines() for flag in (False, True))
    changed = [(a, b) for a, b in zip(plain, swapped) if a != b]
    assert len(changed) == 4 and "exchanged" in changed[0][1]
    assert [pair[0].split()[0] for pair in changed[1:3]] == ["slave:", "master:"]
    assert changed[3][0].split()[:2] == ["-3", "-4"] and changed[3][1].split()[:2] == ["-4", "-3"]


def test_way_of_the_cut():
    model = Model(scenes.hertz(1))
    assert model.parameters["down"] == 30.0e-6
    assert model.lines("BOUNDARY_PRESCRIBED_MOTION_SET")[0].split() == ["5", "2", "0", "2", "&down"]
    curve = model.all_blocks("DEFINE_CURVE_TITLE")[1][2:]
    time, velocity = np.array([(float(row[:20]), float(row[20:])) for row in curve]).T
    way = np.sum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))
    assert way == pytest.approx(-1.0, rel=1e-9)
    assert np.all(velocity[time >= 20.0e-6 * (1.0 - 1e-12)] == 0.0)
    top = model.chain(5)
    np.testing.assert_allclose(top[:, 1], RADIUS, rtol=1e-12)


def test_make_deck(tmp_path, tool):
    path = tmp_path / "h.k"
    done = tool("make-deck", "hertz", "--level", 2, "--ctype", 7, "--exchanged", "-o", path)
    assert done.returncode == 0
    assert path.read_text() == scenes.hertz(2, 7, exchanged=True)
    assert tool("make-deck", "hertz", "--level", 0, "-o", path).returncode == 2


def test_closed_form_of_two_equal_bodies():
    modulus = lines.effective_modulus(STEEL, STEEL)
    assert modulus == pytest.approx(210.0e9 / (2.0 * 0.91))
    half_width, peak = lines.hertz(1.0e6, 0.02, modulus)
    x = np.linspace(-half_width, half_width, 20001)
    force = np.sum(lines.ellipse(x, half_width, peak)) * (x[1] - x[0])
    assert force == pytest.approx(1.0e6, rel=1e-5)
    # p0 = E* a/(2R)
    assert peak == pytest.approx(modulus * half_width / 0.04, rel=1e-12)
    assert lines.effective_modulus(STEEL, ALUMINIUM) < modulus


def test_measure_finds_the_ellipse():
    x = np.linspace(-2.0, 2.0, 4001)
    pressure = lines.ellipse(x, 1.25, 3.0)
    found = lines.measure(x, x[1] - x[0], pressure)
    assert found.half_width == pytest.approx(1.25, rel=1e-4)
    assert found.peak == pytest.approx(3.0, rel=1e-10)
    assert found.force == pytest.approx(0.5 * np.pi * 1.25 * 3.0, rel=1e-4)
    assert found.scatter == pytest.approx(0.0, abs=1e-10)
    assert lines.measure(x, x[1] - x[0], pressure * (1.0 + 0.1 * (-1.0) ** np.arange(4001))
                         ).scatter > 1e-3


def test_deviation_is_reported_apart_by_place():
    x = np.linspace(-1.0, 1.0, 201)
    pressure = lines.ellipse(x, 1.0, 2.0)
    pressure[0] += 0.5
    assert lines.deviation(x, pressure, 1.0, 2.0) == pytest.approx((0.0, 0.25))
    pressure[100] -= 0.8
    assert lines.deviation(x, pressure, 1.0, 2.0) == pytest.approx((0.4, 0.4))


def test_stiff_layer_is_hertz():
    found = lines.layer_profile(0.0)
    assert found.force == pytest.approx(1.0, rel=1e-12)
    assert found.half_width == pytest.approx(1.0, rel=1e-4)
    assert found.peak == pytest.approx(1.0, rel=1e-4)


def test_soft_layer_alone_is_a_parabola():
    # Springs far softer than the bodies: p = k (b^2 - x^2)/(2R), F = 2 k b^3/(3R), m2 = F b^2/5.
    softness = 1.0e4
    edge = (3.0 * np.pi * softness / 8.0) ** (1.0 / 3.0)
    found = lines.layer_profile(softness)
    assert found.half_width == pytest.approx(2.0 * edge / np.sqrt(5.0), rel=0.01)


def test_layer_widens_the_contact_in_proportion():
    small, twice = (lines.layer_profile(softness) for softness in (0.01, 0.02))
    assert 0.0 < small.half_width - 1.0 < 0.01
    assert twice.half_width - 1.0 == pytest.approx(2.0 * (small.half_width - 1.0), rel=0.03)
    assert -0.01 < small.peak - 1.0 < 0.0
    assert twice.peak - 1.0 == pytest.approx(2.0 * (small.peak - 1.0), rel=0.03)


@pytest.mark.parametrize("ctype, expected", [(1, 10.0), (3, 15.0), (7, 10.0)])
def test_layer_of_a_penalty(ctype, expected):
    assert lines.layer_stiffness(ctype, 1.0, 0.1, 0.2) == pytest.approx(expected)


def test_order_of_an_error_in_proportion_to_the_square():
    assert hertz.order([1.0, 0.5, 0.25], [-0.16, 0.04, -0.01]) == pytest.approx(2.0)
    assert np.isnan(hertz.order([1.0], [0.1]))  # a page of one mesh has no order


def test_a_run_lies_near_hertz_and_tells_its_estimate(slideline, tmp_path, plain_pictures):
    """Hertz with the springs of the penalty: tests/verification/hertz."""
    assert command.main(["estimates", "--quick", "--types", "5", "--only", "hertz*", "--program", slideline, "--folder",
                         str(tmp_path)]) == 0
    row, = pd.read_csv(tmp_path / "estimates.csv").to_dict("records")
    assert row["estimate"] == pytest.approx(0.02242, rel=0.02) and row["error"] == pytest.approx(0.03276, rel=0.02)
    assert "| 5 NTS-mAR | 2.24" in (tmp_path / "doc/studies/estimates.md").read_text()
    folder = tmp_path / "runs" / row["run"]
    found = hertz.measure(folder)
    assert found["half_width"] == pytest.approx(1.0297, abs=0.002) and found["peak"] == pytest.approx(0.9742, abs=0.002)
    (folder / "hertz.glstat.csv").write_text("time,cycle\n0,0\n1e-6,9\n")
    with pytest.raises(UserError, match="did not reach its end"):
        hertz.measure(folder)


def test_the_study_of_round_bodies(slideline, tmp_path, plain_pictures):
    """A press fit with arcs, without, and the pin against its own finest run."""
    assert command.main(["round", "--quick", "--types", "5", "--only", "[fb][io]*", "--program", slideline, "--folder",
                         str(tmp_path)]) == 0
    table = pd.read_csv(tmp_path / "round.csv").set_index(["scene", "form"])
    mean = table[table["level"] == 1]["mean"]
    assert mean["fit", "arcs"] < 0.005 and mean["fit", "facets"] > 1.0
    assert mean["bore", "arcs"] < 0.005 and mean["bore", "facets"] > 0.5
    assert "| Press fit | 1 | arcs | 1.8e+05 |" in (tmp_path / "doc/studies/round.md").read_text()
