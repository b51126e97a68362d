# SPDX-License-Identifier: MIT
"""The sliding scene with all contact types: force histories, abrupt peaks, plastic strain.

    python -m slideline_tools.studies.sliding FOLDER DOC --levels 1 2 3

FOLDER holds the runs as level_L_type_T/sliding.*; the page goes to DOC/studies, its pictures
to DOC/pictures.
"""
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.results import read
from slideline_tools.scenes.sliding import DRAW, sliding_grids
from slideline_tools.studies import peaks
from slideline_tools.studies.common import (by_level, colour, field_panels, label,
                                            markdown_table, save_small, study_main, write_page)

JOB = "sliding"
PLATE = 1
SEGMENT = 1.0e-3  # master segment at level 1, m
WINDOW_SHARE = 1.0 / 16.0
THRESHOLD = 0.0025
STEPS_PER_ROW = 10
ENLARGED = (3.55e-3, 4.45e-3)


def judged_interval():
    """The times between which the force is judged: the inner three quarters of the stroke."""
    start, end, _ = DRAW
    return start + (end - start) / 8.0, end - (end - start) / 8.0


def crossing_time(level):
    """Mean time in which the die moves by one master segment, s."""
    start, end, distance = DRAW
    return (end - start) * SEGMENT / level / distance


def travel(time):
    """(n,) distance of the die's upper face along x, m."""
    start, end, distance = DRAW
    share = np.clip((time - start) / (end - start), 0.0, 1.0)
    return distance * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi))


class Run:
    """One run: `time` and vertical `force` on the plate by metre of depth, results on demand."""

    def __init__(self, folder, level, ctype):
        self.level, self.ctype = level, ctype
        self.folder = folder / f"level_{level}_type_{ctype}"
        rows = read_csv(self.folder / f"{JOB}.rcforc.csv").where(side="slave")
        self.time, self.force = rows["time"], rows["fy"]
        if not len(self.time) or self.time[-1] < DRAW[1] * (1.0 - 1e-6):
            raise UserError(f"{self.folder}: the run did not reach its end")
        self.results = read(self.folder / f"{JOB}.vtkhdf")

    def peaks(self, window=1.0, threshold=1.0, every=1):
        """Peaks of the force, with factors on window and threshold and every n-th row."""
        return peaks.abrupt_peaks(
            self.time[::every], self.force[::every],
            window * WINDOW_SHARE * crossing_time(self.level), threshold * THRESHOLD,
            judged_interval())

    def waviness(self):
        """Slow oscillation over one master segment, see peaks.waviness."""
        return peaks.waviness(self.time, self.force, travel(self.time), SEGMENT / self.level,
                              WINDOW_SHARE * crossing_time(self.level), judged_interval())

    def plastic_strain(self):
        """(n_cell of the plate,) effective plastic strain at the end."""
        plate = self.results.cell_field("part_id")[-1] == PLATE
        return self.results.cell_field("plastic_strain")[-1][plate]

    def energy_error(self):
        """Largest deviation of the energy ratio from 1."""
        ratio = read_csv(self.folder / f"{JOB}.glstat.csv")["energy_ratio"]
        return float(np.abs(ratio - 1.0).max())


# ---- tables ------------------------------------------------------------------------------------

def peak_table(runs):
    """Peaks, roughness and plastic strain of the runs of one level."""
    rows = []
    for run in runs:
        found, strain = run.peaks(), run.plastic_strain()
        rows.append([label(run.ctype), found.mean / 1e6, found.count, 100 * found.typical,
                     100 * found.largest, 100 * found.rms, 100 * run.waviness(),
                     float(strain.max()), f"{run.energy_error():.1e}"])
    return markdown_table(["type", "mean force, MN/m", "peaks", "median size, %",
                           "largest, %", "rms, %", "waviness, %", "largest plastic strain",
                           "energy error"], rows)


VARIANTS = ((1.0, 1.0), (1.0, 0.5), (1.0, 2.0), (0.5, 1.0), (2.0, 1.0))


