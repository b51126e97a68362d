# SPDX-License-Identifier: MIT
"""Contact time by steps A (search), M (pairing) and B (force), from timing tables of several runs.

On a machine that others use too, a run may be slow as a whole. Times are therefore corrected by
the pace of the element loop of the same run, which is the same work for all types: they are the
seconds that the run would have taken had its element loop run at the median pace.
"""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.studies.framework.table import finished, grouped

STEPS = ("search", "pairing", "force")
LETTERS = {"search": "A search", "pairing": "M pairing", "force": "B force"}


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


def pace(row):
    """Seconds of one pass over the elements."""
    return row["elements"] / row["element_calls"]


class Times:
    """Medians of one scene: `seconds[level][type]` = {column: median of the corrected seconds};
    "contact" is the sum of the medians of the steps.

    `points[level][type]`: contact points under pressure at most, '' where the rows do not tell.
    `steps[level]`: time steps (explicit runs). `rounds`: fewest runs of a variant; `spread`: largest distance of the quartiles of the contact
    time over its median; `pace_spread`: the same of the uncorrected pace; `load`:
    median of the load of the machine.
    """

    COLUMNS = (*STEPS, "contact", "computing")

    def __init__(self, rows, scene):
        """`rows` with the columns scene, level, type and those of `phases`."""
        rows = [row for row in finished(rows) if row["scene"] == scene]
        if not rows:
            raise UserError(f"no timing runs of the scene {scene}")
        self.scene, self.seconds, self.steps, self.points = scene, {}, {}, {}
        spreads, paces, counts = [], [], []
        for (level,), same_level in grouped(rows, "level").items():
            usual = np.median([pace(row) for row in same_level])
            self.seconds[level], self.steps[level] = {}, same_level[0]["element_calls"] - 1
            self.points[level] = {row["type"]: row.get("points", "") for row in same_level}
            for (ctype,), runs in sorted(grouped(same_level, "type").items()):
                factors = np.array([usual / pace(run) for run in runs])
                values = {name: factors * [run[name] for run in runs] for name in self.COLUMNS}
                middle = {name: float(np.median(column)) for name, column in values.items()}
                # So that the steps add up to what is printed as their sum.
                middle["contact"] = sum(middle[step] for step in STEPS)
                self.seconds[level][ctype] = middle
                spreads.append(quartile_distance(values["contact"]))
                paces.append(quartile_distance(1.0 / factors))
                counts.append(len(runs))
        self.load = float(np.median([row.get("load", np.nan) for row in rows]))
        self.rounds, self.spread, self.pace_spread = min(counts), max(spreads), max(paces)

    @property
    def levels(self):
        return list(self.seconds)

    def has(self, level, ctype):
        """Whether there is a finished run of this variant and of type 1 to compare it with."""
        return {1, ctype} <= set(self.seconds.get(level, {}))

    def ratio(self, level, ctype, name="contact"):
        """Time of a type over the whole contact time of type 1."""
        return self.seconds[level][ctype][name] / self.seconds[level][1]["contact"]

    def computing_ratio(self, level, ctype):
        """Time of the whole computation of a type over that of type 1."""
        return self.seconds[level][ctype]["computing"] / self.seconds[level][1]["computing"]

    def share(self, level, ctype):
        """Contact time over the time of computing."""
        return self.seconds[level][ctype]["contact"] / self.seconds[level][ctype]["computing"]


def quartile_distance(values):
    """Distance of the quartiles over the median."""
    low, middle, high = np.percentile(values, (25, 50, 75))
    return float((high - low) / middle)
