# SPDX-License-Identifier: MIT
"""The command refine: elements in four, hanging nodes, surfaces as a whole, and what is carried along."""
import os
import types

import numpy as np
import pytest
from test_answer import BAR

from slideline_tools import UserError, scenes
from slideline_tools.answer.refine import RefinedMesh, chosen, refine_run, refined
from slideline_tools.cli import main
from slideline_tools.draw.model import check_deck
from slideline_tools.effective_deck import read_blocks
from slideline_tools.finished_run import Run
from slideline_tools.program import run

PROGRAM = pytest.mark.skipif("SLIDELINE" not in os.environ, reason="SLIDELINE is not set")
#: the bar with sets 1 and 2 of its ends, as the program has it
MODEL = types.SimpleNamespace(interfaces=[], node_ids=np.arange(1, 7), node_sets={
    1: types.SimpleNamespace(id=1, nodes=np.array([0, 3])), 2: types.SimpleNamespace(id=2, nodes=np.array([2, 5]))})


def rows(text, keyword):
    """Numbers of all rows of a keyword."""
    return [[float(field) for field in block.fields(line, *([8] * 10 if keyword == "ELEMENT_SHELL" else [])) if field]
            for block in read_blocks(text) if block.keyword == keyword for line in range(len(block.lines))]


def bar(more="", end=1e-5):
    return BAR.format(end=end, more=more)


def test_one_element_in_four_leaves_one_hanging_node():
    text, divided, total = refined(bar(), MODEL, [1])
    assert (divided, total) == (1, 5)
    points = {int(node): (x, y) for node, x, y, *_ in rows(text, "NODE")}
    (node, *parents), = rows(text, "CONSTRAINED_ADAPTIVITY")
    assert sorted(parents) == [2, 5] and points[node] == pytest.approx((0.01, 0.005))
    cells = [[int(field) for field in row] for row in rows(text, "ELEMENT_SHELL")]
    areas = []
    for *_, a, b, c, d in cells:
        p, q = np.subtract(points[c], points[a]), np.subtract(points[d], points[b])
        areas.append(0.5 * (p[0] * q[1] - p[1] * q[0]))
    assert np.allclose(sorted(areas), [2.5e-5] * 4 + [1e-4]) and len({cell[0] for cell in cells}) == 5
    held = next(block for block in read_blocks(text) if block.keyword == "SET_NODE_LIST").fields(1)
    assert {int(field) for field in held if field} == {1, 4, next(node for node, x in points.items() if x == (0.0, 0.005))}


def test_a_small_element_at_a_hanging_node_takes_its_neighbour_along():
    first, *_ = refined(bar(), MODEL, [1])
    hanging = int(rows(first, "CONSTRAINED_ADAPTIVITY")[0][0])
    ids = np.array([int(row[0]) for row in rows(first, "NODE")])
    model = types.SimpleNamespace(interfaces=[], node_ids=ids, node_sets={
        key: types.SimpleNamespace(id=key, nodes=np.searchsorted(ids, np.array(nodes))) for key, nodes in ((1, [1, 4]), (2, [3, 6]))})
    small = next(int(row[0]) for row in rows(first, "ELEMENT_SHELL") if hanging in row[2:])
    text, divided, total = refined(first, model, [small])
    assert (divided, total) == (2, 11)  # it and element 2, with three old pieces
    found = rows(text, "CONSTRAINED_ADAPTIVITY")
    hanging_now, parents = {int(row[0]) for row in found}, {int(node) for row in found for node in row[1:]}
    assert len(found) == 3 and not hanging_now & parents and hanging not in hanging_now
    # Divided everywhere, they still differ by one division.
    text, divided, total = refined(first, model, [int(row[0]) for row in rows(first, "ELEMENT_SHELL")])
    assert (divided, total) == (5, 20) and len(rows(text, "CONSTRAINED_ADAPTIVITY")) == 2


def test_surfaces_are_divided_as_a_whole():
    mesh = RefinedMesh(read_blocks(bar()), [[(1, 2), (2, 3)]])
    assert mesh.surfaces == [{0, 1}] and mesh.closed({1}) == {0, 1}


