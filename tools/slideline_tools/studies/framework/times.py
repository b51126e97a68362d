# SPDX-License-Identifier: MIT
"""Contact time by steps A (search), M (pairing) and B (force), from timing tables of several runs.

On a machine that others use too, a run may be slow as a whole. Times are therefore corrected by
the pace of the element loop of the same run, which is the same work for all types: they are the
seconds that the run would have taken had its element loop run at the median pace.
"""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.studies.framework.table import finished

STEPS = ("search", "pairing", "force")
LETTERS = {"search": "A search", "pairing": "M pairing", "force": "B force"}
VARIANT = ["scene", "level", "type"]


def phases(path):
    """Columns of a row from <job>.timing.csv: seconds by phase, of contact as a whole, and of
    computing (the total without input and output)."""
    table = read_csv(path)
    seconds = dict(zip(table["phase"].tolist(), table["seconds"].tolist()))
    calls = dict(zip(table["phase"].tolist(), table["calls"].tolist()))
    try:
        row = {step: seconds[f"contact_{step}"] for step in STEPS}
        row["contact"] = sum(row.values())
        row.update({name: seconds[name] for name in ("elements", "nodes", "solver", "total")})
        row["computing"] = row["total"] - seconds["input"] - seconds["output"]
        row["element_calls"] = int(calls["elements"])
    except KeyError as missing:
        raise UserError(f"{path}: no phase {missing}") from None
    return row


def contact_times(table):
    """Medians of the finished runs, a row for each (scene, level, type) in order of appearance.

    Columns: the corrected seconds of the `STEPS`, of `contact` (their sum) and of `computing`; `rounds`, how many runs;
    `spread`, the distance of the quartiles of the contact time over its median; `steps`, time steps of an explicit run.
    """
    runs = finished(table)
    pace = runs["elements"] / runs["element_calls"]
    correction = pace.groupby([runs["scene"], runs["level"]]).transform("median") / pace
    corrected = runs[[*STEPS, "contact", "computing"]].mul(correction, axis=0)
    groups = corrected.groupby([runs[name] for name in VARIANT], sort=False)
    times = groups.median()
    # So that the steps add up to what is printed as their sum.
    times["contact"] = times[list(STEPS)].sum(axis=1)
    times["rounds"] = groups.size()
    times["spread"] = groups["contact"].agg(quartile_distance)
    times["steps"] = runs.groupby(VARIANT, sort=False)["element_calls"].first().astype(int) - 1
    return times


def over_type_1(times, column="contact", base="contact"):
    """A column of `contact_times` over what type 1 takes of `base` in the same scene and level; nan where that has not run."""
    is_type_1 = times.index.get_level_values("type") == 1
    return times[column] / times[base].where(is_type_1).groupby(level=["scene", "level"]).transform("max")


def quartile_distance(values):
    """Distance of the quartiles over the median."""
    low, middle, high = np.percentile(values, (25, 50, 75))
    return float((high - low) / middle)
