# SPDX-License-Identifier: MIT
"""The command `slideline-tools from-mesh`."""
from __future__ import annotations

import pathlib


def add(commands) -> None:
    """Add the command and its options."""
    parser = commands.add_parser(
        "from-mesh", help="the skeleton of a deck from a mesh of gmsh and others",
        description="Write the skeleton of a deck from a mesh file: nodes, quads and triangles, physical groups "
                    "of faces as parts, of lines as segment and node sets, of points as node sets; materials, "
                    "conditions and contact are to be filled in. Reads what meshio reads (.msh, .inp, .vtk, ...).")
    parser.add_argument("mesh", metavar="MESH", help="mesh file")
    parser.add_argument("--output", "-o", metavar="FILE", help="deck to write (default: MESH with .k)")
    parser.set_defaults(run=run)


def run(options) -> int:
    """Read, write, and say what became of the groups."""
    from slideline_tools import UserError, from_mesh
    from slideline_tools.files import output
    from slideline_tools.names import counted
    source = pathlib.Path(options.mesh)
    path = pathlib.Path(options.output or source.with_suffix(".k"))
    if path.exists() and not options.output:
        raise UserError(f"{path} exists; give -o FILE to write over it, or elsewhere")
    mesh = from_mesh.read(source)
    deck = from_mesh.deck_of(mesh, f"from {source.name}")
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
