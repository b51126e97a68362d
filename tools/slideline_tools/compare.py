# SPDX-License-Identifier: MIT
"""Compare a history table with a reference, column by column and entity by entity.

Each column is judged by five measures (see MEASURES), counts without the impulse. The allowed difference of a value is
`atol + rtol |reference|`; `atol` is `floor` times the column's maximum in the reference unless
it is given. Series are compared on the times of the reference, the result being interpolated.
"""
import dataclasses

import numpy as np

from slideline_tools import UserError

from slideline_tools.histories import ENTITY_COLUMNS, INTEGER_COLUMNS, TEXT_COLUMNS

MEASURES = ("values", "peak", "time of peak", "impulse", "final")
COVERAGE = ("start", "end")  # first and last time: always judged
WITHOUT_IMPULSE = INTEGER_COLUMNS + ("state",)  # counts and codes: an integral over time says nothing


class Unusable(UserError):
    """Tables that cannot be compared: columns or entities missing, no rows, not a number."""


@dataclasses.dataclass(frozen=True)
class Tolerance:
    """What may differ.

    `rtol` relative to the reference; `floor` as a fraction of the column's largest reference
    value; `atol` absolute, instead of the floor; `time` for the time of the peak, as a fraction
    of the time span; `measures` those that are judged.
    """

    rtol: float = 1.0e-3
    floor: float = 1.0e-3
    atol: float = None
    time: float = 1.0e-2
    measures: tuple = MEASURES

    def absolute(self, largest):
        """The absolute part for a column whose largest reference value is given."""
        return self.floor * largest if self.atol is None else self.atol


@dataclasses.dataclass(frozen=True)
class Check:
    """One judged number: passed if |difference| <= allowed."""

    column: str
    measure: str
    entity: str
    result: float
    reference: float
    difference: float
    allowed: float

    @property
    def passed(self):
        return self.difference <= self.allowed

    @property
    def ratio(self):
        """Difference over what is allowed: above 1 means failed."""
        if self.difference == 0.0:
            return 0.0
        return self.difference / self.allowed if self.allowed > 0.0 else np.inf


class Report:
    """All checks of one comparison."""

    def __init__(self, name, checks):
        self.name = name
        self.checks = checks

    @property
    def passed(self):
        return bool(self.checks) and all(check.passed for check in self.checks)

    def worst(self):
        """The worst check of each column and measure over all entities, in order."""
        worst = {}
        for check in self.checks:
            key = (check.column, check.measure)
            if key not in worst or check.ratio > worst[key].ratio:
                worst[key] = check
        return list(worst.values())

    def text(self):
        """A table for people: what was compared, what failed and by how much."""
        head = (f"{'column':<16}{'measure':<13}{'where':<22}{'result':>14}{'reference':>14}"
                f"{'difference':>12}{'allowed':>12}{'ratio':>9}")
        lines = [self.name, head, "-" * len(head)]
        for check in self.worst():
            verdict = "" if check.passed else "  FAILED"
            lines.append(f"{check.column:<16}{check.measure:<13}{check.entity:<22}"
                         f"{check.result:>14.6g}{check.reference:>14.6g}"
                         f"{check.difference:>12.3g}{check.allowed:>12.3g}"
                         f"{check.ratio:>9.2g}{verdict}")
        failed = sorted({check.column for check in self.checks if not check.passed})
        if failed:
            lines.append(f"failed: {', '.join(failed)}")
        elif self.checks:
            lines.append(f"passed: {len(self.checks)} checks")
        else:
            lines.append("failed: nothing was compared")
        return "\n".join(lines)


def compare(result, reference, columns=None, tolerances=None, default=Tolerance()):
    """Report on two History tables; raises Unusable if they cannot be compared.

    `columns`: those to judge (default: all value columns of the reference);
    `tolerances`: dict of Tolerance by column, for the others `default` holds.
    """
    columns = list(columns or reference.value_columns)
    require_usable(result, "result", columns)
    require_usable(reference, "reference", columns)
    if result.entity_columns != reference.entity_columns:
        raise Unusable(f"the tables tell their series apart by {result.entity_columns} "
                       f"and {reference.entity_columns}")
    ours, theirs = dict(result.series()), dict(reference.series())
    if set(ours) != set(theirs):
        odd = sorted(map(str, set(ours) ^ set(theirs)))
        raise Unusable(f"only one of the tables has {reference.entity_columns} {', '.join(odd)}")
    checks = []
    for column in columns:
        tolerance = (tolerances or {}).get(column, default)
        atol = tolerance.absolute(float(np.max(np.abs(reference[column]))))
        for entity, rows in theirs.items():
            label = reference.entity_label(entity)
            checks += series_checks(column, label, ours[entity], rows, tolerance, atol)
    return Report(reference.name, checks)


