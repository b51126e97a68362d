# SPDX-License-Identifier: MIT
"""The claims of Kang, Lee & Shin (2023) about the contact types, answered from runs.

    python -m slideline_tools.studies.claims RUNS TIMES.csv DOC

RUNS holds the folders block, sliding, collision and claims of the batch jobs; TIMES.csv is the table
of the study paper-tables; the page goes to DOC/studies.
"""
import argparse
import pathlib
import sys

import numpy as np
import pandas as pd

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.scenes import block_grids
from slideline_tools.studies import block, sliding
from slideline_tools.studies.common import TYPES, write_page
from slideline_tools.studies.framework.rules import COST_FACTOR, between, least, share_verdict
from slideline_tools.studies.framework.times import Times
from slideline_tools.studies.speed_accuracy.front import geometric_mean

LEVELS = {"sliding": (1, 2, 3), "collision": (1, 2, 3, 4)}
COMPARED, REMEDIES = (1, 3, 4, 5, 6), (3, 4, 5, 6)  # the types of the source


def smallest(values, among):
    """The key among `among` with the smallest value."""
    return min(among, key=lambda key: values[key])


# ---- force peaks -------------------------------------------------------------------------------

class PeakFigures:
    """Peaks of the sliding runs: dicts by level, of dicts by type."""

    def __init__(self, folder):
        runs = {level: [sliding.Run(folder, level, ctype) for ctype in TYPES]
                for level in LEVELS["sliding"]}
        found = {level: {run.ctype: run.peaks() for run in row} for level, row in runs.items()}
        self.count = self.of(found, lambda peaks: peaks.count)
        self.largest = self.of(found, lambda peaks: 100.0 * peaks.largest)
        self.rms = self.of(found, lambda peaks: 100.0 * peaks.rms)
        self.waviness = {level: {run.ctype: 100.0 * run.waviness() for run in row}
                         for level, row in runs.items()}

    @staticmethod
    def of(found, figure):
        """The same nesting with one figure of each Peaks."""
        return {level: {ctype: figure(peaks) for ctype, peaks in row.items()}
                for level, row in found.items()}


def fewest_peaks(peaks):
    """Answers whether type 5 has the fewest peaks, of the source's types and of its NTS types."""
    every = [row[5] < min(row[k] for k in (1, 3, 4, 6)) for row in peaks.count.values()]
    nts = [row[5] < min(row[k] for k in (1, 3, 4)) for row in peaks.count.values()]
    return every, nts


# ---- pressure at the end -----------------------------------------------------------------------

def end_pressures(folder):
    """{type: (slave end node, penetration of the end)}, each over the chain's or mean value - 1."""
    chain = read_csv(folder / "chain.csv")
    grids = block_grids(block.N_SLAVE, block.N_MASTER)
    figures = {}
    for ctype in TYPES:
        run = block.read_pressures(folder / f"type_{ctype}", grids)
        exact = block.chain_pressure(chain, block.interface_stiffness(ctype))
        figures[ctype] = (float(run.slave[0] / exact - 1.0), float(run.end_depth))
    return figures


# ---- master-to-slave points --------------------------------------------------------------------

def added_points(folder):
    """(touching slave nodes, master-to-slave points) of type 5 at each state with contact."""
    contact = read_csv(folder / "sliding.contact.csv")
    force = read_csv(folder / "sliding.rcforc.csv").where(side="slave")
    counts = []
    for time in np.unique(contact["time"]):
        touching = int(np.sum(contact.where(time=time)["gap"] < 0.0))
        row = int(np.argmin(np.abs(force["time"] - time)))
        if touching:
            counts.append((touching, int(force["n_active"][row]) - touching))
    if not counts:
        raise UserError(f"{folder}: no contact")
    return np.array(counts)


# ---- the page ----------------------------------------------------------------------------------

