# SPDX-License-Identifier: MIT
"""Block-to-block study: how uniform the contact pressure of each type is, on both sides.

    python -m slideline_tools.studies.block RUNS DOC --types 1 2 3 ...

RUNS holds a folder type_<n> for each type (job `block`) and chain.csv, the pressure of the
one-dimensional chain for each stiffness of the interface. Writes DOC/studies/block_to_block.md
and DOC/pictures/block_pressure.png.
"""
import dataclasses
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, mark_cut, plt
from slideline_tools.results import read
from slideline_tools.scenes import block_grids
from slideline_tools.studies.common import (colour, label, markdown_table, save_small,
                                            study_main, write_page)

WIDTH, PENALTY, N_SLAVE, N_MASTER = 10.0, 1.0e6, 51, 50
UNIFORM = 1.0e-8

HEAD = """# Block-to-block contact, explicit

Two soft blocks of 10 m x 0.5 m (dimensions ours), 51 x 2 quads above (slave) and 50 x 2 below
(master), E = 1 MPa, nu = 0, pressed together with 50 mm/s for 200 steps of 1 ms; penalty 1 MN/m, type 6
with 4 points. The scene of section 4.1 of Kang, Lee & Shin (2023); compare with their Figs. 21 and 22.
Written by `tools/batch/block.sh`: do not edit.

![Contact pressure at 0.2 s](../pictures/block_pressure.png)

At the top the pressure along the slave surface (nodal force over half the neighbouring segments); below
enlarged, as deviation from the one-dimensional pressure of the type, on both sides: the left end at 1.5 %, and the
whole surface at 0.2 %.

## Deviation from the one-dimensional pressure at 0.2 s

The exact answer is uniform and one-dimensional. `p_1D` is that of a chain of masses and springs
(`tests/verification/block_to_block/chain.py`) whose interface has all the springs that the type has:
51 segments of 1 MN/m over 10 m; in type 1 its 52 nodes; in type 3 those of both passes, 51 + 50. Min and max are
those of `p/p_1D - 1`, spread is its largest magnitude; end penetration is that of the end node over the mean one, - 1.
"""

TAIL = """
- **Types 4, 5 and 7** give the chain's pressure on both sides, in every node; they lie on one line in the picture. The 1e-10
  that is left is the elements' own: a lateral stress of third order in the strain increment of a step.
- **Type 1** gives each node the same spring. An end node has half the length, so that its pressure is too high; if the
  blocks could not give way it would be twice the others'. The disturbance fades over a few elements on both sides.
- **Type 2** weights a slave node with its length, but the half segment of an end node acts in one place, the very end of
  the master, with part of the next node's force in addition: the master's end nodes are pressed too much, give way, and
  leave the slave's end nodes with too little.
- **Type 3** adds both passes, hence about twice the springs (`p_1D` differs). The errors of the two passes nearly cancel.
  What is left at the ends has one sign: the nodal force is too high on both sides, and the end nodes sink in less.
- **Type 6** errs only by its quadrature: the Gauss points of a slave segment do not see the kinks of the master's
  functions. Its peaks stand where a master node passes a Gauss point (x = 0.7 m, 3.3 m, 6.7 m, 9.3 m), not at the ends.

The deviations of types 1, 2, 3 and 6 are reproduced within 10 % of the largest by a linear plane model that shares no code with the
program (`tests/verification/block_to_block`).

## What the source says of it

| claim (Figs. 18 to 22) | answer |
|---|---|
| classical NTS: anomalously large pressure at the ends | yes, on both sides |
| two-pass NTS-AR: mitigated, but the pressure decreases at the ends | mitigated, yes; decreasing only in penalty times penetration |
| mortar: relatively uniform | yes, to 0.2 % |
| VTS-PPT and NTS-mAR: perfectly uniform | yes, to 1e-10 |

Penalty times penetration is the column end penetration; the nodal forces of two-pass NTS-AR are slightly too high there.
"""


@dataclasses.dataclass
class Pressures:
    """Contact of one run at its last state, nodes from left to right, SI units."""

    slave_x: np.ndarray
    slave: np.ndarray
    master_x: np.ndarray
    master: np.ndarray
    end_depth: float     # penetration of the left end node over the mean one - 1
    force: float         # total force on the slave in y


def half_segments(x):
    """Half of the neighbouring segments of each node of a straight chain with abscissae x."""
    length = np.abs(np.diff(x))
    return 0.5 * (np.append(length, 0.0) + np.append(0.0, length))


