# SPDX-License-Identifier: MIT
"""Pieces of the studies: contact episodes, travel of the die, tables, unfinished runs."""
import pathlib
import re

import numpy as np
import pandas as pd
import pytest

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies import chooses, claims, collision, common, sliding

ROOT = pathlib.Path(__file__).resolve().parents[2]


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


def test_added_points_are_the_active_ones_beyond_the_touching_nodes(tmp_path):
    (tmp_path / "sliding.contact.csv").write_text(
        "time,interface,node,gap\n0,1,1,0.1\n0,1,2,0.1\n"
        "1,1,1,-0.1\n1,1,2,0.1\n2,1,1,-0.1\n2,1,2,-0.2\n")
    (tmp_path / "sliding.rcforc.csv").write_text(
        "time,interface,side,n_active\n0,1,slave,0\n0,1,master,0\n"
        "1,1,slave,1\n1,1,master,1\n2,1,slave,5\n2,1,master,5\n")
    assert claims.added_points(tmp_path).tolist() == [[1, 0], [2, 3]]


def timing_rows(steps):
    """Three runs of every variant, the last one disturbed; `steps` = seconds by type."""
    return pd.DataFrame([{"state": "finished", "scene": scene, "level": level, "type": ctype, "elements": 1.0,
             "element_calls": 1, "computing": 20.0, "load": 1.0, "contact": factor * (a + m + b),
             "search": factor * a, "pairing": factor * m, "force": factor * b}
            for factor in (1.0, 0.9, 50.0) for scene, levels in claims.LEVELS.items()
            for level in levels for ctype, (a, m, b) in steps.items()])


def test_time_claims_follow_the_medians():
    steps = {ctype: (3.0, 0.0, 1.0) for ctype in common.TYPES}
    steps.update({4: (3.0, 0.5, 1.0), 5: (3.0, 0.25, 0.75), 6: (9.0, 0.0, 7.0)})
    slide, crash = (claims.Times(timing_rows(steps), scene) for scene in claims.LEVELS)
    assert (slide.rounds, crash.ratio(4, 6)) == (3, 4.0)
    texts = claims.time_texts(slide, crash)
    assert (texts["pairing"], texts["detection"], texts["cheap"]) == ("yes", "yes", "partly")
    assert (texts["over_a"], texts["over_b"]) == ("0.08 to 0.17", "0.33 to 0.50")
    assert texts["shares"] == "type 1 75 %, type 3 75 %, type 4 67 %, type 5 75 %, type 6 56 %"
    assert texts["cheapest"] == "1.00 in the sliding (type 3), 1.00 in the collision (type 3)"
    del steps[6]
    with pytest.raises(UserError, match="not all types"):
        claims.time_texts(*(claims.Times(timing_rows(steps), scene) for scene in claims.LEVELS))


@pytest.mark.parametrize("fourth, fifth, expected, count", [
    ((3.0, 0.5, 1.0), (3.0, 0.5, 1.0), "yes", 14), ((3.0, 0.5, 1.0), (3.0, 2.0, 1.0), "partly", 7),
    ((3.0, 2.0, 1.0), (3.0, 2.0, 1.0), "no", 0), ((1.0, 2.0, 3.0), (3.0, 2.0, 1.0), "no", 0)])
def test_pairing_is_cheap_only_below_both_steps(fourth, fifth, expected, count):
    steps = {ctype: (3.0, 0.0, 1.0) for ctype in common.TYPES} | {4: fourth, 5: fifth}
    texts = claims.time_texts(*(claims.Times(timing_rows(steps), scene)
                                for scene in claims.LEVELS))
    assert (texts["pairing"], texts["paired"], texts["n_paired"]) == (expected, count, 14)


#: Contact time over that of type 1 by scene, type and level, as two pages had it at the same time.
PUBLISHED = (
    {"sliding": {1: (1.0, 1.0, 1.0), 3: (1.87, 1.52, 1.48), 4: (2.03, 1.95, 2.00), 5: (2.04, 1.80, 1.77),
                 6: (4.11, 3.83, 3.90)},
     "collision": {1: (1.0,) * 4, 3: (1.61, 1.46, 1.38, 1.31), 4: (1.70, 1.81, 1.86, 1.85),
                   5: (1.48, 1.43, 1.40, 1.36), 6: (2.00, 2.24, 2.21, 2.23)}},
    {"sliding": {1: (1.0, 1.0, 1.0), 3: (2.00, 1.41, 1.55), 4: (2.17, 2.01, 2.32), 5: (2.37, 1.76, 1.95),
                 6: (4.39, 3.74, 4.36)},
     "collision": {1: (1.0,) * 4, 3: (1.65, 1.49, 1.45, 1.45), 4: (1.76, 1.87, 1.80, 1.72),
                   5: (1.44, 1.41, 1.34, 1.37), 6: (2.24, 2.43, 2.45, 2.30)}})


