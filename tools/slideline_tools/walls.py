# SPDX-License-Identifier: MIT
"""Rigid walls of a run in pictures of its states."""
import math

import numpy as np

from slideline_tools.draw.model import Wall
from slideline_tools.effective_deck import read_blocks

COLOUR = "#333333"


def walls_of(deck: str) -> list[Wall]:
    """The walls of a deck as run; none where a card can not be read."""
    found: list[Wall] = []
    for block in read_blocks(deck, "RIGIDWALL_PLANAR") if "*RIGIDWALL_PLANAR" in deck.upper() else ():
        try:
            row = [float(word or 0.0) for word in (block.fields(1 + block.is_titled) + [""] * 7)[:7]]
        except ValueError:
            continue
        arrow = (row[3] - row[0], row[4] - row[1])
        size = math.hypot(*arrow)
        if size > 0.0 and math.isfinite(size):
            number = block.number(0) if block.is_titled else 0
            found.append(Wall(number or len(found) + 1, np.array(row[:2]),
                              np.array(arrow) / size, row[6]))
    return found


def draw_walls(axes, walls: list[Wall], zoom) -> None:
    """Each wall as a line across the window (x0, x1, y0, y1), with its number behind it."""
    size = math.hypot(zoom[1] - zoom[0], zoom[3] - zoom[2])
    middle = (0.5 * (zoom[0] + zoom[1]), 0.5 * (zoom[2] + zoom[3]))
    for wall in walls:
        along = (wall.normal[1], -wall.normal[0])
        offset = sum((m - p) * a for m, p, a in zip(middle, wall.point, along))
        near = [p + offset * a for p, a in zip(wall.point, along)]
        if math.dist(near, middle) > size:
            continue
        axes.plot(*zip(*[[f + side * size * a for f, a in zip(near, along)] for side in (-1.0, 1.0)]), color=COLOUR,
                  linewidth=2.0, zorder=4, scalex=False, scaley=False)
        axes.annotate(f"wall {wall.id}", near, xytext=[-9.0 * part for part in wall.normal], textcoords="offset points",
                      fontsize=6, color=COLOUR, ha="center", va="center", annotation_clip=True,
                      rotation=math.degrees(math.atan2(along[1], along[0])) % 180.0)
