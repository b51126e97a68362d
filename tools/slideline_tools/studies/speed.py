# SPDX-License-Identifier: MIT
"""The page doc/studies/speed.md and its pictures, from the table of tests/lab/bench/run.sh.

    python -m slideline_tools.studies.speed FOLDER DOC

FOLDER holds bench.csv and machine.json; the page goes to DOC/studies, its pictures to DOC/pictures.
"""
import csv
import json
import math
import pathlib
import sys
import textwrap

from slideline_tools import UserError
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import (TYPES, colour, label, markdown_table, page_main, save_small,
                                            write_page)

BYTES = 216.0  # moved per element and step, as in tests/lab/bench/measuring.py
IN_MEMORY = 20000  # elements: from there on a model is larger than the caches of a core
AT_ONCE = ", 2 runs at once"
ROUTINE_GOAL, SMALL_GOAL = 2.0, 4.5  # element routine, step of 300 elements over K
STEP_GOAL, TEAM_GOAL = 3.6, 1.9  # step over K, speed-up of two threads; 4000 to 100 000 elements
LARGE_GOAL, GOAL_YARDSTICKS, GOAL_BYTES = 1.3, 3.3, 220.0  # as in tests/lab/bench/measuring.py
POINT_GOAL, POINT_SIZES, SMALL_CONTACT = 6.4, (100, 1000, 10000, 100000), 455.0  # contact: K a point; a step of 20 slave nodes
STYLES = {("elastic", 1): ("-", "o"), ("elastic", 2): ("--", "o"),
          ("yielding", 1): ("-", "s"), ("yielding", 2): ("--", "s")}
SEARCHES = {"still": "pressed, not sliding", "sliding": "sliding fast",
            "folding": "folding chains", "interfaces": "50 interfaces, sliding fast"}

PAGE = """# Speed

This page and its pictures are written by `tests/lab/bench/run.sh --publish`: do not edit it. All figures are medians of
interleaved rounds on one machine; quartiles, repeats and all the rest are in the table that the command leaves in
`results/bench/bench.csv`.

## In plain words

- **K** is the unit of all times: the yardstick of `tests/lab/bench/yardstick`, the bare arithmetic of one step of a plastic one-point quad
  in one loop, on data in the L1 cache. It is a program of its own with flags of its own and stays as it is, whatever becomes of
  slideline. Here {yardstick:.2f} ns.
- The **element routine** is slideline's own on one chunk of elements, with the gathering of their nodes. Here {routine:.2f} ns = {routine_over:.2f} K.
- **R** is the time in which the memory can move what an element reads and writes in a step ({bytes:.0f} bytes): {memory:.2f} ns on one
  thread ({bandwidth:.1f} GB/s). It counts where the model is larger than the
  caches of a core: from some 20 000 elements on.
- The **roofline** is the larger of the two. What the step takes beyond it is for gathering the nodes, summing and moving them,
  boundary conditions, the energy account. The **goal** for large models is {large:g} ({yardsticks:g} K + R of {goal_bytes:.0f} bytes).
- All ratios are of K and R measured within the same minute: the machine's pace drifts, ratios less so.

{disturbed}

## Instructions

{counts}

## The element step

{step_goals}

*Two runs at once*: two computations of one thread each, side by side. They wait for nothing of each other: what one of
them takes longer than alone is what two busy cores cost here (clock, caches, other machines on the same host). Near 2
two threads share one model as well as two runs get on side by side; where a model fills the caches it may be more, since each
of the two runs has a whole one.

![Cost of a step and of contact over the size](../pictures/speed.png)

Left: time per element and step, whole (elements and nodes, with boundary conditions and energies), of square blocks, elastic or
yielding everywhere. Right: time of contact per slave node and step, whole (search, placing, pressure, scatter, energy), of a flat chain all
of whose nodes touch and slide. Both axes are logarithmic: a cost that is proportional to the size is a level line.

{step_table}

## Contact

{contact_goals}

With 100 000 slave nodes contact of type 1 moves a kilobyte a slave node and step through the memory (12 lines of 64 bytes read, 4 written, by
cachegrind with a cache of 512 kB): its time is that of the memory, at 185 instructions (4 K) a slave node.

ns per slave node and step, in brackets per contact point over K. *flat*: all slave nodes touch; *crown*: a third of them.
The clock is not read here (`timing=off`); with `timing=phase` two or three readings come to a step of each
interface, [20 to 40 ns each](../results.md#what-the-timing-costs).

{contact_table}

## The search stays linear

Decks that try the contact search (`tests/lab/bench/search.py` writes them): strips of elements pressed upon each other; the same
sliding at 400 m/s, some 2.7 % of a segment in a step; both strips thrown into waves that fold at up to 300 m/s; 50 pairs that slide, each
an interface of its own. ns of search and pairing per slave node and step; the whole of contact is drawn thinner. A search that compared all with all
would rise {ratio:.0f} times from left to right.

![Contact search over the size](../pictures/speed_search.png)

{search_table}

## Memory, reading and writing

{file_table}

*Steps*: resident memory while stepping, less that of the program alone. The plain file is written with as many bytes
in the same minute; neither is forced to the disk.

## Small jobs

A job of 306 elements and 1,000 cycles steps 306,000 elements; what else it takes from start to exit is felt when there are thousands of
them. `tests/lab/bench/small_jobs.sh` measures it, and how many jobs a second two processors take through `tools/batch/run_folder.sh -j 2` and
through `xargs -P 2`. Counted, without plot states, on Debian 12 (page faults and calls to the system beside instructions):

| job | libraries | instructions | page faults | calls | forced to the disk |
|---|---|---|---|---|---|
| 4 elements, 1 cycle, shared HDF5 | 53 | 24.8 million | 794 | 1073 | 0 |
| 4 elements, 1 cycle, HDF5 within the program | 22 | 6.2 million | 340 | 673 | 0 |
| 306 elements, 1,000 cycles, shared HDF5 | 53 | 92.9 million | 832 | 1098 | 0 |
| 306 elements, 1,000 cycles, HDF5 within the program | 22 | 74.3 million | 383 | 697 | 0 |

The shared HDF5 of Debian brings libraries of network protocols along, so the Release program has HDF5 within it where its archives are
installed (`SLIDELINE_STATIC_HDF5`). Only restart files are forced to the disk, and a mesh too small to be shared makes no threads.
A batch starts one shell and one set of checksums for up to sixteen runs. `tests/program/test_small_jobs.py` bounds the calls.

## Machine

{machine}
"""


