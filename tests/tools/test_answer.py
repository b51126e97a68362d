# SPDX-License-Identifier: MIT
"""The command answer: meshes divided, quantities, the uncertainty, the loop and its statuses."""
import json
import math
import os
import pathlib
import subprocess
import sys
import time

import conftest
import numpy as np
import pytest

from slideline_tools import UserError, scenes
from slideline_tools.answer.divide import Mesh, divided
from slideline_tools.answer.estimate import estimate
from slideline_tools.answer.loop import Answer, Answers, find, following
from slideline_tools.answer.meshes import MeshRun
from slideline_tools.answer.quantity import Quantity, edges_at, parse, weights_at
from slideline_tools.answer.report import rounded_up
from slideline_tools.effective_deck import read_blocks
from slideline_tools.program import STOPPED, Outcome, RunError

PROGRAM = pytest.mark.skipif("SLIDELINE" not in os.environ, reason="SLIDELINE is not set")
#: a bar of 2 by 1 elements, held at the left, with a part of its own for more cards
BAR = """*KEYWORD
*CONTROL_TERMINATION
{end},
*CONTROL_TIMESTEP
0.0,0.9
*DATABASE_GLSTAT
1e-6,
*DATABASE_NODOUT
1e-6,
*DATABASE_HISTORY_NODE
3,
*PART
bar
1,1,1
*SECTION_SHELL
1,13,1.0,1
1.0,1.0,1.0,1.0
*MAT_ELASTIC
1,7850.0,2.1e11,0.3
*SET_NODE_LIST
1
1,4
*BOUNDARY_SPC_SET
1,0,1,1
*SET_NODE_LIST
2
3,6
*NODE
1,0.0,0.0
2,0.01,0.0
3,0.02,0.0
4,0.0,0.01
5,0.01,0.01
6,0.02,0.01
*ELEMENT_SHELL
1,1,1,2,5,4
2,1,2,3,6,5
{more}*END
"""
PULLED = """*LOAD_NODE_SET
2,1,1,1e4
*DEFINE_CURVE
1
0.0,1.0
1.0,1.0
"""


def bar(more=PULLED, end="2e-5"):
    return BAR.format(more=more, end=end)


def mesh_of(text):
    return Mesh(read_blocks(text))


def block_rows(text, keyword):
    """The numbers of all rows of the blocks of a keyword."""
    return [[float(cell or 0) for cell in block.fields(line)] for block in read_blocks(text, keyword) for line in range(len(block.lines))]


def area_of(corners):
    """Area of quads from their four corners, arrays of (x, y)."""
    a, b = corners[2] - corners[0], corners[3] - corners[1]
    return 0.5 * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def test_layouts_of_a_deck_with_wide_fields():
    wide = "*NODE +\n" + "".join(f"{node:20d}{x:20.4f}{y:20.4f}\n" for node, x, y in [(1, 0, 0), (2, 1, 0), (3, 1, 1), (4, 0, 1)])
    mesh = mesh_of("*KEYWORD\n" + wide + "*ELEMENT_SHELL %\n" + "".join(f"{number:10d}" for number in (9, 7, 1, 2, 3, 4)) + "\n*END\n")
    assert mesh.elements == [(9, 7, [1, 2, 3, 4])] and mesh.points[3].tolist() == [1.0, 1.0]


# ---- the mesh --------------------------------------------------------------------------------

@PROGRAM
@pytest.mark.parametrize("factor", [2, 3])
def test_collision_divided_is_its_finer_mesh(tmp_path, factor):
    """An independent mesh: that of make-deck at this level."""
    from slideline_tools.answer.meshes import Meshes
    from slideline_tools.draw.model import check_deck
    from slideline_tools.program import run
    deck = tmp_path / "collision.k"
    deck.write_text(scenes.collision(1), encoding="ascii")
    run(deck, tmp_path / "mesh_1", endtim=1e-6)
    path, _ = Meshes(deck, tmp_path, os.environ["SLIDELINE"]).deck_of(factor)
    finer = tmp_path / "finer.k"
    finer.write_text(scenes.collision(factor), encoding="ascii")
    found, expected = (check_deck(one, os.environ["SLIDELINE"]) for one in (path, finer))

    def places(model, nodes):
        return sorted(map(tuple, np.round(model.points[nodes], 10).tolist()))
    assert places(found, slice(None)) == places(expected, slice(None))
    for axis in (0, 1):
        assert places(found, found.fixed[:, axis]) == places(expected, expected.fixed[:, axis])
    for one, other in zip(found.interfaces, expected.interfaces):
        for side, wanted in ((one.slave, other.slave), (one.master, other.master)):
            np.testing.assert_allclose(found.points[side.nodes], expected.points[wanted.nodes], atol=1e-10)
    for model in (found, expected):
        model.cell_area = np.abs(area_of(model.points[model.cells].transpose(1, 0, 2)))
    np.testing.assert_allclose(np.sort(found.cell_area), np.sort(expected.cell_area), rtol=1e-6)
    assert len(found.velocity[found.velocity[:, 1] != 0.0]) == len(expected.velocity[expected.velocity[:, 1] != 0.0])


