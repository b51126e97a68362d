# SPDX-License-Identifier: MIT
"""Hertz line contact with all contact types: half width, peak pressure, profile, convergence.

    python -m slideline_tools.studies.hertz FOLDER DOC --levels 1 2 4

FOLDER holds the runs as level_L_type_T/hertz.*, those with the block as slave as
level_L_type_T_exchanged, and those with another penalty as penalty_F_type_T; the page
goes to DOC/studies, its picture to DOC/pictures.
"""
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.scenes.common import ALUMINIUM, STEEL
from slideline_tools.scenes.hertz import BLOCK_CELL, CYLINDER_CELL, END, PENALTY, RADIUS
from slideline_tools.studies import line_contact as lines
from slideline_tools.studies.common import (colour, label, marker, markdown_table, save_small,
                                            study_main, write_page)

JOB = "hertz"
MODULUS = lines.effective_modulus(STEEL, ALUMINIUM)
PICTURED = 2
FACTORS, FACTOR_TYPE, FACTOR_LEVEL = ("0.25", "1", "4"), 7, 2


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


def read_runs(folder, levels, types, exchanged):
    """Runs of all types and levels with one choice of the slave, type by type."""
    suffix = "_exchanged" if exchanged else ""
    return [Run(folder / f"level_{level}_type_{ctype}{suffix}", level, ctype, exchanged)
            for ctype in types for level in levels]


def order(sizes, errors):
    """Slope of log(error) over log(size), least squares: 1 for an error in proportion; nan of one size."""
    if len(set(sizes)) < 2:
        return float("nan")
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])


# ---- tables ------------------------------------------------------------------------------------

def digits(value):
    """A ratio near one with five digits behind the point."""
    return f"{value:.5f}"


def result_table(runs):
    """Every run over Hertz, over Hertz on springs, and its profile."""
    return markdown_table(
        ["type", "N_r", "segments in a", "E*/(k a), %", "a / Hertz", "p0 / Hertz", "a / springs",
         "p0 / springs", "profile inside 0.8 a, %", "profile anywhere, %"],
        [[label(run.ctype), run.level, run.segments, 100 * run.softness, digits(run.half_width),
          digits(run.peak), digits(run.half_width / run.layer.half_width),
          digits(run.peak / run.layer.peak), 100 * run.inside, 100 * run.anywhere]
         for run in runs])


def order_table(runs, swapped):
    """Observed orders of convergence of each type, for both choices of the slave."""
    rows = []
    for ctype in dict.fromkeys(run.ctype for run in runs):
        row = [label(ctype)]
        for chosen in (runs, swapped):
            mine = [run for run in chosen if run.ctype == ctype]
            sizes = [1.0 / run.level for run in mine]
            row += [f"{order(sizes, errors):.2f}".replace("nan", "-") for errors in (
                [run.half_width - 1.0 for run in mine], [run.peak - 1.0 for run in mine],
                [run.inside for run in mine])]
        rows.append(row)
    names = ["a", "p0", "profile inside 0.8 a"]
    return markdown_table(["type", *names, *(f"{name}, exchanged" for name in names)], rows)


def exchange_table(runs, swapped):
    """Change of the answers when the block becomes the slave, in per cent of Hertz."""
    return markdown_table(
        ["type", "N_r", "a, %", "p0, %", "contact force, %"],
        [[label(one.ctype), one.level, 100 * (two.half_width - one.half_width),
          100 * (two.peak - one.peak), 100 * (two.force / one.force - 1.0)]
         for one, two in zip(runs, swapped)])


def penalty_table(runs):
    """One type and mesh with other penalties: {factor as text: Run}."""
    return markdown_table(
        ["penalty", "E*/(k a), %", "a / Hertz", "a: springs / Hertz", "p0 / Hertz",
         "p0: springs / Hertz"],
        [[f"{factor} x", 100 * run.softness, digits(run.half_width), digits(run.layer.half_width),
          digits(run.peak), digits(run.layer.peak)] for factor, run in runs.items()])