class Bench:
    """The rows of bench.csv."""

    def __init__(self, path):
        if not path.exists():
            raise UserError(f"{path} is missing: run tests/lab/bench/run.sh")
        with path.open(newline="", encoding="ascii") as stream:
            self.rows = list(csv.DictReader(stream))
        for row in self.rows:
            row["size"], row["threads"] = int(row["size"]), int(row["threads"])
            for name in ("median", "low", "high", "over_yardstick", "over_bandwidth", "over_goal",
                         "yardstick_ns", "bandwidth_gb_s", "share"):
                row[name] = float(row[name]) if row[name] else math.nan

    def of(self, part, case=None, threads=None, unit=None):
        """Rows of a part, smallest size first."""
        found = [row for row in self.rows if row["part"] == part
                 and (case is None or row["case"] == case)
                 and (threads is None or row["threads"] == threads)
                 and (unit is None or row["unit"] == unit)]
        return sorted(found, key=lambda row: row["size"])

    def value(self, part, case, threads=1, name="median"):
        """One figure; nan where it was not measured."""
        found = self.of(part, case, threads)
        return found[0][name] if found else math.nan


# ---- words -------------------------------------------------------------------------------------

def verdict(name, value, goal, most=True):
    """A line of a list: the figure, and whether it keeps to the goal."""
    kept = value <= goal if most else value >= goal
    return f"- {name}: **{value:.2f}**, goal {'at most' if most else 'at least'} {goal:g}: " + (
        "kept" if kept else "missed")


def speed_up(bench, material, size, base):
    """Time of the case `base`, one thread, over that of two threads."""
    alone = [row["median"] for row in bench.of("step", base, 1) if row["size"] == size]
    team = [row["median"] for row in bench.of("step", material, 2) if row["size"] == size]
    return alone[0] / team[0] if alone and team else math.nan


def team_goals(bench, material, sizes):
    """The goal of two threads; how they compare with two runs at once, which is no goal."""
    lines = []
    ups = [up for up in (speed_up(bench, material, size, material) for size in sizes)
           if not math.isnan(up)]
    if ups:
        lines.append(verdict(f"{material}, the same sizes, speed-up of two threads, the least",
                             min(ups), TEAM_GOAL, most=False))
    ups = [up for up in (speed_up(bench, material, size, material + AT_ONCE) for size in sizes)
           if not math.isnan(up)]
    if ups:
        lines.append(f"- {material}, the same sizes, two threads over one of two runs at once: "
                     f"{min(ups):.2f} to {max(ups):.2f}")
    steps = [row["over_yardstick"] for row in bench.of("step", material, 2) if row["size"] in sizes]
    if steps:
        lines.append(f"- {material}, the same sizes, step of two threads over K: {min(steps):.2f} to "
                     f"{max(steps):.2f} (a step of {STEP_GOAL:g} K and a speed-up of {TEAM_GOAL:g} make "
                     f"{STEP_GOAL / TEAM_GOAL:.2f})")
    return lines


