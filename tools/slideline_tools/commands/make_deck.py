# SPDX-License-Identifier: MIT
"""The command `slideline-tools make-deck`: an option has the name of the parameter of the function
that writes the scene, and what is not given is left to that function."""
from __future__ import annotations

import argparse

from slideline_tools import UserError
from slideline_tools.files import output

# The names of scenes.patch.MESHES and SURFACES, here without its slow imports.
MESHES = ("3/2", "5/4", "7/5", "2/7", "51/50")
SURFACES = ("faces", "tied", "one-set")
#: scene -> refinement levels, Gauss points of type 6, what it is
CONTACT_SCENES = {
    "collision": ("1 to 4 in the paper", 4, "projectile on a plate, half model"),
    "sliding": ("1 to 3 in the paper", 6, "die pressed into a plate and drawn along it"),
    "block": ("1 in the paper", 4, "two soft blocks, explicit or implicit"),
    "patch": (None, 4, "contact patch test, damped to rest or static"),
    "oblique": (None, 4, "oblique impact of a turned block on a free one"),
    "hertz": ("1 to 8", 4, "elastic cylinder on an elastic block"),
}
#: what the parser sets beside the options of a scene
OTHERS = ("command", "scene", "output", "run")


def add(commands) -> None:
    """Add the command, its scenes and their options."""
    parser = commands.add_parser(
        "make-deck", help="write the deck of a scene",
        description="Write the keyword deck of a scene. The decks of the folder input are made so; "
                    "numbers such as the penalty are parameters of the deck, p:NAME=VALUE. The "
                    "paper is that of Kang, Lee & Shin (2023).")
    scenes = parser.add_subparsers(dest="scene", required=True, metavar="SCENE")
    for name, (levels, points, text) in CONTACT_SCENES.items():
        scene = add_scene(scenes, name, text)
        add_contact_options(scene, levels, points)
        add_own_options(scene, name)
    scene = add_scene(scenes, "symmetric_plate", "plate on two pins under a step load")
    scene.add_argument("--nx", type=int, dest="n_x", help="elements along 8 m, a multiple of 8 (8)")
    scene.add_argument("--ny", type=int, dest="n_y", help="elements through 1 m, even (4)")
    scene.add_argument("--elastoplastic", action="store_true", help="yield stress 10 MPa")
    scene.add_argument("--hourglass", choices=("viscous", "stiffness"),
                       help="form of hourglass control (stiffness)")
    scene.add_argument("--coefficient", type=float, help="hourglass coefficient "
                       "(0.1 viscous, 0.05 stiffness)")
    scene = add_scene(scenes, "taylor", "copper rod on a rigid wall, axisymmetric, without contact")
    scene.add_argument("--columns", type=int, help="elements along the radius of 3.2 mm (10)")
    scene.add_argument("--rows", type=int, help="elements along 32.4 mm (100)")


def add_scene(scenes, name: str, text: str) -> argparse.ArgumentParser:
    """A scene that has its output file alone."""
    scene = scenes.add_parser(name, help=text, description=f"Write the deck: {text}.",
                              argument_default=argparse.SUPPRESS)
    scene.add_argument("--output", "-o", required=True, help="deck file to write")
    scene.set_defaults(run=run)
    return scene


def add_contact_options(scene: argparse.ArgumentParser, levels: str | None, points: int) -> None:
    """Refinement, contact type and roles."""
    if levels:
        scene.add_argument("--level", type=int, help=f"refinement N_r, {levels} (1)")
    scene.add_argument("--ctype", type=int, help="contact type in the deck (2)")
    scene.add_argument("--ngauss", type=int, help=f"Gauss points of type 6 ({points})")
    scene.add_argument("--exchanged", action="store_true",
                       help="slave and master surface exchanged")


def add_own_options(scene: argparse.ArgumentParser, name: str) -> None:
    """What only some scenes have."""
    if name == "patch":
        scene.add_argument("--mesh", choices=MESHES,
                           help="quads along the interface, upper/lower block; 7/5 is not even, "
                                "2/7 has slave segments over three and four master segments "
                                "(5/4)")
        scene.add_argument("--penalty", type=float, help="N/m per contact node; damping, step and "
                           "end time follow it (1e6)")
        scene.add_argument("--surfaces", choices=SURFACES,
                           help="contact of the two faces, ties of these, or one part set with itself (faces)")
    if name in ("patch", "hertz"):
        scene.add_argument("--static", action="store_true",
                           help="static steps of the implicit method, not damping to rest")
    if name == "block":
        scene.add_argument("--implicit", action="store_true",
                           help="implicit dynamics instead of the explicit method")
    if name == "sliding":
        scene.add_argument("--rigid-die", action="store_true",
                           help="the die is a rigid body, not elastic")


def run(options) -> int:
    """Write the deck."""
    from slideline_tools import scenes
    given = {name: value for name, value in vars(options).items() if name not in OTHERS}
    try:
        text = getattr(scenes, options.scene)(**given)
    except ValueError as problem:
        raise UserError(str(problem)) from problem
    path = output(options.output)
    path.write_text(text, encoding="ascii")
    print(f"wrote {path}")
    return 0