def test_hanging_nodes_have_no_motion_of_their_own():
    more = "*DEFINE_CURVE\n1\n0.0,0.0\n1.0,1.0\n*BOUNDARY_PRESCRIBED_MOTION_NODE\n" + "".join(f"{node},1,2,1\n" for node in range(1, 7))
    text, *_ = refined(bar(more), MODEL, [1])
    hanging = {int(row[0]) for row in rows(text, "CONSTRAINED_ADAPTIVITY")}
    moved = {int(row[0]) for row in rows(text, "BOUNDARY_PRESCRIBED_MOTION_NODE")}
    assert hanging and not hanging & moved and len(moved) == 6 + 4


def test_what_is_not_there_is_refused():
    with pytest.raises(UserError, match="no element 9"):
        refined(bar(), MODEL, [9])
    with pytest.raises(UserError, match="ELEMENT_MASS_NODE_SET"):
        refined(bar("*ELEMENT_MASS_NODE_SET\n1,1,1.0\n"), MODEL, [1])


def test_the_largest_errors_are_chosen():
    results = types.SimpleNamespace(path="job.vtkhdf", cell_fields=["error", "element_id"], cell_field=lambda name: np.array(
        {"error": [[1.0, 4.0, 0.0], [2.0, 3.0, 0.0]], "element_id": [[7, 8, 9]]}[name]))
    assert chosen(results, 0.5) == {8} and chosen(results, 0.7) == {8} and chosen(results, 0.71) == {7, 8} and chosen(results, 1.0) == {7, 8}
    with pytest.raises(UserError, match="no cell field mises"):
        chosen(results, 0.5, "mises")


@PROGRAM
def test_hertz_is_refined_twice(tmp_path, capsys):
    """A tenth of the updates of the mesh divided by four, with surfaces on their arcs and the largest pressure near Hertz's."""
    deck = tmp_path / "first.k"
    deck.write_text(scenes.hertz(1, 7).replace("*END", "*DATABASE_ERROR_INDICATOR\n*END"), encoding="ascii")
    peaks = []
    for name in ("first", "second", "third"):
        outcome = run(tmp_path / f"{name}.k", tmp_path / name, program=os.environ["SLIDELINE"])
        contact = outcome.history("contact")
        last = contact["time"] == contact["time"][-1]
        peaks.append(contact["pressure"][last].max())
        if name != "third":
            following = {"first": "second", "second": "third"}[name]
            assert main(["refine", str(tmp_path / name), "--fraction", "0.3", "--surfaces", "-o", str(tmp_path / f"{following}.k"),
                         "--program", os.environ["SLIDELINE"]]) == 0
            assert "elements divided" in capsys.readouterr().out
    assert main(["refine", str(tmp_path / "third"), "-o", "/dev/null/out/x.k", "--program", os.environ["SLIDELINE"]]) == 2
    assert capsys.readouterr().err == "slideline-tools: cannot make the folder /dev/null/out: Not a directory\n"
    model = check_deck(tmp_path / "third.k", os.environ["SLIDELINE"])
    side = max((model.interfaces[0].slave, model.interfaces[0].master), key=lambda one: np.ptp(model.points[one.nodes, 1]))
    x = model.points[side.nodes]
    centre = np.linalg.lstsq(np.column_stack([2.0 * x, np.ones(len(x))]), np.sum(x ** 2, axis=1), rcond=None)[0]
    radius = np.linalg.norm(x - centre[:2], axis=1)
    assert np.ptp(radius) < 1e-6 * radius.mean() and len(x) == 4 * 12 + 1
    assert abs(peaks[2] - peaks[1]) < abs(peaks[1] - peaks[0])


@PROGRAM
def test_a_run_without_the_field_says_how_to_get_it(tmp_path):
    (tmp_path / "job.k").write_text(bar("*DATABASE_BINARY_D3PLOT\n1e-5,\n"), encoding="ascii")
    run(tmp_path / "job.k", tmp_path / "out", program=os.environ["SLIDELINE"])
    with pytest.raises(UserError, match="ERROR_INDICATOR"):
        refine_run(Run(tmp_path / "out"), os.environ["SLIDELINE"], 0.5)