def step_goals(bench):
    """The goals of the step, one line each."""
    lines = [verdict("element routine over K", row["over_yardstick"], ROUTINE_GOAL) for row in bench.of("unit", "routine")]
    for material in ("elastic", "yielding"):
        rows = bench.of("step", material, 1)
        small = [row for row in rows if 250 <= row["size"] <= 350]
        middle = [row for row in rows if 3500 <= row["size"] <= 110000]
        large = [row for row in rows if row["size"] >= 900000]
        if small:
            lines.append(verdict(f"{material}, {small[0]['size']} elements, step over K",
                                 small[0]["over_yardstick"], SMALL_GOAL))
        if middle:
            lines.append(verdict(f"{material}, 4000 to 100 000 elements, step over K, the largest",
                                 max(row["over_yardstick"] for row in middle), STEP_GOAL))
            lines += team_goals(bench, material, [row["size"] for row in middle])
        if large:
            lines.append(verdict(f"{material}, a million elements and more, step over "
                                 f"{GOAL_YARDSTICKS:g} K + R of {GOAL_BYTES:.0f} bytes, the largest",
                                 max(row["over_goal"] for row in large), LARGE_GOAL))
    return "\n".join(lines)


def contact_rows(bench, scene, ctype, unit="ns/slave node"):
    return bench.of("contact", f"{scene} type {ctype}", 1, unit)


def contact_goals(bench):
    """The goals of contact, one line each, flat chain."""
    lines = []
    for ctype in TYPES:
        rows = [row for row in contact_rows(bench, "flat", ctype, "ns/point") if row["size"] in POINT_SIZES]
        if rows:
            sizes = [row["size"] for row in rows]
            worst = max(rows, key=lambda row: row["over_yardstick"])
            lines.append(verdict(f"type {ctype}, {min(sizes)} to {max(sizes)} slave nodes, K per contact point, the most "
                                 f"(at {worst['size']} slave nodes)", worst["over_yardstick"], POINT_GOAL))
    for ctype in TYPES:
        points = {row["size"]: row["median"] for row in contact_rows(bench, "flat", ctype, "ns/point")}
        lines += [verdict(f"type {ctype}, 20 slave nodes ({20 * row['median'] / points[20]:.0f} points), K a step",
                          row["over_yardstick"] * row["size"], SMALL_CONTACT)
                  for row in contact_rows(bench, "flat", ctype) if row["size"] == 20 and 20 in points]
    return "\n".join(lines)


def disturbed(bench):
    """How far the runs had the processors to themselves."""
    parts = []
    rows = [row for row in bench.of("step") if not row["case"].endswith(AT_ONCE)]
    for threads in sorted({row["threads"] for row in rows}):
        shares = [row["share"] for row in rows if row["threads"] == threads]
        parts.append(f"{100.0 * min(shares):.0f} to {100.0 * max(shares):.0f} % with {threads} "
                     f"thread{'s' * (threads > 1)}")
    least = min((row["share"] for row in rows), default=1.0)
    text = ("Of the processor time that they asked for the runs of the step got (medians of the better half of the "
            f"rounds, from size to size) {', '.join(parts)}.")
    if least >= 0.9:
        return text
    return text + (" **Other work shared the machine.** Times of one thread are corrected: multiplied by that share. Times of "
                   "two threads can not be, since threads that wait for each other use up processor time: they are upper bounds, "
                   "and so are the speed-ups lower bounds.")


# ---- tables ------------------------------------------------------------------------------------

def count_table(bench):
    """Retired instructions per element and step; a sentence where nobody could count them."""
    first = ("yardstick", "element routine")
    rows = sorted(bench.of("count"), key=lambda row: [row["case"] != name for name in first])
    if not rows:
        return "None were counted: valgrind was not installed."
    unit = bench.value("count", "yardstick")
    lines = [[row["case"], row["size"], f"{row['median']:.1f}", f"{row['median'] / unit:.2f}"] for row in rows]
    return ("Retired instructions per element and step, by callgrind, of what is built for x86-64-v3 (four reals a vector). They do not "
            "depend on the machine or its load, and repeat to 1e-4:\n\n"
            + markdown_table(["what", "elements", "instructions", "over the yardstick"], lines))


