# SPDX-License-Identifier: MIT
"""The static contact patch test with all contact types: deviation from uniform pressure by penalty.

    python -m slideline_tools.studies.patch_static decks FOLDER
    python -m slideline_tools.studies.patch_static page FOLDER DOC

`decks` writes FOLDER/<layout>_<penalty>.k, at one penalty also with ties and with both blocks in one set
(FOLDER/<layout>_<penalty>_tied.k, .._one-set.k), and prints the names; `page` reads the runs
FOLDER/<layout>_<penalty>_type_<n>/patch.* and writes DOC/studies/patch_test_static.md, its pictures
and one table FOLDER/type_<n>.csv for each type.
"""
import csv
import math
import re
import sys

from slideline_tools import UserError
from slideline_tools.fields import scalar_field
from slideline_tools.plots import PAGE_WIDTH, STYLE, colour_bar, draw_field, plt
from slideline_tools.results import read
from slideline_tools.scenes.patch import SURFACES, patch
from slideline_tools.studies.common import (decks_and_page_main, label, markdown_table, save_small,
                                            write_page)
from slideline_tools.studies.patch import (ALL, LAYOUTS, Run, deck_name, layout_grids,
                                           pressure_figure)

DEFORMED, DEFORMED_TYPES, DEFORMED_PENALTY, SCALE = "5_4", (1, 5), 1.0e6, 5.0e4
STRESS_RANGE = (-1.15, -0.85)
SMALL, SMALLEST = 1.0e-9, 1.0e-13
OTHER_SURFACES, HELD_PENALTY = SURFACES[1:], 1.0e6


def write_decks(folder):
    """All decks; prints their names."""
    folder.mkdir(parents=True, exist_ok=True)
    for layout in LAYOUTS:
        for penalty in ALL:
            name = deck_name(layout, penalty)
            text = patch(penalty=penalty, grids=layout_grids(layout), static=True)
            (folder / f"{name}.k").write_text(text, encoding="ascii")
            print(name)
        for surfaces in OTHER_SURFACES:
            name = f"{deck_name(layout, HELD_PENALTY)}_{surfaces}"
            text = patch(penalty=HELD_PENALTY, grids=layout_grids(layout), static=True, surfaces=surfaces)
            (folder / f"{name}.k").write_text(text, encoding="ascii")
            print(name)


def size(value):
    """Two digits; round-off as the power of ten it lies below, the same on every machine."""
    if value < SMALL:
        return f"< 1e{math.ceil(math.log10(max(value, SMALLEST))) + 1}"
    return f"{value:.1e}".replace("e-0", "e-") if value < 1.0 else f"{value:.2g}"


def read_deviations(folder, types):
    """(slave, master) deviations by (layout, type, penalty)."""
    return {(layout, ctype, penalty): Run(folder, layout, penalty, ctype).deviations()
            for layout in LAYOUTS for ctype in types for penalty in ALL}


def write_tables(folder, deviations, types):
    """FOLDER/type_<n>.csv: one row for each layout and penalty."""
    for ctype in types:
        with open(folder / f"type_{ctype}.csv", "w", newline="", encoding="ascii") as stream:
            table = csv.writer(stream, lineterminator="\n")
            table.writerow(["meshes", "penalty", "slave_deviation", "master_deviation"])
            table.writerows([layout.replace("_", "/"), f"{penalty:.0e}", *pair]
                            for (layout, one, penalty), pair in deviations.items() if one == ctype)


def layout_table(deviations, layout, types):
    rows = [[label(ctype), *(" / ".join(size(value) for value in deviations[layout, ctype, penalty])
                             for penalty in ALL)] for ctype in types]
    return markdown_table(["type", *(f"{penalty:.0e}".replace("+", "") for penalty in ALL)], rows)


def surfaces_table(folder, types):
    """Deviations by layout and type with ties, and with both blocks in one set."""
    rows = [[label(ctype), *(" / ".join(size(value) for value in
                                        Run(folder, layout, HELD_PENALTY, ctype, f"_{surfaces}").deviations())
                             for layout in LAYOUTS for surfaces in OTHER_SURFACES)] for ctype in types]
    heads = [f"{layout.replace('_', '/')} {text}" for layout in LAYOUTS for text in ("tied", "one set")]
    return markdown_table(["type", *heads], rows)


def newton_table(folder, types):
    """Energy ratios of the iterations on the non-uniform meshes at eps = 1 MN/m, from the logs."""
    rows = []
    for ctype in types:
        path = folder / f"{deck_name('7_5', DEFORMED_PENALTY)}_type_{ctype}" / "patch.log"
        ratios = [float(text) for text in
                  re.findall(r"iteration \d+: energy ratio (\S+),", path.read_text())]
        if not ratios:
            raise UserError(f"{path}: no iterations")
        rows.append([label(ctype), ", ".join(f"{ratio:.0e}" for ratio in ratios)])
    return markdown_table(["type", "energy ratios of the iterations"], rows)