# ---- the picture -------------------------------------------------------------------------------

def pressure_figure(runs):
    """Pressures of the runs of one level over Hertz's ellipse, and their distance from it."""
    style = {**STYLE, "figure.dpi": 110, "savefig.dpi": 110, "lines.linewidth": 0.9}
    with plt.rc_context(style):
        figure, panels = plt.subplots(2, 2, layout="constrained", sharex=True, sharey="row",
                                      height_ratios=(3, 2), figsize=(PAGE_WIDTH + 1.0, 5.6))
        x = np.linspace(0.0, 1.3, 600)
        for column, family in enumerate(((1, 2, 3), (4, 5, 6, 7))):
            upper, lower = panels[:, column]
            upper.plot(x, lines.ellipse(x, 1.0, 1.0), color="black", label="Hertz")
            lower.axhline(0.0, color="black")
            for run in (run for run in runs if run.ctype in family):
                draw_run(upper, lower, run)
            upper.legend()
            lower.set_xlabel("x / a of Hertz")
        panels[0, 0].set_ylabel("pressure / p0 of Hertz")
        panels[1, 0].set_ylabel("less the ellipse, %")
        for axes in panels.flat:
            axes.set_xlim(0.0, 1.3)
            axes.grid(True, linewidth=0.3, color="#bbbbbb")
        return figure


def draw_run(upper, lower, run):
    """Points of one run at x >= 0 in both panels."""
    right = run.x >= -1e-9
    x, pressure = run.x[right] / run.hertz[0], run.pressure[right] / run.hertz[1]
    look = dict(color=colour(run.ctype), marker=marker(run.ctype), fillstyle="none",
                markersize=4.0 + 2.0 * (run.ctype in (1, 6)))
    upper.plot(x, pressure, linestyle="none", label=label(run.ctype), **look)
    lower.plot(x, 100.0 * (pressure - lines.ellipse(x, 1.0, 1.0)), **look)


# ---- the page ----------------------------------------------------------------------------------

PAGE = """# Hertz line contact with all contact types

This page and its picture are written by `tools/batch/hertz.sh`: do not edit it.

A steel cylinder of radius R = 20 mm is pressed 30 micrometres down upon an aluminium block, both
elastic, plane strain, no friction; explicit, with mass damping until both rest (largest kinetic
over internal energy at the end of all runs: {kinetic:.1g}). Decks: `slideline-tools make-deck
hertz --level N [--exchanged]`. With the contact force F that each run finds ({force:.0f} kN/m in
the finest) Hertz (1881) gives

    1/E* = sum (1 - nu^2)/E    a = sqrt(4 F R/(pi E*))    p0 = 2 F/(pi a)    p = p0 sqrt(1 - x^2/a^2)

Each level divides the cells of level 1 into N_r x N_r. Both surfaces are evenly divided where
they can touch; the segments of the block are 6/5 as long as those of the cylinder. One-point
quads, hourglass control of the stiffness form (0.05). Type 6 has 4 Gauss points.

What is measured (`tools/slideline_tools/studies/line_contact.py`):

- a: half width of the ellipse with the same second moment as the nodal pressures times their
  lengths, 2 sqrt(m2/F);
- p0: from the least squares line p^2 = p0^2 - B x^2 through the nodes with |x| < 0.8 a;
- profile: largest distance of a nodal pressure from Hertz's ellipse over p0, among the nodes
  inside 0.8 a and among all: near the edge the ellipse is vertical, and a node more or less in
  contact shows.

The penalty is {penalty:.0f} GN/m a node on every mesh; spread over the slave segments h this is a
layer of springs k = penalty/h between the bodies (types 1, 2, 4 to 7; two passes: both of them
add up). *springs* is Hertz's problem with that layer,

    p/k + (2/(pi E*)) int ln(1/|x - s|) p(s) ds = const - x^2/(2R),    p >= 0,

solved by a separate small program. To first order a grows by 0.42 E*/(k a) and p0 falls by 0.32
E*/(k a): an error of first order in h that belongs to the penalty, not to the type.

## Cylinder as slave

{plain}

![pressure](../pictures/hertz_pressure.png)

Pressures of N_r = {pictured} (half of the contact), and their distance from the ellipse.

## Block as slave

{swapped}

## Order of convergence

Slope of log(error against Hertz) over log(h), least squares through the meshes.

{orders}

## Master and slave exchanged

Answers with the block as slave less those with the cylinder as slave.

{exchange}

## The penalty

Type 7, N_r = {factor_level}, cylinder as slave, with the penalty divided and multiplied by 4:

{penalties}

{reading}
"""

