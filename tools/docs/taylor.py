# SPDX-License-Identifier: MIT
"""Picture of the Taylor bar: first and final shape, beside the radius and length of converged codes, and both over time."""
import pathlib

import numpy as np

from slideline_tools.fields import scalar_field
from slideline_tools.histories import read_csv
from slideline_tools.mirrored import Mirrored
from slideline_tools.plots import PAGE_WIDTH, STYLE, colour_bar, draw_field, plt
from slideline_tools.results import read
from slideline_tools.studies.common import save_small

#: Final radius of the impact end and length in mm of converged codes: tests/verification/taylor_bar.
CODES = {"radius": (7.22, 7.24), "length": (21.42, 21.43)}
MM = 1.0e3
#: Nodes of the deck that radius and length are read from.
NODES = {"radius": (11, "x"), "length": (1101, "y")}
#: Both over time by another program: tests/verification/taylor_bar.
PUBLISHED = pathlib.Path(__file__).resolve().parents[2] / "tests" / "verification" / "taylor_bar" / "published.csv"
OTHER = "#0b559f"


class InMillimetres(Mirrored):
    """The mirrored results with places in mm."""

    @property
    def points(self):
        """(n_state, 2 n_node, 3) in mm."""
        return MM * super().points


def draw_shape(axes, results):
    """The final state with its plastic strain; the first shape and the codes' figures as lines."""
    field = scalar_field(results, "plastic_strain")
    places = results.points[:, :, :2]
    radius, length = places[-1, :, 0].max(), places[-1, :, 1].max()
    artist = draw_field(axes, results, field, results.n_state - 1, limits=field.limits([results.n_state - 1]))
    first = places[0].max(axis=0)
    axes.plot(np.array([-1, -1, 1, 1, -1]) * first[0], np.array([0, 1, 1, 0, 0]) * first[1], color="#888888",
              linewidth=0.8, linestyle=":")
    axes.text(0.0, first[1] + 0.3, "before, 227 m/s", ha="center", fontsize=8, color="#666666")
    middle = 0.5 * sum(CODES["radius"])
    axes.vlines([-middle, middle], 0.0, 8.0, color=OTHER, linewidth=1.5)
    axes.hlines(0.5 * sum(CODES["length"]), -5.5, 5.5, color=OTHER, linewidth=1.5)
    axes.text(3.5, CODES["length"][1] + 0.25, "length of converged codes\n21.42 to 21.43 mm", fontsize=8, color=OTHER)
    axes.text(4.3, 8.6, "radius of converged codes\n7.22 to 7.24 mm", fontsize=8, color=OTHER)
    axes.set_title(f"radius {radius:.2f}, length {length:.2f} mm at {1e6 * results.times[-1]:.0f} microseconds", loc="left")
    axes.set_xlim(-9.0, 13.0)
    axes.set_ylim(-0.3, 34.0)
    axes.set_xlabel("radius, mm")
    axes.set_ylabel("height above the wall, mm")
    colour_bar(artist, [axes], field.label)


def draw_history(axes, nodes, published, name):
    """Radius or length over time, as a line, and what another program has published, as points."""
    node, column = NODES[name]
    rows = nodes.where(node=node)
    axes.plot(1e6 * rows["time"], MM * rows[column], color="#333333", linewidth=1.0, label="here, 10 x 100 quads")
    axes.plot(published["time_us"], published[f"{name}_mm"], "o", color=OTHER, markersize=3.5, fillstyle="none",
              label="Sierra/SM, 1.5 million tetrahedra")
    axes.set_ylabel(f"{name}, mm")
    axes.grid(True, linewidth=0.3, color="#bbbbbb")


def draw(results, nodes):
    """The final shape, and beside it radius and length over time."""
    published = read_csv(PUBLISHED)
    with plt.rc_context(STYLE):
        figure, panels = plt.subplot_mosaic([["shape", "radius"], ["shape", "length"]], layout="constrained",
                                            figsize=(1.2 * PAGE_WIDTH, 6.4), width_ratios=(1.5, 1.0))
        draw_shape(panels["shape"], results)
        for name in NODES:
            draw_history(panels[name], nodes, published, name)
        panels["length"].set_xlabel("time, microseconds")
        panels["length"].legend(fontsize=7)
        panels["radius"].set_title("over time", loc="left")
        return figure


def taylor(results, path):
    """The picture of the results of input/taylor/taylor.k."""
    figure = draw(InMillimetres(read(results)), read_csv(results.with_suffix(".nodout.csv")))
    save_small(figure, path, colours=96)
