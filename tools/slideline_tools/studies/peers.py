# SPDX-License-Identifier: MIT
"""The page doc/studies/peers.md, from the tables of tests/lab/bench/peers/run.sh.

    python -m slideline_tools.studies.peers FOLDER DOC

FOLDER holds elements.csv, collision.csv, contact.csv and versions.txt, and counts.csv where instructions could be counted.
"""
import csv
import math
import pathlib
import statistics
import sys

import pandas as pd

from slideline_tools import UserError
from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.studies.common import markdown_table, page_main, save_small, write_page
from slideline_tools.studies.framework.charts import styled
from slideline_tools.studies.framework.counted import who_counted
from slideline_tools.studies.framework.runner import processor
from slideline_tools.studies.framework.table import COUNTED

PEERS = ("akantu", "KratosMultiphysics", "KratosStructuralMechanicsApplication", "KratosContactStructuralMechanicsApplication",
         "CalculiX")
SOURCE_ALONE = "OpenRadioss"  # comes as source alone
NOT_BUILT = ("OpenRadioss is not in. It comes as source alone, two programs of some 5,700 files and libraries besides, and in no package of "
             "the distribution or of PyPI; it was not built.")
BUILT = ("OpenRadioss comes as source alone and was built for this page: {}. Its plane-strain quads have one point or 2x2 points, large strain; "
         "its time is that of its engine alone, as slideline's (what 20 times as many steps take more). Its contact is INTER/TYPE5: the "
         "nodes of one side on the surface of the other.")

PAGE = """# Side by side with other programs

This page is written by `tests/lab/bench/peers/run.sh --publish`: do not edit it. All programs run in turn on one machine,
one thread each; times are medians of {rounds}, with the quartiles in brackets. Processor time is what counts: the machine may be shared.

| program | version | from |
|---|---|---|
{versions}

{processor}, 1 thread. The times of Akantu and Kratos are those of their released wheels, built for any x86-64 processor;
slideline is {built}. Akantu and Kratos are driven from Python. The ratios are those of these builds and elements.

*K* is the fixed yardstick of [speed](speed.md), the arithmetic of one step of a plastic one-point quad. It was measured before and behind each
run ({yardstick}); times over K are medians of these ratios, and depend less on what else the machine did.

*Instructions* are retired ones, of one run: per element and step of the smallest size, and of the whole static process. They do not depend on the load. {counted}

{radioss}

## The element step

![Time of an element and step](../pictures/peers.png)

A square block of elastic quads (plane strain, no lateral contraction), held on its left side, swings in its slowest longitudinal mode with a
very small amplitude: the closed form is `u = V/w sin(w t) sin(pi x / 2 L)`. The same mesh, lumped mass, central differences and
constant step (half of the side over the wave speed) in all programs. The time is the processor time of the steps alone: for slideline and OpenRadioss all of their cycles
(what 20 times as many steps take more), for the others the calls of their `solveStep` and `Solve`. The error is that of the displacement of the free side over V/w at the end.

{elements}

{words}

Small-strain elements keep the shape functions of the start. slideline's elements are always for large strains; one point with hourglass
control is its default, two by two points are what the others have.

## Collision

Explicit contact: two square blocks of elastic quads (plane strain, no lateral contraction, two by two points), n columns above (slave) and 4/5 n below, strike each other flat at the speeds -V/2 and V/2.
As two bars would they are in contact for 2 L/c and part with exchanged speeds: 1 and -1 times V/2 for the mean speeds of the upper and the lower block, nearly, since waves are left in them.
The same meshes, lumped masses and constant step (0.3 of a side over the wave speed), 2 times 2 L/c long, and springs of the same slope. slideline's and OpenRadioss' strains are large, Akantu's small. Akantu's contact is
node to segment, a penalty on the nodal area. Kratos and CalculiX are not driven with explicit contact.
*Momentum*: of both blocks together, over that of one; it is zero at the start, and no outer force acts. Time and instructions are those of all steps but the first, elements and contact, as in the first table.

{collision}

{collision_words}

## Contact patch and block-to-block

Implicit, one static step; fully integrated plane-strain quads (slideline: NIP 4 with mean dilatation; CalculiX: CPE4), contact springs of the
same slope: pressure over penetration is the penalty of a node over the length of a slave segment. *Patch*: two blocks of 1 m with n and
4/5 n columns under a pressure of 1 Pa. *Block*: the meshes of [block-to-block](block_to_block_implicit.md) (51 and 50 columns), the upper face pushed down by 0.1 mm. No
lateral contraction, so the same s_yy everywhere is exact: the load, or blocks and springs in a row (small strain). *Deviation*: the largest of the elements'
means of s_yy from their mean over all elements. Processor time is that of the whole process, reading and writing included. Kratos' contact (patch alone; large strain) has no springs but
multipliers, so its upper face is pushed down by what gives 1 Pa; its time is that of its analysis from reading the mesh on, without the start of Python and its libraries, and its instructions are not counted.

{contact}

{contact_words}

CalculiX prints seven digits of a stress, hence *< 1e-6*; Kratos' strain of 1e-6 is no smaller an error. In large strains the block is stiffer than the closed form by
some 3e-5.
"""


