# SPDX-License-Identifier: MIT
"""Stability maps: what becomes of each type, and of implicit penalty, over penalty and step.

The penalty is given over the stiffness K L/A of the elements behind the interface (PUNIT 2,
PUNIT 4), the step over the smallest L/c of the elements (TSSFAC, a constant step being refused
above it).
"""
import itertools
import re

import numpy as np
import pandas as pd
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES, IMPLICIT, in_order
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import label, markdown_table, page_of, save_small
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.rules import between
from slideline_tools.studies.stability.measures import BLOWN_UP, CHATTERING, STABLE, VERDICTS, measure_cell
from slideline_tools.studies.stability.scenes import SCENES

NO_COMPLIANCE = 5.0  # decade at which PEN below 0 (PUNIT 4) is drawn
CELL = ["scene", "type"]
LIMITS = {  # name of the column: text and line
    "true_limit": ("limit by eigenvalue", "-"), "program_limit": ("limit of the program", "--"),
    "spring_limit": ("contact springs: omega dt = 2", ":"),
    "opening_limit": ("contact springs: omega dt = 1", "-.")}
FILLS = ("#d9ead3", "#f6b26b", "#9fc5e8", "#ffe599", "#b4a7d6", "#cc4125")
DECADES = np.arange(-2.0, 4.01, 0.5)  # log10 of penalty over K L/A; the quick study has those that are a multiple of 2
STEPS = (0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0, 1.2, 1.5)  # over L/c
QUICK_STEPS = (0.2, 0.7, 1.2)
IMPLICIT_STEPS = (*STEPS[:6], 0.995, *STEPS[7:])  # below L/c, where elements themselves are stable
QUICK_IMPLICIT_STEPS = (0.2, 0.995, 1.2)
STOCK = 0.1          # SLSFAC: PUNIT 2 multiplies K L/A by it
NO_CURVE = 1.0e3     # s: a constant step that no element allows
RULE = "*CONTROL_CONTACT\n\n0,0,0,0,0,0,2\n*CONTROL_ENERGY"  # ECDT 2: the log tells the limit
LIMIT_TIME = 1.0e-9  # s: one cycle
PATIENCE = 120.0     # s for a run
IN_LOG = (r"per slave node = (\S+)", r"smallest L/c of the elements (\S+)", r"stable step of elements and contact springs (\S+)")


def jobs(options):
    """Each scene and type over penalties and steps, and a cycle a penalty for the limit, which
    implicit penalty has none of."""
    listed = []
    names = [name for name in SCENES if not (options.quick and name == "sliding")]
    for name, ctype in itertools.product(names, options.types):
        scene, is_implicit = SCENES[name], ctype == IMPLICIT
        deck = scene.deck(7 if is_implicit else ctype)
        steps = ((QUICK_IMPLICIT_STEPS if is_implicit else QUICK_STEPS) if options.quick else
                 IMPLICIT_STEPS if is_implicit else STEPS)
        for decade in (*DECADES[::4 if options.quick else 1], *[NO_COMPLIANCE] * is_implicit):
            words = (*penalty_words(ctype, decade), f"dt={NO_CURVE:g}", "ncpu=1",
                     *scene.options)
            stem = f"{name}_type_{ctype}_pen_" + (
                "none" if decade == NO_COMPLIANCE else f"1e{decade:+.1f}")
            labels = {"scene": name, "type": ctype, "decade": float(decade)}
            if decade == int(decade) and not is_implicit:
                listed.append(Job(
                    f"{stem}_limit", deck.replace("*CONTROL_ENERGY", RULE), name,
                    (*words, "tssfac=1", f"endtim={LIMIT_TIME:g}"), {**labels, "kind": "limit"},
                    cost=0.1))
            listed += [Job(f"{stem}_dt_{step:g}", deck, name,
                           (*words, f"tssfac={step:g}", f"endtim={scene.end:g}"),
                           {**labels, "kind": "map", "step": step}, cost=0.2 / step, limit=PATIENCE)
                       for step in steps]
    return listed


def penalty_words(ctype, decade):
    """Type and penalty on the command line; PEN below 0 has no compliance."""
    if ctype == IMPLICIT:
        pen = -1.0 if decade == NO_COMPLIANCE else 10.0 ** decade
        return ("ctype=7", "punit=4", f"p:pen={pen:.10g}")
    return (f"ctype={ctype}", "punit=2", f"pen={10.0 ** decade / STOCK:.10g}")