def read_pressures(folder, grids):
    """What the run in `folder` says at its last state; `grids` = lower and upper block."""
    contact = read_csv(folder / "block.contact.csv")
    contact = contact.where(time=contact["time"][-1])
    results = read(folder / "block.vtkhdf")
    row = {int(node): k for k, node in enumerate(results.point_field("node_id")[-1])}
    rows = [row[int(node)] for node in grids[0].upper[::-1]]
    x = results.points[-1][rows, 0]
    force = results.point_field("contact_force")[-1][rows, 1]
    return Pressures(contact["x"], contact["pressure"], x, -force / half_segments(x),
                     contact["gap"][0] / np.mean(contact["gap"]) - 1.0, np.sum(contact["fy"]))


def interface_stiffness(ctype, n_slave=N_SLAVE, n_master=N_MASTER):
    """All springs of the interface over its length, N/m^2."""
    count = {1: n_slave + 1, 3: n_slave + n_master}.get(ctype, n_slave)
    return PENALTY * count / WIDTH


def chain_pressure(chain, stiffness):
    """Last pressure of the chain with that stiffness, from the table penalty,time,pressure."""
    near = np.abs(chain["penalty"] - stiffness) < 1e-9 * stiffness
    if not np.any(near):
        raise UserError(f"{chain.name}: no rows for a penalty of {stiffness:g}")
    return float(chain["pressure"][near][-1])


def table_row(ctype, pressures, exact):
    """One row of the table: text and numbers."""
    deviation = [side / exact - 1.0 for side in (pressures.slave, pressures.master)]
    worst = [float(np.max(np.abs(side))) for side in deviation]
    row = [label(ctype), f"{exact:.6f}"]
    for side, largest in zip(deviation, worst):
        row += [float(side.min()), float(side.max()), largest]
    return row + [float(pressures.end_depth), f"{pressures.force:.4f}",
                  "yes" if max(worst) < UNIFORM else "no"]


COLUMNS = ("type", "p_1D (Pa)", "slave: min", "slave: max", "slave: spread", "master: min",
           "master: max", "master: spread", "end penetration", "total force (N/m)",
           f"uniform to {UNIFORM:.0e}")


def pressure_figure(runs, exact):
    """Pressure of all types: total above, deviation of both sides at two scales below."""
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(PAGE_WIDTH, 7.6), layout="constrained")
        grid = figure.add_gridspec(3, 2)
        whole = figure.add_subplot(grid[0, :])
        for ctype, run in runs.items():
            whole.plot(run.slave_x, run.slave, label=label(ctype), **line_style(ctype))
        whole.set(ylabel="contact pressure (Pa)", title="slave surface")
        whole.set_ylim(0.0, 1.05 * whole.dataLim.ymax)
        whole.legend(ncols=4, loc="lower center")
        whole.grid(True, linewidth=0.3, color="#bbbbbb")
        for row, (reach, percent) in enumerate(((3.0, 1.5), (10.0, 0.2)), start=1):
            for column, side in enumerate(("slave", "master")):
                axes = figure.add_subplot(grid[row, column])
                draw_deviation(axes, runs, exact, side, (-0.02 * reach, 1.02 * reach, -percent, percent))
    return figure


def draw_deviation(axes, runs, exact, side, window):
    """Deviation from the chain along one surface, in per cent, in a window; arrow heads where it goes beyond."""
    lines = {}
    for ctype, run in runs.items():
        x, p = ((run.slave_x, run.slave) if side == "slave" else (run.master_x, run.master))
        lines[ctype] = x, 100.0 * (p / exact[ctype] - 1.0)
        axes.plot(*lines[ctype], **line_style(ctype))
    axes.set_xlim(*window[:2])
    axes.set_ylim(*window[2:])
    for ctype, (x, y) in lines.items():
        mark_cut(axes, x, y, colour(ctype))
    axes.set(xlabel="x (m)", ylabel="$p/p_{1D} - 1$ (%)", title=f"enlarged, {side} side")
    axes.grid(True, linewidth=0.3, color="#bbbbbb")


def line_style(ctype):
    return dict(color=colour(ctype), marker="o", markersize=1.6, linewidth=0.8)


def write(folder, doc, _levels, types):
    """Read the runs; write the page and its picture."""
    chain = read_csv(folder / "chain.csv")
    grids = block_grids(N_SLAVE, N_MASTER)
    runs = {ctype: read_pressures(folder / f"type_{ctype}", grids) for ctype in types}
    exact = {ctype: chain_pressure(chain, interface_stiffness(ctype)) for ctype in types}
    table = markdown_table(COLUMNS, [table_row(ctype, run, exact[ctype])
                                     for ctype, run in runs.items()])
    write_page(doc, "block_to_block", f"{HEAD}\n{table}\n{TAIL}")
    save_small(pressure_figure(runs, exact), doc / "pictures" / "block_pressure.png", lines=True)
    print(table)


if __name__ == "__main__":
    sys.exit(study_main(__doc__, write))