def require_usable(table, role, columns):
    """Refuse a table without rows, time, a wanted column, or with a value that is no number."""
    if not len(table):
        raise Unusable(f"the {role} has no rows")
    missing = [name for name in ["time"] + columns if name not in table]
    if missing:
        raise Unusable(f"the {role} lacks the column {', '.join(missing)}")
    for name, values in table.columns.items():
        if name in TEXT_COLUMNS:
            continue
        broken = np.flatnonzero(~np.isfinite(values.astype(float)))
        if broken.size:
            raise Unusable(f"the {role} holds {values[broken[0]]} in column {name}, "
                           f"row {broken[0] + 1}")
    for entity, rows in table.series():
        if np.any(np.diff(rows["time"]) < 0.0):
            raise Unusable(f"the {role} runs back in time {table.entity_label(entity)}")


def series_checks(column, entity, result, reference, tolerance, atol):
    """The checks of one column of one entity."""
    t, y = unique_times(result["time"], result[column])
    t_ref, y_ref = unique_times(reference["time"], reference[column])
    if t[-1] < t_ref[0] or t[0] > t_ref[-1]:
        raise Unusable(f"no common time: result {t[0]:g} to {t[-1]:g}, "
                       f"reference {t_ref[0]:g} to {t_ref[-1]:g}")
    span = t_ref[-1] - t_ref[0]
    spare = max(np.max(np.diff(t_ref), initial=0.0), 1.0e-9 * abs(t_ref[-1]))
    checks = []

    def judge(measure, value, expected, difference, allowed):
        if measure in tolerance.measures or measure in COVERAGE:
            checks.append(Check(column, measure, entity, float(value), float(expected),
                                float(abs(difference)), float(allowed)))

    judge("start", t[0], t_ref[0], t[0] - t_ref[0], spare)
    judge("end", t[-1], t_ref[-1], t[-1] - t_ref[-1], spare)
    common = t_ref[(t_ref >= t[0]) & (t_ref <= t[-1])]
    common = common if common.size else t_ref
    ours, theirs = np.interp(common, t, y), np.interp(common, t_ref, y_ref)
    allowed = atol + tolerance.rtol * np.abs(theirs)
    at = worst_index(np.abs(ours - theirs), allowed)
    judge("values", ours[at], theirs[at], ours[at] - theirs[at], allowed[at])
    judge_peak(judge, (t, y), (t_ref, y_ref), tolerance, atol, span)
    if column not in WITHOUT_IMPULSE:
        impulse, expected = time_integral(t, y), time_integral(t_ref, y_ref)
        judge("impulse", impulse, expected, impulse - expected,
              tolerance.rtol * abs(expected) + atol * span)
    judge("final", y[-1], y_ref[-1], y[-1] - y_ref[-1], atol + tolerance.rtol * abs(y_ref[-1]))
    return checks


def judge_peak(judge, result, reference, tolerance, atol, span):
    """Height and time of the largest magnitude.

    Of several nearly equal peaks another one may come out highest: the time also counts as met
    if the result is as high as allowed within the allowed time about the peak of the reference.
    """
    (t, y), (t_ref, y_ref) = result, reference
    at, at_ref = np.argmax(np.abs(y)), np.argmax(np.abs(y_ref))
    allowed = atol + tolerance.rtol * abs(y_ref[at_ref])
    judge("peak", y[at], y_ref[at_ref], y[at] - y_ref[at_ref], allowed)
    slack = tolerance.time * span
    near = (np.abs(t - t_ref[at_ref]) <= slack) & (np.abs(y - y_ref[at_ref]) <= allowed)
    late = 0.0 if near.any() else t[at] - t_ref[at_ref]
    judge("time of peak", t[at], t_ref[at_ref], late, slack)


def time_integral(time, values):
    """Integral over time by the trapezoidal rule."""
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))


def worst_index(difference, allowed):
    """Where the difference is largest in relation to what is allowed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(difference == 0.0, 0.0, difference / allowed)
    return int(np.argmax(ratio))


def unique_times(time, values):
    """The last row of each time (a table may hold one time twice)."""
    keep = np.append(np.diff(time) > 0.0, True)
    return time[keep], values[keep]


def judged_columns(table, names):
    """Check column names asked for by a user."""
    unknown = [name for name in names
               if name in ENTITY_COLUMNS + TEXT_COLUMNS + ("time",) or name not in table]
    if unknown:
        raise Unusable(f"not a value column of {table.name}: {', '.join(unknown)}")
    return list(names)
