# SPDX-License-Identifier: MIT
"""The written decks: counts, areas, masses and walking order against the scene descriptions."""
import pathlib

import numpy as np
import pytest

from slideline_tools import scenes
from slideline_tools.decks import Deck, Grid, field, spaced
from slideline_tools.scenes.patch import MESHES

ROOT = pathlib.Path(__file__).resolve().parents[2]
WIDTHS = {"NODE": [8, 16, 16], "ELEMENT_SHELL": [8] * 6}


class Model:
    """A fixed-format deck read back by columns."""

    def __init__(self, text):
        self.blocks, self.parameters, name = [], {}, None
        for line in text.splitlines():
            if line.startswith("*"):
                name = line[1:]
                self.blocks.append((name, []))
            elif not line.startswith("$") and name is not None:
                self.blocks[-1][1].append(line)
        for line in self.lines("PARAMETER"):
            words = line[2:].replace(",", " ").split()
            self.parameters[words[0]] = float(words[1])
        rows = [cut(line, WIDTHS["NODE"]) for line in self.lines("NODE")]
        self.points = {int(row[0]): (float(row[1]), float(row[2])) for row in rows}
        rows = [cut(line, WIDTHS["ELEMENT_SHELL"]) for line in self.lines("ELEMENT_SHELL")]
        self.elements = np.array(rows, dtype=int)

    def lines(self, name):
        return [line for block, lines in self.blocks if block == name for line in lines]

    def all_blocks(self, name):
        return [lines for block, lines in self.blocks if block == name]

    def node_set(self, number):
        for _, head, *rows in self.all_blocks("SET_NODE_LIST_TITLE"):
            if int(head[:10]) == number:
                return [int(line[k:k + 10]) for line in rows for k in range(0, len(line), 10)]
        raise AssertionError(f"no node set {number}")

    def corners(self, part=None):
        rows = self.elements if part is None else self.elements[self.elements[:, 1] == part]
        return np.array([[self.points[node] for node in row[2:6]] for row in rows])

    def chain(self, number):
        return np.array([self.points[node] for node in self.node_set(number)])


def cut(line, widths):
    edges = np.cumsum([0] + widths)
    return [line[a:b] for a, b in zip(edges[:-1], edges[1:])]


def areas(corners):
    x, y = corners[:, :, 0], corners[:, :, 1]
    return 0.5 * np.sum(x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y, axis=1)


DECKS = list(scenes.committed_decks())


@pytest.mark.parametrize("path, text", DECKS, ids=[path for path, _ in DECKS])
def test_committed_deck_is_what_the_tool_writes(path, text):
    assert (ROOT / "input" / path).read_text() == text


KEPT = sorted((ROOT / "input").rglob("*.k"))


def test_decks_of_input_are_few_and_small():
    """They come with every clone and every package."""
    assert len(KEPT) <= 32 and sum(path.stat().st_size for path in KEPT) < 3e6


@pytest.mark.parametrize("path", KEPT, ids=[path.stem for path in KEPT])
def test_lines_fit_and_areas_are_positive(path):
    text = path.read_text(encoding="ascii")
    assert all(len(line) <= 80 for line in text.splitlines())
    assert text.endswith("*END\n")
    assert np.all(areas(Model(text).corners()) > 0.0)


@pytest.mark.parametrize("level", [1, 2, 3, 4])
def test_collision_counts_and_masses(level):
    model = Model(scenes.collision(level))
    plate, projectile = model.corners(1), model.corners(2)
    assert len(plate) == 36 * level * 4 * level
    assert len(projectile) == 24 * level * 4 * level
    assert len(model.points) == sum((n * level + 1) * (4 * level + 1) for n in (36, 24))
    assert 2700.0 * areas(plate).sum() == pytest.approx(2700.0 * 65.0e-3 * 5.0e-3, rel=1e-9)
    assert 7850.0 * areas(projectile).sum() == pytest.approx(7850.0 * 20e-3 * 5e-3, rel=1e-9)
    columns = np.unique(np.round(plate[:, :, 0], 12))
    assert np.sum(columns < 0.025 - 1e-9) == 20 * level
    assert np.sum(columns > 0.025 + 1e-9) == 16 * level


@pytest.mark.parametrize("level", [1, 2, 3, 4])
def test_collision_numbers(level):
    given = Model(scenes.collision(level)).parameters
    assert given["dt"] == pytest.approx(100.0e-9 / level, rel=1e-15)
    assert given["pen"] == pytest.approx(1.0e9 / level, rel=1e-15)
    assert given["endtim"] / given["dt"] == pytest.approx(10000 * level, rel=1e-12)
    assert given["v0"] == -80.0