def read_table(path):
    """Rows of a table, numbers as floats where they are numbers."""
    if not path.exists():
        raise UserError(f"{path} is missing: run tests/lab/bench/peers/run.sh")
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def grouped(rows, *names):
    """{key: rows} in the order of the table."""
    found = {}
    for row in rows:
        found.setdefault(tuple(row[name] for name in names), []).append(row)
    return found


def middle(rows, name):
    """Median, lower and upper quartile of a column."""
    values = [float(row[name]) for row in rows]
    if len(values) == 1:
        return values * 3
    low, centre, high = statistics.quantiles(values, n=4, method="inclusive")
    return centre, low, high


def ratio(rows, others, name):
    """Median over the rounds of the ratio to `others` of the same round."""
    base = {row["round"]: float(row[name]) for row in others}
    return statistics.median(float(row[name]) / base[row["round"]] for row in rows)


def read_counts(path):
    """{(scene, elements, program, element or contact): instructions} and who counted them; {} where nobody could."""
    rows = read_table(path) if path.exists() else []
    counts = {(row["scene"], row["elements"], row["program"], row["what"]): float(row["instructions"]) for row in rows}
    words = who_counted(pd.DataFrame(rows, columns=[*rows[0]] if rows else ["counted_by"]).assign(state=COUNTED))
    return counts, words + " The other programs are counted as they came." * bool(rows)


def element_table(rows, counts):
    """One row per program and size; ratios are to slideline's element with 2x2 points."""
    lines = []
    for (elements,), same in grouped(rows, "elements").items():
        programs = grouped(same, "program", "element")
        ours = programs[("slideline", "2x2 points, large strain")]
        for (program, element), runs in programs.items():
            centre, low, high = middle(runs, "ns")
            error = float(runs[0]["free_side"]) - float(runs[0]["exact"])
            count = counts.get(("step", elements, program, element))
            lines.append([elements, program, element, f"{centre:.3g} ({low:.3g} to {high:.3g})", over_yardstick(runs, "ns"),
                          f"{ratio(runs, ours, 'ns'):.2f}", "" if count is None else f"{count:.0f}", f"{float(runs[0]['free_side']):.8f}",
                          f"{error:+.1e}"])
    return markdown_table(["elements", "program", "element", "ns per element and step", "K",
                           "over slideline, 2x2", "instructions", "free side", "error"], lines)


def step_figure(rows):
    """Bars of the time of an element and step, by program and element, a shade for each size; call it within `styled()`."""
    sizes = list(grouped(rows, "elements"))
    kinds = list(grouped(rows, "program", "element"))
    figure, axes = plt.subplots(figsize=(PAGE_WIDTH, 0.35 * len(kinds) + 0.6), layout="constrained")
    for number, (elements,) in enumerate(sizes):
        times = [middle([row for row in rows if (row["elements"], row["program"], row["element"]) == (elements, *kind)], "ns")[0]
                 for kind in kinds]
        places = [len(kinds) - k - 0.25 * number for k in range(len(kinds))]
        axes.barh(places, times, 0.22, color=str(0.25 + 0.2 * number), label=f"{int(elements)} elements")
    axes.set_yticks([len(kinds) - k - 0.25 for k in range(len(kinds))], [f"{program}, {element}" for program, element in kinds])
    axes.set_xscale("log")
    axes.set_xlabel("ns per element and step")
    axes.legend()
    return figure


