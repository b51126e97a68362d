# SPDX-License-Identifier: MIT
"""Compare a history table with a reference, column by column and entity by entity.

Each column is judged by five measures (see MEASURES), counts without the impulse. The allowed
difference of a value is `atol + rtol |reference|`; unless `atol` is given it is `floor` times the largest value of the
column in the reference, or of all components of its vector or tensor (`fx` and `fy`; `sxx` to `sxy`). Series are compared on the times of the reference, the result being interpolated.
"""
import dataclasses
import re
import typing

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import ENTITY_COLUMNS, INTEGER_COLUMNS, TEXT_COLUMNS, trapezoid

MEASURES = ("values", "peak", "time of peak", "impulse", "final")
COVERAGE = ("start", "end")  # first and last time: always judged
#: counts and codes: an integral over time says nothing
WITHOUT_IMPULSE = INTEGER_COLUMNS + ("state",)
#: what names a component: `fx`, `momentum_y`, `sxy`
COMPONENT = re.compile(r"([xyz]{2}|[xyz])$")


@dataclasses.dataclass(frozen=True)
class Tolerance:
    """What may differ.

    `rtol` relative to the reference; `floor` as a fraction of the largest reference value of the
    column and its other components; `atol` absolute, instead of the floor; `time` for the time of the peak, as a fraction
    of the time span; `measures` those that are judged.
    """

    rtol: float = 1.0e-3
    floor: float = 1.0e-3
    atol: float | None = None
    time: float = 1.0e-2
    measures: tuple = MEASURES

    def absolute(self, largest):
        """The absolute part for a quantity whose largest reference value is given."""
        return self.floor * largest if self.atol is None else self.atol


class Check(typing.NamedTuple):
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
        with np.errstate(divide="ignore"):
            return float(np.divide(self.difference, self.allowed)) if self.difference else 0.0


@dataclasses.dataclass
class Report:
    """All checks of one comparison."""

    name: str
    checks: list

    @property
    def passed(self):
        return bool(self.checks) and all(check.passed for check in self.checks)

    def worst(self):
        """The worst check of each column and measure over all entities, in order."""
        worst = {}
        for check in self.checks:
            known = worst.setdefault((check.column, check.measure), check)
            if check.ratio > known.ratio:
                worst[check.column, check.measure] = check
        return list(worst.values())

    def text(self):
        """A table for people: what was compared, what failed and by how much."""
        head = (f"{'column':<16}{'measure':<13}{'where':<22}{'result':>14}{'reference':>14}"
                f"{'difference':>12}{'allowed':>12}{'ratio':>9}")
        lines = [self.name, head, "-" * len(head)]
        lines += [f"{one.column:<16}{one.measure:<13}{one.entity:<22}{one.result:>14.6g}"
                  f"{one.reference:>14.6g}{one.difference:>12.3g}{one.allowed:>12.3g}"
                  f"{one.ratio:>9.2g}" + ("" if one.passed else "  FAILED")
                  for one in self.worst()]
        failed = sorted({check.column for check in self.checks if not check.passed})
        if failed or not self.checks:
            return "\n".join([*lines, f"failed: {', '.join(failed) or 'nothing was compared'}"])
        return "\n".join([*lines, f"passed: {len(self.checks)} checks"])


def compare(result, reference, columns=None, tolerances=None, default=Tolerance()):
    """Report on two History tables; raises UserError if they cannot be compared: columns or entities missing, no rows, not a number.

    `columns`: those to judge (default: all value columns of the reference);
    `tolerances`: dict of Tolerance by column, for the others `default` holds.
    """
    columns = list(columns or reference.value_columns)
    require_usable(result, "result", columns)
    require_usable(reference, "reference", columns)
    if result.entity_columns != reference.entity_columns:
        raise UserError(f"the tables tell their series apart by {result.entity_columns} "
                       f"and {reference.entity_columns}")
    ours, theirs = dict(result.series()), dict(reference.series())
    if set(ours) != set(theirs):
        odd = sorted(map(str, set(ours) ^ set(theirs)))
        raise UserError(f"only one of the tables has {reference.entity_columns} {', '.join(odd)}")
    checks = []
    for column in columns:
        tolerance = (tolerances or {}).get(column, default)
        atol = tolerance.absolute(max(float(np.max(np.abs(reference[name]))) for name in components(column, reference)))
        for entity, rows in theirs.items():
            label = reference.entity_label(entity)
            checks += series_checks(column, label, ours[entity], rows, tolerance, atol)
    return Report(reference.name, checks)


