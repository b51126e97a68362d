# SPDX-License-Identifier: MIT
"""The maps as pictures and the page of the study."""
from __future__ import annotations

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.studies.common import label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import styled
from slideline_tools.studies.stability import measures
from slideline_tools.studies.stability.measures import BLOWN_UP, CHATTERING, STABLE, VERDICTS
from slideline_tools.studies.stability.scenes import FASTER, SCENES
from slideline_tools.studies.stability.texts import PAGE

DEPTH_DECADES = (-0.5, 0.0, 0.5, 1.0)  # penalties of the table of depths
LIMITS = {  # name of the column: text and line
    "true_limit": ("limit by eigenvalue", dict(color="black")),
    "program_limit": ("limit of the program", dict(color="black", linestyle="--")),
    "spring_limit": ("contact springs: omega dt = 2", dict(color="black", linestyle=":")),
    "opening_limit": ("contact springs: omega dt = 1", dict(color="black", linestyle="-.")),
}
FILLS = ("#d9ead3", "#9fc5e8", "#ffe599", "#b4a7d6", "#cc4125")


def of_type(rows, ctype, kind):
    return [row for row in rows if row["type"] == ctype and row["kind"] == kind]


def grid_of(rows):
    """Decades, steps and verdict numbers (step, decade); -1 where nothing has run."""
    decades = sorted({row["decade"] for row in rows})
    steps = sorted({row["step"] for row in rows})
    verdict = np.full((len(steps), len(decades)), -1.0)
    for row in rows:
        if "verdict" in row:
            place = steps.index(row["step"]), decades.index(row["decade"])
            verdict[place] = VERDICTS.index(row["verdict"])
    return np.array(decades), steps, np.ma.masked_less(verdict, 0.0)


def limits_of(rows, ctype, name):
    """(decade, limit over L/c) in order."""
    return sorted((row["decade"], row[name]) for row in of_type(rows, ctype, "limit") if name in row)


def draw_panel(axes, rows, ctype):
    """One map: cells by verdict; the limits."""
    decades, steps, verdict = grid_of(of_type(rows, ctype, "map"))
    half = 0.5 * (decades[1] - decades[0]) if len(decades) > 1 else 0.5
    norm = BoundaryNorm(np.arange(len(VERDICTS) + 1) - 0.5, len(VERDICTS))
    axes.imshow(verdict, origin="lower", aspect="auto", cmap=ListedColormap(FILLS), norm=norm,
                extent=(decades[0] - half, decades[-1] + half, -0.5, len(steps) - 0.5),
                interpolation="nearest")
    for name, (_, style) in LIMITS.items():
        points = limits_of(rows, ctype, name)
        if points:
            x, limit = map(np.array, zip(*points))
            dense = np.linspace(x[0], x[-1], 100)
            level = np.exp(np.interp(dense, x, np.log(limit)))
            axes.plot(dense, np.interp(level, steps, np.arange(len(steps)), left=np.nan), lw=1.0,
                      **style)
    axes.set_yticks(range(len(steps)), [f"{step:g}" for step in steps], fontsize=5.5)
    axes.tick_params(axis="x", labelsize=6)
    axes.grid(False)


def draw_maps(by_scene):
    """All types in columns, scenes in rows."""
    types = sorted({row["type"] for rows in by_scene.values() for row in rows})
    figure, panels = plt.subplots(len(by_scene), len(types), squeeze=False, sharex=True,
                                  figsize=(PAGE_WIDTH + 2.5, 1.9 * len(by_scene) + 0.6),
                                  layout="constrained")
    for line, (name, rows) in zip(panels, by_scene.items()):
        for axes, ctype in zip(line, types):
            draw_panel(axes, rows, ctype)
            axes.set_title(label(ctype), fontsize=7)
            if axes is not line[0]:
                axes.set_yticklabels([])
        line[0].set_ylabel(f"{SCENES[name].title}: step over L/c", fontsize=7)
    figure.supxlabel("log10 of penalty over K L/A of the elements", fontsize=8)
    handles = [Patch(color=fill, label=name) for fill, name in zip(FILLS, VERDICTS)]
    handles += [plt.Line2D([], [], label=text, **style) for text, style in LIMITS.values()]
    figure.legend(handles=handles, loc="outside upper center", ncols=5, fontsize=6)
    return figure


def limit_table(by_scene):
    """Program's limit over that by eigenvalues, smallest to largest over all penalties."""
    lines = []
    for ctype in sorted({row["type"] for rows in by_scene.values() for row in rows}):
        cells = [label(ctype)]
        for rows in by_scene.values():
            ratios = [row["program_limit"] / row["both_limits"]
                      for row in of_type(rows, ctype, "limit") if "both_limits" in row]
            cells.append(f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else "")
        lines.append(cells)
    return markdown_table(["type", *(SCENES[name].title for name in by_scene)], lines)


