# SPDX-License-Identifier: MIT
"""The section of histories that a deck asks for by name: elements, rigid bodies, boundaries, groups of nodes, sections."""
from __future__ import annotations

import numpy as np

from slideline_tools.histories import History
from slideline_tools.report import charts
from slideline_tools.report.gather import Gathered
from slideline_tools.report.html import Section, figures, paragraph, picture, table, text

#: table -> (its title, columns that are drawn and what they say)
ASKED = {
    "elout": ("Elements", {"sxx": "stress xx", "syy": "stress yy", "sxy": "stress xy", "plastic_strain": "plastic strain"}),
    "rbdout": ("Rigid bodies", {"ux": "displacement in x", "uy": "displacement in y", "rotation": "rotation",
                                "vx": "velocity in x", "vy": "velocity in y", "spin": "angular velocity"}),
    "bndout": ("Loads and prescribed motion", {"fx": "force in x", "fy": "force in y", "moment": "moment", "work": "work"}),
    "nodfor": ("Groups of nodes", {"fx": "force in x, of all nodes", "fy": "force in y, of all nodes",
                                   "work": "work, of all nodes"}),
    "secforc": ("Cross sections", {"fx": "force in x", "fy": "force in y", "moment": "moment"}),
}


def asked(run: Gathered) -> Section | None:
    """Curves of each of these tables that was written, and the last and largest values."""
    body = "".join(one_table(rows, *ASKED[name]) for name in ASKED if (rows := run.rows(name)) is not None)
    return Section("asked", "Elements, bodies and boundaries", body) if body else None


def one_table(history: History, title: str, columns: dict[str, str]) -> str:
    """The part of one table; columns in which nothing happens are left out."""
    found = curves(history)
    drawn = [name for name in columns if any(np.any(one[name]) for _, _, one in found)]
    shown = found[:charts.MOST_LINES]
    body = f"<h3>{text(title)}</h3>\n" + '<div class="grid">\n' + "".join(
        picture(charts.lines([(label, times, one[name]) for label, times, one in shown], columns[name]),
                f"{title}: {columns[name]}") for name in drawn) + "</div>\n"
    if not drawn:
        return body + paragraph("All values are zero.", "note")
    for name in drawn:
        rows = [[label, figures(float(one[name][-1]), 6), figures(float(np.abs(one[name]).max()), 6)] for label, _, one in shown]
        body += table([columns[name], "at the end", "largest amount"], rows, {1, 2})
    if len(found) > len(shown):
        body += paragraph(f"{len(shown)} of {len(found)} are shown.", "note")
    return body


def curves(history: History) -> list[tuple[str, np.ndarray, dict[str, np.ndarray]]]:
    """(label, times, values by column) of each entity; of groups of nodes the sums over their nodes."""
    if history.name != "nodfor":
        return [(history.entity_label(entity), rows["time"], rows.columns) for entity, rows in history.series()]
    found = []
    for group in dict.fromkeys(history["group"].tolist()):
        rows = history.where(group=group)
        times, place = np.unique(rows["time"], return_inverse=True)
        found.append((f"group {group}", times, {name: np.bincount(place, rows[name]) for name in ("fx", "fy", "work")}))
    return found