def test_nodes_of_curved_edges_lie_on_their_arcs():
    """A ring sector whose chords turn by 10 degrees; its straight ends stay straight, inner nodes between."""
    angles, radii = np.radians(np.arange(0.0, 91.0, 10.0)), (1.0, 1.5, 2.0)
    nodes = [f"{3 * k + r + 1},{radius * math.cos(angle)!r},{radius * math.sin(angle)!r}" for k, angle in enumerate(angles)
             for r, radius in enumerate(radii)]
    shells = [f"{2 * k + r + 1},1,{3 * k + r + 1},{3 * k + r + 2},{3 * k + r + 5},{3 * k + r + 4}" for k in range(9) for r in (0, 1)]
    mesh = mesh_of("\n".join(["*NODE", *nodes, "*ELEMENT_SHELL", *shells, "*END"]))
    mesh.divide(3)
    radius = {edge: [np.linalg.norm(mesh.points[node]) for node in mesh.between[edge][1]] for edge, on in mesh.sides.items() if len(on) == 1}
    curved = {edge: found for edge, found in radius.items() if len({(node - 1) % 3 for node in edge}) == 1}
    assert len(curved) == 18
    for edge, found in curved.items():
        np.testing.assert_allclose(found, radii[(min(edge) - 1) % 3], rtol=1e-12)
    for edge, found in radius.items():
        if edge not in curved:  # the ends, towards the middle
            a, b = sorted(edge)
            np.testing.assert_allclose(mesh.points[mesh.between[edge][1][0]], (2 * mesh.points[a] + mesh.points[b]) / 3, atol=1e-15)
    area = sum(area_of([mesh.points[node] for node in cell]) for some in mesh.children for _, cell in some)
    # 27 chords of equal angles, but for the little that thirds of a chord differ from thirds of its angle
    assert area == pytest.approx(27 * 0.5 * (2.0 ** 2 - 1.0) * np.sin(np.pi / 54), rel=1e-8)


@pytest.mark.parametrize("count, is_round", [(16, True), (12, False)])
def test_facets_of_a_circle_are_no_corners(count, is_round):
    """Equal turns of 22.5 degrees are those of a circle, of 30 degrees those of a polygon."""
    ring = [f"{2 * k + r + 1},{radius * math.cos(2 * math.pi * k / count)!r},{radius * math.sin(2 * math.pi * k / count)!r}"
            for k in range(count) for r, radius in enumerate((1.0, 2.0))]
    shells = [f"{k + 1},1,{2 * k + 1},{2 * k + 2},{2 * j + 2},{2 * j + 1}" for k in range(count) for j in ((k + 1) % count,)]
    mesh = mesh_of("\n".join(["*NODE", *ring, "*ELEMENT_SHELL", *shells, "*END"]))
    mesh.divide(2)
    outer = [np.linalg.norm(mesh.points[mesh.between[edge][1][0]]) for edge in mesh.sides if all(node % 2 == 0 for node in edge)]
    np.testing.assert_allclose(outer, 2.0 if is_round else 2.0 * math.cos(math.pi / count), rtol=1e-12)


def test_corners_and_sharp_turns_stay():
    square = mesh_of("*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*ELEMENT_SHELL\n7,1,1,2,3,4\n*END")
    square.divide(4)
    assert {round(float(x), 12) for point in square.points.values() for x in point} == {0.0, 0.25, 0.5, 0.75, 1.0}
    assert len(square.children[0]) == 16 and sum(eid == 7 for eid, _ in square.children[0]) == 1


