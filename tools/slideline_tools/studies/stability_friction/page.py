# SPDX-License-Identifier: MIT
"""The map of the flutter and its page."""
from __future__ import annotations

import functools

import numpy as np
from matplotlib.colors import LogNorm

from slideline_tools.plots import PAGE_WIDTH, plt
from slideline_tools.studies.common import label, markdown_table, save_small, write_page
from slideline_tools.studies.framework.charts import styled
from slideline_tools.studies.framework.rules import between, names
from slideline_tools.studies.framework.table import finished
from slideline_tools.studies.stability_friction.measures import LARGEST, STRETCH
from slideline_tools.studies.stability_friction.scene import (FOLDS, KICK, PRESSURE, SPEED, STEPS, YOUNG, flutter)
from slideline_tools.studies.stability_friction.texts import PAGE

THOUSAND = 1000.0
TELLING = 8.0   # e-folds by prediction from which a run must show its rate
FEW = 0.1       # e-folds in 1000 steps: what a table rounds to
ROWS = (("rate", "measured"), ("predicted", "by eigenvalue"))


@functools.lru_cache(maxsize=None)
def element_step():
    """Shortest stable step of the elements alone, s: the unit of time of the page."""
    model = flutter(5).model
    return model.limit(np.zeros((len(model.x),) * 2))


def folds(rate):
    """E-folds in 1000 shortest stable steps of the elements."""
    return THOUSAND * rate * element_step()


def of_map(rows):
    """Finished runs of the map, by type."""
    found = {}
    for row in finished(rows):
        if row["kind"] == "map":
            found.setdefault(row["type"], []).append(row)
    return dict(sorted(found.items()))


def value(rows, friction, ratio, name):
    """A column of one cell; nan where it has not run."""
    return next((row[name] for row in rows if (row["friction"], row["ratio"]) == (friction, ratio)), np.nan)


def axes_of(by_type):
    """Coefficients and ratios that have run."""
    rows = [row for own in by_type.values() for row in own]
    return sorted({row["friction"] for row in rows}), sorted({row["ratio"] for row in rows})


def draw_map(rows):
    """Measured growth above that by eigenvalue, a column for each type."""
    by_type = of_map(rows)
    frictions, ratios = axes_of(by_type)
    cells = {(ctype, name): np.array([[folds(value(own, friction, ratio, name)) for friction in frictions]
                                      for ratio in ratios]) for ctype, own in by_type.items() for name, _ in ROWS}
    top = max(np.nanmax(one) for one in cells.values())
    figure, panels = plt.subplots(2, len(by_type), squeeze=False, sharex=True, sharey=True, layout="constrained",
                                  figsize=(PAGE_WIDTH + 2.0, 3.6))
    for number, (line, (name, words)) in enumerate(zip(panels, ROWS)):
        for axes, ctype in zip(line, by_type):
            artist = axes.imshow(np.ma.masked_less(cells[ctype, name], FEW), origin="lower", aspect="auto", cmap="YlOrRd",
                                 norm=LogNorm(FEW, top), interpolation="nearest")
            axes.set_xticks(range(len(frictions)), [f"{one:g}" for one in frictions], fontsize=6, rotation=90)
            axes.set_yticks(range(len(ratios)), [f"{one:g}" for one in ratios], fontsize=7)
            if number == 0:
                axes.set_title(label(ctype), fontsize=7)
        line[0].set_ylabel(f"{words}:\npenalty over K L/A", fontsize=7)
    figure.supxlabel("coefficient of friction", fontsize=8)
    bar = figure.colorbar(artist, ax=panels, aspect=30, pad=0.01)
    bar.set_label(f"e-folds in 1000 steps of L/c\n(white: below {FEW:g})", fontsize=7)
    return figure


def pair(row):
    """'3.4 (3.5)': measured and predicted e-folds; '-' where nothing grows."""
    texts = ["-" if folds(row[name]) < 0.5 * FEW else f"{folds(row[name]):.1f}" for name, _ in ROWS]
    return f"{texts[0]} ({texts[1]})"


def map_table(own):
    """Growth of one type: a row for each penalty."""
    frictions, ratios = axes_of({0: own})
    cells = {(row["friction"], row["ratio"]): pair(row) for row in own}
    return markdown_table(["penalty over K L/A", *(f"mu {one:g}" for one in frictions)],
                          [[f"{ratio:g}", *(cells.get((friction, ratio), "") for friction in frictions)]
                           for ratio in ratios])


def expected_folds(row):
    """E-folds that the run could show, by the prediction."""
    return min(FOLDS, row["predicted"] * row["step"] * STEPS[1])


def penalty_table(by_type):
    """Range of the growth over the types: a row for each penalty."""
    frictions, ratios = axes_of(by_type)
    rows = [row for own in by_type.values() for row in own]
    lines = []
    for ratio in ratios:
        found = [[folds(row["rate"]) for row in rows if (row["ratio"], row["friction"]) == (ratio, friction)]
                 for friction in frictions]
        lines.append([f"{ratio:g}", *(between(rates, "{:.1f}") if rates else "" for rates in found)])
    return markdown_table(["penalty over K L/A", *(f"mu {one:g}" for one in frictions)], lines)


