# SPDX-License-Identifier: MIT
"""Draws the pictures of the gallery and the head picture from runs of the program.

    build/venv/bin/python tools/docs/gallery.py [--program build/release/slideline] [NAME...]

writes doc/pictures/gallery_NAME.png and doc/pictures/impact.png.
"""
import argparse
import dataclasses
import pathlib
import re
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import slideline_tools  # noqa: E402
from slideline_tools.fields import scalar_field  # noqa: E402
from slideline_tools.mirrored import Mirrored  # noqa: E402
from slideline_tools.plots import draw_field, window  # noqa: E402
from slideline_tools.studies.common import save_small  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ROOT / "doc/pictures"
LABELS = {"mises": ("von Mises stress, MPa", 1e-6), "plastic_strain": ("plastic strain", 1.0),
          "stress:yy": ("axial stress, MPa", 1e-6), "pressure": ("pressure, GPa", 1e-9)}


@dataclasses.dataclass
class Scene:
    """A picture: panels of one run, without axes."""
    deck: str                    #: below the top
    field: str
    times: tuple                 #: of the panels, s; -1 the end
    words: tuple = ()            #: of the command line
    mirror: bool = False
    scale: float = 1.0           #: of the displacements
    box: tuple | None = None     #: x0, x1, y0, y1 of every panel
    limits: tuple | None = None  #: of the colours, in units of the label
    stacked: bool = False        #: panels one below the other
    inches: float = 7.0
    factor: float | None = None  #: of the values, instead of that of LABELS
    label: str | None = None


SCENES = {
    "collision": Scene("input/collision/collision_3.k", "mises", (1e-5, 6e-5), ("ctype=5", "endtim=7e-5", "p:dtplot=1e-5"), True,
                       stacked=True, limits=(0.0, 320.0)),
    "sliding": Scene("input/sliding/sliding.k", "mises", (4.0e-3,), ("ctype=7", "endtim=4.1e-3"), limits=(0.0, 320.0)),
    "block": Scene("input/block/block.k", "mises", (-1,), ("ctype=5",), factor=1.0, label="von Mises stress, Pa", inches=4.0),
    "patch": Scene("input/patch/patch_5_4.k", "stress:yy", (-1,), ("ctype=5",), scale=2e4, factor=1.0,
                   label="stress along y, Pa", inches=4.0, limits=(-1.05, -0.95)),
    "hertz": Scene("input/hertz/hertz.k", "mises", (-1,), ("ctype=5",), inches=4.5),
    "symmetric_plate": Scene("input/symmetric_plate/plate_32x16_elastoplastic.k", "plastic_strain", (-1,), stacked=True),
    "taylor": Scene("input/taylor/taylor.k", "plastic_strain", (0.0, 2e-5, 8e-5), mirror=True),
    "taylor_johnson_cook": Scene("input/taylor/taylor_johnson_cook.k", "temperature", (2e-5, 8e-5), mirror=True, factor=1.0,
                                 label="temperature, deg C", inches=4.5),
    "impact": Scene("input/penetration/penetration.k", "mises", (3e-5,), ("endtim=3.1e-5",), True,
                    box=(-0.05, 0.05, -0.012, 0.03), limits=(0.0, 1500.0), inches=7.5),
    "seal": Scene("input/seal/seal.k", "mises", (0.0, 1.45e-2, 2.85e-2), limits=(0.0, 1.0)),
    "v_bend": Scene("input/v_bend/v_bend.k", "mises", (1.0e-3, 2.2e-3, 4.0e-3), mirror=True, limits=(0.0, 450.0)),
    "press_fit": Scene("input/press_fit/press_fit.k", "mises", (-1,), inches=4.0, limits=(0.0, 180.0)),
    "plate_hole": Scene("input/plate_hole/plate_hole.k", "stress:xx", (-1,), inches=6.0, label="stress along x, MPa", factor=1e-6,
                        limits=(0.0, 300.0)),
    "tube": Scene("input/tube/tube.k", "plastic_strain", (5.0e-4, 1.25e-3, 2.5e-3), mirror=True),
    "penetration": Scene("input/penetration/penetration.k", "plastic_strain", (1.5e-5, 4.5e-5, 1.2e-4), mirror=True,
                         box=(-0.035, 0.035, -0.032, 0.05), limits=(0.0, 1.5)),
}


