# SPDX-License-Identifier: MIT
"""The command `slideline-tools draw`."""
from __future__ import annotations

import argparse
import pathlib

# The names of draw.picture.WHAT, here without its slow imports.
WHAT = ("mesh", "sets", "surfaces", "boundary", "motion", "velocity", "loads", "walls", "history")
EPILOG = """Slave surfaces are red, master surfaces blue, with arrow heads in their walking direction
(the body lies on the left) and short lines along the outward normals. Arrows of velocities, motions
and loads have the length of the largest value over time, within each kind."""


def add(commands) -> None:
    """Add the command and its options."""
    parser = commands.add_parser(
        "draw", help="picture of a model before its run",
        description="Draw the model of a deck: mesh by part, node sets, contact surfaces with walking "
                    "direction and outward normals, held nodes, motions, initial velocities, loads, "
                    "pressures, rigid bodies. The program reads the deck, so that the picture shows "
                    "what would run.", epilog=EPILOG)
    parser.add_argument("deck", metavar="DECK", help="keyword deck; or a results folder, whose deck as run is "
                                                     "drawn")
    parser.add_argument("overrides", nargs="*", metavar="OVERRIDE",
                        help="as for the program, for example p:ctype=5")
    parser.add_argument("--output", "-o", metavar="FILE",
                        help="picture (.png, .pdf, .svg; default: <deck>.png in this folder)")
    parser.add_argument("--show", metavar="WHAT,...", type=wanted,
                        help=f"only these of: {', '.join(WHAT)} (default: all)")
    parser.add_argument("--zoom", type=float, nargs=4, metavar=("X0", "X1", "Y0", "Y1"),
                        help="window to show")
    parser.add_argument("--program", help="default: $SLIDELINE or build/release/slideline")
    parser.set_defaults(run=run)


def wanted(text: str) -> list[str]:
    """The names of a comma list, each one of WHAT."""
    names = [name for name in text.split(",") if name]
    for name in names:
        if name not in WHAT:
            raise argparse.ArgumentTypeError(f"unknown '{name}'; there are {', '.join(WHAT)}")
    return names


def run(options) -> int:
    """Draw, and say what could not be shown."""
    from slideline_tools.draw import draw
    deck = pathlib.Path(options.deck)
    path = options.output or f"{stem(deck)}.png"
    model = draw(deck, path, options.program, options.overrides, options.show, options.zoom)
    counts = {"node": model.points, "element": model.cells, "part": model.parts, "interface": model.interfaces}
    print(f"wrote {path} (" + ", ".join(f"{len(all_of)} {name}{'s' * (len(all_of) != 1)}" for name, all_of in counts.items()) + ")")
    for words in model.warnings:
        print(f"warning: {words}")
    if model.not_drawn:
        print("not drawn: " + ", ".join(model.not_drawn))
    return 0


def stem(deck: pathlib.Path) -> str:
    """The name of a picture: that of the deck without its endings."""
    name = deck.resolve().name
    for ending in (".effective.k", ".k", ".key", ".dyn"):
        if name.endswith(ending):
            return name.removesuffix(ending)
    return name