def test_triangles_are_divided_in_triangles():
    mesh = mesh_of("*NODE\n1,0,0\n2,3,0\n3,0,3\n*ELEMENT_SHELL\n1,1,1,2,3,3\n*END")
    mesh.divide(3)
    areas = [area_of([mesh.points[node] for node in (*cell, cell[-1])]) for _, cell in mesh.children[0]]
    np.testing.assert_allclose(areas, 0.5)
    assert len(areas) == 9 and len(mesh.points) == 10


def test_loads_of_nodes_are_those_of_the_same_line_load():
    text = divided(bar(), {1: [1, 4], 2: [3, 6]}, 2)
    loads = {int(row[0]): row[3] for row in block_rows(text, "LOAD_NODE_POINT")}
    assert sorted(loads.values()) == [5e3, 5e3, 1e4] and loads[3] == loads[6] == 5e3
    assert sum(loads.values()) == pytest.approx(2e4)
    single = divided(bar("*LOAD_NODE_POINT\n3,1,1,7.0\n"), {1: [1, 4], 2: [3, 6]}, 3)
    assert block_rows(single, "LOAD_NODE_POINT") == [[3.0, 1.0, 1.0, 7.0, 0.0, 0.0, 0.0, 0.0]]


def test_sets_take_new_nodes_on_edges_and_not_through_the_body():
    text = divided(bar(), {1: [1, 4], 2: [3, 6]}, 2)
    sets = read_blocks(text, "SET_NODE")
    assert len(sets[0].fields(1)) == len(sets[1].fields(1)) == 4  # three nodes and the comma
    mesh = mesh_of(bar())
    mesh.divide(2)
    assert not mesh.new_in([2, 5])              # from the lower to the upper side
    assert len(mesh.new_in(range(1, 7))) == 9   # all of it


def test_supports_of_single_nodes_pass_on_where_both_have_them():
    more = "*BOUNDARY_SPC_NODE\n1,0,1,1\n2,0,0,1\n3,0,0,1\n"
    text = divided(bar(more), {1: [1, 4], 2: [3, 6]}, 2)
    new = block_rows(text, "BOUNDARY_SPC_NODE")[3:]
    assert [row[1:] for row in new] == [[0.0, 0.0, 1.0]] * 2


def test_velocities_and_pressures_of_edges():
    more = "*INITIAL_VELOCITY_NODE\n3,1.0,2.0\n6,3.0,4.0\n*LOAD_SEGMENT\n1,1.0,0.0,6,5\n"
    text = divided(bar(more), {1: [1, 4], 2: [3, 6]}, 2)
    assert block_rows(text, "INITIAL_VELOCITY_NODE")[2][1:] == [2.0, 3.0]
    first, second = block_rows(text, "LOAD_SEGMENT")
    assert first[3] == 6.0 and second[4] == 5.0 and first[4] == second[3]


def test_a_step_by_curve_is_divided_in_a_copy():
    more = "*DEFINE_CURVE\n9\n0.0,1e-7\n1.0,1e-7\n"
    text = divided(bar(more).replace("0.0,0.9\n", "0.0,0.9,0,0.0,0.0,9\n"), {1: [1, 4], 2: [3, 6]}, 4)
    assert block_rows(text, "CONTROL_TIMESTEP")[0][5] == 10.0
    curves = [block for block in read_blocks(text, "DEFINE_CURVE")]
    assert curves[0].lines == ["9", "0.0,1e-7", "1.0,1e-7"] and curves[1].fields(0)[3] == "0.25"


def test_a_penalty_per_length_grows_as_elements_shrink():
    more = "*CONTACT_2D_SLIDELINE\n-1,-2,5,2,1e9\n0.0,1e20,{}\n"
    penalties = [block_rows(divided(bar(more.format(unit)), {1: [1, 4], 2: [3, 6]}, 3), "CONTACT")[0][4] for unit in (0, 1)]
    assert penalties == [1e9, 3e9]


@pytest.mark.parametrize("more, words", [
    ("*ELEMENT_BEAM\n1,1,1,2\n", "ELEMENT_BEAM"), ("*ELEMENT_MASS_NODE_SET\n1,2,1.0\n", "ELEMENT_MASS_NODE_SET"),
    ("*LOAD_SEGMENT\n1,1.0,0.0,1,6\n", "edge 1, 6"), ("*ELEMENT_SHELL\n3,1,1,2\n", "element 3")])