def robustness_table(runs):
    """Peaks of the runs of one level with window and threshold halved and doubled."""
    rows = []
    for run in runs:
        counts = [run.peaks(window, threshold).count for window, threshold in VARIANTS]
        large = [100 * run.peaks(window).largest for window in (0.5, 2.0)]
        rough = [100 * run.peaks(window).rms for window in (0.5, 2.0)]
        coarse = run.peaks(every=5)
        rows.append([label(run.ctype), *counts, coarse.count, *large, 100 * coarse.largest,
                     *rough])
    return markdown_table(
        ["type", "peaks", "threshold / 2", "threshold x 2", "window / 2", "window x 2",
         "every 5th row", "largest, window / 2, %", "window x 2, %", "every 5th row, %",
         "rms, window / 2, %", "window x 2, %"], rows)


def sampling_change(runs):
    """By how much every fifth row alone changes the largest |r| at most, %."""
    return max(100.0 * abs(run.peaks(every=5).largest / run.peaks().largest - 1.0) for run in runs)


# ---- pictures ----------------------------------------------------------------------------------

def force_figure(runs):
    """Force of the runs over the whole time, enlarged, and what is left without the trend."""
    style = {**STYLE, "figure.dpi": 110, "savefig.dpi": 110, "lines.linewidth": 0.8}
    with plt.rc_context(style):
        figure, panels = plt.subplots(3, 1, layout="constrained", height_ratios=(2, 3, 3),
                                      figsize=(PAGE_WIDTH + 1.0, 9.0))
        spacing = 0.015
        for place, run in enumerate(runs):
            window = WINDOW_SHARE * crossing_time(run.level)
            line = dict(color=colour(run.ctype), label=label(run.ctype))
            mean = run.peaks().mean
            near = (run.time >= ENLARGED[0]) & (run.time <= ENLARGED[1])
            rest = run.force - peaks.trend(run.time, run.force, window)
            panels[0].plot(1e3 * run.time[::20], run.force[::20] / 1e6, **line)
            panels[1].plot(1e3 * run.time[near], run.force[near] / 1e6, **line)
            panels[2].plot(1e3 * run.time, 100 * (rest / mean - spacing * place), **line)
            panels[2].axhspan(100 * (-THRESHOLD - spacing * place),
                              100 * (THRESHOLD - spacing * place), color="#00000012", linewidth=0)
        panels[0].set_title("vertical contact force", loc="left")
        panels[1].set_title("the same, enlarged", loc="left")
        panels[2].set_title("force without its trend, each type shifted by 1.5 %; shaded: below "
                            "the threshold of a peak", loc="left")
        panels[2].set_xlim(1e3 * np.array(judged_interval()))
        for axes, text in zip(panels, ("MN/m", "MN/m", "% of the mean force")):
            axes.set_ylabel(text)
            axes.grid(True, linewidth=0.3, color="#bbbbbb")
        panels[0].legend(ncols=2)
        panels[2].set_xlabel("time, ms")
        return figure


# ---- the page ----------------------------------------------------------------------------------

