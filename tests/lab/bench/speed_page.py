# SPDX-License-Identifier: MIT
"""The figures of doc/studies/speed.md, from the table of tests/lab/bench/run.sh.

    speed_page.py FOLDER DOC

FOLDER holds bench.csv and machine.json; the page goes to DOC/studies, its picture to DOC/pictures.
"""
import json
import pathlib
import sys

import pandas as pd

from slideline_tools import UserError
from slideline_tools.contact_types import TYPES
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import colour, label, markdown_table, save_small, write_page

IN_MEMORY = 20000  # elements: from there on a model is larger than the caches of a core
AT_ONCE = ", 2 runs at once"
FILE_GOALS = {"reading": "at most 3 s", "peak over steps": "at most 1.5",
              "steps": "at most 250", "states over plain file": "at least 0.5"}
STYLES = {("elastic", 1): "-o", ("elastic", 2): "--o",
          ("yielding", 1): "-s", ("yielding", 2): "--s"}

PAGE = """# Speed

Medians of interleaved rounds; K is the yardstick of `tests/lab/bench/yardstick`, here
{yardstick:.2f} ns; the memory moves {bandwidth:.1f} GB/s on one thread. The runs of the step got
{share} of the processor time that they asked for; what one thread lacked is corrected.

## Goals

{goals}

## The element step

![Cost of a step and of contact over the size](../pictures/speed.png)

ns per element and step, over K, and from 20 000 elements on in brackets over 3.3 K and the time in
which the memory moves 220 bytes:

{steps}

Retired instructions per element and step:

{counts}

## Contact

ns per slave node and step, in brackets K per contact point:

{contact}

## Search

ns of search and pairing per slave node and step:

{search}

## Memory, reading and writing

{files}

## Machine

{machine}
"""


def read_bench(path):
    """The table of the benchmarks."""
    if not path.exists():
        raise UserError(f"{path} is missing: run tests/lab/bench/run.sh")
    return pd.read_csv(path)


def of_step(bench):
    """The rows of the step alone, with the columns `material` and `at_once`."""
    steps = bench[bench["part"] == "step"]
    return steps.assign(material=steps["case"].str.removesuffix(AT_ONCE),
                        at_once=steps["case"].str.endswith(AT_ONCE))


def of_contact(bench, unit):
    """The rows of contact in one unit, with the columns `scene` and `type`."""
    rows = bench[(bench["part"] == "contact") & (bench["unit"] == unit)]
    words = rows["case"].str.extract(r"(?P<scene>\w+) type (?P<type>\d)")
    return rows.assign(scene=words["scene"], type=words["type"].astype(int))


def unit_of(bench, case):
    """Median of one of the units."""
    found = bench[(bench["part"] == "unit") & (bench["case"] == case)]["median"]
    return found.iloc[0] if len(found) else float("nan")


# ---- goals -------------------------------------------------------------------------------------

def found_goals(bench):
    """(what, figures found, goal, whether it is the most or the least that is judged)."""
    steps, contact = of_step(bench), of_contact(bench, "ns/point")
    yield ("element routine over K", bench[bench["case"] == "routine"]["over_yardstick"], 2.0, max)
    for material, rows in steps[~steps["at_once"]].groupby("material"):
        alone, team = (rows[rows["threads"] == count].set_index("size") for count in (1, 2))
        over_k, speed_up = alone["over_yardstick"], (alone["median"] / team["median"]).dropna()
        yield f"{material}, step of 300 elements over K", over_k.loc[250:350], 4.5, max
        yield f"{material}, 4000 to 100 000 elements over K", over_k.loc[3500:110000], 3.6, max
        yield (f"{material}, the same sizes, speed-up of two threads", speed_up.loc[3500:110000],
               1.9, min)
        yield (f"{material}, a million and more over 3.3 K and 220 bytes",
               alone["over_goal"].loc[900000:], 1.3, max)
    for ctype, rows in contact[(contact["scene"] == "flat")].groupby("type"):
        large = rows[rows["size"].between(100, 100000)]
        yield f"type {ctype}, from 100 slave nodes, K a point", large["over_yardstick"], 6.4, max
    small = of_contact(bench, "ns/slave node")
    for ctype, rows in small[(small["scene"] == "flat") & (small["size"] == 20)].groupby("type"):
        yield f"type {ctype}, 20 slave nodes, K a step", 20.0 * rows["over_yardstick"], 455.0, max


def goal_table(bench):
    """What was found beside each goal."""
    lines = []
    for what, found, goal, judged in found_goals(bench):
        if len(found):
            kept = found.max() <= goal if judged is max else found.min() >= goal
            lines.append([what, f"{found.min():.2f} to {found.max():.2f}",
                          f"at {'most' if judged is max else 'least'} {goal:g}",
                          "kept" if kept else "missed"])
    return markdown_table(["what", "found", "goal", ""], lines)


# ---- tables ------------------------------------------------------------------------------------