def test_what_cannot_be_divided_is_refused_by_name(more, words):
    with pytest.raises(UserError, match=words):
        divided(bar(more), {1: [1, 4], 2: [3, 6]}, 2)


# ---- the estimate ----------------------------------------------------------------------------

@pytest.mark.parametrize("order", [0.7, 1.0, 1.6])
def test_a_power_of_the_mesh_is_found(order):
    factors = (1, 2, 3)
    found = estimate(factors, [5.0 - 2.0 * factor ** -order for factor in factors])
    assert found.value == pytest.approx(5.0, rel=1e-6) and found.order == pytest.approx(order, rel=1e-5)
    assert found.uncertainty == pytest.approx(1.25 * 2.0 * 3.0 ** -order, rel=1e-4)


@pytest.mark.parametrize("order, taken", [(0.2, 0.5), (4.0, 2.0)])
def test_the_order_stays_between_its_bounds(order, taken):
    factors = (1, 2, 3, 4)
    found = estimate(factors, [1.0 + factor ** -order for factor in factors])
    assert found.order == pytest.approx(taken) and found.scatter > 0.0
    assert found.uncertainty == pytest.approx(3.0 * abs(1.0 + 4.0 ** -order - found.value) + 2.0 * found.scatter)


def test_values_to_and_fro_have_their_range():
    found = estimate((1, 2, 3), [1.0, 1.4, 1.1])
    assert (found.value, found.order) == (1.1, None) and found.uncertainty == pytest.approx(0.4)


def test_one_and_two_meshes():
    assert estimate((1,), [3.0]).uncertainty == np.inf
    two = estimate((1, 2), [3.0, 3.1])
    assert (two.value, two.order) == (3.1, None) and two.uncertainty == pytest.approx(0.3)


def test_the_mesh_that_would_do():
    factors = (1, 2, 3)
    found = estimate(factors, [5.0 - 2.0 / factor for factor in factors])
    needed = found.needed(0.01, 3)
    assert needed == pytest.approx(1.25 * 2.0 / 0.05, rel=1e-3)
    assert estimate(factors, [5.0 - 2.0 / factor for factor in (1, 2, 50)]).needed(1e-9, 3) is None


# ---- the loop --------------------------------------------------------------------------------

def test_the_loop_ends_when_the_budget_does():
    runs = [MeshRun(mesh, 10 * mesh ** 2, 100 * mesh ** 3, mesh ** 3.0, Outcome(pathlib.Path(), "x", {}, 0, "")) for mesh in (1, 2, 3)]
    quantity = Quantity("x", "glstat", "internal")
    one = Answer(quantity, [4.0, 4.5, 14.0 / 3.0], estimate((1, 2, 3), [4.0, 4.5, 14.0 / 3.0]), False)
    found = Answers([one], runs)
    factor, reason = following(found, runs, 0.01, 1e3)
    assert factor == 0 and "mesh 25 would do" in reason and "1.6e+04 s" in reason
    assert following(found, runs, 0.01, 1e6) == (6, "")          # no more than twice finer at once
    assert following(found, runs, 0.05, 1e3) == (5, "")
    assert following(found, runs, None, 70.0) == (4, "")         # the best for these seconds
    assert following(found, runs, None, 10.0)[0] == 0
    assert following(Answers([one], runs[:1]), runs[:1], 0.01, 5.0)[0] == 0


def test_a_run_that_takes_too_long_leaves_the_best(outcome):
    """Mesh 3 is stopped: the answer of two meshes stands, and says why."""
    class Long:
        def tell(self, line):
            pass

        def run(self, factor, limit):
            if factor == 3:
                assert 400.0 < limit <= 1.5 * 400.0
                raise RunError("mesh_3/x: stopped after 600 s", Outcome(pathlib.Path(), "x", {}, STOPPED, ""))
            return MeshRun(factor, 10 * factor, 100, 1.0, outcome)
    found = find(Long(), [parse("field:mises:largest")], 0.01, 400.0)
    assert len(found.runs) == 2 and found.failure is None
    assert found.answers[0].reason == "mesh 3 ended it: mesh_3/x: stopped after 600 s (--seconds)"


