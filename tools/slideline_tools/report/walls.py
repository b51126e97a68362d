# SPDX-License-Identifier: MIT
"""The section of a report about rigid walls: where they stand, and their forces."""
from __future__ import annotations

import numpy as np

from slideline_tools.report import charts
from slideline_tools.report.gather import Gathered
from slideline_tools.report.html import Section, figures, paragraph, picture, table
from slideline_tools.walls import walls_of


def walls(run: Gathered) -> Section | None:
    """Every rigid wall that the log, the deck or rwforc tells of; None where there is none."""
    rwforc = run.rows("rwforc")
    deck = run.results.run.get("effective_deck", "") if run.results is not None else ""
    known = {wall.id: wall for wall in walls_of(deck)} | run.log.walls
    numbers = sorted(set(known) | ({int(number) for number in rwforc["wall"]} if rwforc is not None else set()))
    if not numbers:
        return None
    rows = [[number, *place(known.get(number))] for number in numbers]
    body = table(["wall", "through x", "y", "normal in x", "y", "nodes that see it"], rows, set(range(1, 6)))
    if rwforc is None:
        return Section("walls", "Rigid walls", body + paragraph("Their forces were not written (*DATABASE_RWFORC).", "note"))
    pictures, rows = "", []
    for number in numbers:
        if not len(one := rwforc.where(wall=number)):
            continue
        pictures += picture(charts.wall_forces(one), f"Force of wall {number} on the nodes")
        rows.append([number, *force_row(one)])
    body += f'<div class="grid">\n{pictures}</div>\n'
    body += table(["wall", "largest force", "at time", "impulse", "work on the nodes", "most nodes at once"], rows,
                  set(range(1, 6)))
    return Section("walls", "Rigid walls", body)


def place(wall) -> list[str]:
    """Where a wall stands; dashes where nothing tells."""
    if wall is None:
        return ["–"] * 5
    return [*(figures(value, 5) for value in (*wall.point, *wall.normal)), figures(wall.n_node)]


def force_row(rows) -> list[str]:
    """Largest force and its time, impulse and work at the end, most nodes at once."""
    size = np.hypot(rows["fx"], rows["fy"])
    if not np.any(np.isfinite(size)):
        return ["–"] * 5
    top = int(np.nanargmax(size))
    return [figures(float(size[top]), 6), figures(float(rows["time"][top]), 4), figures(float(rows["impulse"][-1]), 6),
            figures(float(rows["work"][-1]), 6), figures(float(np.nanmax(rows["n_active"])))]