@pytest.mark.parametrize("level", [1, 3])
def test_collision_surfaces_walk_with_the_body_on_the_left(level):
    model = Model(scenes.collision(level))
    card = model.lines("CONTACT_2D_SLIDELINE")[0]
    slave, master = (model.chain(-int(card[k:k + 10])) for k in (0, 10))
    assert len(slave) == 24 * level + 1 and len(master) == 20 * level + 1
    np.testing.assert_allclose(slave[[0, -1]], [[0.0, 0.5e-3], [20.0e-3, 0.5e-3]], atol=1e-15)
    np.testing.assert_allclose(master[[0, -1]], [[25.0e-3, 0.0], [0.0, 0.0]], atol=1e-15)
    for chain, down in ((slave, True), (master, False)):
        tangent = np.diff(chain, axis=0)
        outward = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
        assert np.all((outward[:, 1] < 0.0) == down)
    edges = {(a, b) for row in model.elements for a, b in zip(row[2:6], np.roll(row[2:6], -1))}
    for number in (3, 4):
        nodes = model.node_set(number)
        assert all(pair in edges for pair in zip(nodes[:-1], nodes[1:]))


def test_collision_supports():
    model = Model(scenes.collision(2))
    symmetry, clamped = model.chain(1), model.chain(2)
    assert np.all(symmetry[:, 0] == 0.0) and len(symmetry) == 18
    assert np.all(clamped[:, 0] == 0.065) and len(clamped) == 9
    cards = [line.split() for line in model.lines("BOUNDARY_SPC_SET")]
    assert cards == [["1", "0", "1", "0"], ["2", "0", "1", "1"]]


@pytest.mark.parametrize("n_x, n_y", [(8, 4), (16, 8), (32, 16), (64, 32)])
@pytest.mark.parametrize("elastoplastic", [False, True])
def test_symmetric_plate(n_x, n_y, elastoplastic):
    model = Model(scenes.symmetric_plate(n_x, n_y, elastoplastic))
    assert len(model.elements) == n_x * n_y
    assert areas(model.corners()).sum() == pytest.approx(8.0, rel=1e-12)
    part = model.corners(1)
    assert part[:, :, 0].max() == (7.0 if elastoplastic else 8.0)
    pinned = int(model.lines("BOUNDARY_SPC_NODE")[0][:10])
    assert model.points[pinned] == (8.0, 0.5)
    watched = int(model.lines("DATABASE_HISTORY_NODE")[0][:10])
    assert model.points[watched] == (0.0, 0.5)


