# SPDX-License-Identifier: MIT
"""The commands that write decks: make-deck, from-mesh and refine. An option of a scene has the name of the
parameter of the function that writes it, and what is not given is left to that function."""
import argparse
import pathlib

from slideline_tools import UserError
from slideline_tools.commands import PROGRAM, add, output_to

SCENES = {  # name -> what it is, refinement levels, Gauss points of type 6 (no contact: 0)
    "collision": ("projectile on a plate, half model", "1 to 4 in the paper", 4),
    "sliding": ("die pressed into a plate and drawn along it", "1 to 3 in the paper", 6),
    "block": ("two soft blocks, explicit or implicit", "1 in the paper", 4),
    "patch": ("contact patch test, damped to rest or static", "", 4),
    "oblique": ("oblique impact of a turned block on a free one", "", 4),
    "hertz": ("elastic cylinder on an elastic block", "1 to 8", 4),
    "symmetric_plate": ("plate on two pins under a step load", "", 0),
    "taylor": ("copper rod on a rigid wall, axisymmetric, without contact", "", 0),
}
STATIC = ("--static", {"action": "store_true",
                       "help": "static steps of the implicit method, not damping to rest"})
# The names of scenes.patch.MESHES and SURFACES stand here without their slow imports.
OWN_OPTIONS = {
    "patch": (("--mesh", {"choices": ("3/2", "5/4", "7/5", "2/7", "51/50"),
                          "help": "quads along the interface, upper/lower block; 7/5 is not even, "
                                  "2/7 has slave segments over three and four master segments "
                                  "(5/4)"}),
              ("--penalty", {"type": float, "help": "N/m per contact node; damping, step and end "
                                                    "time follow it (1e6)"}),
              ("--surfaces", {"choices": ("faces", "tied", "one-set"),
                              "help": "contact of the two faces, ties of these, or one part set "
                                      "with itself (faces)"}), STATIC),
    "hertz": (STATIC,),
    "block": (("--implicit", {"action": "store_true",
                              "help": "implicit dynamics instead of the explicit method"}),),
    "sliding": (("--rigid-die", {"action": "store_true",
                                 "help": "the die is a rigid body, not elastic"}),),
    "symmetric_plate": (
        ("--nx", {"type": int, "dest": "n_x", "help": "elements along 8 m, a multiple of 8 (8)"}),
        ("--ny", {"type": int, "dest": "n_y", "help": "elements through 1 m, even (4)"}),
        ("--elastoplastic", {"action": "store_true", "help": "yield stress 10 MPa"})),
    "taylor": (("--columns", {"type": int, "help": "elements along the radius of 3.2 mm (10)"}),
               ("--rows", {"type": int, "help": "elements along 32.4 mm (100)"})),
}
#: what the parser sets beside the options of a scene
OTHERS = ("command", "scene", "output", "run", "parser")


def add_all(commands) -> None:
    """Add these commands."""
    scenes = add(commands, make_deck, "make-deck", "write the deck of a scene", """\
make-deck collision --level 2 -o collision_2.k
make-deck hertz --static -o hertz.k
make-deck patch --mesh 7/5 --penalty 1e4 -o patch.k
make-deck SCENE --help""").add_subparsers(dest="scene", required=True, metavar="SCENE")
    for name, (text, levels, points) in SCENES.items():
        scene = scenes.add_parser(name, help=text, description=f"Write the deck: {text}.",
                                  argument_default=argparse.SUPPRESS)
        scene.add_argument("--output", "-o", required=True, help="deck file to write")
        if levels:
            scene.add_argument("--level", type=int, help=f"refinement N_r, {levels} (1)")
        if points:
            scene.add_argument("--ctype", type=int, help="contact type in the deck (2)")
            scene.add_argument("--ngauss", type=int, help=f"Gauss points of type 6 ({points})")
            scene.add_argument("--exchanged", action="store_true",
                               help="slave and master surface exchanged")
        for option, words in OWN_OPTIONS.get(name, ()):
            scene.add_argument(option, **words)
    add(commands, refine, "refine", "the deck of a run on a mesh that is finer where it pays", """\
refine results/hertz --fraction 0.5 -o hertz_2.k
refine results/hertz --fraction 0.3 --surfaces -o hertz_2.k
refine results/bar --field plastic_strain -o bar_2.k

The new deck has the keyword too: run it and refine it again.""",
        ("run_path", {"metavar": "RUN", "help": "folder of a run, or a file of it"}),
        ("--fraction", {"type": float, "default": 0.5, "metavar": "X",
                        "help": "share of the sum of the field that the divided elements have (0.5)"}),
        ("--field", {"default": "error", "metavar": "NAME", "help": "cell field that says where (error)"}),
        ("--surfaces", {"action": "store_true", "help": "divide the elements along all contact surfaces too"}),
        output_to("deck file to write", required=True), PROGRAM)
    add(commands, from_mesh, "from-mesh", "the skeleton of a deck from a mesh of gmsh and others", """\
from-mesh model.msh                    # model.k: fill in materials, conditions, contact
from-mesh model.msh -o decks/first.k

gmsh: recombine to quads, Mesh.ElementOrder 1, physical groups for bodies and edges
(doc/meshes.md).""", ("mesh", {"metavar": "MESH", "help": "mesh file"}),
        output_to("deck to write (default: MESH with .k)"))


