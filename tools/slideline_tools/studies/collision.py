# SPDX-License-Identifier: MIT
"""The collision scene: plastic strain, rebound, largest force and energy ratio of a run."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.results import read

PROJECTILE, FACING = 2, 0.025  # part; m of the plate that it faces
END, SNAPSHOT_TIME = 1.0e-3, 0.7e-3  # s


def measure(folder):
    """SI units, forces by metre of depth; the plastic strain at 0.7 ms, of all and below the projectile."""
    force = read_csv(folder / "collision.rcforc.csv").where(side="slave")
    if not len(force) or force["time"][-1] < END * (1.0 - 1e-6):
        raise UserError(f"{folder}: the run did not reach its end")
    moving = read_csv(folder / "collision.matsum.csv").where(part=PROJECTILE)
    ratio = read_csv(folder / "collision.glstat.csv")["energy_ratio"]
    results = read(folder / "collision.vtkhdf")
    strain = results.cell_field("plastic_strain")[results.state_index(repr(SNAPSHOT_TIME))]
    facing = results.points[0][results.cells][:, :, 0].mean(axis=1) < FACING
    return {"strain": float(strain.max()), "strain_below": float(strain[facing].max()),
            "rebound": float(moving["momentum_y"][-1] / moving["mass"][-1]), "peak_force": float(force["fy"].max()),
            "energy_error": float(np.abs(ratio - 1.0).max())}