@pytest.mark.parametrize("n_x", [8, 32])
def test_plate_load_is_80_kn_per_metre_on_the_whole_edge(n_x):
    model = Model(scenes.symmetric_plate(n_x, n_x // 2))
    set_card = model.lines("LOAD_NODE_SET")[0].split()
    inside = model.node_set(int(set_card[0]))
    shares = {node: float(set_card[3]) for node in inside}
    for line in model.lines("LOAD_NODE_POINT"):
        shares[int(line.split()[0])] = float(line.split()[3])
    assert len(shares) == n_x + 1
    assert all(model.points[node][1] == 1.0 for node in shares)
    assert 80.0e3 * sum(shares.values()) == pytest.approx(640.0e3, rel=1e-14)
    moment = sum(share * model.points[node][0] for node, share in shares.items())
    assert moment == pytest.approx(32.0, rel=1e-14)
    assert model.parameters["load"] == 80.0e3


@pytest.mark.parametrize("level", [1, 2])
def test_sliding(level):
    model = Model(scenes.sliding(level))
    plate, die = model.corners(1), model.corners(2)
    assert (len(plate), len(die)) == (144 * level ** 2, 54 * level ** 2)
    assert np.all(areas(model.corners()) > 0.0)
    assert areas(plate).sum() == pytest.approx(36.0e-3 * 4.0e-3, rel=1e-9)
    under_crown = 2.0 * 4.5e-3 ** 3 / (6.0 * 20.0e-3)
    assert areas(die).sum() == pytest.approx(9.0e-3 * 2.0e-3 - under_crown, rel=0.01 / level ** 2)
    lower, upper = model.chain(3), model.chain(2)
    np.testing.assert_allclose(lower[:, 1], (lower[:, 0] - 0.010) ** 2 / 0.040, atol=1e-12)
    assert np.all(upper[:, 1] == 0.002) and np.all(np.diff(lower[:, 0]) > 0.0)
    assert np.all(model.chain(1)[:, 1] == -0.004) and np.all(np.diff(model.chain(4)[:, 0]) < 0.0)
    given = model.parameters
    assert given["endtim"] / given["dt"] == pytest.approx(150000 * level, rel=1e-12)
    assert given["pen"] == 10.0e9 / level


def test_strokes_of_the_die():
    model = Model(scenes.sliding(1))
    for lines, distance, end in zip(model.all_blocks("DEFINE_CURVE_TITLE")[1:],
                                    (-0.15e-3, 8.0e-3), (1.5e-3, 6.0e-3)):
        points = np.array([(float(line[:20]), float(line[20:])) for line in lines[2:]])
        t, v = points.T
        assert np.sum(0.5 * (v[1:] + v[:-1]) * np.diff(t)) == pytest.approx(distance, rel=1e-9)
        assert np.all(v[t >= end - 1e-12] == 0.0)
    start = 1.5e-3
    assert np.all(v[t <= start] == 0.0)
    middle = np.argmin(np.abs(t - 0.5 * (start + end)))
    assert v[middle] == pytest.approx(2.0 * 8.0e-3 / 4.5e-3, rel=1e-9)
    cards = [block[0].split()[:4] for block in model.all_blocks("BOUNDARY_PRESCRIBED_MOTION_SET")]
    assert cards == [["2", "2", "0", "2"], ["2", "1", "0", "3"]]


def test_sliding_with_a_rigid_die():
    elastic, rigid = Model(scenes.sliding(1)), Model(scenes.sliding(1, rigid_die=True))
    assert [line.split() for line in rigid.lines("MAT_RIGID")[:2]] == [
        elastic.lines("MAT_ELASTIC")[0].split(), ["1", "0", "7"]]
    assert not rigid.lines("MAT_ELASTIC") and not rigid.lines("BOUNDARY_PRESCRIBED_MOTION_SET")
    cards = [block[0].split()[:4] for block in rigid.all_blocks("BOUNDARY_PRESCRIBED_MOTION_RIGID")]
    assert cards == [["2", "2", "0", "2"], ["2", "1", "0", "3"]]
    np.testing.assert_array_equal(rigid.corners(), elastic.corners())


def test_block():
    model = Model(scenes.block())
    lower, upper = model.corners(1), model.corners(2)
    assert (len(lower), len(upper)) == (100, 102)
    assert areas(lower).sum() == pytest.approx(5.0) and areas(upper).sum() == pytest.approx(5.0)
    slave, master = model.chain(3), model.chain(4)
    assert len(slave) == 52 and len(master) == 51
    assert np.all(slave[:, 1] == 0.0) and np.all(master[:, 1] == 0.0)
    assert np.all(np.diff(slave[:, 0]) > 0.0) and np.all(np.diff(master[:, 0]) < 0.0)
    assert np.all(model.chain(1)[:, 1] == -0.5) and np.all(model.chain(2)[:, 1] == 0.5)


@pytest.mark.parametrize("implicit", [False, True])
def test_level_of_the_block(implicit):
    coarse, fine = (Model(scenes.block(level=level, implicit=implicit)) for level in (1, 2))
    assert [len(fine.corners(part)) for part in (1, 2)] == [400, 408]
    assert np.ptp(fine.corners(2)[:, :, 1]) == 0.5
    for name, share in (("dt", 0.5), ("pen", 0.5), ("endtim", 1.0), ("v0", 1.0)):
        assert fine.parameters[name] == share * coarse.parameters[name]
    with pytest.raises(ValueError, match="level"):
        scenes.block(level=0)


@pytest.mark.parametrize("mesh", MESHES)
def test_meshes_of_the_patch(mesh):
    model = Model(scenes.patch(mesh=mesh))
    assert [len(model.chain(number)) - 1 for number in (3, 4)] == [int(n) for n in mesh.split("/")]
    assert areas(model.corners()).sum() == pytest.approx(2.0)
    even = np.ptp(np.diff(model.chain(3)[:, 0])) < 1e-12
    assert even == (mesh != "7/5")


@pytest.mark.parametrize("n_x, n_y", [(12, 4), (8, 3), (0, 4)])
def test_plate_mesh_that_cannot_be(n_x, n_y):
    with pytest.raises(ValueError):
        scenes.symmetric_plate(n_x, n_y)


@pytest.mark.parametrize("value", [1.0 / 3.0, -1.0 / 3.0, 1e-7 / 3.0, 2.76e8, -1.23456789e-12,
                                   123456789.0, 0.001, -80.0, 6.02e23])
@pytest.mark.parametrize("width", [10, 16, 20])
def test_real_fields_keep_a_blank_and_their_value(value, width):
    text = field(value, width)
    assert len(text) == width and text[0] == " "
    assert float(text) == pytest.approx(value, rel=10.0 ** (10 - width - 3 + 3.5))


def test_fields_that_do_not_fit():
    with pytest.raises(ValueError):
        field(123456789, 8)
    with pytest.raises(ValueError):
        Deck("x" * 81)
    with pytest.raises(ValueError):
        Grid([0.0, 1.0, 1.0], [0.0, 1.0])


def test_grid_edges_walk_counter_clockwise():
    grid = Grid(spaced((0.0, 2.0, 2)), spaced((0.0, 1.0, 1)))
    assert grid.lower.tolist() == [1, 3, 5]
    assert grid.right.tolist() == [5, 6]
    assert grid.upper.tolist() == [6, 4, 2]
    assert grid.left.tolist() == [2, 1]
