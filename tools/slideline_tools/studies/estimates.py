# SPDX-License-Identifier: MIT
"""What a run says of how good its contact is, beside how good it is: estimate over error of every type and mesh.

    python -m slideline_tools.studies.estimates decks FOLDER
    python -m slideline_tools.studies.estimates page FOLDER DOC [--types ...]

`decks` writes the decks and prints their names SCENE_LEVEL; each is run with every type into FOLDER/SCENE_LEVEL_type_T
as job SCENE. The page goes to DOC/studies, its picture to DOC/pictures.
"""
import dataclasses
import functools
import importlib.util
import pathlib
import re
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.scenes import hertz, sliding
from slideline_tools.scenes.hertz import BLOCK_CELL, CYLINDER_CELL, PENALTY, RADIUS
from slideline_tools.studies import hertz as hertz_study
from slideline_tools.studies import line_contact as lines
from slideline_tools.studies import peaks
from slideline_tools.studies import sliding as sliding_study
from slideline_tools.studies.common import (colour, decks_and_page_main, label, marker, markdown_table, save_small,
                                            write_page)
from slideline_tools.studies.ironing import forces_along, ironing, roughness

VERIFICATION = pathlib.Path(__file__).resolve().parents[3] / "tests" / "verification"
LEVELS = {"hertz": (1, 2, 3), "spheres": (1, 2), "sliding": (1,), "ironing": (1, 2)}
TITLES = {"hertz": "Hertz, cylinder on block", "spheres": "Hertz, spheres", "sliding": "sliding", "ironing": "ironing"}
TOLD = re.compile(r"stress behind it differ by +([\d.E+-]+) %")
ROUGH = re.compile(r"the force is rough by +([\d.E+-]+) %")