PAGE = """# Sliding contact with all contact types

This page and its pictures are written by `tools/batch/sliding.sh`: do not edit it.

An elastic steel die with a crowned lower face (slave) is pressed 0.15 mm into an elastic, perfectly
plastic aluminium plate (master) and drawn 8 mm along it (Kang, Lee & Shin 2023, section 4.2, the
source; dimensions and motion that its text does not give are ours, see the deck). Decks:
`slideline-tools make-deck sliding --level N`. No friction, no damping but hourglass control of
the viscous form (0.1). Type 6 has 6 Gauss points. The penalty is the same for all types: with its second pass type 3 has
{stiffer:.2f} times the springs of the others (all at one stiffness: [speed_accuracy](speed_accuracy.md)).

## The measure of abrupt peaks

Node passing shows as bursts: the contact force jumps and the two bodies ring for some tens of
microseconds. (In the undeformed meshes some slave node passes a master node every half master
segment: {passes:.0f} times N_r in the time judged below.) Between the bursts the force swings
slowly, with the passage of the master segments. The measure
(`tools/slideline_tools/studies/peaks.py`, tested on made histories in `tests/tools/test_peaks.py`)
tells the two apart:

- The force F is written every {rows} steps and judged between {first:.4g} ms and {last:.4g} ms,
  while the die moves from {from_mm:.3g} mm to {to_mm:.3g} mm.
- Its *trend* is the running median over a window, smoothed by the running mean over the same
  window. The window is 1/{share:.0f} of the mean time in which the die passes one master segment:
  {window:.3g} microseconds over N_r.
- What is left is r = F - trend. A spike leaves its height, a step half its height.
- An *abrupt peak* is a place where |r| exceeds {threshold:g} % of the mean force in the judged
  time; places less than half a window apart are one peak. Its *size* is its largest |r| over the
  mean force. The threshold is the same for all types and levels.
- *largest* is the largest |r| and *rms* the root mean square of r, peak or not, over the mean
  force.
- *waviness* is the slow swing: the trend as a function of the distance travelled, less its running
  mean over one master segment, root mean square over the mean force.
- *energy error* is the largest deviation of the energy ratio from 1.

## Results

{tables}

![contact force](../pictures/sliding_force.png)

The picture shows N_r = {pictured}; Figs. 27 and 28 of the source show the same for its own
dimensions. Every run reached its end: the script stops otherwise.

Effective plastic strain at the end (6 ms), N_r = {pictured}, colours from 0.1 to 0.3 as in
Fig. 26 of the source:

![plastic strain](../pictures/sliding_plastic_strain.png)

## How far the measure depends on its two numbers

Number of peaks with the threshold ({threshold:g} %) or the window halved and doubled, and from
every fifth row of the histories only; then the largest |r| and the rms.

{robustness}

A window twice as wide lets the kinks of the slow swing into r (a node that starts or ceases to
touch); half as wide, the longer bursts fall into the trend. Every fifth row alone changes the largest |r| by {sampling:.0f} %
at most. A count jumps where most bursts of a type have
about the height of the threshold: read it together with the largest |r| and the rms, which need
none.
"""


def two_pass_stiffness():
    """Springs of both passes of type 3 over those of one: 1 + l_sl/l_ms."""
    plate, die = sliding_grids(1)
    slave, master = (np.linalg.norm(np.diff(line, axis=0), axis=1).mean()
                     for line in (die.points[:, 0], plate.points[:, -1]))
    return 1.0 + slave / master


def page(runs, pictured):
    first, last = judged_interval()
    moved = 1e3 * travel(np.array([first, last]))
    return PAGE.format(
        passes=(moved[1] - moved[0]) / (500 * SEGMENT), rows=STEPS_PER_ROW, first=1e3 * first,
        last=1e3 * last, from_mm=moved[0], to_mm=moved[1], share=1.0 / WINDOW_SHARE,
        window=1e6 * WINDOW_SHARE * crossing_time(1),
        threshold=100 * THRESHOLD, stiffer=two_pass_stiffness(), sampling=sampling_change(runs), pictured=pictured, tables=by_level(runs, peak_table),
        robustness=by_level(runs, robustness_table))


def write(folder, doc, levels, types):
    """Read the runs below `folder`, write page and pictures below `doc`."""
    runs = [Run(folder, level, ctype) for level in levels for ctype in types]
    pictured = min(levels)
    shown = [run for run in runs if run.level == pictured]
    save_small(force_figure(shown), doc / "pictures" / "sliding_force.png", lines=True)
    save_small(field_panels({run.ctype: run.results for run in shown}, "plastic_strain",
                            (0.1, 0.3), (0.008, 0.026, -0.0042, 0.0022)),
               doc / "pictures" / "sliding_plastic_strain.png")
    write_page(doc, "sliding", page(runs, pictured))


if __name__ == "__main__":
    sys.exit(study_main(__doc__, write))