def components(column, table):
    """The columns of the vector or tensor that a column is a component of, or the column alone."""
    stem = COMPONENT.sub("", column)
    return [name for name in table.value_columns if name == column or COMPONENT.sub("", name) == stem != column]


def require_usable(table, role, columns):
    """Refuse a table without rows, time, a wanted column, or with a value that is no number."""
    if not len(table):
        raise UserError(f"the {role} has no rows")
    missing = [name for name in ["time"] + columns if name not in table]
    if missing:
        raise UserError(f"the {role} lacks the column {', '.join(missing)}")
    for name, values in table.columns.items():
        if name in TEXT_COLUMNS:
            continue
        broken = np.flatnonzero(~np.isfinite(values.astype(float)))
        if broken.size:
            raise UserError(f"the {role} holds {values[broken[0]]} in column {name}, "
                           f"row {broken[0] + 1}")
    for entity, rows in table.series():
        if np.any(np.diff(rows["time"]) < 0.0):
            raise UserError(f"the {role} runs back in time {table.entity_label(entity)}")


def series_checks(column, entity, result, reference, tolerance, atol):
    """The checks of one column of one entity.

    Of several nearly equal peaks another one may come out highest: the time of the peak also
    counts as met if the result is as high as allowed within the allowed time about the peak of
    the reference.
    """
    t, y = unique_times(result["time"], result[column])
    t_ref, y_ref = unique_times(reference["time"], reference[column])
    if t[-1] < t_ref[0] or t[0] > t_ref[-1]:
        raise UserError(f"no common time: result {t[0]:g} to {t[-1]:g}, "
                       f"reference {t_ref[0]:g} to {t_ref[-1]:g}")
    span = t_ref[-1] - t_ref[0]
    spare = max(np.max(np.diff(t_ref), initial=0.0), 1.0e-9 * abs(t_ref[-1]))
    inside = (t_ref >= t[0]) & (t_ref <= t[-1])
    common = t_ref[inside] if inside.any() else t_ref
    ours, theirs = np.interp(common, t, y), np.interp(common, t_ref, y_ref)
    allowed = atol + tolerance.rtol * np.abs(theirs)
    with np.errstate(divide="ignore", invalid="ignore"):
        worst = int(np.argmax(np.nan_to_num(np.abs(ours - theirs) / allowed)))
    top, top_ref = np.argmax(np.abs(y)), np.argmax(np.abs(y_ref))
    slack, peak_allowed = tolerance.time * span, atol + tolerance.rtol * abs(y_ref[top_ref])
    near = np.abs(t - t_ref[top_ref]) <= slack
    is_met = np.any(near & (np.abs(y - y_ref[top_ref]) <= peak_allowed))
    found = [("start", t[0], t_ref[0], spare), ("end", t[-1], t_ref[-1], spare),
             ("values", ours[worst], theirs[worst], allowed[worst]),
             ("peak", y[top], y_ref[top_ref], peak_allowed),
             ("time of peak", t_ref[top_ref] if is_met else t[top], t_ref[top_ref], slack)]
    if column not in WITHOUT_IMPULSE:
        impulse, expected = trapezoid(y, t), trapezoid(y_ref, t_ref)
        found.append(("impulse", impulse, expected, tolerance.rtol * abs(expected) + atol * span))
    found.append(("final", y[-1], y_ref[-1], atol + tolerance.rtol * abs(y_ref[-1])))
    return [Check(column, measure, entity, float(value), float(expected),
                  float(abs(value - expected)), float(limit))
            for measure, value, expected, limit in found
            if measure in tolerance.measures or measure in COVERAGE]


def unique_times(time, values):
    """The last row of each time (a table may hold one time twice)."""
    keep = np.append(np.diff(time) > 0.0, True)
    return time[keep], values[keep]


def judged_columns(table, names):
    """Check column names asked for by a user."""
    unknown = [name for name in names
               if name in ENTITY_COLUMNS + TEXT_COLUMNS + ("time",) or name not in table]
    if unknown:
        raise UserError(f"not a value column of {table.name}: {', '.join(unknown)}")
    return list(names)
