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
    low, high = np.array(zoom[::2]), np.array(zoom[1::2])
    size, middle = np.linalg.norm(high - low), 0.5 * (low + high)
    for wall in walls:
        along = np.array([wall.normal[1], -wall.normal[0]])
        near = wall.point + (middle - wall.point) @ along * along
        if np.linalg.norm(near - middle) > size:
            continue
        axes.plot(*np.stack([near - size * along, near + size * along]).T, color=COLOUR,
                  linewidth=2.0, zorder=4, scalex=False, scaley=False)
        axes.annotate(f"wall {wall.id}", near, xytext=-9.0 * wall.normal, textcoords="offset points",
                      fontsize=6, color=COLOUR, ha="center", va="center", annotation_clip=True,
                      rotation=math.degrees(math.atan2(along[1], along[0])) % 180.0)