def measure(job, folder):
    """The verdict of a run, or the limit that the program found."""
    if job.labels["kind"] == "map":
        return measure_cell(folder, job.jobid, SCENES[job.labels["scene"]])
    log = (folder / f"{job.jobid}.log").read_text(encoding="utf-8")
    found = [re.search(pattern, log) for pattern in IN_LOG]
    if not all(found):
        raise UserError("no limits in the log")
    penalty, element_limit, joint = (float(match[1]) for match in found)
    return {"penalty": penalty, "element_limit": element_limit, "program_limit": joint / element_limit}


def derive(table, _folder):
    """With the limits by eigenvalue over L/c, and which cells lie below the program's limit."""
    return with_below(with_limits(table))


def with_limits(table):
    """`true_limit` of all that stays closed, `spring_limit` = 2/omega of the springs alone,
    `opening_limit`, half of it, for springs that open and close, and `both_limits`, the smaller."""
    known = table[table["penalty"].notna()]
    for column, with_elements in (("true_limit", True), ("spring_limit", False)):
        limits = [SCENES[row.scene].limit(row.type, row.penalty, with_elements) / row.element_limit
                  for row in known.itertuples()]
        table.loc[known.index, column] = limits
    table["opening_limit"] = 0.5 * table["spring_limit"]
    table["both_limits"] = table[["true_limit", "opening_limit"]].min(axis=1)
    return table


def with_below(table):
    """`below_limit`: the step lies below the program's limit for that penalty, which is L/c with
    PUNIT 4; missing where the limit is not known."""
    for (_, ctype), rows in table.groupby(["scene", "type"], sort=False):
        cells = rows[rows["kind"] == "map"]
        limits = rows.set_index("decade")["program_limit"].dropna().sort_index()
        if ctype == IMPLICIT:
            table.loc[cells.index, "below_limit"] = cells["step"] < 1.0
        elif len(limits):
            bound = np.interp(cells["decade"], limits.index, limits)
            table.loc[cells.index, "below_limit"] = cells["step"] < bound
    return table


def cells_of(table):
    """The cells of the maps that have a verdict."""
    return table[(table["kind"] == "map") & table["verdict"].notna()]


def below(table):
    """Those below the program's limit."""
    cells = cells_of(table)
    return cells[cells["below_limit"].astype(bool)]


# ---- maps --------------------------------------------------------------------------------------

def draw_panel(axes, rows, ctype):
    """One map: cells by verdict, and the limits."""
    mine = rows[rows["type"] == ctype]
    verdicts = cells_of(mine).pivot(index="step", columns="decade", values="verdict").map(
        dict(zip(VERDICTS, range(len(VERDICTS)))).get)
    decades, steps = verdicts.columns.to_numpy(), verdicts.index.to_numpy()
    count = int(np.sum(decades < NO_COMPLIANCE))
    half = 0.5 * (decades[1] - decades[0]) if count > 1 else 0.5
    left, right = decades[0] - half, decades[count - 1] + half
    draw_cells(axes, verdicts.iloc[:, :count], left, right)
    if count < len(decades):  # apart from the others, as wide as one of them
        draw_cells(axes, verdicts.iloc[:, count:], right + 0.5 * half, right + 2.5 * half)
        even = decades[:count][decades[:count] % 2.0 == 0.0]
        axes.set_xticks([*even, right + 1.5 * half], [*(f"{x:g}" for x in even), "<0"])
        axes.set_xlim(left, right + 2.5 * half)
    for name, (_, line) in LIMITS.items():
        draw_limit(axes, mine, name, line, steps)
    axes.set_yticks(range(len(steps)), [f"{step:g}" for step in steps], fontsize=5.5)
    axes.tick_params(axis="x", labelsize=6)
    axes.grid(False)


def draw_cells(axes, verdicts, left, right):
    """Cells side by side between two places of the axis."""
    axes.imshow(np.ma.masked_invalid(verdicts.to_numpy(dtype=float)), origin="lower",
                aspect="auto", interpolation="nearest", cmap=ListedColormap(FILLS),
                norm=BoundaryNorm(np.arange(len(VERDICTS) + 1) - 0.5, len(VERDICTS)),
                extent=(left, right, -0.5, len(verdicts) - 0.5))


def draw_limit(axes, rows, name, line, steps):
    """One limit over the penalty, straight between the penalties that have it."""
    limits = rows.set_index("decade")[name].dropna().sort_index() if name in rows else ()
    if len(limits):
        x = np.linspace(limits.index[0], limits.index[-1], 100)
        level = np.exp(np.interp(x, limits.index, np.log(limits)))
        axes.plot(x, np.interp(level, steps, np.arange(len(steps)), left=np.nan), line,
                  color="black", lw=1.0)


