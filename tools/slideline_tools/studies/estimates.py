# SPDX-License-Identifier: MIT
"""How good the estimate of contact is: what a run tells, beside what it errs by, for every type and mesh.

Contact of a cylinder with a block and of two spheres has closed forms; for sliding and ironing, which have none, the
roughness of the force stands for the error.
"""
import re

import numpy as np
import pandas as pd

from slideline_tools import UserError
from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.scenes import hertz, sliding
from slideline_tools.scenes.hertz import BLOCK_CELL, CYLINDER_CELL, PENALTY, RADIUS
from slideline_tools.studies import sliding as sliding_study
from slideline_tools.studies.common import colour, label, markdown_table, marker, save_small, verification
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.rules import geometric_mean
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.hertz import MODULUS, lines, order

LEVELS = {"hertz": (1, 2, 3), "spheres": (1, 2), "sliding": (1,), "ironing": (1, 2)}
TITLES = {"hertz": "cylinder on block", "spheres": "spheres", "sliding": "sliding", "ironing": "ironing"}
CLOSED = ("hertz", "spheres")
#: Ironing: UNITs of the ways down and along, way along, the part of it that is judged; the deck of the verification case.
PRESS, DRAW, ALONG, JUDGED = 150.0, 240.0, 4.0, (1.0, 3.9)
REPORTED = re.compile(r"stress behind it differ by +([\d.E+-]+) %")


def deck_of(scene, level):
    """Text of a deck; the type comes from the command line."""
    if scene == "sliding":
        return sliding(level)
    every = 1.0
    if scene == "ironing":
        case = verification("ironing")
        text = case.ironing(5, PRESS, DRAW, penalty=1.0e10 * level, level=level, reach=ALONG).text()
        every = (PRESS + DRAW) * case.UNIT / 500.0
    else:
        text = hertz(level) if scene == "hertz" else verification("hertz_spheres").pressed(5, level, False).text()
    return text.replace("*END", f"*DATABASE_SLEOUT\n{every:.17g},\n*END")


def jobs(options):
    """Every scene, mesh and type; the quick study has the coarsest mesh of the closed forms alone."""
    listed = []
    for scene in CLOSED if options.quick else LEVELS:
        for level in (level for level in LEVELS[scene] if level in options.levels):
            deck = deck_of(scene, level)
            listed += [Job(f"{scene}_{level}_type_{ctype}", deck, scene, (f"ctype={ctype}", "ncpu=1"),
                           {"scene": scene, "level": level, "type": ctype}, cost=level ** 3)
                       for ctype in options.types]
    return listed


# ---- measures ----------------------------------------------------------------------------------

def measure(job, folder):
    """`estimate` and `error`, as shares of one."""
    scene, level, ctype = (job.labels[name] for name in ("scene", "level", "type"))
    if scene in CLOSED:
        error = line_error(folder, level, ctype) if scene == "hertz" else sphere_error(folder, ctype)
        return {"estimate": float(last(folder / f"{scene}.sleout.csv")["estimate"][0]), "error": error}
    found = REPORTED.search((folder / f"{scene}.log").read_text(encoding="utf-8"))
    if not found:
        raise UserError(f"{folder}: the log tells no estimate")
    if scene == "sliding":
        error = sliding_study.force_peaks(*sliding_study.vertical_force(folder), level).rms
    else:
        error = ironing_roughness(folder, level)
    return {"estimate": float(found[1]) / 100.0, "error": float(error)}


def last(path):
    """The rows of the last instant of a table."""
    rows = read_csv(path)
    if not len(rows):
        raise UserError(f"{path} has no rows")
    return rows.where(time=rows["time"][-1])


def distance(pressure, exact, size, area):
    """Root of the integral of the squared difference over a surface, over that of `size`."""
    return float(np.sqrt(np.sum((pressure - exact) ** 2 * area) / np.sum(size ** 2 * area)))


def line_contact(folder, level, ctype):
    """Nodes at rest; half width and peak of Hertz for their force, and by what the springs of the penalty change both."""
    nodes = last(folder / "hertz.contact.csv")
    half, peak = lines.hertz(lines.measure(nodes["x"], nodes["length"], nodes["pressure"]).force, RADIUS, MODULUS)
    stiffness = lines.layer_stiffness(ctype, PENALTY, CYLINDER_CELL / level, BLOCK_CELL / level)
    return nodes, half, peak, lines.layer_profile(MODULUS / half / stiffness)


def line_error(folder, level, ctype):
    """Profile of a line contact against Hertz on the springs of the penalty."""
    nodes, half, peak, layer = line_contact(folder, level, ctype)
    return distance(nodes["pressure"], lines.ellipse(nodes["x"], half * layer.half_width, peak * layer.peak),
                    lines.ellipse(nodes["x"], half, peak), nodes["length"])