PAGE = """# The claims about the contact types, answered

This page is written by `tools/batch/claims.sh` from runs: do not edit it. The verdicts follow from
the figures by the rules stated here; "partly" means in some of the runs, or in part of the sense, as the
section tells. The figures stand in the pages that the sections name. The claims are those of Kang, Lee & Shin (2023), the source;
its text compares types 1, 3, 4, 5 and 6. Type 3 has the source's penalty, with which it is the stiffer interface. Dimensions that
the source does not give are ours, and its program and machine are others. It has no friction.

| claim | answer |
|---|---|
{summary}

## 1. NTS-mAR has the fewest force peaks: {fewest}

Abrupt peaks of the sliding scene: [sliding.md](sliding.md), column *peaks*. Yes means: type 5 has
fewer than types 1, 3, 4 and 6 at every level. Fewer than all four at {every_levels}; fewer than types 1, 3 and 4, the NTS family, at
{nts_levels}.

## 2. Its peaks are larger: {larger}

The same tables, column *largest*. Yes means: that of type 5
exceeds those of types 3, 4 and 6 at every level. It does at {larger_levels}.

## 3. The mortar history is the smoothest: {smooth}

The same tables, columns *rms* (fast roughness) and *waviness* (slow swing over a master segment). Yes means: of types 1, 3, 4, 5 and 6,
type 6 has the smallest of both at every level. Smallest rms at {rms_levels}, smallest waviness at {wave_levels}.

The source also finds NTS-mAR smoother than VTS-PPT: {smoother}. Its rms is smaller at
{calm_levels}, its waviness at {still_levels}.

## 4. NTS overestimates and two-pass NTS-AR underestimates the pressure at the end: {end}

Block-to-block, end node of the slave surface at 0.2 s ([block_to_block.md](block_to_block.md)). Yes means: the pressure (nodal force over
its length) of type 1 is above and that of type 3 below the chain's; partly: one of them, or type 3 by its penetration only. Type 1
{over} %, type 3 {under} %; penetration of the end against the mean one in type 3 {shallow} %.

## 5. At most N - 1 master-to-slave points for N touching slave nodes: {points}

The source says so where the master is not finer than the slave. In the sliding scene the master is
twice as coarse: {states} states with contact over all levels, at most {most} such points with
{of} touching slave nodes. Yes means: never above N - 1; partly: in less than 5 % of
the states. It is above in {above} states, which have at most {above_of} touching slave nodes: a
segment of which only one end touches can have a master node that touches too. With slave and
master exchanged, the master twice as fine, there are up to {exchanged_most} such points with
{exchanged_of} touching slave nodes, and {exchanged_above} of {exchanged_states} states are above
N - 1: the bound needs its condition.

Sections 6 to 8 follow from the steps in [paper_tables.md](paper_tables.md), for the sliding and the collision.

## 6. Step M is cheaper than steps A and B: {pairing}

The timing has no M of its own for types 1, 2, 3 and 6, whose placing counts as B. Yes
means: in types 4 and 5, M takes less time than A and less than B in every run; partly: less than both in some;
no: in none. It does in {paired} of {n_paired}: M over A is {over_a}, M over B {over_b}. What is called M here places the points:
portions of the master and their shares in type 4, pieces of the slave segments and projected master nodes in type 5.

## 7. The contact cost of the collision is mostly detection: {detection}

Yes means: in each of types 1, 3, 4, 5 and 6 step A takes half of the contact time of the collision or more (mean over the levels; less
by less than a factor of {factor:g} counts as half); partly: in some of them. Shares of step A: {shares}.

## 8. NTS-mAR is the cheapest remedy: {cheap}

Yes means: of types 3, 4, 5 and 6, type 5 alone has the least contact time, in the sliding and in the collision; partly: in one of
them, or together with others. Contact times (geometric means over the levels) that differ by less than a factor of {factor:g} count as alike,
so that a repeat does not change the answer. Type 5 over the least of the others: {cheapest}.
"""


def levels_text(answers, levels):
    """'N_r = 1, 3' for the levels at which the answer is true."""
    held = [str(level) for level, answer in zip(levels, answers) if answer]
    return "N_r = " + ", ".join(held) if held else "no level"


def peak_texts(peaks):
    """The texts of claims 1 to 3."""
    levels = LEVELS["sliding"]
    every, nts = fewest_peaks(peaks)
    larger = [row[5] > max(row[k] for k in (3, 4, 6)) for row in peaks.largest.values()]
    rms, wave = ([smallest(row, COMPARED) == 6 for row in figures.values()]
                 for figures in (peaks.rms, peaks.waviness))
    calm, still = ([row[5] < row[4] for row in figures.values()]
                   for figures in (peaks.rms, peaks.waviness))
    return {
        "fewest": "yes" if all(every) else share_verdict(every + nts),
        "every_levels": levels_text(every, levels), "nts_levels": levels_text(nts, levels),
        "larger": share_verdict(larger), "larger_levels": levels_text(larger, levels),
        "smooth": share_verdict(rms + wave), "smoother": share_verdict(calm + still),
        "calm_levels": levels_text(calm, levels), "still_levels": levels_text(still, levels),
        "rms_levels": levels_text(rms, levels), "wave_levels": levels_text(wave, levels)}


def end_texts(ends):
    """The texts of claim 4."""
    over, under, shallow = ends[1][0] > 0.0, ends[3][0] < 0.0, ends[3][1] < 0.0
    return {"end": "yes" if over and under else "partly" if over or under or shallow else "no",
            **{name: f"{100.0 * value:+.3f}" for name, value in
               (("over", ends[1][0]), ("under", ends[3][0]), ("shallow", ends[3][1]))}}


