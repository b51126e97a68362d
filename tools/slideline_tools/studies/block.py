# SPDX-License-Identifier: MIT
"""The block-to-block scene: contact pressure on both sides at the end of a run, and the one-dimensional pressure."""
import dataclasses
import functools
import re

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.results import read
from slideline_tools.scenes import block_grids
from slideline_tools.studies.common import verification

WIDTH, PENALTY, N_SLAVE, N_MASTER = 10.0, 1.0e6, 51, 50
FIRST_STEPS = 5
ITERATION = re.compile(r"^step to (\S+) iteration (\d+): energy ratio", re.MULTILINE)


@dataclasses.dataclass
class Pressures:
    """Contact of one run at its last state, nodes from left to right, SI units."""

    slave_x: np.ndarray
    slave: np.ndarray
    master_x: np.ndarray
    master: np.ndarray
    end_depth: float     # penetration of the left end node over the mean one - 1


def half_segments(x):
    """Half of the neighbouring segments of each node of a straight chain with abscissae x."""
    length = np.abs(np.diff(x))
    return 0.5 * (np.append(length, 0.0) + np.append(0.0, length))


def nodal_pressure(results, nodes, x):
    """Contact force in y of nodes over the length that each stands for, at the last state."""
    row = {int(node): k for k, node in enumerate(results.point_field("node_id")[-1])}
    force = results.point_field("contact_force")[-1][[row[int(node)] for node in nodes], 1]
    return np.abs(force) / half_segments(x)


def read_pressures(folder, grids):
    """What the run in `folder` says at its last state; `grids` = lower and upper block."""
    contact = read_csv(folder / "block.contact.csv")
    contact = contact.where(time=contact["time"][-1])
    results = read(folder / "block.vtkhdf")
    nodes = grids[0].upper[::-1]
    row = {int(node): k for k, node in enumerate(results.point_field("node_id")[-1])}
    x = results.points[-1][[row[int(node)] for node in nodes], 0]
    return Pressures(contact["x"], contact["pressure"], x, nodal_pressure(results, nodes, x),
                     contact["gap"][0] / np.mean(contact["gap"]) - 1.0)


def interface_stiffness(ctype, n_slave=N_SLAVE, n_master=N_MASTER):
    """All springs of the interface over its length, N/m^2: in type 1 those of the slave nodes, in type 3 of both passes."""
    count = {1: n_slave + 1, 3: n_slave + n_master}.get(ctype, n_slave)
    return PENALTY * count / WIDTH


@functools.lru_cache(maxsize=None)
def chain_pressure(stiffness, **more):
    """The one-dimensional pressure at the end, Pa: that of a chain of masses and springs, `stiffness` in N/m^2."""
    chain = verification("block_to_block", "chain")
    return float(chain.solve(chain.Blocks(penalty=stiffness, **more)).pressure[-1])


def mean_pressure(x, pressure):
    """Force of a surface over its length."""
    length = half_segments(x)
    return np.sum(pressure * length) / length.sum()


def side_deviations(run, exact):
    """{side: p/p0 - 1}; `exact` None: p0 is the mean pressure of the side."""
    return {side: p / (exact or mean_pressure(x, p)) - 1.0
            for side, x, p in (("slave", run.slave_x, run.slave), ("master", run.master_x, run.master))}


def measure(folder, ctype, implicit):
    """Largest deviations of the pressure: explicit from the one-dimensional one, implicit from the mean; and iterations."""
    run = read_pressures(folder, block_grids(N_SLAVE, N_MASTER))
    exact = None if implicit else chain_pressure(interface_stiffness(ctype))
    sides = side_deviations(run, exact)
    return {**{side: float(np.abs(values).max()) for side, values in sides.items()},
            "end_pressure": float(sides["slave"][0]), "end_depth": float(run.end_depth),
            **(newton_iterations(folder / "block.log") if implicit else {})}


def newton_iterations(log):
    """Most iterations of a step among the first five, and those of the median step later."""
    steps = []
    for _, number in ITERATION.findall(log.read_text(encoding="utf-8")):
        if number == "1":
            steps.append(0)
        steps[-1] += 1
    if not steps:
        raise UserError(f"{log}: no iterations of the implicit method")
    return {"first_iterations": max(steps[:FIRST_STEPS]), "later_iterations": int(np.median(steps[FIRST_STEPS:] or [0]))}
