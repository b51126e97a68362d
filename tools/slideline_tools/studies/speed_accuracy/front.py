# SPDX-License-Identifier: MIT
"""Points of cost and error, the Pareto front, and what is read from them."""
import dataclasses

import numpy as np

from slideline_tools.contact_types import in_order
from slideline_tools.studies.framework.rules import RUN_FACTOR
from slideline_tools.studies.framework.table import FINISHED, records
from slideline_tools.studies.framework.times import Times
from slideline_tools.studies.speed_accuracy.scenes import SCENES

COSTS = {"contact": "contact time", "computing": "computing time"}
GAIN, TIE = 0.05, RUN_FACTOR - 1.0  # smaller differences of errors and of times tell nothing


@dataclasses.dataclass(frozen=True)
class Point:
    """One type, or PUNIT 4 (a text), on one mesh of a scene.

    `cost`   {"contact", "computing"}: seconds for the whole run
    `error`  by measure; `floor` what the exact answer or the reference is itself known to
    `moment` net moment of the contact forces at the end, over force times slave segment; nan where
             nothing touches
    """

    type: object
    level: int
    cost: dict
    error: dict
    floor: dict
    moment: float = float("nan")

    @property
    def name(self):
        """Type / N_r."""
        return f"{self.type}/{self.level}"

    def judged(self, key):
        """The error, or what can not be told from it."""
        return max(self.error[key], self.floor[key])

    def resolved(self, key):
        """Whether the error is larger than that of the exact answer or the reference."""
        return self.error[key] > self.floor[key]


def pareto(pairs, gain=0.0, tie=0.0):
    """Indices of the (cost, error) pairs that no other one beats in both, by rising cost.

    An error is better if it is smaller by more than the share `gain`; a cost is no worse if it is
    larger by no more than the share `tie`. Of errors that are no better the cheapest stays.
    """
    def beaten(pair):
        return any(cost <= pair[0] * (1.0 + tie) and error < pair[1] * (1.0 - gain)
                   for cost, error in pairs)

    chosen, best = [], np.inf
    for index in sorted(range(len(pairs)), key=lambda k: pairs[k]):
        if pairs[index][1] < best * (1.0 - gain) and not beaten(pairs[index]):
            chosen.append(index)
            best = pairs[index][1]
    return chosen


def front(points, cost, key):
    """The points of the Pareto front of a cost and a measure, by rising cost."""
    points = [point for point in points if key in point.error]
    return [points[k] for k in pareto([(point.cost[cost], point.judged(key))
                                       for point in points], GAIN, TIE)]


def meeting(points, key, target):
    """The points whose error is at most `target`."""
    return [point for point in points if key in point.error and point.judged(key) <= target]


def cheapest(points, cost, key, target):
    """The cheapest point whose error is at most `target`; None if there is none."""
    return min(meeting(points, key, target), key=lambda point: point.cost[cost], default=None)


def swept_rows(rows):
    """The finished runs that were timed."""
    return rows[(rows["state"] == FINISHED) & (rows["role"] == "sweep")]


def times_of(rows):
    """{scene: Times} of the scenes with finished runs."""
    rows = swept_rows(rows)
    there = set(rows["scene"])
    return {name: Times(rows, name) for name in SCENES if name in there}


def points_of(rows, times):
    """{scene: [Point]} by type and level; `times` as from times_of."""
    points = {}
    for name, found in times.items():
        first = {}
        for row in records(swept_rows(rows)):
            if row["scene"] == name:
                first.setdefault(row["type"], {}).setdefault(row["level"], row)
        points[name] = [make_point(SCENES[name], row, found) for ctype in in_order(first)
                        for _, row in sorted(first[ctype].items())]
    return points


def make_point(scene, row, times):
    """The point of one variant; `row`: one of its runs (all give the same errors)."""
    seconds = times.seconds[row["level"]][row["type"]]
    there = [measure for measure in scene.measures if measure.key in row]
    return Point(row["type"], row["level"], {cost: seconds[cost] for cost in COSTS},
                 {measure.key: row[measure.key] for measure in there},
                 {measure.key: row.get(f"{measure.key}_floor", measure.known)
                  for measure in there}, row.get("moment", float("nan")))


def geometric_mean(values):
    """Geometric mean; nan of nothing."""
    values = list(values)
    return float(np.exp(np.mean(np.log(values)))) if values else float("nan")


def ratios(points, ctype, value, base=1):
    """value(point of the type) over value(point of type `base`) on each mesh that has both."""
    first = {point.level: value(point) for point in points if point.type == base}
    return [value(point) / first[point.level] for point in points
            if point.type == ctype and point.level in first]
