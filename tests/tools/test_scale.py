# SPDX-License-Identifier: MIT
"""The study of scale: tiles and what processes send each other, against counts by hand; the page from tables."""
import csv
import re

import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.studies.scale import page as scale, tiles as scale_tiles
from slideline_tools.studies.scale.runs import COSTS, NAMES, grid_mesh, ring_mesh


def strip(columns=2048):
    """(slots, elements of the tiles) of a strip two elements high."""
    points, quads = grid_mesh(columns, 2, 0.1 * columns, 0.2)
    tiles = scale_tiles.tiles_of(points, quads)
    return scale_tiles.slots_of(quads, tiles), np.bincount(tiles)


def test_curve_visits_neighbours_one_after_the_other():
    side = 2 ** 11  # of the cells that a 32 x 32 grid of places is apart
    x, y = np.meshgrid(np.arange(32), np.arange(32))
    order = np.argsort(scale_tiles.hilbert_distance(side * x.ravel(), side * y.ravel()))
    steps = np.abs(np.diff(x.ravel()[order])) + np.abs(np.diff(y.ravel()[order]))
    assert np.all(steps == 1)


def test_tiles_of_a_strip_share_columns_of_nodes():
    slots, sizes = strip()
    assert list(sizes) == [512] * 8
    nodes, tiles = slots
    assert len(np.unique(nodes)) == 7 * 3 and np.all(np.bincount(nodes)[nodes] == 2) and len(tiles) == 42
    messages, sent = scale_tiles.traffic(slots, scale_tiles.ranges(sizes, 4), 4)
    assert list(messages) == [1, 2, 2, 1] and list(sent) == [48, 96, 96, 48]


def test_a_slot_goes_to_a_process_once():
    """Four tiles around one node: where two of them are of one process it sends both slots, but hears each of the others once."""
    quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])
    slots = scale_tiles.slots_of(quads, np.arange(4))
    # Process 0 has the lower two: nodes 3, 4, 5 lie between, with 1, 2, 1 slots on each side.
    messages, sent = scale_tiles.traffic(slots, np.array([0, 0, 1, 1]), 2)
    assert list(messages) == [1, 1] and list(sent) == [4 * 16, 4 * 16]
    # Each by itself: two of its slots go to one other, that of the middle to three.
    messages, sent = scale_tiles.traffic(slots, np.arange(4), 4)
    assert list(messages) == [3] * 4 and list(sent) == [5 * 16] * 4


def test_ranges_are_even_as_far_as_tiles_allow():
    assert list(scale_tiles.ranges(np.full(6, 100), 3)) == [0, 0, 1, 1, 2, 2]
    assert scale.load_of(10 ** 6, 64) == pytest.approx(31 / (1954 / 64))


def test_graph_of_tiles_has_both_ways_of_each_edge():
    slots, sizes = strip()
    starts, neighbours, weights = scale_tiles.tile_graph(slots, len(sizes))
    assert len(neighbours) == 14 and np.all(weights == 3)
    pairs = {(a, b) for a in range(8) for b in neighbours[starts[a]:starts[a + 1]]}
    assert all((b, a) in pairs and abs(a - b) == 1 for a, b in pairs)


def test_a_ring_is_closed():
    points, quads = ring_mesh(12, 2)
    corners = points[quads]
    following = np.roll(corners, -1, axis=1)
    areas = 0.5 * np.sum(corners[..., 0] * following[..., 1] - corners[..., 1] * following[..., 0], axis=1)
    assert np.all(areas > 0.0) and areas.sum() == pytest.approx(6.0 * np.sin(np.pi / 6) * (1.0 - 0.8 ** 2))
    assert np.all(np.bincount(quads.ravel()) == np.tile([2, 4, 2], 12))


def test_efficiency_is_one_where_nothing_is_exchanged_and_falls(monkeypatch):
    monkeypatch.setattr(scale, "NETWORKS", {"free": (0.0, 1.0e30), **scale.NETWORKS})
    assert scale.efficiency(512 * 64, 64, "free", (4, 4.0), False) == pytest.approx(1.0)
    by_ranks = [scale.efficiency(10 ** 7, n, "fast", (4, 4.0), False) for n in (2, 16, 256, 1024)]
    assert by_ranks == sorted(by_ranks, reverse=True) and by_ranks[-1] < 1.0
    assert scale.efficiency(10 ** 7, 256, "fast", (4, 4.0), True) < by_ranks[2]
    # All compute the contact: no more than one over its share.
    share = 1e-9 * scale.CONTACT_NS * (10 ** 7 / 2) ** 0.5
    one = 1e-9 * scale.STEP_NS * 10 ** 7 + share
    assert scale.efficiency(10 ** 7, 1024, "free", (4, 4.0), True) < one / (1024 * share)


@pytest.fixture
def small(monkeypatch):
    """A strip alone, and no large mesh."""
    monkeypatch.setattr(scale, "MESHES", {"strip": lambda: grid_mesh(2048, 2, 204.8, 0.2)})
    monkeypatch.setattr(scale, "LARGE", 64)


def table(path, most=96.0):
    """runs.csv as the program would count for the strip, but for the most bytes."""
    rows = [["strip", 4096, 4, 10, 1.5, 2, 72, most, 1, 72, "", ""]]
    rows += [[scene, n * n, 1, cycles, 0, 0, 0, 0, 0, 0, n * n * (1e-6 + 1e-8 * cycles), 0.3 * n * n]
             for scene, n in COSTS.items() for cycles in (20, 220)]
    with path.open("w", newline="") as stream:
        csv.writer(stream).writerows([NAMES, *rows])


def test_page(small, tmp_path):
    table(tmp_path / "runs.csv")
    scale.write(tmp_path, tmp_path / "doc")
    text = " ".join((tmp_path / "doc/studies/scale.md").read_text().split())  # lines end where they are full
    assert "all 1 runs of" in text and "Not what" not in text
    assert "| strip | 4096 | 4 | 1.50 (2) | 72 (96) | 72 |" in text
    assert "a step took 10 ns" in text and "it: 1.0 microseconds" in text and "here 307 bytes an element" in text
    assert re.search(r"two bodies in contact, 1e8 elements: predicted to keep 80 % on \d+ processes", text)
    assert (tmp_path / "doc/pictures/scale.png").exists()


def test_counts_that_the_tiles_do_not_explain_are_told(small, tmp_path):
    table(tmp_path / "runs.csv", 95.0)
    scale.write(tmp_path, tmp_path / "doc")
    text = " ".join((tmp_path / "doc/studies/scale.md").read_text().split())
    assert "**Not what the tiles" in text
    with pytest.raises(UserError, match="scale.sh"):
        scale.write(tmp_path / "nowhere", tmp_path / "doc")
