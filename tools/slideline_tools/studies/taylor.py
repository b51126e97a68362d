# SPDX-License-Identifier: MIT
"""Picture of the Taylor bar: first and final shape, beside the radius and length of converged codes.

    python -m slideline_tools.studies.taylor FOLDER DOC

FOLDER holds the run of input/taylor/taylor.k as taylor.vtkhdf; the picture goes to DOC/pictures/taylor.png.
"""
import sys

import numpy as np

from slideline_tools.fields import scalar_field
from slideline_tools.mirrored import Mirrored
from slideline_tools.plots import PAGE_WIDTH, STYLE, colour_bar, draw_field, plt
from slideline_tools.results import read
from slideline_tools.studies.common import page_main, save_small

#: Final radius of the foot and length in mm of converged codes: tests/verification/taylor_bar.
CODES = {"radius": (7.22, 7.24), "length": (21.42, 21.43)}
MM = 1.0e3


class InMillimetres(Mirrored):
    """The mirrored results with places in mm."""

    @property
    def points(self):
        """(n_state, 2 n_node, 3) in mm."""
        return MM * super().points


def draw(results):
    """The final state with its plastic strain; the first shape and the codes' figures as lines."""
    field = scalar_field(results, "plastic_strain")
    places = results.points[:, :, :2]
    radius, length = places[-1, :, 0].max(), places[-1, :, 1].max()
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(0.9 * PAGE_WIDTH, 7.6), layout="constrained")
        artist = draw_field(axes, results, field, results.n_state - 1, limits=field.limits([results.n_state - 1]))
        first = places[0].max(axis=0)
        axes.plot(np.array([-1, -1, 1, 1, -1]) * first[0], np.array([0, 1, 1, 0, 0]) * first[1], color="#888888",
                  linewidth=0.8, linestyle=":")
        axes.text(0.0, first[1] + 0.3, "before, 227 m/s", ha="center", fontsize=8, color="#666666")
        middle = 0.5 * sum(CODES["radius"])
        axes.vlines([-middle, middle], 0.0, 8.0, color="#0b559f", linewidth=1.5)
        axes.hlines(0.5 * sum(CODES["length"]), -5.5, 5.5, color="#0b559f", linewidth=1.5)
        axes.text(3.5, CODES["length"][1] + 0.25, "length of converged codes\n21.42 to 21.43 mm", fontsize=8, color="#0b559f")
        axes.text(4.3, 8.6, "radius of converged codes\n7.22 to 7.24 mm", fontsize=8, color="#0b559f")
        axes.set_title(f"here: radius {radius:.2f} mm, length {length:.2f} mm at {1e6 * results.times[-1]:.0f} microseconds",
                       loc="left")
        axes.set_xlim(-9.0, 12.0)
        axes.set_ylim(-0.3, 34.0)
        axes.set_xlabel("radius, mm")
        axes.set_ylabel("height above the wall, mm")
        colour_bar(artist, [axes], field.label)
        return figure


def write(folder, doc):
    """DOC/pictures/taylor.png."""
    save_small(draw(InMillimetres(read(folder / "taylor.vtkhdf"))), doc / "pictures" / "taylor.png", colours=96)


if __name__ == "__main__":
    sys.exit(page_main(__doc__, write))
