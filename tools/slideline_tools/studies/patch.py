# SPDX-License-Identifier: MIT
"""The contact patch test: its meshes, and how far the pressures of a run are from the uniform one."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.results import read
from slideline_tools.scenes.patch import MESHES, patch_grids
from slideline_tools.studies.block import nodal_pressure

ALL = tuple(10.0 ** k for k in range(3, 11))
FEW = tuple(10.0 ** k for k in range(3, 9))

LAYOUTS = {  # title, lines above (slave) and below (master), rows, penalties
    "3_2": ("3 / 2", *MESHES["3/2"], ALL),
    "5_4": ("5 / 4", *MESHES["5/4"], ALL),
    "7_5": ("7 / 5, non-uniform", *MESHES["7/5"], ALL),
    "2_7": ("2 / 7: slave segments over three and four master segments", *MESHES["2/7"], ALL),
    "51_50": ("51 / 50 (two rows of quads)", *MESHES["51/50"], FEW),
}


def layout_grids(layout):
    """Lower and upper block."""
    _, upper, lower, rows, _ = LAYOUTS[layout]
    return patch_grids(upper, lower, rows)


def sides(folder, grids):
    """(x, nodal pressures) of the slave and the master side of a run at rest."""
    energy = read_csv(folder / "patch.glstat.csv")
    if not energy["kinetic"][-1] <= 1e-16 * energy["internal"][-1]:
        raise UserError(f"{folder}: not at rest at the end")
    results, (lower, upper) = read(folder / "patch.vtkhdf"), grids
    found = []
    for nodes, grid in ((upper.lower, upper), (lower.upper[::-1], lower)):
        x = grid.points[:, 0, 0]
        found.append((x, nodal_pressure(results, nodes, x)))
    return found


def measure(folder, layout):
    """max |p/p0 - 1| on both sides; p0 = 1 Pa."""
    deviations = [float(np.max(np.abs(pressure - 1.0))) for _, pressure in sides(folder, layout_grids(layout))]
    return dict(zip(("slave", "master"), deviations))