def count_table(by_scene):
    """Verdicts of the cells below the program's limit, and stability above the limit by eigenvalue."""
    lines = []
    for name, rows in by_scene.items():
        for ctype in sorted({row["type"] for row in rows}):
            cells = [row for row in of_type(rows, ctype, "map") if "verdict" in row]
            below = [row["verdict"] for row in cells if row.get("below_limit")]
            true = limits_of(rows, ctype, "true_limit")
            above = [row["verdict"] for row in cells if true
                     and row["step"] > 1.001 * np.exp(np.interp(
                         row["decade"], *zip(*[(x, np.log(y)) for x, y in true])))]
            lines.append([SCENES[name].title, label(ctype), len(below),
                          *(below.count(verdict) for verdict in VERDICTS), len(above),
                          above.count(VERDICTS[STABLE])])
    return markdown_table(["scene", "type", "cells below the program's limit", *VERDICTS,
                           "cells above the limit by eigenvalue", "of these stable"], lines)


def good_decades(rows, ctype):
    """Decades of the penalty at which all cells below the program's limit are stable, in order."""
    below = [row for row in of_type(rows, ctype, "map") if row.get("below_limit")]
    bad = {row["decade"] for row in below if row["verdict"] != VERDICTS[STABLE]}
    return sorted({row["decade"] for row in below} - bad)


def one_digit(decade):
    """The penalty at a decade, rounded to a digit: 0.3 for -0.5."""
    return f"{float(f'{10.0 ** decade:.1g}'):g}"


def smallest_penalties(by_scene):
    """The types by their smallest good penalty over K L/A, as a text for each scene."""
    texts = []
    for name, rows in by_scene.items():
        types = {}
        for ctype in sorted({row["type"] for row in rows}):
            good = good_decades(rows, ctype)
            types.setdefault(good[0] if good else np.inf, []).append(str(ctype))
        texts.append(f"{SCENES[name].title} " + ", ".join(
            f"{'none' if decade == np.inf else one_digit(decade)} "
            f"(type{'s' if len(same) > 1 else ''} {', '.join(same)})"
            for decade, same in sorted(types.items())))
    return "; ".join(texts)


def depth_table(rows, approach):
    """Deepest slave node over `approach` in cells below the program's limit that do not blow up."""
    cells = [row for row in rows if row.get("below_limit") and row["decade"] in DEPTH_DECADES
             and row["verdict"] != VERDICTS[BLOWN_UP]]
    lines = []
    for ctype in sorted({row["type"] for row in cells}):
        deepest = [max((row["depth"] for row in cells if (row["type"], row["decade"]) ==
                        (ctype, decade)), default=None) for decade in DEPTH_DECADES]
        lines.append([label(ctype), *("" if depth is None else f"{depth / approach:.2f}"
                                      for depth in deepest)])
    return markdown_table(["type", *map(one_digit, DEPTH_DECADES)], lines)


def first_failures(by_scene):
    """Smallest and largest penalty of each type for which all steps below the program's limit are
    good, by scene."""
    lines = []
    for ctype in sorted({row["type"] for rows in by_scene.values() for row in rows}):
        cells = [label(ctype)]
        for rows in by_scene.values():
            good = good_decades(rows, ctype)
            cells.append(f"1e{good[0]:+.1f} to 1e{good[-1]:+.1f}" if good else "none")
        lines.append(cells)
    return markdown_table(["type", *(SCENES[name].title for name in by_scene)], lines)


def write_maps_page(rows, doc):
    """doc/studies/stability.md and doc/pictures/stability.png."""
    names = [name for name in SCENES if any(row["scene"] == name and "verdict" in row for row in rows)]
    by_scene = {name: [row for row in rows if row["scene"] == name] for name in names}
    with styled():
        save_small(draw_maps(by_scene), doc / "pictures" / "stability.png", lines=True)
    below = [row for row in rows if row.get("below_limit")]
    bad = [row for row in below if row["verdict"] in (VERDICTS[BLOWN_UP], VERDICTS[CHATTERING])]
    times = ", ".join(f"{SCENES[name].title.lower()} {SCENES[name].end:g} s" for name in names)
    write_page(doc, "stability", PAGE.format(
        times=times, faster=FASTER, limits=limit_table(by_scene), counts=count_table(by_scene),
        ranges=first_failures(by_scene), soft=smallest_penalties(by_scene),
        depths=depth_table(by_scene.get("block", ()), SCENES["block"].approach),
        ways=f"{SCENES['block'].approach:g} m and {1e3 * SCENES['sliding'].approach:g} mm",
        n_below=len(below), n_bad=len(bad),
        **{name: getattr(measures, name) for name in (
            "ENERGY_DRIFT", "ENERGY_CREATED", "DEPTH_SIDES", "DEPTH_APPROACH", "SWINGS",
            "UNEVEN", "ENDS")}))