def over_yardstick(rows, name, unit=1.0):
    """Median over the rounds of a column over the yardstick that was measured beside it."""
    return f"{statistics.median(unit * float(row[name]) / float(row['yardstick_ns']) for row in rows):.3g}"


def yardstick_words(*tables):
    """'K = 2.2 ns, 2.1 to 3.4'."""
    found = [float(row["yardstick_ns"]) for rows in tables for row in rows]
    return f"median {statistics.median(found):.2f} ns, from {min(found):.2f} to {max(found):.2f}"


def collision_table(rows, counts):
    """One row per size, program and contact."""
    lines = []
    for (elements, program, contact), runs in grouped(rows, "elements", "program", "contact").items():
        centre, low, high = middle(runs, "ns")
        count = counts.get(("collision", elements, program, contact))
        lines.append([elements, program, contact, f"{centre:.3g} ({low:.3g} to {high:.3g})", over_yardstick(runs, "ns"),
                      "" if count is None else f"{count:.0f}", *(f"{float(runs[0][name]):.4f}" for name in ("upper", "lower")),
                      f"{float(runs[0]['momentum']):.1e}"])
    return markdown_table(["elements", "program", "contact", "ns per element and step", "K", "instructions", "upper block", "lower block",
                           "momentum"], lines)


def collision_words(rows):
    """Ratios of the times, and whose momentum is made, in a list."""
    lines = []
    for (elements,), same in grouped(rows, "elements").items():
        ours = [row for row in same if row["contact"] == "type 2"]
        for (program, contact), runs in grouped(same, "program", "contact").items():
            if program == "slideline":
                continue
            lines.append(f"- {elements} elements: {program}, {contact}, takes {ratio(runs, ours, 'ns'):.1f} times as long as slideline with "
                         "type 2, its own node-to-segment contact.")
            if abs(float(runs[0]["momentum"])) > 0.01:
                lines.append(f"- {elements} elements: as it is driven here, {program}'s contact forces do not balance: it makes "
                             f"{float(runs[0]['momentum']):.1f} times the momentum of a block, and its answer is not that of the bars.")
    return "\n".join(lines)


def element_words(rows):
    """What the element step shows, in one paragraph."""
    programs, spread, errors = {}, 0.0, []
    for (_,), same in grouped(rows, "elements").items():
        by_program = grouped(same, "program", "element")
        ours = by_program[("slideline", "2x2 points, large strain")]
        one = by_program[("slideline", "one point, large strain")]
        ends = [float(runs[0]["free_side"]) for runs in by_program.values()]
        spread = max(spread, max(ends) - min(ends))
        errors.append(abs(ends[0] - float(same[0]["exact"])))
        for (program, element), runs in by_program.items():
            if program != "slideline":
                programs.setdefault(f"{program} ({element})", []).append(
                    (ratio(runs, ours, "ns"), ratio(runs, one, "ns")))
    parts = [f"- {name} takes {spanned([r[0] for r in found])} times as long as slideline's element with "
             f"2x2 points and {spanned([r[1] for r in found])} times as long as that with one."
             for name, found in programs.items()]
    return ("In this run, over all sizes:\n\n" + "\n".join(parts) + "\n\nThe answers of all programs lie within "
            f"{spread:.0e} of each other at every size; the error that they share is {errors[0]:.1e} on the coarsest mesh and "
            f"{errors[-1]:.1e} on the finest.")


def spanned(values):
    """'3.1 to 12'."""
    return " to ".join(f"{value:.0f}" if value >= 10.0 else f"{value:.1f}"
                       for value in (min(values), max(values)))