def step_table(bench):
    sizes = sorted({row["size"] for row in bench.of("step")})
    names, columns = ["elements"], []
    for material in ("elastic", "yielding"):
        for threads in sorted({row["threads"] for row in bench.of("step")}):
            names.append(f"{material}, {threads} thread{'s' * (threads > 1)}")
            columns.append({row["size"]: row for row in bench.of("step", material, threads)})
        at_once = {row["size"]: row for row in bench.of("step", material + AT_ONCE)}
        if at_once:
            names.append(f"{material}{AT_ONCE}")
            columns.append(at_once)
    lines = []
    for size in sizes:
        cells = [f"{column[size]['median']:.2f} ns = {column[size]['over_yardstick']:.2f} K"
                 + f" ({column[size]['over_goal']:.2f})" * (size >= IN_MEMORY)
                 if size in column else "" for column in columns]
        lines.append([f"{size:,}".replace(",", " "), *cells])
    return ("ns per element and step, over K, and from 20 000 elements on in brackets "
            f"over {GOAL_YARDSTICKS:g} K + R of {GOAL_BYTES:.0f} bytes:\n\n"
            + markdown_table(names, lines))


def contact_table(bench):
    sizes = sorted({row["size"] for row in bench.of("contact")})
    lines = []
    for scene in ("flat", "crown"):
        for ctype in TYPES:
            nodes = {row["size"]: row for row in contact_rows(bench, scene, ctype)}
            points = {row["size"]: row for row in contact_rows(bench, scene, ctype, "ns/point")}
            if nodes:
                lines.append([f"{scene}, {label(ctype)}", *(
                    f"{nodes[size]['median']:.1f} ({points[size]['over_yardstick']:.2f} K)"
                    if size in nodes else "" for size in sizes)])
    return markdown_table(["slave nodes", *(f"{size}" for size in sizes)], lines)


def search_lines(bench, what):
    """{(case, type): rows}."""
    found = {}
    for row in bench.of("search"):
        case, _, ctype, kind = row["case"].split()
        if kind == what:
            found.setdefault((case, int(ctype)), []).append(row)
    return found


def search_table(bench):
    lines = []
    for (case, ctype), rows in search_lines(bench, "search").items():
        lines.append([f"{SEARCHES[case]}, type {ctype}",
                      *(f"{row['median']:.2f}" for row in rows)])
    rows = next(iter(search_lines(bench, "search").values()), [])
    return markdown_table(["slave nodes", *(f"{row['size']}" for row in rows)], lines)


def file_table(bench):
    goals = {"reading": "at most 3 s", "peak over steps": "at most 1.5",
             "steps": "at most 250", "states over plain file": "at least 0.5"}
    lines = [[f"{row['part']}: {row['case']}", f"{row['size']}", f"{row['median']:.3g} {row['unit']}",
              goals.get(row["case"], "")]
             for part in ("memory", "input", "output") for row in bench.of(part)]
    return markdown_table(["quantity", "elements", "median", "goal"], lines)


# ---- pictures ----------------------------------------------------------------------------------

def draw_steps(axes, bench):
    """Cost of the element step with its bounds."""
    for (material, threads), (line, marker) in STYLES.items():
        rows = bench.of("step", material, threads)
        if rows:
            axes.plot([r["size"] for r in rows], [r["median"] for r in rows], line + marker,
                      color="#0b559f" if material == "elastic" else "#c23b22", markersize=3,
                      label=f"{material}, {threads} thread{'s' * (threads > 1)}")
    rows = bench.of("step", "elastic", 1)
    if rows:
        sizes = [row["size"] for row in rows]
        yardstick = [row["yardstick_ns"] for row in rows]
        memory = [BYTES / row["bandwidth_gb_s"] if row["size"] >= IN_MEMORY else 0.0 for row in rows]
        axes.plot(sizes, [max(pair) for pair in zip(yardstick, memory)], color="black", lw=1.6,
                  label="roofline of 1 thread: larger of K and R")
        axes.plot(sizes, yardstick, color="black", lw=0.8, ls=":", label="K, the yardstick, 1 thread")
        axes.plot(sizes, [GOAL_YARDSTICKS * k + r * GOAL_BYTES / BYTES for k, r in zip(yardstick, memory)], color="grey", lw=0.8,
                  ls="--", label=f"{GOAL_YARDSTICKS:g} K + R of {GOAL_BYTES:.0f} bytes")
    axes.set_xlabel("elements")
    axes.set_ylabel("ns per element, or per slave node, and step")


