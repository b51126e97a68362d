# SPDX-License-Identifier: MIT
"""The collision scene with all contact types: contact episodes, force, plastic strain, energy.

    python -m slideline_tools.studies.collision FOLDER DOC --levels 1 2 3 4

FOLDER holds the runs as level_L_type_T/collision.*; the page goes to DOC/studies, its pictures
to DOC/pictures.
"""
import sys

import numpy as np

from slideline_tools import UserError
from slideline_tools.histories import read_csv
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt
from slideline_tools.results import read
from slideline_tools.studies.common import (by_level, colour, field_panels, label,
                                            markdown_table, save_small, study_main, write_page)
from slideline_tools.summaries import SNAPSHOT_TIME, collision_row

JOB = "collision"
END = 1.0e-3
FACING = 0.025
FIRST_HIT, LATER = (0.0, 0.025e-3), (0.25e-3, 0.55e-3)


def episodes(time, force):
    """(start, end) of each stretch of rows with a force: first and last row of the stretch."""
    closed = np.concatenate([[False], np.asarray(force) > 0.0, [False]])
    starts = np.flatnonzero(closed[1:] & ~closed[:-1])
    ends = np.flatnonzero(closed[:-1] & ~closed[1:]) - 1
    return [(float(time[start]), float(time[end])) for start, end in zip(starts, ends)]


class Run:
    """One run: `time` and vertical `force` per metre of depth, `row` of numbers, results."""

    def __init__(self, folder, level, ctype):
        self.level, self.ctype = level, ctype
        self.folder = folder / f"level_{level}_type_{ctype}"
        rows = read_csv(self.folder / f"{JOB}.rcforc.csv").where(side="slave")
        self.time, self.force = rows["time"], rows["fy"]
        if not len(self.time) or self.time[-1] < END * (1.0 - 1e-6):
            raise UserError(f"{self.folder}: the run did not reach its end")
        self.results = read(self.folder / f"{JOB}.vtkhdf")
        self.row = collision_row(self.folder, JOB)
        self.episodes = episodes(self.time, self.force)

    def plastic_strain_below(self):
        """Largest plastic strain of the plate between x = 0 and 25 mm at the snapshot."""
        state = self.results.state_index(repr(SNAPSHOT_TIME))
        start = self.results.points[0][self.results.cells][:, :, 0].mean(axis=1)
        return float(self.results.cell_field("plastic_strain")[state][start < FACING].max())

    def contact_share(self):
        """Share of the rows of the force history with a force."""
        return float(np.mean(self.force > 0.0))


# ---- tables ------------------------------------------------------------------------------------

def result_table(runs):
    """What the runs of one level gave."""
    rows = []
    for run in runs:
        row = run.row
        rows.append([label(run.ctype), row["plastic_strain"], run.plastic_strain_below(),
                     row["rebound"],
                     row["peak_force"] / 1e6, row["impulse"],
                     f"{row['energy_low']:.5f} to {row['energy_high']:.5f}"])
    return markdown_table(["type", "largest plastic strain at 0.7 ms", "below the projectile",
                           "rebound, m/s", "largest force, MN/m", "impulse, N s/m",
                           "energy ratio"], rows)


def episode_table(runs):
    """When the bodies touched, per run of one level."""
    rows = []
    for run in runs:
        spans = ", ".join(f"{1e6 * start:.0f} to {1e6 * end:.0f}" for start, end in run.episodes)
        rows.append([label(run.ctype), len(run.episodes), spans, 100.0 * run.contact_share()])
    return markdown_table(["type", "episodes", "from and to, microseconds", "time in contact, %"],
                          rows)


# ---- pictures ----------------------------------------------------------------------------------

def force_figure(runs):
    """Force of the runs over the whole time, in the first hit and in the later contacts."""
    style = {**STYLE, "figure.dpi": 110, "savefig.dpi": 110, "lines.linewidth": 0.9}
    with plt.rc_context(style):
        figure, grid = plt.subplots(3, 1, layout="constrained", figsize=(PAGE_WIDTH + 1.0, 8.0))
        titles = ("vertical contact force", "the first hit", "the later contacts")
        for axes, title, (first, last) in zip(grid, titles, ((0.0, END), FIRST_HIT, LATER)):
            for run in runs:
                near = (run.time >= first) & (run.time <= last)
                axes.plot(1e3 * run.time[near], run.force[near] / 1e6, color=colour(run.ctype),
                          label=label(run.ctype))
            axes.set_title(title, loc="left")
            axes.set_ylabel("MN/m")
            axes.grid(True, linewidth=0.3, color="#bbbbbb")
        grid[0].legend(ncols=2)
        grid[-1].set_xlabel("time, ms")
        return figure


# ---- the page ----------------------------------------------------------------------------------

PAGE = """# Collision with all contact types

This page and its pictures are written by `tools/batch/collision.sh`: do not edit it.

An elastic steel block (slave) hits a clamped, elastic and perfectly plastic aluminium plate
(master) at 80 m/s (Kang, Lee & Shin 2023, section 4.3, the source; dimensions and velocity that
its text does not give are ours, see the decks `input/collision/collision*.k`). Type 6 has 4 Gauss
points. The largest plastic strain of all sits at the clamped end of the plate and grows with
refinement (a clamped corner of a plastic plate has no limit), so compare it within a level only;
the largest below the projectile (0 to 25 mm) stands beside it.

The force is written every microsecond; an episode is a stretch of rows with a force, from its first
to its last row. The rebound velocity is the mean vertical velocity of the projectile at the end.
Every run reached its end: the script stops otherwise.

## Results

{results}

## Contact episodes

{episodes}

![contact force](../pictures/collision_force.png)

The picture shows N_r = {pictured}. Effective plastic strain at 0.7 ms, N_r = {pictured}, colours
from 0 to 0.25 as in Fig. 31 of the source:

![plastic strain](../pictures/collision_plastic_strain.png)
"""


def write(folder, doc, levels, types):
    """Read the runs below `folder`, write page and pictures below `doc`."""
    runs = [Run(folder, level, ctype) for level in levels for ctype in types]
    pictured = min(levels)
    shown = [run for run in runs if run.level == pictured]
    save_small(force_figure(shown), doc / "pictures" / "collision_force.png", lines=True)
    save_small(field_panels({run.ctype: run.results for run in shown}, "plastic_strain",
                            (0.0, 0.25), (-0.001, 0.066, -0.022, 0.007), SNAPSHOT_TIME),
               doc / "pictures" / "collision_plastic_strain.png")
    write_page(doc, "collision", PAGE.format(
        results=by_level(runs, result_table), episodes=by_level(runs, episode_table),
        pictured=pictured))


if __name__ == "__main__":
    sys.exit(study_main(__doc__, write))
