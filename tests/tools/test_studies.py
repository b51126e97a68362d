# SPDX-License-Identifier: MIT
"""Pieces of the studies: contact episodes, travel of the die, tables, unfinished runs."""
import numpy as np
import pytest

from slideline_tools import UserError
from slideline_tools.studies import collision, common, sliding


@pytest.mark.parametrize("force, expected", [
    ([0, 0, 0, 0, 0, 0], []),
    ([0, 1, 2, 0, 0, 0], [(1.0, 2.0)]),
    ([3, 1, 0, 0, 5, 5], [(0.0, 1.0), (4.0, 5.0)]),
    ([0, 1, 0, 1, 0, 1], [(1.0, 1.0), (3.0, 3.0), (5.0, 5.0)]),
    ([1, 1, 1, 1, 1, 1], [(0.0, 5.0)])])
def test_episodes_are_the_stretches_with_a_force(force, expected):
    assert collision.episodes(np.arange(6.0), force) == expected


def test_travel_of_the_die_is_the_integral_of_the_deck_s_curve():
    start, end, distance = sliding.DRAW
    time = np.linspace(0.0, 7e-3, 7001)
    moved = sliding.travel(time)
    assert moved[time <= start].max() == 0.0
    assert moved[-1] == pytest.approx(distance)
    curve = np.array(sliding_curve())
    velocity = np.interp(time, curve[:, 0], curve[:, 1])
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1])
                                              * np.diff(time))])
    # Linear between 200 points: (2 pi)^2 / 12 / 200^2 / (2 pi) = 1.3e-5 of the distance is lost.
    assert np.abs(moved - summed).max() < 1.6e-5 * distance


def sliding_curve():
    from slideline_tools.scenes.sliding import stroke
    return stroke(*sliding.DRAW)


def test_judged_interval_and_crossing_time():
    first, last = sliding.judged_interval()
    assert (first, last) == pytest.approx((2.0625e-3, 5.4375e-3))
    assert sliding.crossing_time(2) == pytest.approx(0.5 * 0.5625e-3)


def test_table_and_levels():
    assert common.markdown_table(["a", "b"], [["x", 0.123456], [2, 3.0]]) == \
        "| a | b |\n|---|---|\n| x | 0.1235 |\n| 2 | 3 |"


@pytest.mark.parametrize("study, job", [(sliding, "sliding"), (collision, "collision")])
def test_a_run_that_stopped_early_is_refused(study, job, tmp_path):
    folder = tmp_path / "level_1_type_2"
    folder.mkdir()
    with pytest.raises(UserError, match="cannot read"):
        study.Run(tmp_path, 1, 2)
    (folder / f"{job}.rcforc.csv").write_text(
        "time,interface,side,fx,fy,n_active\n0,1,slave,0,0,0\n1e-5,1,slave,0,0,0\n")
    with pytest.raises(UserError, match="did not reach its end"):
        study.Run(tmp_path, 1, 2)
