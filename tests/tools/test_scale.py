# SPDX-License-Identifier: MIT
"""The study of scale: tiles and what processes send each other, against counts by hand; the page from a table."""
import numpy as np
import pandas as pd
import pytest

from slideline_tools.studies.framework.job import Options
from slideline_tools.studies.scale import study, tiles as scale_tiles
from slideline_tools.studies.scale.tiles import grid_mesh, ring_mesh


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
    assert study.load_of(10 ** 6, 64) == pytest.approx(31 / (1954 / 64))


def test_a_ring_is_closed():
    points, quads = ring_mesh(12, 2)
    corners = points[quads]
    following = np.roll(corners, -1, axis=1)
    areas = 0.5 * np.sum(corners[..., 0] * following[..., 1] - corners[..., 1] * following[..., 0], axis=1)
    assert np.all(areas > 0.0) and areas.sum() == pytest.approx(6.0 * np.sin(np.pi / 6) * (1.0 - 0.8 ** 2))
    assert np.all(np.bincount(quads.ravel()) == np.tile([2, 4, 2], 12))


def test_efficiency_is_one_where_nothing_is_exchanged_and_falls(monkeypatch):
    monkeypatch.setattr(study, "NETWORKS", {"free": (0.0, 1.0e30), **study.NETWORKS})
    assert study.efficiency(512 * 64, 64, "free", (4, 4.0), False) == pytest.approx(1.0)
    by_ranks = [study.efficiency(10 ** 7, n, "fast", (4, 4.0), False) for n in (2, 16, 256, 1024)]
    assert by_ranks == sorted(by_ranks, reverse=True) and by_ranks[-1] < 1.0
    # All compute the contact: no more than one over its share.
    share = 1e-9 * study.CONTACT_NS * (10 ** 7 / 2) ** 0.5
    one = 1e-9 * study.STEP_NS * 10 ** 7 + share
    assert study.efficiency(10 ** 7, 1024, "free", (4, 4.0), True) < one / (1024 * share)


def test_jobs_and_what_the_log_counts(tmp_path):
    job = next(job for job in study.jobs(Options(quick=True)) if job.name == "collision_4")
    assert job.launcher == ("mpirun", "--oversubscribe", "-n", "4") and job.labels["elements"] == 15360
    (tmp_path / "run.log").write_text("exchange: 4 processes; a cycle, mean (most): messages 2.00 (3), bytes 2860.00 (3584), calls "
                                      "of all 2.00 (2), bytes by them 4544.00 (4544); besides\n")
    found = study.measure(job, tmp_path)
    assert [found[name] for name in ("messages", "most_messages", "bytes", "most_bytes", "bytes_to_all")] == [2, 3, 2860, 3584, 4544]


@pytest.mark.parametrize("most, reported", [(96.0, "yes"), (95.0, "no")])
def test_page_says_whether_the_tiles_explain_the_counts(monkeypatch, tmp_path, plain_pictures, most, reported):
    """A strip on four processes sends 96 bytes from those in the middle."""
    monkeypatch.setattr(scale_tiles, "MESHES", {"strip": lambda: grid_mesh(2048, 2, 204.8, 0.2)})
    study.all_cuts.cache_clear()
    table = pd.DataFrame([{"scene": "strip", "elements": 4096, "ranks": 4, "state": "finished", "messages": 1.5,
                           "most_messages": 2, "bytes": 72, "most_bytes": most, "bytes_to_all": 80}])
    text = study.page(table)
    study.chart(table, tmp_path)
    study.all_cuts.cache_clear()
    assert f"| strip | 4096 | 4 | 1.5 | 2 | 72 | {most:g} | 80 | {reported} |" in text
    assert (tmp_path / "scale.png").exists()
