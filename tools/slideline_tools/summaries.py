# SPDX-License-Identifier: MIT
"""The few numbers of a scene that are worth a row of a table."""
import pathlib

import numpy as np

from slideline_tools.histories import read_csv
from slideline_tools.results import read

PROJECTILE = 2
SNAPSHOT_TIME = 0.7e-3


def collision_row(folder, job):
    """What a collision run gave: a dict of numbers in SI units.

    `plastic_strain`   largest effective plastic strain at 0.7 ms
    `rebound`          mean velocity of the projectile in y at the end, m/s
    `peak_force`       largest contact force in y on the projectile, N per m depth
    `impulse`          time integral of that force, N s per m depth
    `episodes`         how often contact was made, seen at the interval of the force history
    `energy_low/high`  extremes of the energy ratio
    """
    folder = pathlib.Path(folder)
    results = read(folder / f"{job}.vtkhdf")
    matsum = read_csv(folder / f"{job}.matsum.csv").where(part=PROJECTILE)
    rcforc = read_csv(folder / f"{job}.rcforc.csv").where(side="slave")
    ratio = read_csv(folder / f"{job}.glstat.csv")["energy_ratio"]
    state = int(np.argmin(np.abs(results.times - SNAPSHOT_TIME)))
    closed = rcforc["n_active"] > 0
    force, time = rcforc["fy"], rcforc["time"]
    return {
        "plastic_strain": float(results.cell_field("plastic_strain")[state].max()),
        "rebound": float(matsum["momentum_y"][-1] / matsum["mass"][-1]),
        "peak_force": float(force.max()),
        "impulse": float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(time))),
        "episodes": int(np.sum(closed[1:] & ~closed[:-1]) + closed[0]),
        "energy_low": float(ratio.min()),
        "energy_high": float(ratio.max()),
    }


def plate_row(folder, job, node):
    """What a symmetric plate run gave: deflection of the mid-span node in y, SI units.

    `peak`, `time_of_peak`, `mean` over the run, `final`, and the hourglass energy at the end over
    the internal energy at the end.
    """
    folder = pathlib.Path(folder)
    rows = read_csv(folder / f"{job}.nodout.csv").where(node=node)
    glstat = read_csv(folder / f"{job}.glstat.csv")
    top = int(np.argmax(rows["uy"]))
    time, deflection = rows["time"], rows["uy"]
    area = np.sum(0.5 * (deflection[1:] + deflection[:-1]) * np.diff(time))
    return {
        "peak": float(deflection[top]),
        "time_of_peak": float(time[top]),
        "mean": float(area / (time[-1] - time[0])),
        "final": float(deflection[-1]),
        "hourglass_share": float(glstat["hourglass"][-1] / glstat["internal"][-1]),
    }


def timing(folder, job):
    """Seconds of the whole run and the share of contact in it, from the timing table."""
    table = read_csv(pathlib.Path(folder) / f"{job}.timing.csv")
    seconds = dict(zip(table["phase"].tolist(), table["seconds"].tolist()))
    contact = sum(value for phase, value in seconds.items() if phase.startswith("contact_") and "." not in phase)
    total = seconds["total"]
    return {"seconds": total, "contact_share": contact / total if total > 0.0 else 0.0}