def contact_table(rows, counts):
    """One row per scene, size, program and contact."""
    lines = []
    for (scene, elements, program, contact), runs in grouped(
            rows, "scene", "elements", "program", "contact").items():
        used = middle(runs, "processor_seconds")
        mean, deviation = float(runs[0]["mean"]), float(runs[0]["deviation"])
        exact = float(runs[0]["exact"])
        answer = ["refused", "", ""] if math.isnan(mean) else [
            f"{mean:.6g}", size(mean / exact - 1.0), size(deviation)]
        count = counts.get((scene, elements, program, contact))
        lines.append([scene, elements, program, contact, *answer,
                      f"{used[0]:.3g} ({used[1]:.3g} to {used[2]:.3g})", over_yardstick(runs, "processor_seconds", 1.0e3), "" if count is None else f"{1e-6 * count:.0f}"])
    return markdown_table(["scene", "elements", "program", "contact", "-s_yy, mean, Pa", "error",
                           "deviation", "processor time, s", "million K", "instructions, millions"], lines)


def size(value):
    """A relative error; those that CalculiX's seven digits can not tell from none by their bound."""
    return f"{value:.1e}" if abs(value) >= 1.0e-6 else "< 1e-6"


def contact_words(rows):
    """Ratios of the times and what was refused, in a list."""
    lines = []
    for (scene, elements), same in grouped(rows, "scene", "elements").items():
        ours = [row for row in same if row["contact"] == "type 5"]
        for (program, contact), runs in grouped(same, "program", "contact").items():
            if program != "slideline" and not math.isnan(float(runs[0]["mean"])):
                lines.append(f"- {scene}, {elements} elements: {program}, {contact}, takes "
                             f"{ratio(runs, ours, 'processor_seconds'):.2f} times the processor time "
                             "of slideline with type 5.")
    refused = {(row["contact"], re_message(row["message"])) for row in rows if row["message"]}
    lines += [f"- CalculiX, {contact}: refused (`{message}`); its plane elements become solids whose "
              "nodes are tied, and this contact takes no tied nodes." for contact, message
              in sorted(refused)]
    return "\n".join(lines)


def re_message(text):
    """A message without its numbers, so that runs of all sizes say the same."""
    return " ".join(word for word in text.split() if not word.strip(",").isdigit())


def rounds_in_words(count):
    """'one round', '5 rounds'."""
    return "one round" if count == 1 else f"{count} rounds"


def version_rows(path):
    """Markdown rows of the programs and their versions."""
    lines = path.read_text(encoding="utf-8").splitlines()
    found = dict(line.split("==", 1) for line in lines if "==" in line)
    found["CalculiX"] = next((line.split()[-1] for line in lines if "Version" in line), "")
    return "\n".join(f"| {name} | {found[name]} | "
                     f"{'Debian package calculix-ccx' if name == 'CalculiX' else 'PyPI, wheel'} |"
                     for name in PEERS if found.get(name))


def radioss_in_words(path):
    """How OpenRadioss was built, or that it was not."""
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith(f"{SOURCE_ALONE}=="):
            return BUILT.format(line.split("==", 1)[1])
    return NOT_BUILT


def built_in_words(path):
    """'version 1.2.3 (source ...), built with `...`' as the program itself says."""
    said = dict(line.split(maxsplit=1) for line in path.read_text(encoding="utf-8").splitlines()
                if line.startswith(("slideline ", "flags ")))
    return f"version {said['slideline']}, built with `{said['flags']}`"


def write(folder, doc):
    """The page."""
    elements, collision, contact = (read_table(folder / f"{name}.csv") for name in ("elements", "collision", "contact"))
    counts, counted = read_counts(folder / "counts.csv")
    with styled():
        save_small(step_figure(elements), doc / "pictures" / "peers.png", lines=True)
    write_page(doc, "peers", PAGE.format(
        counted=counted, radioss=radioss_in_words(folder / "versions.txt"), built=built_in_words(folder / "versions.txt"), yardstick=yardstick_words(elements, collision, contact),
        rounds=rounds_in_words(max(int(row["round"]) for row in elements)), processor=processor(),
        versions=version_rows(folder / "versions.txt"), elements=element_table(elements, counts),
        words=element_words(elements), collision=collision_table(collision, counts),
        collision_words=collision_words(collision), contact=contact_table(contact, counts),
        contact_words=contact_words(contact)))


def main(arguments=None):
    """Returns the exit status."""
    return page_main(__doc__, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