def test_what_just_misses_a_target_is_seen_to():
    assert [rounded_up(value) for value in (1.03, 1.0001, 0.53, 12.341, 0.0)] == ["1.03", "1.01", "0.53", "12.4", "0"]


# ---- quantities ------------------------------------------------------------------------------

def test_linear_fields_are_exact_at_any_point():
    """On a distorted mesh, of nodes inside elements, of elements at the boundary too; a node has its own value."""
    columns, rows = 6, 5
    x = np.array([(i + 0.2 * math.sin(3 * i + 5 * j), j + 0.2 * math.cos(7 * i + 2 * j)) for j in range(rows) for i in range(columns)])
    cells = np.array([[k, k + 1, k + columns + 1, k + columns] for j in range(rows - 1) for k in range(j * columns, (j + 1) * columns - 1)])
    centres, parts = x[cells].mean(axis=1), np.ones(len(cells))

    def of(places):
        return 3.0 + 2.0 * places[..., 0] - 5.0 * places[..., 1]
    for point in ([0.6, 0.5], [2.3, 1.7], [3.9, 3.2], x[0], x[8], 0.5 * (x[0] + x[1])):
        assert weights_at(x, cells, parts, point, True) @ of(x) == pytest.approx(of(np.asarray(point)))
        assert weights_at(x, cells, parts, point, False) @ of(centres) == pytest.approx(of(np.asarray(point)))
    assert weights_at(x, cells, parts, x[8], True)[8] == pytest.approx(1.0)
    for point in (0.3 * x[2] + 0.7 * x[3] - [0.0, 0.1], x[3]):  # what a surface has: along it alone
        below = weights_at(x, edges_at(x, cells, point), parts, point, True)
        assert set(np.flatnonzero(below > 1e-9)) <= {2, 3} and below[3] > 0.6 and below.sum() == pytest.approx(1.0)
    near = weights_at(x, cells, np.where(centres[:, 0] < 2.5, 1, 2), [2.3, 1.7], False)
    assert not np.any(near[centres[:, 0] > 2.5])   # not across to another part



def test_words_of_a_quantity():
    assert parse("rcforc:fy@interface=1,side=slave:largest") == Quantity(
        "rcforc:fy@interface=1,side=slave:largest", "rcforc", "fy", (("interface", "1"), ("side", "slave")), "largest")
    assert parse("glstat:internal").measure == "largest"
    assert (parse("nodout:ux@node=5:at=1e-3").measure, parse("nodout:ux@node=5:at=1e-3").time) == ("at", 1e-3)
    assert (parse("field:stress:xy").column, parse("field:stress:xy:smallest").measure) == ("stress:xy", "smallest")
    assert parse("field:stress:xy@x=1,y=2:end").where == (("x", "1"), ("y", "2"))


@pytest.mark.parametrize("text, words", [
    ("glstat", "expected HISTORY:COLUMN"), ("glstat:internal:larges", "nearest name is 'largest'"), ("rcforc:fy@side", "KEY=VALUE"),
    ("glstat:internal:at=soon", "no number"), ("field:mises@node=5:end", "@x=X,y=Y"), (":fy", "expected")])
def test_bad_words(text, words):
    with pytest.raises(UserError, match=words):
        parse(text)


@pytest.fixture
def outcome(tmp_path):
    conftest.write_results(tmp_path / "three.vtkhdf")
    (tmp_path / "three.rcforc.csv").write_text("time,interface,side,fx,fy,n_active\n0,1,slave,0,0,1\n0,1,master,0,0,1\n2,1,slave,0,4,1\n"
                                               "2,1,master,0,-4,1\n3,1,slave,0,1,1\n3,1,master,0,-1,1\n", encoding="ascii")
    return Outcome(tmp_path, "three", {}, 0, "")


@pytest.mark.parametrize("text, value", [
    ("rcforc:fy@side=slave:largest", 4.0), ("rcforc:fy@side=master:smallest", -4.0), ("rcforc:fy@interface=1,side=slave:impulse", 6.5),
    ("rcforc:fy@side=slave:mean", 6.5 / 3.0), ("rcforc:fy@side=slave:end", 1.0), ("rcforc:fy@side=slave:at=1", 2.0),
    ("field:mises:largest", 3e6), ("field:mises@x=1.5,y=0.5:end", 2e6), ("field:mises@x=0,y=0:end", 5e5), ("field:displacement:y:largest", 0.2),
    ("field:displacement:x@x=2,y=0:at=0.25", 0.05)])