def deformed_figure(folder, types):
    """Blocks with magnified displacements, coloured by the vertical stress, side by side."""
    with plt.rc_context({**STYLE, "figure.dpi": 110, "savefig.dpi": 110}):
        figure, panels = plt.subplots(1, len(types), layout="constrained", squeeze=False,
                                      figsize=(PAGE_WIDTH, 4.6))
        for axes, ctype in zip(panels.flat, types):
            result = read(folder / f"{deck_name(DEFORMED, DEFORMED_PENALTY)}_type_{ctype}"
                          / "patch.vtkhdf")
            field = scalar_field(result, "stress:yy")
            artist = draw_field(axes, result, field, -1, SCALE, STRESS_RANGE)
            axes.autoscale_view()
            axes.set_axis_off()
            axes.set_title(label(ctype), loc="left")
        colour_bar(artist, list(panels.flat), "stress yy (Pa)")
        return figure


PAGE = """# Static contact patch test with all contact types

This page and its pictures are written by `tools/batch/patch.sh static`: do not edit it.

The scene of [the explicit page](patch_test.md) (section 2 of Kang, Lee & Shin 2023) with fully integrated
quads and one static step of the implicit method: two blocks of 1 m x 1 m, E = 1 MPa, nu = 0, a uniform
pressure of 1 Pa. The upper block is the slave; type 6 has 4 points. Deck of the 5 / 4 meshes:
`slideline-tools make-deck patch --static`. `tests/verification/contact_patch_static` judges these runs, compares
types 1, 2, 3 and 6 with an independent static solution and has the interface inclined by 20 degrees, nu = 0.3, and
the explicit program damped to rest on the same quads.

Largest deviation |p/p0 - 1| of the nodal pressure (contact force over half the neighbouring segments) on the
slave side / on the master side, by the penalty eps in N/m; 1 is 100 per cent. Round-off is given as the
power of ten below which it lies, with a decade to spare (coordinates in the decks have 13 decimals). The stiffness of a block is 1 MN/m.

{tables}

![Contact pressure along both sides](../pictures/patch_static_pressure.png)

The chart shows the non-uniform 7 / 5 meshes at eps = 1 MN/m.

![Deformed blocks](../pictures/patch_static_deformed.png)

Blocks of the 5 / 4 meshes at eps = 1 MN/m, displacements drawn 50 000 times, coloured by the
vertical stress (-1 Pa is exact), for a type that fails and one that passes.

## Ties, and both blocks in one set

The same at eps = 1 MN/m where the faces are tied (TIE 1 of `*CONTACT_2D_SLIDELINE`), and where both blocks are one set of parts in contact
with itself (SURFB 0): the whole outlines are met from either side, each time by half of the penalty.

{surfaces}

## Newton's method

{newton}

The first iteration is the linear solution; what it leaves is smaller than the first by the strains, 1e-6, and in
energy by their square. After the second the residual is round-off.

## What it says

- **Types 4, 5 and 7** are exact to round-off on both sides. What is left grows in proportion to the penalty from
  1e8 N/m on, since the gap p0/eps_hat becomes a small difference of displacements of 1e-6 m: at 1e10 N/m
  it is still far below 1e-9. Type 5 shows no locking up to 1e10 N/m.
- **Types 1, 2, 3, 6** deviate as on the explicit page; its remarks hold. Of the four, type 3 alone gets ever
  better as the penalty grows.
- **Ties** transmit what contact of the same type does. **In one set** types 4, 5 and 7 stay exact: two half passes of what is exact are exact.
"""


def write(folder, doc, types):
    """Read the runs below `folder`, write tables, page and pictures."""
    deviations = read_deviations(folder, types)
    write_tables(folder, deviations, types)
    tables = "\n\n".join(f"## Meshes {title}\n\n{layout_table(deviations, layout, types)}"
                         for layout, (title, *_) in LAYOUTS.items())
    pictures = doc / "pictures"
    save_small(pressure_figure(folder, types), pictures / "patch_static_pressure.png", lines=True)
    shown = [ctype for ctype in DEFORMED_TYPES if ctype in types] or types[:1]
    save_small(deformed_figure(folder, shown), pictures / "patch_static_deformed.png")
    write_page(doc, "patch_test_static",
               PAGE.format(tables=tables, surfaces=surfaces_table(folder, types), newton=newton_table(folder, types)))


def main(arguments=None):
    return decks_and_page_main(__doc__, write_decks, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
