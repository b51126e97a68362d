#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Forces of the whole ironing, all types, as a chart: `along.py PROGRAM WORK PICTURE.svg` (two to four minutes).

Runs that WORK holds already (WORK/type_N/x.rcforc.csv) are taken as they are.
"""
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[2] / "tools")]

from check import UNIT, ironing  # noqa: E402
from contact_types import TYPES  # noqa: E402
from slideline_tools.histories import read_csv  # noqa: E402
from slideline_tools.plots import PAGE_WIDTH, STYLE, plt  # noqa: E402
from slideline_tools.studies.common import colour, label  # noqa: E402

PRESS, SLIDE, PENALTY = 150.0, 600.0, 2.0e10


def forces(program, work, kind):
    """Way along the slab, and forces on the slab: down and against the motion, 1e8."""
    folder = work / f"type_{kind}"
    table = folder / "x.rcforc.csv"
    if not table.exists():
        folder.mkdir(parents=True, exist_ok=True)
        deck = folder / "x.k"
        deck.write_text(ironing(kind, PRESS, SLIDE, penalty=PENALTY).text())
        subprocess.run([program, f"i={deck}", f"d={folder}", "jobid=x"], check=True, capture_output=True)
    rows = read_csv(table).where(side="slave")
    return 10.0 * (rows["time"] / UNIT - PRESS) / SLIDE, rows["fy"] / 1e8, -rows["fx"] / 1e8


def main(program, work, picture):
    with plt.rc_context({**STYLE, "lines.linewidth": 0.7, "svg.hashsalt": "ironing", "svg.fonttype": "none", "path.simplify_threshold": 0.5}):
        figure, panels = plt.subplots(2, 1, sharex=True, layout="constrained", figsize=(PAGE_WIDTH, 5.0))
        for kind in TYPES:
            way, *found = forces(program, pathlib.Path(work), kind)
            for axes, force in zip(panels, found):
                axes.plot(way[way >= 0.0], force[way >= 0.0], color=colour(kind), label=label(kind))
        for axes, words in zip(panels, ("vertical force, 1e8", "horizontal force, 1e8")):
            axes.set_ylabel(words)
            axes.set_ylim(0.0)
        panels[1].set_xlabel("way along the slab")
        panels[0].legend(ncols=2)
        figure.savefig(picture, metadata={"Date": None})


if __name__ == "__main__":
    main(*sys.argv[1:])