def test_values_of_quantities(outcome, text, value):
    assert parse(text).of(outcome) == pytest.approx(value)


@pytest.mark.parametrize("text, words", [
    ("rcfore:fy", "nearest name is 'rcforc'"), ("rcforc:fyy@side=slave", "nearest name is 'fy'"), ("rcforc:fy", "2 series"),
    ("rcforc:fy@interface=7,side=slave", "no interface 7; there are 1"), ("rcforc:fy@node=1", "no series by 'node'"),
    ("rcforc:fy@side=slav", "nearest name is 'slave'"), ("rcforc:fy@side=slave:at=9", "times from 0 to 3"),
    ("field:misses:largest", "nearest name is 'mises'"), ("rcforc:side@side=slave,interface=1:largest", "no number")])
def test_quantities_that_are_not_there(outcome, text, words):
    with pytest.raises(UserError, match=words):
        parse(text).of(outcome)


# ---- the command -----------------------------------------------------------------------------

QUANTITY = "nodout:ux@node=3:largest"


@pytest.fixture
def deck(tmp_path):
    path = tmp_path / "bar.k"
    path.write_text(bar(), encoding="ascii")
    return path


@PROGRAM
def test_an_answer_is_found_written_and_kept(deck, tmp_path, tool, plain_pictures):
    words = ("answer", deck, "--of", QUANTITY, "--of", "glstat:internal:end", "--within", "60%", "--folder", tmp_path / "out")
    done = tool(*words)
    assert done.returncode == 0, done.stderr
    assert f"{QUANTITY} = " in done.stdout and "mesh 3" in done.stderr
    facts = json.loads((tmp_path / "out/answer.json").read_text(encoding="utf-8"))
    assert {"value", "uncertainty", "order", "runs", "reason"} <= facts.keys() and len(facts["answers"]) == 2
    assert [run["mesh"] for run in facts["runs"]] == [1, 2, 3] and [run["elements"] for run in facts["runs"]] == [2, 8, 18]
    assert all({"updates", "seconds", "value"} <= run.keys() for run in facts["runs"])
    assert (tmp_path / "out/answer.png").stat().st_size > 1000
    marks = [path.stat().st_mtime_ns for path in sorted((tmp_path / "out").glob("mesh_*/bar.glstat.csv"))]
    again = tool(*words, "--json")
    assert json.loads(again.stdout) == facts and again.stderr.count("kept") == 3
    assert marks == [path.stat().st_mtime_ns for path in sorted((tmp_path / "out").glob("mesh_*/bar.glstat.csv"))]
    deck.write_text(bar(end="3e-5"), encoding="ascii")
    assert "kept" not in tool(*words).stderr


@PROGRAM
@pytest.mark.parametrize("adapt", [(), ("--adapt",)], ids=["divided", "adapted"])
def test_runs_of_a_file_that_has_changed_are_not_kept(deck, tmp_path, tool, plain_pictures, adapt):
    part = tmp_path / "parts/bar.inc"
    part.parent.mkdir()
    deck.write_text("*KEYWORD\n*INCLUDE\nfirst.inc\n*END\n", encoding="ascii")
    (tmp_path / "first.inc").write_text("*INCLUDE_PATH\nparts\n*INCLUDE\nbar.inc\n", encoding="ascii")
    words = ("answer", deck, "--of", QUANTITY, "--within", "90%", "--folder", tmp_path / "out", *adapt)
    for end in ("2e-5", "3e-5"):
        part.write_text(bar(PULLED + "*DATABASE_BINARY_D3PLOT\n1e-5,\n", end=end), encoding="ascii")
        done = tool(*words)
        assert done.returncode == 0 and "kept" not in done.stderr, done.stderr


@PROGRAM
def test_what_is_not_reached_is_written_all_the_same(deck, tmp_path, tool, plain_pictures):
    done = tool("answer", deck, "--of", QUANTITY, "--within", "0.0001%", "--seconds", "2", "--folder", tmp_path / "out")
    assert done.returncode == 4, done.stderr
    facts = json.loads((tmp_path / "out/answer.json").read_text(encoding="utf-8"))
    assert facts["within"] is False and facts["reason"] and facts["uncertainty"] > 0.0


