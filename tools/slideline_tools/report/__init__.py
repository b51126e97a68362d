# SPDX-License-Identifier: MIT
"""The report of a run: one HTML file with all its pictures inside.

    from slideline_tools.report import write_report
    write_report("results/collision", "report.html")
"""
from __future__ import annotations

import pathlib

from slideline_tools import UserError, __version__, files
from slideline_tools.report import sections
from slideline_tools.report.asked import asked
from slideline_tools.report.gather import Gathered, gather
from slideline_tools.report.html import Section, page, paragraph, text, tiles
from slideline_tools.report.walls import walls


def report_html(run: Gathered, fields=(), states=(), scale: float = 1.0) -> str:
    """The page. `fields` such as `mises` or `stress:xy`, `states` numbers or times as texts;
    empty: what the run suggests. `scale` multiplies the displacements in pictures."""
    chosen = sections.chosen_states(run, list(states))
    found = [sections.summary(run), sections.warnings(run),
             attempt("energies", "Energies", sections.energies, run),
             attempt("contact", "Contact", sections.contact, run, chosen),
             attempt("walls", "Rigid walls", walls, run),
             # Fields that were asked for by name must be there.
             sections.fields(run, list(fields), chosen, scale) if fields
             else attempt("fields", "Fields", sections.fields, run, [], chosen, scale),
             attempt("nodes", "Nodes", sections.nodes, run),
             attempt("asked", "Elements, bodies and boundaries", asked, run),
             attempt("model", "Parts, materials, interfaces", sections.understood, run),
             attempt("timing", "Timing", sections.timing, run),
             sections.savings(run), sections.files(run)]
    kind = run.ending.kind
    head = (f"<h1>{text(run.title)}</h1>\n<p><span class=\"state {kind}\">"
            f"{sections.KINDS[kind]}</span> {text(run.ending.reason)}</p>\n"
            + tiles(sections.tiles_of(run)))
    return page(f"{run.title} - report", head, [item for item in found if item],
                f"Written by slideline-tools {text(__version__)}.")


def attempt(anchor: str, title: str, make, *arguments) -> Section | None:
    """A section; where its tables lack a column, the section that says so."""
    try:
        return make(*arguments)
    except UserError as problem:
        return Section(anchor, title, paragraph(f"This section could not be made: {problem}.",
                                                "note"))


def write_report(path, output=None, fields=(), states=(), scale: float = 1.0, program=None) -> pathlib.Path:
    """Write the report of the run at `path` (its folder or a file of it); gives its path.

    Without `output` it goes beside the results as `<job>.report.html`. `program` reads the deck as run; the page notes where
    it can not.
    """
    run = gather(path, program)
    words = report_html(run, fields, states, scale)
    path = files.output(output or run.folder / f"{run.job}.report.html", [run.folder / name for name, _ in run.files])
    path.write_text(words, encoding="utf-8")
    return path