def draw_maps(table):
    """All types in columns, scenes in rows."""
    cells = cells_of(table)
    types, names = in_order(cells["type"]), [name for name in SCENES if name in set(cells["scene"])]
    figure, panels = plt.subplots(len(names), len(types), squeeze=False, sharex="col",
                                  figsize=(PAGE_WIDTH + 2.5, 1.9 * len(names) + 0.6),
                                  layout="constrained")
    for line, name in zip(panels, names):
        for axes, ctype in zip(line, types):
            draw_panel(axes, table[table["scene"] == name], ctype)
            axes.set_title(label(ctype), fontsize=7)
            if ctype == IMPLICIT and axes is not line[0]:
                axes.yaxis.tick_right()  # its steps are others
            elif axes is not line[0]:
                axes.set_yticklabels([])
        line[0].set_ylabel(f"{SCENES[name].title}: step over L/c", fontsize=7)
    figure.supxlabel("log10 of penalty over K L/A of the elements", fontsize=8)
    handles = [Patch(color=fill, label=name) for fill, name in zip(FILLS, VERDICTS)]
    handles += [plt.Line2D([], [], label=text, linestyle=line, color="black")
                for text, line in LIMITS.values()]
    figure.legend(handles=handles, loc="outside upper center", ncols=5, fontsize=6)
    return figure


def chart(table, folder):
    """The maps of all scenes."""
    with plt.rc_context(STYLE):
        save_small(draw_maps(table), folder / "stability.png", lines=True)


# ---- tables ------------------------------------------------------------------------------------

def by_type(values):
    """A table of the texts of (scene, type): types in rows, scenes in columns."""
    table = values.unstack("scene")
    table = table.reindex(index=in_order(table.index),
                          columns=[name for name in SCENES if name in table])
    titles = {name: scene.title for name, scene in SCENES.items()}
    return markdown_table(table.rename(index=label, columns=titles).reset_index(names="type"))


def limit_table(table):
    """Program's limit over that by eigenvalues, smallest to largest over all penalties."""
    ratios = (table["program_limit"] / table["both_limits"]).dropna()
    return by_type(ratios.groupby([table[name] for name in CELL]).agg(between))


def verdict_table(table):
    """How many cells below the program's limit have each verdict."""
    cells = below(table)
    counts = pd.crosstab([cells["scene"], cells["type"].map(label)], cells["verdict"])
    return markdown_table(counts.reindex(columns=list(VERDICTS), fill_value=0).reset_index())


def good_penalties(table):
    """Smallest and largest penalty of (scene, type) with all cells below the limit stable."""
    cells = below(table)
    stable = cells["verdict"] == STABLE
    good = stable.groupby([cells[name] for name in [*CELL, "decade"]]).all().reset_index()
    return good.groupby(CELL)[["decade", "verdict"]].apply(
        lambda rows: range_text(rows.loc[rows["verdict"], "decade"]))


def range_text(decades):
    """'1e-0.5 to no compliance', or 'none'."""
    texts = ["no compliance" if decade == NO_COMPLIANCE else f"1e{decade:+.1f}"
             for decade in sorted(decades)]
    return f"{texts[0]} to {texts[-1]}" if texts else "none"


def depth_table(table):
    """Deepest slave node of the blocks, over the way, in cells that do not blow up."""
    cells = below(table)
    cells = cells[(cells["scene"] == "block") & (cells["verdict"] != BLOWN_UP)]
    depths = cells["depth"] / SCENES["block"].approach
    found = depths.groupby([cells["type"], cells["decade"]]).max().map("{:.2f}".format)
    table = found.unstack(fill_value="").reindex(in_order(found.index.levels[0]))
    return markdown_table(table.rename(index=label, columns="1e{:+.1f}".format).reset_index())


def page(table):
    """Text of DOC/studies/stability.md."""
    cells = below(table[table["type"] != IMPLICIT])
    bad = cells["verdict"].isin([BLOWN_UP, CHATTERING])
    return page_of(
        "# Where each type is stable", "![Stability maps](../pictures/stability.png)",
        "## Limit of the program over the smaller of those by eigenvalues", limit_table(table),
        "## Verdicts below the program's limit", f"Of {len(cells)} cells of the types by number {bad.sum()} blew up or chattered.",
        verdict_table(table),
        "## Penalties over K L/A, as powers of ten, at which all steps below the limit are stable", by_type(good_penalties(table)),
        "## Deepest slave node over the way that the bodies are driven, below the limit, by penalty", depth_table(table))


STUDY = Study("stability", jobs, measure, chart, derive, page, types=(*ALL_TYPES, IMPLICIT))
