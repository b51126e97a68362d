# SPDX-License-Identifier: MIT
"""The Hertz scene: half width, largest pressure and profile of a run over the closed form; order of an error."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.scenes.common import ALUMINIUM, STEEL
from slideline_tools.scenes.hertz import END, RADIUS
from slideline_tools.studies.common import verification

lines = verification(".", "hertz_line")  # closed form, and what nodal pressures amount to
MODULUS = lines.effective_modulus(STEEL, ALUMINIUM)


def measure(folder):
    """`half_width` and `peak` of the nodal pressures at rest over those of Hertz, `inside` the largest distance from his
    ellipse inside 0.8 of it, over its peak."""
    nodes, energy = (read_csv(folder / f"hertz.{name}.csv") for name in ("contact", "glstat"))
    if not len(energy) or energy["time"][-1] < END * (1.0 - 1e-6):
        raise UserError(f"{folder}: the run did not reach its end")
    nodes = nodes.where(time=nodes["time"][-1])
    found = lines.measure(nodes["x"], nodes["length"], nodes["pressure"])
    half_width, peak = lines.hertz(found.force, RADIUS, MODULUS)
    inside, _ = lines.deviation(nodes["x"], nodes["pressure"], half_width, peak)
    return {"half_width": found.half_width / half_width, "peak": found.peak / peak, "inside": inside}


def order(sizes, errors):
    """Slope of log(error) over log(size), least squares: 1 for an error in proportion; nan of one size."""
    if len(set(sizes)) < 2:
        return float("nan")
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])
