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

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.scenes import block_grids
from slideline_tools.studies import block, sliding
from slideline_tools.studies.common import TYPES, label, markdown_table, write_page
from slideline_tools.study.table import read_rows
from slideline_tools.study.times import Times

LEVELS = {"sliding": (1, 2, 3), "collision": (1, 2, 3, 4)}


def verdict(answers):
    """'yes' if all answers hold, 'no' if none does, else 'partly'."""
    answers = list(answers)
    return "yes" if all(answers) else "partly" if any(answers) else "no"


def least(values, among):
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


def level_table(figures):
    """Table of {level: {type: figure}}."""
    return markdown_table(["type"] + [f"N_r = {level}" for level in figures],
                          [[label(ctype)] + [row[ctype] for row in figures.values()]
                           for ctype in TYPES])


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
section tells. The claims are those of Kang, Lee & Shin (2023), the source;
its text compares types 1, 3, 4, 5 and 6. Dimensions that it does not give are ours, and
its program and machine are others: compare ratios.

| claim | answer |
|---|---|
{summary}

## 1. NTS-mAR has the fewest force peaks: {fewest}

Abrupt peaks of the sliding scene, as defined in [sliding.md](sliding.md). Yes means: type 5 has
fewer than types 1, 3, 4 and 6 at every level. Fewer than types 1, 3 and 4, the NTS family, at
{nts_levels}.

{counts}

## 2. Its peaks are larger: {larger}

Largest |r| of the sliding scene in % of the mean force, as defined there. Yes means: that of type 5
exceeds those of types 3, 4 and 6 at every level. It does at {larger_levels}.

{largest}

## 3. The mortar history is the smoothest: {smooth}

Yes means: of types 1, 3, 4, 5 and 6, type 6 has the smallest rms of r (fast roughness) and the
smallest waviness (slow swing over a master segment) at every level. Smallest rms at {rms_levels},
smallest waviness at {wave_levels}. Both in % of the mean force.

The source also finds NTS-mAR smoother than VTS-PPT: {smoother}. Its rms is smaller at
{calm_levels}, its waviness at {still_levels}.

rms:

{rms}

waviness:

{waviness}

## 4. NTS overestimates and two-pass NTS-AR underestimates the pressure at the end: {end}

Block-to-block, end node of the slave surface at 0.2 s, see [block_to_block.md](block_to_block.md):
pressure (nodal force over its length) against the chain, and penetration of the end against the
mean one, both in %. Yes means: the pressure of type 1 is above and that of type 3 below the
chain's; partly: one of them, or type 3 by its penetration only.

{ends}

## 5. At most N - 1 master-to-slave points for N touching slave nodes: {points}

The source says so where the master is not finer than the slave. In the sliding scene the master is
twice as coarse: {states} states with contact over all levels, at most {most} such points with
{of} touching slave nodes. Yes means: never above N - 1; partly: in less than 5 % of
the states. It is above in {above} states, which have at most {above_of} touching slave nodes: a
segment of which only one end touches can have a master node that touches too. With slave and
master exchanged, the master twice as fine, there are up to {exchanged_most} such points with
{exchanged_of} touching slave nodes, and {exchanged_above} of {exchanged_states} states are above
N - 1: the bound needs its condition.

## 6. Step M is cheaper than steps A and B: {pairing}

The timing has no M of its own for types 1, 2, 3 and 6, whose placing counts as B. Yes
means: in types 4 and 5, M takes less time than A and less than B in every run; partly: less than both in some;
no: in none. It does in {paired} of {n_paired}. M over A and M over B:

{pairings}

Here A is cheap because a touching node keeps its segment from step to step and is not searched
for again, and nodes far from the other body sleep. What is called M here places the points:
portions of the master and their shares in type 4, pieces of the slave segments and projected
master nodes in type 5.

## 7. The contact cost of the collision is mostly detection: {detection}

Yes means: step A takes more than half of the contact time of the collision in types 1, 3, 4, 5 and
6 at every level. It does in {detections} of {n_detections} runs. Share of step A in the contact time:

