# SPDX-License-Identifier: MIT
"""Block-to-block study, implicit beside explicit: pressure, Newton iterations.

    python -m slideline_tools.studies.block_implicit RUNS DOC --types 1 2 3 ...

RUNS holds folders implicit_<n> and explicit_<n> for each type (job `block`), in each of them the folder `counted` of the
same run, shortened, where instructions could be counted. Writes
DOC/studies/block_to_block_implicit.md and DOC/pictures/block_implicit_pressure.png.
"""
import re
import sys

import numpy as np
import pandas as pd

from slideline_tools import UserError, counting
from slideline_tools.plots import PAGE_WIDTH, STYLE, mark_cut, plt
from slideline_tools.scenes import block_grids
from slideline_tools.studies.block import (N_MASTER, N_SLAVE, UNIFORM, half_segments, line_style,
                                           read_pressures)
from slideline_tools.studies.common import (colour, label, markdown_table, save_small, study_main,
                                            write_page)
from slideline_tools.studies.framework.counted import instruction_section
from slideline_tools.studies.framework.table import COUNTED

METHODS = ("implicit", "explicit")
FIRST_STEPS, MOST_ITERATIONS = 5, 3
NEARLY_UNIFORM = 0.01

NEWTON = """
## Newton iterations

The energy ratio of an iteration is correction times residual before it, over that of the first iteration. A step ends
when the ratio is at most 1e-20 or when the residual after the correction is round-off; the latter ends most steps
after two iterations, before the ratio of a third is formed.
"""

COUNTED_OPTION = "endtim=0.02"  # as in tools/batch/block_implicit.sh
COST = """
What contact costs here in seconds, implicitly and explicitly: [paper_tables](paper_tables.md).
"""
ITERATION = re.compile(r"^step to (\S+) iteration (\d+): energy ratio ([^,\s]+)", re.MULTILINE)

HEAD = """# Block-to-block contact, implicit beside explicit

The scene of [the explicit study](block_to_block.md) by the implicit method: generalised-alpha (spectral radius 0.8),
consistent mass, fully integrated quads, 200 steps of 1 ms (section 4.1, Figs. 18 to 20 and 23 of Kang, Lee & Shin, 2023).
Explicit: lumped mass, one-point quads, the same steps. Written by `tools/batch/block_implicit.sh`: do not edit.

![Contact pressure at 0.2 s](../pictures/block_implicit_pressure.png)

At the top the implicit pressure along the slave surface, below its left end enlarged, implicit and explicit
(the end node of type 1 is beyond the frame, see the table).

## Pressure at 0.2 s

Min, max and spread (largest magnitude) of `p/p_mean - 1`; `p_mean` is the force of the surface over its length, `p` the
nodal force over half the neighbouring segments.
"""


def energy_history(text):
    """(time, energy ratios of the iterations) of each attempted step in the text of a log."""
    steps = []
    for time, iteration, ratio in ITERATION.findall(text):
        if int(iteration) == 1:
            steps.append((float(time), []))
        steps[-1][1].append(float(ratio))
    return steps


def read_history(folder):
    """The energy history of the implicit run in `folder`; raises UserError if it has none."""
    log = folder / "block.log"
    steps = energy_history(log.read_text(encoding="utf-8"))
    if not steps:
        raise UserError(f"{log}: no iterations of the implicit method")
    return steps


def deviation(x, pressure):
    """p/p_mean - 1 of each node of a surface with abscissae x."""
    length = half_segments(x)
    return pressure * length.sum() / np.sum(pressure * length) - 1.0


def pressure_table(runs):
    """Deviations on both sides, a row for each type and method."""
    rows = []
    for (method, ctype), run in runs.items():
        row = [label(ctype), method]
        for side in (deviation(run.slave_x, run.slave), deviation(run.master_x, run.master)):
            row += [float(side.min()), float(side.max()), float(np.abs(side).max())]
        rows.append(row)
    return markdown_table(("type", "method", "slave: min", "slave: max", "slave: spread",
                           "master: min", "master: max", "master: spread"), rows)


def largest_count(steps):
    """Largest number of iterations of a step."""
    return max(len(ratios) for _, ratios in steps)


def newton_table(histories):
    """Numbers of iterations, a row for each type."""
    return markdown_table(
        ("type", f"most iterations, steps 1 to {FIRST_STEPS}", "most iterations, all steps",
         "mean of all steps"),
        [[label(ctype), largest_count(steps[:FIRST_STEPS]), largest_count(steps),
          f"{np.mean([len(ratios) for _, ratios in steps]):.3f}"]
         for ctype, steps in histories.items()])


def ratio_table(steps):
    """Energy ratios of the first steps, a row for each step."""
    first = steps[:FIRST_STEPS]
    names = [f"iteration {k + 1}" for k in range(largest_count(first))]
    return markdown_table(["time (ms)", *names],
                          [[f"{1000.0 * time:g}", *(f"{ratio:.1e}" for ratio in ratios),
                            *[""] * (len(names) - len(ratios))] for time, ratios in first])