def draw_contact(axes, bench):
    """Cost of contact per slave node."""
    for ctype in TYPES:
        rows = contact_rows(bench, "flat", ctype)
        if rows:
            axes.plot([r["size"] for r in rows], [r["median"] for r in rows], "-o", markersize=3,
                      color=colour(ctype), label=label(ctype))
    rows = contact_rows(bench, "flat", 1)
    if rows:
        axes.plot([r["size"] for r in rows], [r["yardstick_ns"] for r in rows], color="black", lw=0.8,
                  ls=":", label="K")
    axes.set_xlabel("slave nodes")


def scale_chart(bench, path):
    """The chart of the scale: elements and contact, both axes logarithmic, one scale of time."""
    with plt.rc_context({**STYLE, "legend.fontsize": 6.5}):
        figure, panels = plt.subplots(1, 2, sharey=True, layout="constrained",
                                      figsize=(PAGE_WIDTH + 1.5, 4.2))
        draw_steps(panels[0], bench)
        draw_contact(panels[1], bench)
        for axes in panels:
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.grid(True, which="both", lw=0.3, alpha=0.5)
            axes.legend(ncols=2, loc="upper right")
        low, high = panels[0].get_ylim()
        panels[0].set_ylim(low, 3.0 * high)
        save_small(figure, path, lines=True)


def search_chart(bench, path):
    """Search over the number of slave nodes, a panel for each type."""
    found, whole = search_lines(bench, "search"), search_lines(bench, "whole")
    types = sorted({ctype for _, ctype in found})
    with plt.rc_context({**STYLE, "legend.fontsize": 6.5}):
        figure, panels = plt.subplots(1, max(1, len(types)), sharey=True, squeeze=False,
                                      layout="constrained", figsize=(PAGE_WIDTH + 1.5, 3.2))
        for axes, ctype in zip(panels[0], types):
            for k, case in enumerate(SEARCHES):
                rows = found.get((case, ctype), [])
                sizes = [row["size"] for row in rows]
                axes.plot(sizes, [row["median"] for row in rows], "-o", color=colour(k + 1),
                          markersize=3, label=SEARCHES[case])
                axes.plot(sizes, [row["median"] for row in whole.get((case, ctype), [])],
                          color=colour(k + 1), lw=0.5)
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.grid(True, which="both", lw=0.3, alpha=0.5)
            axes.set_title(label(ctype), loc="left")
            axes.set_xlabel("slave nodes")
        panels[0, 0].set_ylabel("ns per slave node and step")
        if found:
            panels[0, 0].legend()
        save_small(figure, path, lines=True)


# ---- the page ----------------------------------------------------------------------------------

def machine_text(path):
    """The machine in words."""
    machine = json.loads(path.read_text(encoding="utf-8"))
    return "\n".join(textwrap.fill(f"- {name}: {value}", 120, subsequent_indent="  ", break_on_hyphens=False)
                     for name, value in machine.items())


def write(folder, doc):
    """Page and pictures."""
    bench = Bench(folder / "bench.csv")
    scale_chart(bench, doc / "pictures" / "speed.png")
    search_chart(bench, doc / "pictures" / "speed_search.png")
    bandwidth = bench.value("unit", "bandwidth")
    sizes = [row["size"] for row in bench.of("search")] or [1]
    write_page(doc, "speed", PAGE.format(
        yardstick=bench.value("unit", "yardstick"), routine=bench.value("unit", "routine"),
        routine_over=bench.value("unit", "routine", name="over_yardstick"), large=LARGE_GOAL,
        yardsticks=GOAL_YARDSTICKS, goal_bytes=GOAL_BYTES, counts=count_table(bench), bytes=BYTES, memory=BYTES / bandwidth,
        bandwidth=bandwidth, disturbed=disturbed(bench), step_goals=step_goals(bench),
        step_table=step_table(bench), contact_goals=contact_goals(bench),
        contact_table=contact_table(bench), search_table=search_table(bench),
        ratio=max(sizes) / min(sizes), file_table=file_table(bench),
        machine=machine_text(folder / "machine.json")))


def main(arguments=None):
    """Returns the exit status."""
    return page_main(__doc__, write, arguments)


if __name__ == "__main__":
    sys.exit(main())