READING = """## What this says

- Half width and peak pressure of all seven types go to those of Hertz. On the finest mesh most of
  what is left is the layer of springs that the penalty is, an error of first order; from Hertz on
  springs they differ by a part or a few parts in a thousand. The orders of types 3 to 7 lie above
  one since the mesh's own part falls faster; those of types 1 and 2 mean little, since the jumps of
  the pressure disturb a and p0.
- The profile tells the types apart. With types 1 and 2 the pressure jumps from node to node by
  much the same share of p0 on every mesh: the failed patch test. Where the cylinder is the slave,
  every sixth slave node meets a master node, at x = 0 first (every 0.7 a at N_r = 2); under a
  uniform pressure that master node would get 10/9 of its share and the four between 35/36 of
  theirs. The block sinks under it, and the pressure falls there. Refinement makes the pattern
  finer, not smaller. The jumps are 2.5 to 3 times smaller where the block is the slave: then the
  uneven load falls upon the steel.
- Type 3 loads both sides by their own lengths; its jumps are smaller and fall with the mesh.
- Types 4 to 7 follow the ellipse inside 0.8 a ever closer, VTS-PPT and the segmented mortar
  closest on the finest mesh, NTS-mAR more than twice as far where the cylinder is the slave and as close where
  the block is. The mortar's quadrature shows on the finest mesh.
- At the edge types 3 to 7 load one node more than types 1 and 2: a segment that is closed in
  part, or a master node that touches it, loads both its nodes.
- Exchanging slave and master changes a and p0 by the order of the mesh error, most with types 1
  and 2 at N_r = 2. Type 3 has the same forces either way: only the side on which the pressure is
  read changes.
- The remaining tenth of a per cent in p0 of types 3 to 7 on the finest mesh is finite strain:
  pressed down by 9 micrometres only, with as many segments in a (N_r = 8, type 7), p0 over that
  of springs falls from 1.0011 to 1.0003.
"""


def page(plain, swapped, penalties):
    """Text of the page."""
    runs = [*plain, *swapped, *penalties.values()]
    return PAGE.format(
        kinetic=max(run.kinetic for run in runs), penalty=PENALTY / 1e9, pictured=PICTURED,
        force=max(plain, key=lambda run: run.level).force / 1e3, plain=result_table(plain),
        swapped=result_table(swapped), orders=order_table(plain, swapped),
        exchange=exchange_table(plain, swapped), factor_level=FACTOR_LEVEL,
        penalties=penalty_table(penalties), reading=READING).rstrip() + "\n"


def write(folder, doc, levels, types):
    """Read the runs below `folder`, write page and picture below `doc`."""
    plain, swapped = (read_runs(folder, levels, types, flag) for flag in (False, True))
    penalties = {factor: Run(folder / f"penalty_{factor}_type_{FACTOR_TYPE}", FACTOR_LEVEL,
                             FACTOR_TYPE, penalty=float(factor) * PENALTY)
                 for factor in FACTORS}
    shown = PICTURED if PICTURED in levels else max(levels)
    save_small(pressure_figure([run for run in plain if run.level == shown]),
               doc / "pictures" / "hertz_pressure.png")
    write_page(doc, "hertz", page(plain, swapped, penalties))


if __name__ == "__main__":
    sys.exit(study_main(__doc__, write))
