# SPDX-License-Identifier: MIT
"""Moving pictures of a field on the deformed mesh (GIF by Pillow, MP4 by ffmpeg)."""
import pathlib

from matplotlib import animation

from slideline_tools import UserError, plots
from slideline_tools.fields import default_field, scalar_field
from slideline_tools.plots import plt

PIXELS_PER_INCH = 110
WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}


def animate(results, path, name=None, scale=1.0, rate=12, zoom=None):
    """All states of a field on one colour scale and in one window, `rate` pictures a second."""
    kind = WRITERS.get(pathlib.Path(path).suffix.lower())
    if kind is None:
        raise UserError(f"'{path}': an animation is written to a .gif or .mp4 file")
    if not animation.writers.is_available(kind):
        raise UserError("MP4 needs the program ffmpeg, which is not installed here; install it or choose a name that ends in .gif")
    writer = animation.writers[kind](fps=rate)
    field = scalar_field(results, name or default_field(results))
    states = range(results.n_state)
    if not results.n_state:
        raise UserError(f"{results.path}: no states")
    limits = field.limits()
    with plt.rc_context(dict(plots.STYLE, **{"savefig.dpi": PIXELS_PER_INCH})):
        zoom = plots.window(results, states, scale, zoom)
        height = plots.panel_height(zoom, plots.PAGE_WIDTH - 1.9) + 0.75
        figure, axes = plt.subplots(figsize=(plots.PAGE_WIDTH, height), layout="constrained")
        artist = plots.field_panel(axes, results, field, 0, scale, limits, zoom)
        plots.colour_bar(artist, [axes], field.label)
        figure.suptitle(plots.run_title(results), fontsize=9)
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # the places stay as they are
        with writer.saving(figure, str(path), PIXELS_PER_INCH):
            for state in states:
                for drawn in list(axes.collections):
                    drawn.remove()
                plots.draw_field(axes, results, field, state, scale, limits)
                axes.set_title(plots.state_title(results, state, scale), loc="left")
                writer.grab_frame()
        plt.close(figure)
    return results.n_state
