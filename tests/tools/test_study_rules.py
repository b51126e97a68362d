# SPDX-License-Identifier: MIT
"""The rules by which studies compare types: they name the same ones when the runs are repeated."""
import numpy as np
import pytest

from slideline_tools.studies.framework import rules
from slideline_tools.studies.speed_accuracy import advice, front as fronts

#: Contact times, s, by scene, type and mesh, as published in November 2026 (EPYC, medians of 3).
PUBLISHED = {
    "patch": {1: [0.0017, 0.0043, 0.0098], 4: [0.004, 0.01, 0.028], 5: [0.0058, 0.017, 0.023],
              7: [0.0094, 0.031, 0.039]},
    "block": {1: [0.0023, 0.0041, 0.0078], 4: [0.0094, 0.017, 0.033], 5: [0.0068, 0.012, 0.024],
              7: [0.011, 0.021, 0.043]},
    "hertz": {1: [0.0026, 0.0092, 0.033], 4: [0.0062, 0.018, 0.094], 5: [0.011, 0.022, 0.099],
              7: [0.027, 0.032, 0.13]},
    "sliding": {1: [0.074, 0.25, 0.67], 4: [0.15, 0.5, 1.4], 5: [0.17, 0.49, 1.3], 7: [0.26, 0.78, 1.9]},
    "collision": {1: [0.0028, 0.009, 0.018, 0.031], 4: [0.0059, 0.016, 0.035, 0.06],
                  5: [0.0042, 0.013, 0.025, 0.045], 7: [0.0046, 0.014, 0.028, 0.05]},
}
QUARTILES = 0.18  # largest distance of the quartiles of a contact time over its median, there
SIGMA = QUARTILES / (2.0 * 0.6745)
#: Means over the scenes of four publications, from programs with as many kinds of contact kernels.
REPEATS = ({4: 2.49, 5: 2.45, 7: 3.72}, {4: 2.28, 5: 2.20, 7: 3.54}, {4: 2.35, 5: 2.11, 7: 3.44},
           {4: 2.56, 5: 2.19, 7: 4.02})


def overview(noise):
    """All published points, each time multiplied by exp(SIGMA noise()); types 4, 5, 7 exact."""
    points = {}
    for scene, types in PUBLISHED.items():
        points[scene] = []
        for ctype, times in types.items():
            for level, seconds in enumerate(times, start=1):
                seconds *= float(np.exp(SIGMA * noise()))
                error = 1e-12 if ctype > 1 else 0.1
                points[scene].append(fronts.Point(
                    ctype, level, {"contact": seconds, "computing": 1.0},
                    {"pressure_error": error}, {"pressure_error": 1e-9}))
    return advice.Overview(points)


def test_least_names_all_that_are_alike():
    assert rules.least({}, 1.2) == []
    assert rules.least({4: 1.0}, 1.2) == [4]
    assert rules.least({4: 1.19, 5: 1.0, 7: 1.21}, 1.2) == [4, 5]


@pytest.mark.parametrize("types, expected", [
    ((), "no type"), ((4,), "type 4"), ((4, 5), "types 4 and 5"), ((4, 5, 7), "types 4, 5 and 7")])
def test_names(types, expected):
    assert rules.names(types) == expected


def test_words():
    assert rules.numbers((4, 5), "or") == "4 or 5"
    assert rules.between([1.0, 2.0]) == "1.00 to 2.00" and rules.between([1.001, 1.0]) == "1.00"
    assert [rules.share_verdict(answers) for answers in ([True, True], [True, False], [False])] \
        == ["yes", "partly", "no"]


@pytest.mark.parametrize("costs", REPEATS)
def test_four_publications_lead_to_one_conclusion(costs):
    assert rules.least(costs, rules.COST_FACTOR) == [4, 5]


def test_the_recommendation_stands_when_runs_are_repeated():
    """400 repeats with the scatter of the published times.  The type of the least mean, which was
    recommended before, changes with them."""
    numbers = np.random.default_rng(7)
    cheapest = set()
    for _ in range(400):
        over = overview(numbers.standard_normal)
        assert advice.chosen_types(over) == [4, 5]
        assert "In general type 4 or 5" in advice.general_advice(over)[1]
        cheapest.add(min((4, 5, 7), key=lambda ctype: over.cost(ctype, "contact")))  # pylint: disable=cell-var-from-loop
    assert cheapest == {4, 5}


def test_a_clear_difference_is_told():
    """The rule does not call everything alike: half the cost of type 5 makes it the only one."""
    over = overview(lambda: 0.0)
    for points in over.points.values():
        for point in points:
            if point.type == 5:
                point.cost["contact"] *= 0.5
    assert advice.chosen_types(over) == [5]