def make_deck(options) -> int:
    """Write the keyword deck of a scene, as those of its folder in input; numbers such as the penalty are parameters of the
    deck, p:NAME=VALUE. The paper is that of Kang, Lee & Shin (2023)."""
    from slideline_tools import scenes
    from slideline_tools.files import output
    given = {name: value for name, value in vars(options).items() if name not in OTHERS}
    try:
        text = getattr(scenes, options.scene)(**given)
    except ValueError as problem:
        raise UserError(str(problem)) from problem
    path = output(options.output)
    path.write_text(text, encoding="ascii")
    print(f"wrote {path}")
    return 0


def from_mesh(options) -> int:
    """Write the skeleton of a deck from a mesh file: nodes, quads and triangles, physical groups of faces as parts, of lines
    as segment and node sets, of points as node sets; materials, conditions and contact are to be filled in. Reads what
    meshio reads (.msh, .inp, .vtk, ...)."""
    from slideline_tools import from_mesh as meshes
    from slideline_tools.files import output
    from slideline_tools.names import counted
    source = pathlib.Path(options.mesh)
    path = pathlib.Path(options.output or source.with_suffix(".k"))
    if path.exists() and not options.output:
        raise UserError(f"{path} exists; give -o FILE to write over it, or elsewhere")
    mesh = meshes.read(source)
    deck = meshes.deck_of(mesh, f"from {source.name}")
    output(path, [source]).write_text(deck.text(), encoding="utf-8")
    n_face = sum(map(len, mesh.parts.values()))
    print(f"wrote {path} ({counted(len(mesh.points), 'node')}, {counted(n_face, 'element')})")
    for pid, (name, faces) in enumerate(mesh.parts.items(), start=1):
        print(f"part {pid}: {name}, {counted(len(faces), 'element')}")
    for sid, (name, rows) in enumerate([*mesh.lines.items(), *mesh.nodes.items()], start=1):
        kind = "edge" if name in mesh.lines else "node"
        print(f"set {sid}: {name}, {counted(len(rows), kind)}")
    for note in mesh.notes:
        print(note)
    return 0


def refine(options) -> int:
    """Write the deck of a run with the elements divided in four whose stress errors are largest, from time zero on.
    Neighbours differ by one division at most, with hanging nodes between them (*CONSTRAINED_ADAPTIVITY); elements along a
    contact surface are divided all or none. The run needs *DATABASE_ERROR_INDICATOR for the field error."""
    from slideline_tools.answer.refine import refine_run
    from slideline_tools.files import output
    from slideline_tools.finished_run import Run
    from slideline_tools.program import find_program
    if not 0.0 < options.fraction <= 1.0:
        raise UserError(f"--fraction {options.fraction:g}: expected more than 0 and at most 1")
    text, divided, total = refine_run(Run(options.run_path), find_program(options.program), options.fraction, options.field,
                                      options.surfaces)
    output(options.output).write_text(text, encoding="utf-8")
    print(f"{options.output}: {divided} elements divided, {total} in all")
    return 0