@functools.lru_cache(maxsize=None)
def case(name):
    """The check of a verification case, as a module; `spheres` is its module of closed forms."""
    sys.path.insert(0, str(VERIFICATION))
    try:
        spec = importlib.util.spec_from_file_location(f"round_{name}", VERIFICATION / name / "check.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module
    except OSError as problem:
        raise UserError(f"cannot read {VERIFICATION / name}: {problem}") from problem
    finally:
        sys.path.remove(str(VERIFICATION))


def deck_of(scene, level):
    """Text of a deck; the type comes from the command line."""
    if scene == "hertz":
        text = hertz(level)
    elif scene == "spheres":
        text = case("hertz_spheres").pressed(5, level, False).text()
    elif scene == "sliding":
        return sliding(level)
    else:
        return ironing(5, level)
    return text.replace("*END", "*DATABASE_SLEOUT\n1.0,\n*END")


def write_decks(folder):
    """One deck for each scene and mesh; prints their names."""
    for scene, levels in LEVELS.items():
        for level in levels:
            (folder / f"{scene}_{level}.k").write_text(deck_of(scene, level), encoding="utf-8")
            print(f"{scene}_{level}")


# ---- measures ----------------------------------------------------------------------------------

@dataclasses.dataclass
class Row:
    """One run: what it tells, and what it errs by."""

    scene: str
    level: int
    ctype: int
    estimate: float
    error: float
    springs: float = np.nan     # energy of springs over that of rows
    soft_error: float = np.nan  # error against Hertz without springs
    rough: float = np.nan       # roughness as told, over the mean force


def norm_of(difference, area):
    """Root of the integral of a square over a surface."""
    return np.sqrt(np.sum(difference ** 2 * area))


def judge_line(folder, level, ctype):
    """Profile of a line contact against Hertz on the springs of the penalty, and on rigid ones."""
    nodes = last(folder, "hertz", "contact")
    x, area, pressure = nodes["x"], nodes["length"], nodes["pressure"]
    force = lines.measure(x, area, pressure).force
    half, peak = lines.hertz(force, RADIUS, hertz_study.MODULUS)
    cells = (CYLINDER_CELL / level, BLOCK_CELL / level)
    layer = lines.layer_profile(hertz_study.MODULUS / half / lines.layer_stiffness(ctype, PENALTY, *cells))
    size = norm_of(lines.ellipse(x, half, peak), area)
    return [norm_of(pressure - lines.ellipse(x, half * wide, peak * high), area) / size
            for wide, high in ((layer.half_width, layer.peak), (1.0, 1.0))]


def judge_spheres(folder, ctype):
    """The same between spheres."""
    check = case("hertz_spheres")
    nodes = last(folder, "spheres", "contact")
    r, area, pressure = nodes["x"], nodes["length"], nodes["pressure"]
    force = check.spheres.measure(r, area, pressure).force
    half, peak = check.spheres.hertz(2.0 * np.pi * force, 0.5 * check.RADIUS, check.MODULUS)
    soft = check.spheres.layer(check.MODULUS / (half * check.PENALTY * (2.0 if ctype == 3 else 1.0)))

    def profile(wide, high):
        return high * peak * np.sqrt(np.clip(1.0 - (r / (wide * half)) ** 2, 0.0, None))

    return [norm_of(pressure - profile(*factors), area) / norm_of(profile(1.0, 1.0), area)
            for factors in ((soft[0], soft[1]), (1.0, 1.0))]


def last(folder, scene, name):
    """The rows of the last instant of a table."""
    rows = read_csv(folder / f"{scene}.{name}.csv")
    if not len(rows):
        raise UserError(f"{folder}: {name} has no rows")
    return rows.where(time=rows["time"][-1])


def told(folder, scene, pattern):
    """A percentage of the log, as a share."""
    found = pattern.search((folder / f"{scene}.log").read_text(encoding="utf-8"))
    if not found:
        raise UserError(f"{folder}: the log tells no estimate")
    return float(found[1]) / 100.0


def sliding_roughness(folder, level):
    """Of the vertical force while sliding, without its trend."""
    rows = read_csv(folder / "sliding.rcforc.csv").where(side="slave")
    return peaks.abrupt_peaks(rows["time"], rows["fy"], sliding_study.WINDOW_SHARE * sliding_study.crossing_time(level),
                              sliding_study.THRESHOLD, sliding_study.judged_interval()).rms


def judge(folder, scene, level, ctype):
    """One run."""
    if scene in ("hertz", "spheres"):
        end = last(folder, scene, "sleout")
        error, soft = judge_line(folder, level, ctype) if scene == "hertz" else judge_spheres(folder, ctype)
        return Row(scene, level, ctype, float(end["estimate"][0]), error,
                   float(end["stored"][0] / end["row_energy"][0]), soft)
    if scene == "sliding":
        error = sliding_roughness(folder, level)
    else:
        error = roughness(forces_along(folder, scene)[1], level)[0]
    return Row(scene, level, ctype, told(folder, scene, TOLD), float(error), rough=told(folder, scene, ROUGH))


# ---- page --------------------------------------------------------------------------------------

def table_of(rows, scene):
    """All runs of a scene."""
    mine = [row for row in rows if row.scene == scene]
    if scene in ("hertz", "spheres"):
        return markdown_table(
            ["type", "N_r", "estimate, %", "error of the profile on springs, %", "estimate / error", "error against Hertz, %",
             "springs / rows"],
            [[label(row.ctype), row.level, 100 * row.estimate, 100 * row.error, f"{row.estimate / row.error:.2f}",
              100 * row.soft_error, f"{row.springs:.2f}"] for row in mine])
    return markdown_table(["type", "N_r", "estimate, %", "roughness as told, %", "roughness measured, %"],
                          [[label(row.ctype), row.level, 100 * row.estimate, 100 * row.rough, 100 * row.error] for row in mine])


def order_table(rows):
    """Order in the mesh of estimate and error."""
    lines_of = []
    for scene in ("hertz", "spheres"):
        for ctype in dict.fromkeys(row.ctype for row in rows):
            mine = [row for row in rows if (row.scene, row.ctype) == (scene, ctype)]
            sizes = [1.0 / row.level for row in mine]
            lines_of.append([TITLES[scene], label(ctype),
                             *(f"{hertz_study.order(sizes, values):.2f}" for values in
                               ([row.estimate for row in mine], [row.error for row in mine]))])
    return markdown_table(["scene", "type", "order of the estimate", "order of the error"], lines_of)


def chart(rows):
    """Estimate over error, a panel for each scene."""
    style = {**STYLE, "figure.dpi": 110, "savefig.dpi": 110, "lines.linewidth": 0.8}
    with plt.rc_context(style):
        figure, panels = plt.subplots(2, 2, layout="constrained", figsize=(PAGE_WIDTH + 1.0, 6.4))
        for axes, scene in zip(panels.flat, LEVELS):
            mine = [row for row in rows if row.scene == scene]
            for ctype in dict.fromkeys(row.ctype for row in mine):
                points = [(100 * row.error, 100 * row.estimate) for row in mine if row.ctype == ctype]
                axes.plot(*zip(*points), color=colour(ctype), marker=marker(ctype), markersize=5, label=label(ctype))
            reach = [100 * value for row in mine for value in (row.error, row.estimate)]
            axes.plot([min(reach), max(reach)], [min(reach), max(reach)], color="black", linewidth=0.5)
            axes.set(xscale="log", yscale="log", title=TITLES[scene], ylabel="estimate, %",
                     xlabel="error of the profile, %" if scene in ("hertz", "spheres") else "roughness of the force, %")
            axes.grid(True, which="both", linewidth=0.3, color="#bbbbbb")
        figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
        return figure


PAGE = """# How good the estimate of contact is

This page and its picture are written by `tools/batch/estimates.sh`: do not edit it.

Each interface tells how far contact pressure and the stress of the elements behind differ
([theory](../theory/contact.md#81-how-good-the-answer-is-runcontact_judging-runrows_behind)): the *estimate*, column `estimate` of sleout
and in words in the log. Here it stands beside what is wrong. N_r divides the cells of the coarsest mesh. All decks give every type the same
PEN; type 6 has 4 Gauss points (sliding: 6).

![estimate over error](../pictures/estimates.png)

The thin line is where both are the same. Points of a type are joined from mesh to mesh.

## Cylinder on block

`slideline-tools make-deck hertz`, at rest. Error: `sqrt(sum (p - q)^2 a / sum p0^2 a)` over all slave nodes, q the ellipse of Hertz for the force of the run, widened and lowered
by the springs of the penalty , p0 without them; the column after it with p0 for q, so that the softness of the penalty counts.

{hertz}

## Spheres

The deck of the verification case `hertz_spheres`, both spheres elastic; errors as above, by area.

{spheres}

## Order in the mesh

Slope of log over log.

{orders}

## Sliding and ironing

There is no closed form. The force should be smooth: roughness as [sliding](sliding.md) measures it (r.m.s. without the trend, over the mean), and as
`slideline_tools/studies/ironing.py` does for the vertical force of ironing. The estimate is that of all instants written. *As told* is the roughness of the
log, between the instants that are written (plot states and rows of sleout), which are far apart here.

{sliding}

{ironing}

{reading}
"""


READING = """## What this says

- Where there is a closed form the estimate is {least:.2f} to {most:.2f} of the error, {mean:.2f} in the geometric mean: it is no bound: the error of the profile
  is {low:.1f} to {high:.1f} times as large. Part of the error is where contact ends, which the estimate does not see: a node more or less in contact is in
  equilibrium too. On the meshes of Hertz the error itself does not fall steadily (types 1 to 5), while the estimate does.
- It falls with the mesh in {falling} of {number} cases, at an order of {order:.2f} in the mean where it does.
- What a type that fails the patch test adds on finer meshes it sees: between spheres it does not fall with types 1 and 2, while it does with the others.
- In sliding and ironing it puts smooth types before rough ones, much as the measured roughness does: the ranks of all runs with the same mesh agree with a coefficient of {ranks:.2f}
  (1: the same order). Where a type loses the soft slab (types 1 and 2 in ironing) it says so in tens of per cent.
- *As told*, roughness between outputs counts what the force really does between them too. It compares types at the same interval of output and says nothing by itself.
"""


def rank_agreement(pairs):
    """Spearman's coefficient of pairs of figures."""
    first, second = (np.argsort(np.argsort(column)) for column in zip(*pairs))
    return float(np.corrcoef(first, second)[0, 1])


def reading(rows):
    """What the figures say, with the figures."""
    closed = [row for row in rows if row.scene in ("hertz", "spheres")]
    shares = np.array([row.estimate / row.error for row in closed])
    orders = []
    for scene, ctype in dict.fromkeys((row.scene, row.ctype) for row in closed):
        mine = [row for row in closed if (row.scene, row.ctype) == (scene, ctype)]
        orders.append(hertz_study.order([1.0 / row.level for row in mine], [row.estimate for row in mine]))
    falling = [one for one in orders if one > 0.0]
    ranks = [rank_agreement([(row.estimate, row.error) for row in rows if (row.scene, row.level) == which])
             for which in dict.fromkeys((row.scene, row.level) for row in rows if row not in closed)]
    return READING.format(least=shares.min(), most=shares.max(), mean=float(np.exp(np.log(shares).mean())),
                          low=1.0 / shares.max(), high=1.0 / shares.min(),
                          falling=len(falling), number=len(orders), order=float(np.mean(falling)),
                          ranks=float(np.mean(ranks)))


def write(folder, doc, types):
    """Read the runs below `folder`, write page and picture."""
    rows = [judge(folder / f"{scene}_{level}_type_{ctype}", scene, level, ctype)
            for scene, levels in LEVELS.items() for ctype in types for level in levels]
    save_small(chart(rows), doc / "pictures" / "estimates.png", lines=True)
    write_page(doc, "estimates", PAGE.format(orders=order_table(rows), reading=reading(rows),
                                             **{scene: table_of(rows, scene) for scene in LEVELS}).rstrip() + "\n")


def main(arguments=None):
    return decks_and_page_main(__doc__, write_decks, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
