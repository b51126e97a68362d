# SPDX-License-Identifier: MIT
"""Converged references of the study speed-accuracy, their own error, and errors against them.

The reference is the run of type 7 on the finest mesh, that of implicit penalty (PUNIT 4) the one
without compliance: a penalty is judged as an interface with these springs, an implicit one as an
interface with none. Its own error is extrapolated from its two or three finest levels.
"""
import numpy as np
import pandas as pd

from slideline_tools.answer.estimate import fit
from slideline_tools.contact_types import HARD, IMPLICIT_PENALTIES
from slideline_tools.histories import read_csv
from slideline_tools.results import read
from slideline_tools.scenes import collision_grids
from slideline_tools.scenes.common import ALUMINIUM
from slideline_tools.studies import sliding as sliding_study
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.framework.times import VARIANT
from slideline_tools.studies.speed_accuracy.scenes import SCENES

REFERENCE_TYPE = 7
IMPACT_SPEED = 80.0
PLATE, PROJECTILE = 1, 2


def own_error(levels, distances):
    """(order, error of the finest level) from distances of successive levels, the finest last, as of values that go one way.

    Two levels: first order is assumed.
    """
    values = np.cumsum([0.0, *distances])[-3:]
    if len(levels) == 2:
        return 1.0, distances[-1] * levels[0] / (levels[1] - levels[0])
    order, (limit, _), _ = fit(1.0 / np.array(levels[-3:]), values)
    return order, abs(limit - values[-1])


# ---- what is compared --------------------------------------------------------------------------

def sliding_force(folder):
    """Force at even times of the judged interval (every 2 microseconds), N/m."""
    rows = read_csv(folder / "sliding.rcforc.csv").where(side="slave")
    first, last = sliding_study.judged_interval()
    times = np.linspace(first, last, 1 + int(round((last - first) / 2.0e-6)))
    return {"force_error": np.interp(times, rows["time"], rows["fy"])}


def plastic_work(results):
    """Plastic work of each column of the level 1 mesh of the plate at the last state, J/m.

    Ideally plastic: yield stress times plastic strain times area.
    """
    plate = results.cell_field("part_id")[-1] == PLATE
    corners = results.points[0][results.cells[plate]][:, :, :2]
    x, y = corners[..., 0], corners[..., 1]
    area = 0.5 * np.abs(np.sum(x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1), axis=1))
    work = ALUMINIUM["yield_stress"] * results.cell_field("plastic_strain")[-1][plate] * area
    edges = collision_grids(1)[0].points[:, 0, 0]
    return np.histogram(x.mean(axis=1), edges, weights=work)[0]


def collision_outcome(folder):
    """Plastic work by column and in total, rebound velocity as a share of the speed of impact."""
    rows = read_csv(folder / "collision.matsum.csv").where(part=PROJECTILE)
    rebound = rows["momentum_y"][-1] / rows["mass"][-1]
    work = plastic_work(read(folder / "collision.vtkhdf"))
    return {"plastic_error": work, "total_work_error": np.array([work.sum()]),
            "rebound_error": np.array([rebound / IMPACT_SPEED])}


def work_distance(one, other, reference):
    """Sum of the differences over the sum."""
    return float(np.abs(one - other).sum() / reference.sum())


OUTCOMES = {"sliding": sliding_force, "collision": collision_outcome}
#: Of two outcomes, over a reference.
DISTANCES = {
    "force_error": lambda one, other, reference: float(np.sqrt(np.mean((one - other) ** 2)) / np.mean(reference)),
    "plastic_error": work_distance, "total_work_error": work_distance,
    "rebound_error": lambda one, other, _: float(np.abs(one - other)[0])}


# ---- columns -----------------------------------------------------------------------------------

def reference_series(ctype):
    """The series whose finest mesh is the reference of another."""
    return HARD if ctype in IMPLICIT_PENALTIES else REFERENCE_TYPE


def reference_levels(scene, there):
    """Levels of which the reference is made, of those that are there: of the full or the quick
    study."""
    for levels in (SCENES[scene].references, SCENES[scene].quick_references):
        if set(levels) <= there:
            return levels
    return ()


def add_errors(table, folder):
    """The table with the columns KEY, KEY_floor and KEY_order of each measure against a reference,
    where a run is coarser than that, and KEY_springs: how far the two references are apart."""
    found = []
    for scene, read_outcome in OUTCOMES.items():
        runs = finished(table)
        runs = runs[runs["scene"] == scene].drop_duplicates(VARIANT)
        outcomes = {(run.type, run.level): read_outcome(folder / "runs" / run.run)
                    for run in runs.itertuples()}
        found += [{"scene": scene, **row} for row in errors_of(scene, outcomes)]
    return table.merge(pd.DataFrame(found), how="left", on=VARIANT) if found else table


def errors_of(scene, outcomes):
    """The columns of each variant of a scene; `outcomes`: {(type, level): what is compared}."""
    chains = {}
    for series in (REFERENCE_TYPE, HARD):
        levels = reference_levels(scene, {level for ctype, level in outcomes if ctype == series})
        if levels:
            chains[series] = [(series, level) for level in levels]
    for (ctype, level), outcome in outcomes.items():
        chain = chains.get(reference_series(ctype))
        if chain:
            row = against(outcome, level, chain, outcomes)
            if len(chains) == 2:
                row.update(springs(*(outcomes[one[-1]] for one in chains.values())))
            yield {"type": ctype, "level": level, **row}


def against(outcome, level, chain, outcomes):
    """The columns of one variant; `chain`: (series, level) of its reference, the finest last."""
    levels = [number for _, number in chain]
    row = {"reference_levels": ", ".join(map(str, levels))}
    for key, reference in outcomes[chain[-1]].items() if level < levels[-1] else ():
        distance = DISTANCES[key]
        row[key] = distance(outcome[key], reference, reference)
        row[f"{key}_order"], row[f"{key}_floor"] = own_error(
            levels, [distance(outcomes[one][key], outcomes[other][key], reference)
                     for one, other in zip(chain[:-1], chain[1:])])
    return row


def springs(soft, hard):
    """How far the reference with springs is from that without."""
    return {f"{key}_springs": DISTANCES[key](soft[key], hard[key], hard[key]) for key in hard}
