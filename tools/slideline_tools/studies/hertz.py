# SPDX-License-Identifier: MIT
"""Hertz line contact: half width, peak pressure and profile of a run over the closed form, order of an error."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.scenes.common import ALUMINIUM, STEEL
from slideline_tools.scenes.hertz import BLOCK_CELL, CYLINDER_CELL, END, PENALTY, RADIUS
from slideline_tools.studies import line_contact as lines

JOB = "hertz"
MODULUS = lines.effective_modulus(STEEL, ALUMINIUM)


class Run:
    """One run at rest: nodal pressures of the slave, and their profile over that of Hertz."""

    def __init__(self, folder, level, ctype, exchanged=False, penalty=PENALTY):
        self.level, self.ctype = level, ctype
        nodes, energy = (read_csv(folder / f"{JOB}.{name}.csv") for name in ("contact", "glstat"))
        if not len(energy) or energy["time"][-1] < END * (1.0 - 1e-6):
            raise UserError(f"{folder}: the run did not reach its end")
        nodes = nodes.where(time=nodes["time"][-1])
        self.x, self.pressure = nodes["x"], nodes["pressure"]
        found = lines.measure(self.x, nodes["length"], self.pressure)
        self.force = found.force
        self.hertz = lines.hertz(found.force, RADIUS, MODULUS)
        self.half_width = found.half_width / self.hertz[0]
        self.peak = found.peak / self.hertz[1]
        self.inside, self.anywhere = lines.deviation(self.x, self.pressure, *self.hertz)
        cells = (BLOCK_CELL, CYLINDER_CELL) if exchanged else (CYLINDER_CELL, BLOCK_CELL)
        self.segments = self.hertz[0] * level / cells[0]
        self.softness = MODULUS / self.hertz[0] / lines.layer_stiffness(
            ctype, penalty, *(cell / level for cell in cells))
        self.layer = lines.layer_profile(self.softness)
        self.kinetic = float(energy["kinetic"][-1] / energy["internal"][-1])


def order(sizes, errors):
    """Slope of log(error) over log(size), least squares: 1 for an error in proportion; nan of one size."""
    if len(set(sizes)) < 2:
        return float("nan")
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