#: deck, time between states in s, field, axis along which the wave runs (0 x, 1 y), largest value of the colours
DIAGRAMS = {
    "hopkinson": ("input/hopkinson/hopkinson.k", 2e-6, "stress:yy", 1, 210.0),
    "spall": ("doc/examples/plate_impact_spall.k", 4e-9, "pressure", 0, 4.0),
}


def run(program, scene, folder):
    """The results of a scene."""
    given = dict(word.split("=") for word in scene.words)
    results = slideline_tools.run(ROOT / scene.deck, folder, program=program, **given).results
    return Mirrored(results) if scene.mirror else results


def draw(results, scene):
    """The figure of a scene."""
    label, factor = LABELS.get(scene.field, ("", 1.0))
    label, factor = scene.label or label, scene.factor or factor
    field = scalar_field(results, scene.field)
    field.values = factor * field.values
    states = [int(np.argmin(abs(results.times - time))) if time >= 0.0 else results.n_state - 1 for time in scene.times]
    limits = scene.limits or field.limits(states)
    x0, x1, y0, y1 = window(results, states, scene.scale, scene.box)
    rows, columns = (len(states), 1) if scene.stacked else (1, len(states))
    width = (scene.inches - 0.9) / columns
    figure, panels = plt.subplots(rows, columns, figsize=(scene.inches, max(rows * width * (y1 - y0) / (x1 - x0), 1.6) + 0.1), dpi=130,
                                  layout="constrained", squeeze=False)
    for axes, state in zip(panels.flat, states):
        artist = draw_field(axes, results, field, state, scene.scale, limits)
        axes.set_xlim(x0, x1)
        axes.set_ylim(y0, y1)
        axes.axis("off")
    bar = figure.colorbar(artist, ax=panels, aspect=18, pad=0.015, shrink=0.9)
    bar.set_label(label, fontsize=8)
    bar.ax.tick_params(labelsize=7, length=2)
    bar.outline.set_linewidth(0.3)
    return figure


def diagram(program, name, folder):
    """A field over place and time: waves of one row of elements along x, or of those at the axis along y."""
    deck, step, field, along, limit = DIAGRAMS[name]
    label, factor = LABELS[field]
    text = re.sub(r"(\*DATABASE_BINARY_D3PLOT\n.*\n) *\S+", lambda found: f"{found[1]}{step:10.1E}",
                  (ROOT / deck).read_text(encoding="ascii"))
    (folder / "x.k").write_text(text, encoding="ascii")
    results = run(program, Scene(folder / "x.k", field, ()), folder)
    middles = results.points[0][results.cells].mean(axis=1)
    row = np.flatnonzero(np.isclose(middles[:, 1 - along], middles[:, 1 - along].min(), atol=1.0e-3))
    row = row[np.argsort(middles[row, along])]
    figure, axes = plt.subplots(figsize=(6.0, 3.2), dpi=130, layout="constrained")
    artist = axes.pcolormesh(1e3 * middles[row, along], 1e6 * results.times, factor * scalar_field(results, field).values[:, row],
                             cmap="RdBu_r", vmin=-limit, vmax=limit, shading="nearest")
    axes.set_xlabel("position, mm", fontsize=8)
    axes.set_ylabel("time, microseconds", fontsize=8)
    axes.tick_params(labelsize=7)
    bar = figure.colorbar(artist, ax=axes)
    bar.set_label(label, fontsize=8)
    bar.ax.tick_params(labelsize=7)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default=str(ROOT / "build/release/slideline"))
    names = [*SCENES, *DIAGRAMS]
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(names)} (all)")
    options = parser.parse_args()
    for name in options.names or names:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            figure = (diagram(options.program, name, path) if name in DIAGRAMS else
                      draw(run(options.program, SCENES[name], path), SCENES[name]))
            save_small(figure, PICTURES / f"{'' if name == 'impact' else 'gallery_'}{name}.png", colours=96)
        print(name, flush=True)


if __name__ == "__main__":
    main()