{shares}

## 8. NTS-mAR is the cheapest remedy: {cheap}

Yes means: of types 3, 4, 5 and 6, type 5 has the smallest contact time at every level of the sliding and the
collision. It has in {cheapest}. Contact time over that of the classical one-pass NTS, steps A + M + B:

{ratios}

[paper_tables.md](paper_tables.md) has the times by step beside those of the source, and how they are
measured.
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
    rms, wave = ([least(row, (1, 3, 4, 5, 6)) == 6 for row in figures.values()]
                 for figures in (peaks.rms, peaks.waviness))
    calm, still = ([row[5] < row[4] for row in figures.values()]
                   for figures in (peaks.rms, peaks.waviness))
    return {
        "fewest": "yes" if all(every) else verdict(every + nts),
        "nts_levels": levels_text(nts, levels), "counts": level_table(peaks.count),
        "larger": verdict(larger), "larger_levels": levels_text(larger, levels),
        "largest": level_table(peaks.largest), "smooth": verdict(rms + wave),
        "smoother": verdict(calm + still),
        "calm_levels": levels_text(calm, levels), "still_levels": levels_text(still, levels),
        "rms_levels": levels_text(rms, levels), "wave_levels": levels_text(wave, levels),
        "rms": level_table(peaks.rms), "waviness": level_table(peaks.waviness)}


def end_texts(ends):
    """The texts of claim 4."""
    over, under, shallow = ends[1][0] > 0.0, ends[3][0] < 0.0, ends[3][1] < 0.0
    return {"end": "yes" if over and under else "partly" if over or under or shallow else "no",
            "ends": markdown_table(
                ["type", "pressure of the end node, %", "penetration of the end node, %"],
                [[label(k), *(f"{100.0 * value:+.3f}" for value in pair)]
                 for k, pair in ends.items()])}


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


def time_texts(slide, crash):
    """The texts of claims 6 to 8."""
    names, cases = [], []
    for times in (slide, crash):
        for level in LEVELS[times.scene]:
            if not all(times.has(level, ctype) for ctype in TYPES):
                raise UserError(f"{times.scene}: not all types have been timed at N_r = {level}")
            names.append(f"{times.scene}, N_r = {level}")
            cases.append(times.seconds[level])
    pairings = [[row[k]["pairing"] / row[k][step] for k in (4, 5) for step in ("search", "force")]
                for row in cases]
    cheaper = [max(pair) < 1.0 for row in pairings for pair in (row[:2], row[2:])]
    shares = [{k: row[k]["search"] / row[k]["contact"] for k in TYPES} for row in cases]
    ratios = [{k: row[k]["contact"] / row[1]["contact"] for k in TYPES} for row in cases]
    detected = [row[k] > 0.5 for name, row in zip(names, shares)
                for k in (1, 3, 4, 5, 6) if name.startswith(crash.scene)]
    cheapest = [least(row, (3, 4, 5, 6)) == 5 for row in ratios]
    heads = ["run", *(label(k) for k in TYPES)]
    return {
        "pairing": verdict(cheaper), "paired": sum(cheaper), "n_paired": len(cheaper),
        "pairings": markdown_table(
            ["run", "type 4: M/A", "M/B", "type 5: M/A", "M/B"],
            [[name, *(f"{ratio:.2f}" for ratio in row)] for name, row in zip(names, pairings)]),
        "detection": verdict(detected), "detections": sum(detected), "n_detections": len(detected),
        "shares": markdown_table(heads, [[name, *(f"{100.0 * row[k]:.0f} %" for k in TYPES)]
                                         for name, row in zip(names, shares)]),
        "cheap": verdict(cheapest), "cheapest": f"{sum(cheapest)} of {len(cheapest)} cases",
        "ratios": markdown_table(heads, [[name, *(f"{row[k]:.2f}" for k in TYPES)]
                                         for name, row in zip(names, ratios)])}


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
    rows = read_rows(times)
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
