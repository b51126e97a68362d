# SPDX-License-Identifier: MIT
"""Medians over the runs of the study simplify, and how its figures are printed."""
import numpy as np

from slideline_tools.studies.framework.table import counted, finished, records
from slideline_tools.studies.framework.times import quartile_distance


class Runs:
    """The finished runs by variant and level.

    `rounds`: fewest timed runs of a variant; `spread`: median over variants of the distance of the
    quartiles of their processor times; `load`: median of the load of the machine.
    """

    def __init__(self, rows):
        done = records(finished(rows))
        self.groups = {}
        for row in done:
            self.groups.setdefault((row["variant"], row["level"]), []).append(row)
        self.counts = {(row["variant"], row["level"]): row["instructions"] for row in records(counted(rows))}
        self.levels = sorted({row["level"] for row in done})
        timed = [group for group in self.groups.values() if len(group) > 1]
        self.rounds = min((len(group) for group in timed), default=1)
        self.spread = float(np.median([quartile_distance([row["processor_seconds"] for row in group])
                                       for group in timed])) if timed else float("nan")
        self.load = float(np.median([row.get("load", np.nan) for row in done] or [np.nan]))

    def has(self, name, level):
        return (name, level) in self.groups

    def instructions_saved(self, more, less, level):
        """Per cent of the retired instructions that the run with less saves; '' where they were not counted."""
        pair = [self.counts.get((name, level)) for name in (more, less)]
        return "" if None in pair else f"{100.0 * (1.0 - pair[1] / pair[0]):.1f} %"

    def first(self, name, level):
        """The row of the first run, which has what was compared; {} if there is none."""
        return self.groups.get((name, level), [{}])[0]

    def seconds(self, name, level, phase=None):
        """Median processor time, of a phase by its share of the clock over all repeats, s.

        Contact: no more than the clock has ever shown, which is better for a short phase.
        """
        group = self.groups[name, level]
        whole = float(np.median([row["processor_seconds"] for row in group]))
        if phase is None:
            return whole
        total = sum(row["total"] for row in group)
        shown = [self.clock(row, phase) for row in group]
        share = whole * sum(shown) / total
        return min(share, *shown) if phase == "contact" else share

    @staticmethod
    def clock(row, phase):
        """Seconds of a phase on the clock."""
        if phase == "output":
            return row["total"] - row["computing"] - row["input"]
        return row[phase]


def duration(seconds):
    """A time in s or ms."""
    return f"{seconds:.3g} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def megabytes(count):
    """Bytes in MB with three digits."""
    return f"{1e-6 * count:.3g}"


def percent(share):
    """A share in per cent."""
    return f"{100.0 * share:.0f} %"


def small_share(share):
    """A difference: 0, per cent, or a power of ten; nothing for None."""
    if share is None:
        return ""
    if share == 0.0:
        return "the same"
    return f"{100.0 * share:.2g} %" if share >= 1.0e-4 else f"{share:.0e}"