@pytest.mark.parametrize("ratios", PUBLISHED)
def test_the_cheapest_remedy_is_the_same_by_both_publications(ratios):
    """They had type 5 as the cheapest in 2 and in 4 of 7 cases."""
    rows = [{"state": "finished", "scene": scene, "level": level, "type": ctype, "elements": 1.0,
             "element_calls": 1, "computing": 9.0, "contact": ratio, "search": ratio, "pairing": 0.0,
             "force": 1e-12, "load": 1.0}
            for scene, types in ratios.items() for ctype, column in (types | {2: types[1], 7: types[6]}).items()
            for level, ratio in enumerate(column, start=1)]
    texts = claims.time_texts(*(claims.Times(pd.DataFrame(rows), scene) for scene in claims.LEVELS))
    assert texts["cheap"] == "partly"
    assert re.fullmatch(r"1[.][12]. in the sliding \(type 3\), 0[.]9. in the collision \(type 3\)", texts["cheapest"])


@pytest.mark.parametrize("first, expected", [
    (([5], [5]), "yes"), (([5], [3, 5]), "partly"), (([3, 5], [4, 5]), "partly"), (([3], [4]), "no")])
def test_a_remedy_is_the_cheapest_alone_or_with_others(first, expected):
    assert claims.remedy_verdict(first) == expected


def peak_figures(count):
    figures = claims.PeakFigures.__new__(claims.PeakFigures)
    figures.count = figures.largest = figures.rms = figures.waviness = {
        level: dict(zip(ALL_TYPES, count)) for level in (1, 2, 3)}
    return figures


@pytest.mark.parametrize("count, fewest, larger, smooth", [
    ((9, 9, 9, 9, 1, 2, 0), "yes", "no", "no"),
    ((9, 9, 9, 9, 3, 2, 0), "partly", "no", "yes"),
    ((9, 9, 2, 4, 5, 1, 0), "no", "yes", "yes")])
def test_peak_claims_follow_the_figures(count, fewest, larger, smooth):
    texts = claims.peak_texts(peak_figures(count))
    assert (texts["fewest"], texts["larger"], texts["smooth"]) == (fewest, larger, smooth)


@pytest.mark.parametrize("nts, two_pass, expected", [
    ((0.1, 0.1), (-0.1, -0.1), "yes"), ((0.1, 0.1), (0.1, -0.1), "partly"),
    ((-0.1, 0.1), (0.1, 0.1), "no")])
def test_end_claim_follows_the_figures(nts, two_pass, expected):
    ends = dict.fromkeys(ALL_TYPES, (0.0, 0.0))
    ends.update({1: nts, 3: two_pass})
    assert claims.end_texts(ends)["end"] == expected


@pytest.mark.parametrize("above, expected", [(0, "yes"), (4, "partly"), (5, "no")])
def test_point_claim_follows_the_counts(above, expected):
    counts = np.array([(1, 1)] * above + [(6, 5)] * (100 - above))
    texts = claims.point_texts(counts, np.array([(4, 10), (3, 2)]))
    assert (texts["points"], texts["above"], texts["above_of"]) == (expected, above, above > 0)
    assert (texts["most"], texts["of"], texts["exchanged_above"]) == (5, 6, 1)


@pytest.mark.parametrize("scene", chooses.SCENES)
def test_ctype_0_is_judged_by_the_errors_of_the_page(scene):
    titles, errors = chooses.published(scene, ROOT / "doc")
    assert all(title == " ".join(title.split()) for title in titles)
    assert all(len(found) == len(titles) and min(found) > 0.0 for found in errors.values())


def test_an_error_below_that_of_its_reference_counts_as_that():
    page = ("| Collision: rebound | 7 | N_r = 2, 4, 6 | 0.50 | 2.4 % | 11 % |\n"
            "| Collision: rebound | 7h | N_r = 2, 4, 6 | 0.50 | 1.9 % | 11 % |\n")
    assert chooses.known_error(page, "Collision: rebound", "(0.0026)") == 2.4
    assert chooses.known_error(page, "Collision: rebound", "3.1") == 3.1
