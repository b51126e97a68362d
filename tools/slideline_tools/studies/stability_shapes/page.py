# SPDX-License-Identifier: MIT
"""Picture and page of the study of shapes."""
import itertools
import textwrap

from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.studies.common import label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import styled
from slideline_tools.studies.stability.measures import VERDICTS
from slideline_tools.studies.stability.page import FILLS

TWO_PASS = 3

#: sweeps of shapes alone, and what they are with the least and the largest of their values
SHAPES = {"ratio": "mesh ratios from {:g} to {:g} at one stiffness", "ratio_punit3": "mesh ratios from {:g} to {:g} with PUNIT 3",
          "turn": "the whole scene turned by up to {1:g} degrees", "tilt": "a corner first at {:g} to {:g} degrees",
          "speed": "slave nodes that cross master nodes at {:g} to {:g} times the wave speed"}


def draw_shapes(rows, sweeps):
    """One panel: a line for each sweep, a column for each type; the worst verdict, and the values that are not stable."""
    rows = [row for row in rows if "verdict" in row]
    names = [name for name in sweeps if any(row["sweep"] == name for row in rows)]
    types = sorted({row["type"] for row in rows})
    figure, axes = plt.subplots(layout="constrained", figsize=(PAGE_WIDTH + 1.0, 0.34 * len(names) + 0.9))
    for (i, name), (k, ctype) in itertools.product(enumerate(names), enumerate(types)):
        cells = [row for row in rows if row["sweep"] == name and row["type"] == ctype]
        if not cells:
            continue
        worst = max(VERDICTS.index(row["verdict"]) for row in cells)
        axes.add_patch(plt.Rectangle((k - 0.5, i - 0.5), 1.0, 1.0, facecolor=FILLS[worst], edgecolor="white"))
        failed = sorted(row["value"] for row in cells if row["verdict"] != VERDICTS[0])
        axes.text(k, i, "\n".join(textwrap.wrap(", ".join(f"{value:g}" for value in failed), 14)), fontsize=6,
                  ha="center", va="center", color="white" if worst == len(VERDICTS) - 1 else "black")
    axes.set(xlim=(-0.5, len(types) - 0.5), ylim=(len(names) - 0.5, -0.5))
    axes.set_xticks(range(len(types)), [label(ctype).replace(" ", "\n", 1) for ctype in types], fontsize=7)
    axes.set_yticks(range(len(names)), [f"{sweeps[name][0]}\n{values_text(rows, name)}" for name in names], fontsize=7)
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.grid(False)
    there = {row["verdict"] for row in rows}
    figure.legend(handles=[plt.Rectangle((0, 0), 1, 1, color=fill, label=name) for fill, name in zip(FILLS, VERDICTS)
                           if name in there], loc="outside lower center", ncols=5, fontsize=7,
                  title="worst of all values; those that are not stable are written in the cell", title_fontsize=7)
    return figure


def values_text(rows, name):
    """How many values a sweep has, and from where to where."""
    values = sorted({row["value"] for row in rows if row["sweep"] == name})
    return f"{len(values)} values from {values[0]:g} to {values[-1]:g}"


def value_table(rows, name, column, scale=1.0):
    """One measure by type and value."""
    chosen = [row for row in rows if row["sweep"] == name and column in row]
    values, types = (sorted({row[key] for row in chosen}) for key in ("value", "type"))
    found = {(row["type"], row["value"]): row for row in chosen}
    lines = [[label(ctype), *(f"{scale * found[ctype, value][column] + 0.0:.3g}"  # no -0
                              + ("" if found[ctype, value]["verdict"] == VERDICTS[0] else " *")
                              if (ctype, value) in found else "" for value in values)]
             for ctype in types]
    return markdown_table(["type", *(f"{value:g}" for value in values)], lines)


def failures(rows):
    """Every cell that is not stable."""
    bad = [row for row in rows if row.get("verdict", VERDICTS[0]) != VERDICTS[0]]
    if not bad:
        return "No cell failed."
    lines = [[row["sweep"], f"{row['value']:g}", label(row["type"]), row["verdict"],
              f"{row['drift']:.2g}", f"{row['depth']:.2g}", row.get("message", "")] for row in bad]
    return markdown_table(["sweep", "value", "type", "verdict", "energy drift", "depth, m",
                           "message"], lines)


PAGE = """# What breaks a contact that penalty and step allow

This page and its picture are written by `tools/study.sh stability-shapes --publish`: do not edit them.

A block of 1 m x 0.5 m flies at 3 % of the wave speed onto a larger one that is fixed below. Penalty and step lie inside the stable region by the program's own means: `PUNIT 3` with half of the
largest stable penalty, `TSSFAC` 0.8 (but for the mesh ratio, below). One thing is varied at a time, for every type. Verdicts as in [stability](stability.md); what fails here, fails for its shape.

![Worst verdict by sweep and type, and the values that are not stable](../pictures/stability_shapes.png)

## Read in words

{shapes}
{overhangs}
- *Hourglass coefficient* (stiffness form). The hourglass mode alone needs `dt < L/(c sqrt(2 Q_h))`, 0.71 `L/c` at 1.0, and TSSFAC is 0.8. The
  stable step counts it (`../theory/elements.md`), at 1.0 the step is 0.57 `L/c`, and the program warns that it falls.
{meshes}
- *Turned* scenes agree in every digit shown.

## What failed

{failures}

## Impulse

Impulse on the block by mesh ratio, slave segments per master segment (N s/m): its change of momentum, as `matsum` has it. A star marks a
cell that is not stable. Interface of one stiffness, all runs with the step of the finest mesh:

{ratio}

Kinetic and strain energy of both bodies at the end, less that of the rebound, over the energy of the flight, per cent:

{ratio_vibration}

The same with the penalty of `PUNIT 3`, impulse and vibration:

{ratio_punit3}

{ratio_punit3_vibration}

Turned with its mesh the scene is the same scene:

{turn}

## Roughness

Rises of the contact force over its largest value: 1 is one push, more is rattling. Slave nodes crossing master nodes at growing speed:

{speed}

Corner first:

{tilt}

## Overhang

Energy made by the contact forces over the whole energy, per cent, by overhang in slave elements:

{overhang}

## Hourglass coefficient and refinement

Hourglass energy at the end over the whole energy, per cent.

{hourglass}
"""


