# SPDX-License-Identifier: MIT
"""The command `slideline-tools`: info | plot | animate | compare | bless | make-deck."""
import argparse
import pathlib
import sys

from slideline_tools import __version__

OK, FAILED, UNUSABLE = 0, 1, 2


class ToolError(Exception):
    """A request that cannot be met; the text is for the user."""


def add_make_deck(commands):
    parser = commands.add_parser(
        "make-deck", help="write the deck of a scene",
        description="Write the keyword deck of a scene.")
    scenes = parser.add_subparsers(dest="scene", required=True, metavar="SCENE")
    scene = scenes.add_parser("collision", help="projectile on a plate, half model")
    scene.add_argument("--level", type=int, default=1, help="refinement N_r, 1 to 4 in the seed")
    scene.add_argument("--ctype", type=int, default=2, help="contact type in the deck (2)")
    scene.add_argument("--ngauss", type=int, default=4, help="Gauss points of type 6 (4)")
    scene.add_argument("--output", "-o", required=True, help="deck file to write")
    scene.set_defaults(run=make_collision)
    scene = scenes.add_parser("symmetric_plate", help="plate on two pins under a step load")
    scene.add_argument("--nx", type=int, default=8, help="elements along 8 m, a multiple of 8")
    scene.add_argument("--ny", type=int, default=4, help="elements through 1 m, even")
    scene.add_argument("--elastoplastic", action="store_true", help="yield stress 10 MPa")
    scene.add_argument("--hourglass", choices=("viscous", "stiffness"), default="viscous")
    scene.add_argument("--coefficient", type=float, help="hourglass coefficient "
                       "(0.1 viscous, 0.05 stiffness)")
    scene.add_argument("--output", "-o", required=True, help="deck file to write")
    scene.set_defaults(run=make_symmetric_plate)


def make_collision(options):
    from slideline_tools import scenes
    return write_deck(options, scenes.collision, options.level, options.ctype, options.ngauss)


def make_symmetric_plate(options):
    from slideline_tools import scenes
    return write_deck(options, scenes.symmetric_plate, options.nx, options.ny,
                      options.elastoplastic, options.hourglass, options.coefficient)


def write_deck(options, scene, *arguments):
    try:
        text = scene(*arguments)
    except ValueError as problem:
        raise ToolError(str(problem)) from problem
    path = pathlib.Path(options.output)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="ascii")
    print(f"wrote {path}")
    return OK


def build_parser():
    parser = argparse.ArgumentParser(prog="slideline-tools", description=__doc__)
    parser.add_argument("--version", action="version", version=f"slideline-tools {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    add_make_deck(commands)
    return parser


def main(arguments=None):
    """Entry point: returns 0 when done, 1 when a comparison failed, 2 when it could not be done."""
    options = build_parser().parse_args(arguments)
    try:
        return options.run(options)
    except (ToolError, OSError) as problem:
        print(f"slideline-tools: {problem}", file=sys.stderr)
        return UNUSABLE


if __name__ == "__main__":
    sys.exit(main())