@PROGRAM
def test_bad_requests_are_refused(deck, tmp_path, tool):
    for words, text in ((("--within", "2"), "percentage"), (("--within", "0%"), "percentage"), (("--within", "-2%"), "expected one argument"), 
                        ((), "--within X% or --seconds N"), (("--seconds", "5", "--choose"), "--within X%"),
                        (("--seconds", "0"), "more than 0"), (("--within", "2%", "--adapt", "--mesh-parameter", "level"), "--adapt"), (("--seconds", "9", "--ncpu", "0"), "1 or more"),
                        (("--within", "2%", "--mesh-parameter", "level"), "no such parameter")):
        done = tool("answer", deck, "--of", QUANTITY, *words, "--folder", tmp_path / "out")
        assert done.returncode == 1 and text in done.stderr, done.stderr
    for quantity, text in (("nodout:uxx@node=3", "nearest name is"), ("nodont:ux@node=3", "nearest name is 'nodout'")):
        done = tool("answer", deck, "--of", quantity, "--within", "2%", "--folder", tmp_path / "out")
        assert done.returncode == 1 and text in done.stderr
    assert tool("answer", tmp_path / "none.k", "--of", QUANTITY, "--within", "2%").returncode == 1
    done = tool("answer", deck, "--of", QUANTITY, "--within", "2%", "--folder", "/dev/null/out")
    assert done.returncode == 1 and done.stderr.splitlines()[-1] == (
        "slideline-tools: answer: cannot make the folder /dev/null/out/mesh_1: Not a directory")
    done = tool("answer", deck, "--of", QUANTITY, "--within", "2%", "--withn", "2%")
    assert done.returncode == 1 and "usage: slideline-tools answer" in done.stderr and "unrecognized arguments: --withn" in done.stderr
    deck.write_text(bar("*MAT_NONSENSE\n1,\n"), encoding="ascii")
    done = tool("answer", deck, "--of", QUANTITY, "--within", "2%", "--folder", tmp_path / "out")
    assert done.returncode == 1 and "MAT_NONSENSE" in done.stderr and "bar.k" in done.stderr


@PROGRAM
def test_a_run_that_fails_ends_with_the_deck_and_the_reason(deck, tmp_path, tool):
    deck.write_text(bar(PULLED.replace("1e4", "1e14")), encoding="ascii")
    done = tool("answer", deck, "--of", QUANTITY, "--within", "2%", "--folder", tmp_path / "out")
    assert done.returncode == 2 and "bar.k" in done.stderr and "error termination" in done.stderr


@PROGRAM
def test_a_first_run_that_takes_too_long_is_stopped(deck, tmp_path, tool):
    deck.write_text(bar(PULLED, end="10.0"), encoding="ascii")
    done = tool("answer", deck, "--of", QUANTITY, "--seconds", "0.5", "--folder", tmp_path / "out")
    assert done.returncode == 4 and "stopped after 0.75 s" in done.stderr


@PROGRAM
def test_a_finer_mesh_that_fails_leaves_the_best(tmp_path, tool, plain_pictures):
    for level in (1, 2):
        (tmp_path / f"plate_{level}.k").write_text(scenes.symmetric_plate(n_x=8 * level, n_y=4 * level), encoding="ascii")
    (tmp_path / "plate_3.k").write_text(bar(PULLED.replace("1e4", "1e14")), encoding="ascii")
    done = tool("answer", tmp_path / "plate_{level}.k", "--mesh-parameter", "level", "--of", "glstat:internal:largest", "--seconds", "1000",
                "--within", "99%", "--folder", tmp_path / "out")
    assert done.returncode == 2, done.stderr
    facts = json.loads((tmp_path / "out/answer.json").read_text(encoding="utf-8"))
    assert len(facts["runs"]) == 2 and facts["within"] is False and "error termination" in facts["reason"]