def span(rows, name, column):
    """(least, largest) of a measure in a sweep; None where it has not run."""
    found = [row[column] for row in rows if row["sweep"] == name and column in row]
    return (min(found), max(found)) if found else None


def judged(rows, names):
    """(cells with a verdict, how many of them are stable in words) of some sweeps."""
    cells = [row for row in rows if row["sweep"] in names and "verdict" in row]
    n_bad = sum(row["verdict"] != VERDICTS[0] for row in cells)
    return cells, f"{n_bad} of {len(cells)} cells are not stable" if n_bad else f"all {len(cells)} cells are stable"


def shape_text(rows):
    """Whether meshes, angles, corners and speeds break a contact inside the stable region."""
    parts = []
    for name, words in SHAPES.items():
        found = span(rows, name, "value")
        if found:
            parts.append(words.format(*found))
    return "- *Shapes*: " + ", ".join(parts or ["not tried"]) + f": {judged(rows, SHAPES)[1]}."


def overhang_text(rows):
    """What a place beyond an end does, and how much energy it makes."""
    text = ("- *Overhang.* A place that carries a whole spring (a slave node in types 1 to 3, a virtual node in type 4, a Gauss point in type 6) and stands "
            "just beyond the end of the other surface sinks beside it without a spring. When the block spreads and draws together again it comes in over "
            "the end and is caught as deep as it is then, with no work done. What an interface returns is limited by what it was given "
            "([theory](../theory/contact.md), 6.1).")
    cells, outcome = judged(rows, ("overhang",))
    if cells:
        most = max(cells, key=lambda row: row["created"])
        text += (f" Here {outcome}, and contact forces make at most {100.0 * most['created']:.2g} % of the energy "
                 f"({label(most['type'])}, overhang {most['value']:g}).")
    cells = judged(rows, ("overhang_srch",))[0]
    if cells:
        text += (f" With a limit of a tenth for first contacts (*overhang, SRCH a tenth of its default*) it is at most "
                 f"{100.0 * max(row['created'] for row in cells):.2g} %.")
    return text + " The program warns at the start and names node, end and SRCH."


def mesh_text(rows):
    """What the mesh ratio changes at one stiffness, and what stiffness changes."""
    text, impulse = "- *Mesh ratio.*", span(rows, "ratio", "impulse")
    if impulse:
        low, high = span(rows, "ratio", "stiffness")
        text += (f" At one stiffness of the interface ({high:.3g} N/m^2, in type 3 {low:.3g} in each pass) the impulses of all ratios and types "
                 f"lie within {100.0 * (impulse[1] / impulse[0] - 1.0):.1f} % of each other, {impulse[0]:.0f} to {impulse[1]:.0f} N s/m, "
                 f"and at most {100.0 * span(rows, 'ratio', 'vibration')[1]:.1f} % of the energy of the flight is left in vibration of the two bodies.")
    impulse = span(rows, "ratio_punit3", "impulse")
    if impulse:
        low, high = span([row for row in rows if row["type"] != TWO_PASS], "ratio_punit3", "stiffness")
        text += (f" `PUNIT 3` makes the interface up to {high / low:.0f} times as stiff on one mesh as on another (types other than 3); a stiffer "
                 f"contact leaves more vibration, up to {100.0 * span(rows, 'ratio_punit3', 'vibration')[1]:.1f} %, and what swings does not "
                 f"fly back: the impulse is then {impulse[0]:.0f} to {impulse[1]:.0f} N s/m. That is the penalty, not the mesh ratio.")
    return text


def write_shapes_page(rows, sweeps, doc):
    """doc/studies/stability_shapes.md and its picture."""
    with styled():
        save_small(draw_shapes(rows, sweeps), doc / "pictures" / "stability_shapes.png", lines=True)
    tables = {"ratio": "impulse", "ratio_punit3": "impulse", "turn": "impulse", "speed": "roughness", "tilt": "roughness",
              "overhang": "created"}
    texts = {name: value_table(rows, name, column, 100.0 if column == "created" else 1.0)
             for name, column in tables.items()}
    texts.update({f"{name}_vibration": value_table(rows, name, "vibration", 100.0)
                  for name in ("ratio", "ratio_punit3")})
    hourglass = "\n\n".join(f"Refinement {name.split('_')[1]}:\n\n"
                            + value_table(rows, name, "hourglass", 100.0)
                            for name in sweeps if name.startswith("hourglass"))
    write_page(doc, "stability_shapes", PAGE.format(
        failures=failures(rows), hourglass=hourglass, meshes=mesh_text(rows), shapes=shape_text(rows),
        overhangs=overhang_text(rows), **texts))
