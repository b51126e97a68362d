# SPDX-License-Identifier: MIT
"""The figures of doc/studies/peers.md, from the tables of tests/lab/bench/peers/run.sh.

    peers_page.py FOLDER DOC

FOLDER holds elements.csv, collision.csv, contact.csv and versions.txt, and counts.csv where
instructions could be counted.
"""
import pathlib
import sys

import pandas as pd

from slideline_tools import UserError
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.studies.common import markdown_table, save_small, write_page
from slideline_tools.studies.framework.table import COUNTED, who_counted

PEERS = ("akantu", "KratosMultiphysics", "KratosStructuralMechanicsApplication",
         "KratosContactStructuralMechanicsApplication", "CalculiX", "OpenRadioss", "slideline",
         "flags")
SAME = ["scene", "elements"]         # what is compared
VARIANT = [*SAME, "program", "what"]  # what: the element or the contact

PAGE = """# Side by side with other programs

All programs in turn on one machine, one thread each: medians of {rounds} rounds with quartiles;
K is the yardstick measured beside each run, a median of {yardstick:.2f} ns. {counted}

{versions}

## The element step

Processor time of an element and step, ns; over slideline's element of 2x2 points; displacement of
the free side over V/w. The answers of a size lie within {apart:.0e} of each other.

{elements}

## Collision

Processor time of an element and step, ns; over type 2; speeds over V/2; momentum over that of a
block.

{collision}

## Static patch and blocks

Processor time of the process, s, in millions of K, over type 5; mean of -s_yy; largest deviation of
an element.

{contact}
"""


def read_table(path):
    """A table of run.sh."""
    if not path.exists():
        raise UserError(f"{path} is missing: run tests/lab/bench/peers/run.sh")
    return pd.read_csv(path)


def read_runs(folder, name, what, seconds, base, to_ns=1.0):
    """A table of runs with the columns `VARIANT`, `time`, `yardsticks` and `ratio`, which is that
    to slideline's variant `base` in the same round."""
    runs = read_table(folder / f"{name}.csv").rename(columns={what: "what", seconds: "time"})
    if "scene" not in runs:
        runs["scene"] = "step" if name == "elements" else name
    runs["yardsticks"] = to_ns * runs["time"] / runs["yardstick_ns"]
    is_base = (runs["program"] == "slideline") & (runs["what"] == base)
    of_base = runs["time"].where(is_base).groupby([runs[key] for key in [*SAME, "round"]])
    runs["ratio"] = runs["time"] / of_base.transform("max")
    return runs


def summary(runs, counts):
    """What all three tables of the page show, a row for each variant, and the first run of each."""
    groups = runs.groupby(VARIANT, sort=False)
    low, high = groups["time"].quantile(0.25), groups["time"].quantile(0.75)
    found = groups[["time", "yardsticks", "ratio"]].median()
    spread = [f"{middle:.3g} ({one:.3g} to {other:.3g})"
              for middle, one, other in zip(found["time"], low, high)]
    shown = pd.DataFrame({"time": spread, "K": found["yardsticks"].map("{:.3g}".format),
                          "ratio": found["ratio"].map("{:.2f}".format)}, index=found.index)
    shown["instructions"] = counts.reindex(found.index)
    return shown, groups.first()


def read_counts(path):
    """Instructions by variant, and who counted them."""
    if path.exists():
        counts = read_table(path).assign(state=COUNTED)
    else:
        counts = pd.DataFrame(columns=[*VARIANT, "instructions", "state"])
    return counts.set_index(VARIANT)["instructions"], who_counted(counts)


def table_of(shown, **answers):
    """The Markdown table of a summary and its answers."""
    shown = shown.assign(**answers).reset_index().drop(columns="scene")
    return markdown_table(shown.rename(columns={"what": "element or contact"}))


def element_table(runs, counts):
    """One row per program and size."""
    shown, first = summary(runs, counts)
    error = (first["free_side"] - first["exact"]).map("{:+.1e}".format)
    return table_of(shown, free_side=first["free_side"].map("{:.8f}".format), error=error)


def collision_table(runs, counts):
    """One row per size, program and contact."""
    shown, first = summary(runs, counts)
    return table_of(shown, upper=first["upper"].map("{:.4f}".format),
                    lower=first["lower"].map("{:.4f}".format),
                    momentum=first["momentum"].map("{:.1e}".format))


def contact_table(runs, counts):
    """One row per scene, size, program and contact; what has no answer was refused."""
    tables = []
    for scene, same in runs.groupby("scene", sort=False):
        shown, first = summary(same, counts)
        error = (first["mean"] / first["exact"] - 1.0).map(size)
        tables.append(f"{scene}:\n\n" + table_of(shown, mean=first["mean"], error=error,
                                                 deviation=first["deviation"].map(size)))
    return "\n\n".join(tables)


def size(value):
    """A relative error; what seven digits can not tell from none by their bound."""
    if value != value:
        return "refused"
    return f"{value:.1e}" if abs(value) >= 1.0e-6 else "< 1e-6"


def step_figure(runs):
    """Bars of the time of an element and step, by program and element, a shade for each size."""
    times = runs.groupby(["program", "what", "elements"], sort=False)["time"].median().unstack()
    figure, axes = plt.subplots(figsize=(PAGE_WIDTH, 0.35 * len(times) + 0.6), layout="constrained")
    for number, elements in enumerate(times):
        places = [len(times) - k - 0.25 * number for k in range(len(times))]
        axes.barh(places, times[elements], 0.22, color=str(0.25 + 0.2 * number),
                  label=f"{elements} elements")
    axes.set_yticks([len(times) - k - 0.25 for k in range(len(times))],
                    [f"{program}, {element}" for program, element in times.index])
    axes.set_xscale("log")
    axes.set_xlabel("ns per element and step")
    axes.legend()
    return figure


def version_table(path):
    """The programs and their versions, as pip and the programs themselves say."""
    lines = path.read_text(encoding="utf-8").splitlines()
    found = dict(line.split("==", 1) for line in lines if "==" in line)
    found.update(line.split(maxsplit=1) for line in lines
                 if line.startswith(("slideline ", "flags ")))
    found.update(("CalculiX", line.split()[-1]) for line in lines if "Version" in line)
    return markdown_table(["program", "version"],
                          [[name, found[name]] for name in PEERS if name in found])


def write(folder, doc):
    """The page and its picture."""
    counts, counted = read_counts(folder / "counts.csv")
    elements = read_runs(folder, "elements", "element", "ns", "2x2 points, large strain")
    collision = read_runs(folder, "collision", "contact", "ns", "type 2")
    contact = read_runs(folder, "contact", "contact", "processor_seconds", "type 5", 1.0e3)
    with plt.rc_context(STYLE):
        save_small(step_figure(elements), doc / "pictures" / "peers.png", lines=True)
    ends = elements.groupby("elements")["free_side"]
    write_page(doc, "peers", PAGE.format(
        rounds=elements["round"].max(), counted=counted,
        yardstick=pd.concat([elements, collision, contact])["yardstick_ns"].median(),
        versions=version_table(folder / "versions.txt"), apart=(ends.max() - ends.min()).max(),
        elements=element_table(elements, counts), collision=collision_table(collision, counts),
        contact=contact_table(contact, counts)))


if __name__ == "__main__":
    write(*map(pathlib.Path, sys.argv[1:]))
