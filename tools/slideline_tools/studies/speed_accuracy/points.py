# SPDX-License-Identifier: MIT
"""Cost and error of every type on every mesh, and what is compared of them."""
import numpy as np
import pandas as pd

from slideline_tools.contact_types import SERIES
from slideline_tools.studies.framework.rules import RUN_FACTOR
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import VARIANT, contact_times
from slideline_tools.studies.speed_accuracy.scenes import SCENES

COSTS = {"contact": "contact time", "computing": "computing time"}
GAIN, TIE = 0.05, RUN_FACTOR - 1.0  # smaller differences of errors and of times tell nothing


def points_of(table):
    """A row for each (scene, level, type) that was timed: seconds of `contact` and `computing`,
    with the measures of its first run (all runs of a variant give the same)."""
    swept = finished(table)
    swept = swept[swept["role"] == "sweep"]
    first = swept.drop_duplicates(VARIANT).drop(columns=list(COSTS))
    points = contact_times(swept)[[*COSTS, "spread", "rounds"]].merge(first, on=VARIANT)
    points["type"] = pd.Categorical(points["type"], list(SERIES), ordered=True)
    return points.sort_values(["type", "level"])


def errors_of(points):
    """A row for each point and measure: `error`, `floor` (what the exact answer or the reference is
    known to), `judged`, the larger of them, and whether the error is `resolved`."""
    found = []
    for name, scene in SCENES.items():
        mine = points[points["scene"] == name]
        for measure in scene.measures:
            if measure.key in mine and mine[measure.key].notna().any():
                floor = mine.get(f"{measure.key}_floor", measure.known)
                found.append(mine[[*VARIANT, *COSTS]].assign(
                    measure=measure.key, error=mine[measure.key], floor=floor))
    errors = pd.concat(found, ignore_index=True).dropna(subset="error").fillna({"floor": 0.0})
    errors["judged"] = errors[["error", "floor"]].max(axis=1)
    errors["resolved"] = errors["error"] > errors["floor"]
    return errors


def named(points):
    """Type/N_r of each row."""
    return points["type"].astype(str) + "/" + points["level"].astype(str)


def over(rows, column, base=1):
    """A column over that of the series `base` on the same mesh, in the same measure."""
    same = [rows[name] for name in ("scene", "level", "measure") if name in rows]
    of_base = rows[column].where(rows["type"] == base)
    return rows[column] / of_base.groupby(same).transform("max")


def geometric(values, by):
    """Geometric means of values by some columns."""
    return np.exp(np.log(values.dropna()).groupby(by, observed=True).mean())


def front(errors, cost):
    """The rows of one scene and measure that no other beats in cost and error, by rising cost.

    An error is better if it is smaller by more than the share GAIN; a cost is no worse if it is
    larger by no more than the share TIE. Of errors that are no better the cheapest stays.
    """
    ordered, best, chosen = errors.sort_values([cost, "judged"]), np.inf, []
    for row in ordered.itertuples():
        at_no_more = ordered[ordered[cost] <= getattr(row, cost) * (1.0 + TIE)]
        limit = row.judged * (1.0 - GAIN)
        if row.judged < best * (1.0 - GAIN) and not (at_no_more["judged"] < limit).any():
            chosen.append(row.Index)
            best = row.judged
    return ordered.loc[chosen]