def by_size(rows, names, cell):
    """A table of texts over the sizes; `cell` takes a row."""
    texts = rows.assign(text=[cell(row) for row in rows.itertuples()])
    table = texts.set_index([*names, "size"])["text"].unstack("size", fill_value="")
    return table.rename(columns=str).reset_index()


def step_table(bench):
    """A row for each size, a column for each law and number of threads."""
    steps = of_step(bench).replace({"threads": {1: "1 thread", 2: "2 threads"}})
    steps["how"] = steps["case"] + ", " + steps["threads"]
    table = by_size(steps, ["how"], lambda row: f"{row.median:.2f} ns = {row.over_yardstick:.2f} K"
                    + f" ({row.over_goal:.2f})" * (row.size >= IN_MEMORY))
    return markdown_table(table.set_index("how").T.reset_index(names="elements"))


def contact_table(bench):
    """A row for each scene and type, a column for each size."""
    keys = ["scene", "type", "size"]
    points = of_contact(bench, "ns/point").set_index(keys)["over_yardstick"]
    nodes = of_contact(bench, "ns/slave node").join(points, keys, rsuffix="_point")
    nodes = nodes[nodes["scene"].isin(["flat", "crown"])]
    table = by_size(nodes, ["scene", "type"],
                    lambda row: f"{row.median:.1f} ({row.over_yardstick_point:.2f} K)")
    table["type"] = table["type"].map(label)
    return markdown_table(table.sort_values("scene", ascending=False, kind="stable"))


def search_table(bench):
    """A row for each scene and type, a column for each size."""
    rows = bench[(bench["part"] == "search") & bench["case"].str.endswith(" search")]
    return markdown_table(by_size(rows, ["case"], lambda row: f"{row.median:.2f}"))


def file_table(bench):
    """Memory, reading and writing beside their goals."""
    rows = bench[bench["part"].isin(["memory", "input", "output"])]
    found = [f"{value:.3g} {unit}" for value, unit in zip(rows["median"], rows["unit"].fillna(""))]
    return markdown_table(rows[["part", "case", "size"]].assign(
        median=found, goal=rows["case"].map(FILE_GOALS)))


def count_table(bench):
    """Retired instructions, and over those of the yardstick."""
    rows = bench[bench["part"] == "count"]
    if rows.empty:
        return "None were counted: valgrind was not installed."
    yardstick = rows.loc[rows["case"] == "yardstick", "median"].iloc[0]
    return markdown_table(rows[["case", "size"]].assign(
        instructions=rows["median"], yardsticks=(rows["median"] / yardstick).map("{:.2f}".format)))


# ---- picture and page --------------------------------------------------------------------------

def speed_chart(bench, path):
    """Elements and contact over the size, both axes logarithmic, one scale of time."""
    steps, contact = of_step(bench), of_contact(bench, "ns/slave node")
    contact = contact[contact["scene"] == "flat"]
    with plt.rc_context({**STYLE, "legend.fontsize": 6.5}):
        figure, (left, right) = plt.subplots(1, 2, sharey=True, layout="constrained",
                                             figsize=(PAGE_WIDTH + 1.5, 4.2))
        for (case, threads), rows in steps[~steps["at_once"]].groupby(["case", "threads"]):
            left.plot(rows["size"], rows["median"], STYLES[case, threads], markersize=3,
                      color=colour(1 + (case == "yielding")), label=f"{case}, {threads} threads")
        for ctype in TYPES:
            rows = contact[contact["type"] == ctype]
            right.plot(rows["size"], rows["median"], "-o", markersize=3, color=colour(ctype),
                       label=label(ctype))
        left.set(xlabel="elements", ylabel="ns per element, or slave node, and step")
        right.set_xlabel("slave nodes")
        for axes in (left, right):
            axes.axhline(unit_of(bench, "yardstick"), color="black", lw=0.8, ls=":", label="K")
            axes.set(xscale="log", yscale="log")
            axes.grid(True, which="both", lw=0.3, alpha=0.5)
            axes.legend(ncols=2, loc="upper right")
        low, high = left.get_ylim()
        left.set_ylim(low, 3.0 * high)
        save_small(figure, path, lines=True)


def write(folder, doc):
    """The page and its picture."""
    bench = read_bench(folder / "bench.csv")
    machine = json.loads((folder / "machine.json").read_text(encoding="utf-8"))
    share = of_step(bench).query("~at_once")["share"]
    speed_chart(bench, doc / "pictures" / "speed.png")
    write_page(doc, "speed", PAGE.format(
        yardstick=unit_of(bench, "yardstick"), bandwidth=unit_of(bench, "bandwidth"),
        share=f"{share.min():.0%} to {share.max():.0%}", goals=goal_table(bench),
        steps=step_table(bench), counts=count_table(bench), contact=contact_table(bench),
        search=search_table(bench), files=file_table(bench),
        machine="\n".join(f"- {name}: {value}" for name, value in machine.items())))


if __name__ == "__main__":
    write(*map(pathlib.Path, sys.argv[1:]))