def still_growing(rows):
    """(runs with another cure than mass damping in which something still grows, all of these)."""
    there = [row for row in finished(rows) if row["kind"] not in ("map", "mass")]
    return sum(row["rate"] > 0.0 for row in there), len(there)


def agreement(by_type):
    """One row a type: how measured and predicted rates compare where a run has the time to show one."""
    lines = []
    for ctype, own in by_type.items():
        told = [row["rate"] / row["predicted"] for row in own if expected_folds(row) > TELLING]
        calm = [row for row in own if expected_folds(row) <= 1.0]
        lines.append([label(ctype), len(told), f"{np.median(told):.2f}" if told else "",
                      between(told) if told else "", len(calm), sum(row["rate"] == 0.0 for row in calm)])
    return markdown_table(["type", "cells that should grow", "measured over predicted, median", "smallest to largest",
                           "cells that should not", "of these calm"], lines)


def threshold_table(by_type):
    """Growth at each coefficient, as the range over penalties."""
    frictions, _ = axes_of(by_type)
    lines = []
    for ctype, own in by_type.items():
        line = [label(ctype)]
        for friction in frictions:
            rates = [folds(row["rate"]) for row in own if row["friction"] == friction]
            line.append(between(rates, "{:.1f}") if rates else "")
        lines.append(line)
    return markdown_table(["type", *(f"mu {one:g}" for one in frictions)], lines)


CURES = {"vdc": ("VDC, per cent of critical", "{:g}"), "mass": ("mass damping D, over twice the predicted rate", "{:g}"),
         "viscosity": ("bulk viscosity, Q2", "{:g}"), "hourglass": ("viscous hourglass control, QH", "{:g}")}


def cure_table(rows):
    """Growth with each cure, and the frequency of what still grows."""
    cured = [row for row in finished(rows) if row["kind"] != "map"]
    types = sorted({row["type"] for row in cured})
    plain = [row for row in finished(rows) if row["kind"] == "map" and row["type"] in types and cured
             and (row["friction"], row["ratio"]) == (cured[0]["friction"], cured[0]["ratio"])]
    lines = [["none", "", *(growth(row) for row in sorted(plain, key=lambda row: row["type"]))]]
    for kind, (words, form) in CURES.items():
        for amount in sorted({row["amount"] for row in cured if row["kind"] == kind}):
            there = {row["type"]: row for row in cured if (row["kind"], row["amount"]) == (kind, amount)}
            lines.append([words, form.format(amount), *(growth(there[ctype]) if ctype in there else "" for ctype in types)])
    return markdown_table(["cure", "amount", *(f"type {ctype}: e-folds in 1000 steps, frequency times L/c" for ctype in types)],
                          lines)


def growth(row):
    """'8.1 at 1.62'; 'calm' where nothing grows."""
    if row["rate"] == 0.0:
        return "calm"
    return f"{folds(row['rate']):.1f} at {row['omega'] * element_step():.2f}"


def mode_text(ctype, friction, ratio):
    """The motions that grow in one cell, by the prediction: '34.9 at 1.58, ...'."""
    found = flutter(ctype).motions(friction, ratio)
    return ", ".join(f"{folds(rate):.1f} at {omega * element_step():.2f}" for rate, omega in found)


def cured_by_mass(rows):
    """(calm at D above the predicted bound, all of these)."""
    there = [row for row in finished(rows) if row["kind"] == "mass" and row["amount"] > 1.0]
    return sum(row["rate"] == 0.0 for row in there), len(there)


def write_friction_page(rows, doc):
    """doc/studies/stability_friction.md and doc/pictures/stability_friction.png."""
    by_type = of_map(rows)
    with styled():
        save_small(draw_map(rows), doc / "pictures" / "stability_friction.png")
    cells = [row for own in by_type.values() for row in own]
    frictions, _ = axes_of(by_type)
    calmest = {friction: [ctype for ctype, own in by_type.items()
                          if all(row["rate"] == 0.0 for row in own if row["friction"] == friction)] for friction in frictions}
    shown = [ctype for ctype in (5, 7) if ctype in by_type]
    cured = [row for row in finished(rows) if row["kind"] != "map"]
    calm, held = cured_by_mass(rows)
    growing, others = still_growing(rows)
    write_page(doc, "stability_friction", PAGE.format(
        pressure=PRESSURE / YOUNG, speed=SPEED, kick=KICK, largest=LARGEST, stretch=STRETCH, n_cells=len(cells),
        telling=TELLING, longest=STEPS[1], agreement=agreement(by_type), ranges=threshold_table(by_type), penalties=penalty_table(by_type),
        tables="\n\n".join(f"Type {label(ctype)}:\n\n{map_table(by_type[ctype])}" for ctype in shown),
        calm="; ".join(f"mu {friction:g}: {names(types)}" for friction, types in calmest.items()),
        cures=cure_table(rows) if cured else "(not run)", calm_mass=calm, n_mass=held, growing=growing, others=others,
        modes="; ".join(f"type {ctype}: {mode_text(ctype, cured[0]['friction'], cured[0]['ratio'])}" for ctype in shown)
        if cured else ""))