def point_texts(normal, exchanged):
    """The texts of claim 5."""
    texts = {}
    for prefix, counts in (("", normal), ("exchanged_", exchanged)):
        top = counts[np.argmax(counts[:, 1])]
        above = counts[:, 1] > counts[:, 0] - 1
        texts.update({prefix + "states": len(counts), prefix + "most": top[1],
                      prefix + "of": top[0], prefix + "above": int(np.sum(above)),
                      prefix + "above_of": int(np.max(counts[above, 0], initial=0))})
    share = texts["above"] / texts["states"]
    texts["points"] = "yes" if share == 0.0 else "partly" if share < 0.05 else "no"
    return texts


def mean_by_type(times, value):
    """{type: geometric mean over the levels of value(level, type)}."""
    return {ctype: geometric_mean(value(level, ctype) for level in LEVELS[times.scene]) for ctype in TYPES}


def time_texts(slide, crash):
    """The texts of claims 6 to 8."""
    for times in (slide, crash):
        for level in LEVELS[times.scene]:
            if not all(times.has(level, ctype) for ctype in TYPES):
                raise UserError(f"{times.scene}: not all types have been timed at N_r = {level}")
    rows = [times.seconds[level][ctype] for times in (slide, crash)
            for level in LEVELS[times.scene] for ctype in (4, 5)]
    over = {step: [row["pairing"] / row[step] for row in rows] for step in ("search", "force")}
    cheaper = [max(pair) < 1.0 for pair in zip(*over.values())]
    shares = mean_by_type(crash, lambda level, k: crash.seconds[level][k]["search"]
                          / crash.seconds[level][k]["contact"])
    costs = {times.scene: {k: value for k, value in mean_by_type(times, times.ratio).items() if k in REMEDIES}
             for times in (slide, crash)}
    rivals = {scene: smallest(row, [k for k in REMEDIES if k != 5]) for scene, row in costs.items()}
    return {
        "pairing": share_verdict(cheaper), "paired": sum(cheaper), "n_paired": len(cheaper),
        "over_a": between(over["search"]), "over_b": between(over["force"]),
        "detection": share_verdict(shares[k] * COST_FACTOR > 0.5 for k in COMPARED), "factor": COST_FACTOR,
        "shares": ", ".join(f"type {k} {100.0 * shares[k]:.0f} %" for k in COMPARED),
        "cheap": remedy_verdict(least(row, COST_FACTOR) for row in costs.values()),
        "cheapest": ", ".join(f"{row[5] / row[rivals[scene]]:.2f} in the {scene} (type {rivals[scene]})"
                              for scene, row in costs.items())}


def remedy_verdict(first):
    """Whether type 5 is the cheapest; `first`: the types of least cost, scene by scene."""
    first = list(first)
    if all(types == [5] for types in first):
        return "yes"
    return "partly" if any(5 in types for types in first) else "no"


CLAIMS = (("NTS-mAR has the fewest force peaks", "fewest"),
          ("... but larger ones", "larger"),
          ("the mortar history is the smoothest", "smooth"),
          ("NTS-mAR is smoother than VTS-PPT", "smoother"),
          ("NTS over- and two-pass NTS-AR underestimates the pressure at the end", "end"),
          ("at most N - 1 master-to-slave points", "points"),
          ("step M is cheaper than A and B", "pairing"),
          ("the collision's contact cost is mostly detection", "detection"),
          ("NTS-mAR is the cheapest remedy", "cheap"))


def write(folder, times, doc):
    """Read the runs below `folder` and the table `times`, write the page below `doc`."""
    texts = peak_texts(PeakFigures(folder / "sliding"))
    texts.update(end_texts(end_pressures(folder / "block")))
    normal = [added_points(folder / "sliding" / f"level_{level}_type_5")
              for level in LEVELS["sliding"]]
    texts.update(point_texts(np.concatenate(normal),
                             added_points(folder / "claims" / "exchanged")))
    try:
        rows = pd.read_csv(times)
    except OSError as problem:
        raise UserError(f"cannot read {times}: {problem}") from problem
    texts.update(time_texts(*(Times(rows, scene) for scene in LEVELS)))
    texts["summary"] = "\n".join(f"| {text} | {texts[name]} |" for text, name in CLAIMS)
    write_page(doc, "claims", PAGE.format(**texts))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("times", type=pathlib.Path)
    parser.add_argument("doc", type=pathlib.Path)
    options = parser.parse_args()
    try:
        write(options.folder, options.times, options.doc)
    except UserError as problem:
        print(problem, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
