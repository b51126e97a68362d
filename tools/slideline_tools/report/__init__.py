# SPDX-License-Identifier: MIT
"""The report of a run: one HTML file with all its pictures inside.

    from slideline_tools.report import write_report
    write_report("results/collision", "report.html")
"""
import pathlib

from slideline_tools import __version__, files
from slideline_tools.report import sections
from slideline_tools.report.gather import Gathered
from slideline_tools.report.page import page


def write_report(path, output=None, fields=(), states=(), scale: float = 1.0,
                 program=None) -> pathlib.Path:
    """Write the report of the run at `path` (its folder or a file of it); gives its path.

    `fields` such as `mises` or `stress:xy`, `states` numbers or times as texts; empty: what the
    run suggests. `scale` multiplies the displacements in pictures. Without `output` it goes beside
    the results as `<job>.report.html`. `program` reads the deck as run; the page notes where it
    can not.
    """
    run = Gathered(path, program)
    words = page(title=run.title, ending=run.ending, kind=sections.KINDS[run.ending.kind],
                 tiles=sections.tiles_of(run), version=__version__,
                 sections=sections.all_sections(run, list(fields), list(states), scale))
    path = files.output(output or run.folder / f"{run.job}.report.html",
                        run.files())
    path.write_text(words, encoding="utf-8")
    return path