@PROGRAM
def test_a_command_that_is_stopped_stops_its_run(deck, tmp_path):
    deck.write_text(bar(PULLED, end="1.0"), encoding="ascii")
    command = [sys.executable, "-m", "slideline_tools.cli", "answer", deck, "--of", QUANTITY, "--within", "2%", "--folder", tmp_path / "out"]
    with subprocess.Popen(command, env={**os.environ, "PYTHONPATH": str(conftest.ROOT / "tools")}, stderr=subprocess.PIPE, text=True) as started:
        status = tmp_path / "out/mesh_1/status.out"
        for _ in range(600):
            if status.exists():
                break
            time.sleep(0.05)
        started.terminate()
        _, said = started.communicate(timeout=30)
    assert started.returncode == 4 and "stopped" in said and "Traceback" not in said
    before = status.stat().st_mtime_ns, (tmp_path / "out/mesh_1/bar.glstat.csv").stat().st_size
    time.sleep(1.0)
    assert before == (status.stat().st_mtime_ns, (tmp_path / "out/mesh_1/bar.glstat.csv").stat().st_size)


@PROGRAM
def test_decks_of_a_generator(tmp_path, tool, plain_pictures):
    for level in (1, 2, 3):
        (tmp_path / f"plate_{level}.k").write_text(scenes.symmetric_plate(n_x=8 * level, n_y=4 * level), encoding="ascii")
    done = tool("answer", tmp_path / "plate_{level}.k", "--mesh-parameter", "level", "--of", "glstat:internal:largest", "--seconds", "1000",
                "--within", "99%", "--folder", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    assert [run["elements"] for run in json.loads(done.stdout)["runs"]] == [32, 128, 288]


@PROGRAM
def test_an_answer_on_meshes_that_are_finer_where_it_pays(deck, tmp_path, tool, plain_pictures):
    deck.write_text(bar(PULLED + "*DATABASE_BINARY_D3PLOT\n1e-5,\n"), encoding="ascii")
    words = ("answer", deck, "--of", QUANTITY, "--within", "90%", "--adapt", "--folder", tmp_path / "out", "--json")
    done = tool(*words)
    assert done.returncode == 0, done.stderr
    runs = json.loads(done.stdout)["runs"]
    assert len(runs) >= 3 and all(a["elements"] < b["elements"] < 4 * a["elements"] + 1 for a, b in zip(runs, runs[1:]))
    assert [run["mesh"] for run in runs] == pytest.approx([(run["elements"] / 2) ** 0.5 for run in runs], abs=1e-3)
    assert tool(*words).stderr.count("kept") == len(runs)


@PROGRAM
def test_adapted_meshes_need_states(deck, tmp_path, tool):
    done = tool("answer", deck, "--of", QUANTITY, "--within", "2%", "--adapt", "--folder", tmp_path / "out")
    assert done.returncode == 1 and "no results" in done.stderr


@PROGRAM
def test_a_parameter_that_makes_no_mesh_is_refused(deck, tmp_path, tool):
    deck.write_text(bar(PULLED + "*PARAMETER\nI level,1\n"), encoding="ascii")
    done = tool("answer", deck, "--of", QUANTITY, "--within", "2%", "--mesh-parameter", "level", "--folder", tmp_path / "out")
    assert done.returncode == 1 and "the mesh stays as it is" in done.stderr


@PROGRAM
def test_types_are_tried(tmp_path, tool, plain_pictures):
    """Unlike meshes under a uniform pressure: what is reached at least cost is one of all types."""
    deck = tmp_path / "patch.k"
    deck.write_text(scenes.patch(mesh="3/2", static=True), encoding="ascii")
    done = tool("answer", deck, "--of", "rcforc:fy@interface=1,side=slave:end", "--within", "1%", "--choose", "--folder", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    assert facts["type"] in [one["type"] for one in facts["tried"]] and len(facts["tried"]) == 7
    reached = [one for one in facts["tried"] if one["reached"]]
    assert min(reached, key=lambda one: one["seconds"])["type"] == facts["type"]


@PROGRAM
def test_the_study_of_the_uncertainty(tmp_path, plain_pictures):
    """Two bars against their closed forms: all four quantities within U."""
    from slideline_tools.studies import __main__ as command
    assert command.main(["uncertainty", "--quick", "--program", os.environ["SLIDELINE"], "--folder", str(tmp_path)]) == 0
    text = (tmp_path / "doc/studies/uncertainty.md").read_text(encoding="utf-8")
    assert "4 of 4 quantities are within U (100 %)" in text and (tmp_path / "uncertainty.png").exists()