def answers(runs, histories):
    """The source's statements with yes or no, for the types that were run."""
    slave = {ctype: deviation(run.slave_x, run.slave)
             for (method, ctype), run in runs.items() if method == "implicit"}
    spread = {ctype: float(np.abs(side).max()) for ctype, side in slave.items()}
    rows = []

    def answer(text, is_so, figure):
        rows.append([text, "yes" if is_so else "no", figure])

    if 1 in slave:
        answer("classical NTS: anomalously high pressure at the end",
               slave[1][0] > NEARLY_UNIFORM and slave[1][0] > slave[1][1:-1].max(),
               f"end node {slave[1][0]:+.1e}")
    if 1 in slave and 3 in slave:
        answer("two-pass NTS-AR: mitigated", spread[3] < spread[1],
               f"spread {spread[3]:.1e}, classical NTS {spread[1]:.1e}")
        answer("two-pass NTS-AR: pressure lower at the end", slave[3][0] < -UNIFORM,
               f"end node {slave[3][0]:+.1e} (nodal force)")
    for ctype, name in ((4, "VTS-PPT"), (5, "NTS-mAR")):
        if ctype in slave:
            answer(f"{name}: perfectly uniform (to {UNIFORM:.0e})", spread[ctype] < UNIFORM,
                   f"spread {spread[ctype]:.1e}")
    if 6 in slave:
        answer(f"mortar: relatively uniform (to {NEARLY_UNIFORM:g})", spread[6] < NEARLY_UNIFORM,
               f"spread {spread[6]:.1e}")
    most = max(largest_count(steps[:FIRST_STEPS]) for steps in histories.values())
    answer(f"at most {MOST_ITERATIONS} iterations in the first {FIRST_STEPS} steps",
           most <= MOST_ITERATIONS, f"most {most}, all types")
    return markdown_table(("statement (slave side, implicit)", "answer", "figure"), rows)


def pressure_figure(runs):
    """Implicit pressure above, the left end enlarged by both methods below."""
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(PAGE_WIDTH, 5.4), layout="constrained")
        grid = figure.add_gridspec(2, 2)
        whole = figure.add_subplot(grid[0, :])
        panels = {method: figure.add_subplot(grid[1, k]) for k, method in enumerate(METHODS)}
        for (method, ctype), run in runs.items():
            style = line_style(ctype)
            if method == "implicit":
                whole.plot(run.slave_x, run.slave, label=label(ctype), **style)
            panels[method].plot(run.slave_x, 100.0 * deviation(run.slave_x, run.slave), **style)
        whole.set(ylabel="contact pressure (Pa)", title="slave surface, implicit", xlabel="x (m)")
        whole.set_ylim(0.0, 1.05 * whole.dataLim.ymax)
        whole.legend(ncols=4, loc="lower center")
        for method, axes in panels.items():
            axes.set(xlim=(-0.06, 3.06), ylim=(-2.0, 2.0), title=f"enlarged, {method}",
                     xlabel="x (m)", ylabel=r"$p/p_\mathrm{mean} - 1$ (%)")
        for (method, ctype), run in runs.items():
            mark_cut(panels[method], run.slave_x, 100.0 * deviation(run.slave_x, run.slave), colour(ctype))
        for axes in (whole, *panels.values()):
            axes.grid(True, linewidth=0.3, color="#bbbbbb")
        return figure


def count_section(folder, types):
    """Retired instructions of both methods."""
    runs = {(method, ctype): folder / f"{method}_{ctype}" / "counted" for method in METHODS for ctype in types}
    rows = [{"scene": method, "level": 1, "type": ctype, "shortened": COUNTED_OPTION, "state": COUNTED,
             **counting.columns(path)} for (method, ctype), path in runs.items() if (path / counting.COUNTS).exists()]
    return "\n" + instruction_section(pd.DataFrame(rows, columns=None if rows else ["state", "scene", "level"]), {method: method.capitalize() for method in METHODS})


def write(folder, doc, _levels, types):
    """Read the runs; write the page and its picture."""
    grids = block_grids(N_SLAVE, N_MASTER)
    runs = {(method, ctype): read_pressures(folder / f"{method}_{ctype}", grids)
            for ctype in types for method in METHODS}
    histories = {ctype: read_history(folder / f"implicit_{ctype}") for ctype in types}
    parts = [HEAD, pressure_table(runs), "\n## What the source says of it\n",
             answers(runs, histories), NEWTON, newton_table(histories)]
    for ctype in (5, 1):
        if ctype in types:
            parts += [f"\nEnergy ratios of the first steps, type {label(ctype)}:\n",
                      ratio_table(histories[ctype])]
    write_page(doc, "block_to_block_implicit", "\n".join([*parts, COST, count_section(folder, types)]))
    save_small(pressure_figure(runs), doc / "pictures" / "block_implicit_pressure.png", lines=True)


if __name__ == "__main__":
    sys.exit(study_main(__doc__, write))
