# SPDX-License-Identifier: MIT
"""The contact patch test with all contact types: deviation from uniform pressure by penalty.

    python -m slideline_tools.studies.patch decks FOLDER
    python -m slideline_tools.studies.patch page FOLDER DOC

`decks` writes FOLDER/<layout>_<penalty>.k and prints the names; `page` reads the runs
FOLDER/<layout>_<penalty>_type_<n>/patch.* and writes DOC/studies/patch_test.md and its picture.
"""
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.results import read
from slideline_tools.scenes.patch import MESHES, patch, patch_grids
from slideline_tools.studies.common import (colour, decks_and_page_main, label, markdown_table,
                                            save_small, write_page)

ALL = tuple(10.0 ** k for k in range(3, 11))
FEW = tuple(10.0 ** k for k in range(3, 9))
PICTURED, PICTURED_PENALTY = "7_5", 1.0e6


LAYOUTS = {  # title, lines above (slave) and below (master), rows, penalties
    "3_2": ("3 / 2", *MESHES["3/2"], ALL),
    "5_4": ("5 / 4", *MESHES["5/4"], ALL),
    "7_5": ("7 / 5, non-uniform", *MESHES["7/5"], ALL),
    "2_7": ("2 / 7: slave segments over three and four master segments", *MESHES["2/7"], ALL),
    "51_50": ("51 / 50 (two rows of quads)", *MESHES["51/50"], FEW),
}


def layout_grids(layout):
    _, upper, lower, rows, _ = LAYOUTS[layout]
    return patch_grids(upper, lower, rows)


def deck_name(layout, penalty):
    return f"{layout}_{penalty:.0e}".replace("+", "")


def write_decks(folder):
    """All decks; prints their names."""
    folder.mkdir(parents=True, exist_ok=True)
    for layout, (*_, penalties) in LAYOUTS.items():
        for penalty in penalties:
            name = deck_name(layout, penalty)
            text = patch(penalty=penalty, grids=layout_grids(layout))
            (folder / f"{name}.k").write_text(text, encoding="ascii")
            print(name)


class Run:
    """Pressures at rest on both sides of one run."""

    def __init__(self, folder, layout, penalty, ctype, surfaces=""):
        path = folder / f"{deck_name(layout, penalty)}{surfaces}_type_{ctype}"
        energy = read_csv(path / "patch.glstat.csv")
        if not energy["kinetic"][-1] <= 1e-16 * energy["internal"][-1]:
            raise UserError(f"{path}: not at rest at the end")
        results = read(path / "patch.vtkhdf")
        row = {int(node): k for k, node in enumerate(results.point_field("node_id")[-1])}
        force = results.point_field("contact_force")[-1][:, 1]
        lower, upper = layout_grids(layout)
        self.sides = []
        for nodes, grid in ((upper.lower, upper), (lower.upper[::-1], lower)):
            x = grid.points[:, 0, 0]
            half = 0.5 * np.diff(x)
            length = np.append(half, 0.0) + np.append(0.0, half)
            self.sides.append((x, np.abs([force[row[int(node)]] for node in nodes]) / length))

    def deviations(self):
        """max |p/p0 - 1| on the slave and the master side; p0 = 1 Pa."""
        return [float(np.max(np.abs(pressure - 1.0))) for _, pressure in self.sides]


def percent(value):
    """Per cent with two digits; rounding is shown as a bound, the same on every machine."""
    if value < 1e-9:
        return "< 1e-7"
    return f"{100.0 * value:.0f}" if value > 1.0 else f"{100.0 * value:.2g}"


def layout_table(folder, layout, types):
    *_, penalties = LAYOUTS[layout]
    rows = []
    for ctype in types:
        row = [label(ctype)]
        for penalty in penalties:
            row.append(" / ".join(percent(value) for value in
                                  Run(folder, layout, penalty, ctype).deviations()))
        rows.append(row)
    return markdown_table(["type", *(f"{penalty:.0e}".replace("+", "") for penalty in penalties)],
                          rows)


def pressure_figure(folder, types):
    """Pressure along both sides of the interface, one line per type."""
    with plt.rc_context(STYLE):
        figure, panels = plt.subplots(1, 2, layout="constrained", sharey=True,
                                      figsize=(PAGE_WIDTH, 3.4))
        for ctype in types:
            sides = Run(folder, PICTURED, PICTURED_PENALTY, ctype).sides
            for axes, (x, pressure) in zip(panels, sides):
                axes.plot(x, pressure, color=colour(ctype), label=label(ctype), marker="o",
                          markersize=3)
        for axes, title in zip(panels, ("slave side", "master side")):
            axes.set(title=title, xlabel="x (m)")
            axes.grid(True, linewidth=0.3, color="#bbbbbb")
        panels[0].set_ylabel("contact pressure (Pa)")
        panels[0].legend(fontsize=7)
        return figure


PAGE = """# Contact patch test with all contact types

This page and its picture are written by `tools/batch/patch.sh`: do not edit it.

Two blocks of 1 m x 1 m (E = 1 MPa, nu = 0) with non-matching meshes, a uniform pressure of 1 Pa on the
upper face, the lower face at rest (u_y = 0), u_x = 0 at one node of each of these faces; the scene of section 2
of Kang, Lee & Shin (2023). The upper block is the slave. Type 6 has 4 points. The explicit program runs with mass
damping until exp(-{surviving:g}) of the motion is left, with the stiffness form of hourglass control (0.1). Decks:
`slideline-tools make-deck patch --mesh 7/5 --penalty 1e4` and the like; those of 1 MN/m are in `input/patch`, but
for 2 / 7. The static solution of types 1, 2, 3 and 6 is checked by an independent computation in
`tests/verification/contact_patch`, and so is an inclined interface.

Largest deviation |p/p0 - 1| of the nodal pressure (contact force over half the neighbouring segments) on the
slave side / on the master side in per cent, by the penalty eps in N/m. The stiffness of a 1 m x 1 m block is
1 MN/m.

{tables}

![Contact pressure along both sides](../pictures/patch_pressure.png)

The picture shows the non-uniform 7 / 5 meshes at eps = 1 MN/m.

- **Types 4, 5 and 7** give the uniform pressure at every node of both sides at every penalty; the picture shows one
  line for the three.
- **Type 1**, soft: every node has the same spring, so an end node (half the length) has up to twice
  the pressure, the more segments the more.
- **Type 2** looks perfect on the slave side at soft penalties, but not on the master side: there the forces
  arrive where the slave nodes happen to stand. At stiff penalties types 1 and 2 agree: the nodes are then
  constrained, and the weights do not matter.
- **Type 3** improves with the penalty: both sides constrain each other, and its pressures become uniform.
- **Type 6** errs by its quadrature alone, at any penalty: on the master side where it is soft, on both where it is
  stiff, and most where a slave segment faces several master segments.
"""


def write(folder, doc, types):
    """Read the runs below `folder`, write page and picture below `doc`."""
    from slideline_tools.scenes.patch import SURVIVING
    tables = "\n\n".join(f"## Meshes {title}\n\n{layout_table(folder, layout, types)}"
                         for layout, (title, *_) in LAYOUTS.items())
    save_small(pressure_figure(folder, types), doc / "pictures" / "patch_pressure.png", lines=True)
    write_page(doc, "patch_test", PAGE.format(tables=tables, surviving=SURVIVING))


def main(arguments=None):
    return decks_and_page_main(__doc__, write_decks, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