def sphere_error(folder, ctype):
    """The same between spheres."""
    check = verification("hertz_spheres")
    nodes = last(folder / "spheres.contact.csv")
    r, area, pressure = nodes["x"], nodes["length"], nodes["pressure"]
    force = check.spheres.measure(r, area, pressure).force
    half, peak = check.spheres.hertz(2.0 * np.pi * force, 0.5 * check.RADIUS, check.MODULUS)
    wide, high = check.spheres.layer(check.MODULUS / (half * check.PENALTY * (2.0 if ctype == 3 else 1.0)))[:2]
    return distance(pressure, lines.ellipse(r, half * wide, peak * high), lines.ellipse(r, half, peak), area)


def ironing_roughness(folder, level):
    """Of the vertical force along the slab."""
    case = verification("ironing")
    force = read_csv(folder / "ironing.rcforc.csv").where(side="slave")
    way = ALONG * (force["time"] / case.UNIT - PRESS) / DRAW
    if way[-1] < JUDGED[1]:
        raise UserError(f"{folder}: ended before the way did")
    keep = (way >= JUDGED[0]) & (way <= JUDGED[1])
    return case.roughness(way[keep], force["fy"][keep], cell=0.2 / level)


# ---- picture and page --------------------------------------------------------------------------

def chart(table, folder):
    """Estimate over error, a panel for each scene."""
    runs = finished(table)
    with plt.rc_context({**STYLE, "figure.dpi": 110, "savefig.dpi": 110, "lines.linewidth": 0.8}):
        figure, panels = plt.subplots(2, 2, layout="constrained", figsize=(PAGE_WIDTH + 1.0, 6.4))
        for axes, scene in zip(panels.flat, LEVELS):
            mine = 100.0 * runs[runs["scene"] == scene].set_index("type")[["error", "estimate"]]
            for ctype in dict.fromkeys(mine.index):
                axes.plot(*mine.loc[[ctype]].to_numpy().T, color=colour(ctype), marker=marker(ctype), markersize=5,
                          label=label(ctype))
            if len(mine):
                reach = [mine.to_numpy().min(), mine.to_numpy().max()]
                axes.plot(reach, reach, color="black", linewidth=0.5)
            axes.set(xscale="log", yscale="log", title=TITLES[scene], ylabel="estimate, %",
                     xlabel="error of the profile, %" if scene in CLOSED else "roughness of the force, %")
            axes.grid(True, which="both")
        figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
        save_small(figure, folder / "estimates.png", lines=True)


PAGE = """# How good the estimate of contact is

Tables of `tools/study.sh estimates`: the [estimate](../theory/contact.md#81-how-good-the-answer-is-runerror_indicator-runface_stress),
of sliding and ironing that of all instants written. N_r divides the cells of the coarsest mesh. All types have the same PEN.

![estimate over error](../pictures/estimates.png)

The thin line is where both are the same. Error of a cylinder on a block and of spheres (decks of `make-deck hertz` and of
`tests/verification/hertz_spheres`): `sqrt(sum (p - q)^2 a / sum p0^2 a)` over all slave nodes, q the ellipse of Hertz for the force of
the run, widened and lowered by the springs of the penalty, p0 without them. Of sliding and ironing: standard deviation of the
vertical force from its trend, over its mean.

Estimates, %:

{estimates}

Errors, %:

{errors}

{reading}
"""


def table_of(runs, name):
    """A column of every run in per cent: types in rows, scenes and meshes in columns."""
    wide = 100.0 * runs.pivot(index="type", columns=["scene", "level"], values=name)
    wide.columns = [f"{TITLES[scene]}, N_r {level}" for scene, level in wide.columns]
    return markdown_table(wide.reset_index().assign(type=[label(ctype) for ctype in wide.index]))


def reading(runs):
    """Estimate over error, order of the estimate in the mesh, agreement of the ranks, in words."""
    closed, others = (runs[runs["scene"].isin(CLOSED) == flag] for flag in (True, False))
    over = closed["error"] / closed["estimate"]
    orders = pd.Series([order(1.0 / same["level"], same["estimate"]) for _, same in closed.groupby(["scene", "type"])],
                       dtype=float).dropna()
    ranks = [same["estimate"].rank().corr(same["error"].rank()) for _, same in others.groupby(["scene", "level"])]
    words = ((over, f"With a closed form the error is {over.min():.1f} to {over.max():.1f} times the estimate, "
              f"{geometric_mean(over):.1f} times in the geometric mean."),
             (orders, f"The estimate falls with the mesh in {(orders > 0.0).sum()} of {len(orders)} cases, at an order of "
              f"{orders[orders > 0.0].mean():.2f} in the mean where it does."),
             (ranks, "In sliding and ironing the ranks of estimate and roughness on one mesh agree with a coefficient of "
              f"{np.sum(ranks) / max(len(ranks), 1):.2f} (1: the same order)."))
    return "\n".join(f"- {text}" for figures, text in words if len(figures))


def page(table):
    """Text of DOC/studies/estimates.md."""
    runs = finished(table)
    return PAGE.format(estimates=table_of(runs, "estimate"), errors=table_of(runs, "error"), reading=reading(runs))


STUDY = Study("estimates", jobs, measure, chart, page=page, levels=(1, 2, 3), types=ALL_TYPES)
