# SPDX-License-Identifier: MIT
"""The skeleton of a deck from a mesh file (gmsh, Abaqus, VTK and what else meshio reads).

Physical groups become what a deck knows: groups of faces parts, groups of lines segment sets (surfaces
of contact, edges under pressure) and node sets, groups of points node sets. Faces of no group are one
part. Materials, contact and times are for the user to fill in: the skeleton says where.
"""
import contextlib
import dataclasses
import io
import pathlib

import numpy as np

from slideline_tools import UserError
from slideline_tools.decks import Deck
from slideline_tools.names import counted

FACES = {"triangle": 3, "quad": 4}
#: cells of a plane mesh of the first order
TAKEN = (*FACES, "line", "vertex")
UNGROUPED = "without a group"


@dataclasses.dataclass
class PlaneMesh:
    """points (n, 2); faces of each part and lines of each set by rows of points, name -> rows."""

    points: np.ndarray
    parts: dict[str, list[list[int]]]
    lines: dict[str, np.ndarray]
    nodes: dict[str, np.ndarray]
    notes: list[str]


def read(path) -> PlaneMesh:
    """The mesh of a file; everything that cannot be taken is reported at once."""
    try:
        import meshio
    except ImportError:
        raise UserError("reading meshes needs meshio: build/venv/bin/pip install -e './tools[mesh]'") from None
    if not pathlib.Path(path).is_file():
        raise UserError(f"{path}: no such file")
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # meshio says an empty line of some files
            mesh = meshio.read(path)
    except (Exception, SystemExit) as trouble:  # meshio ends the interpreter on some files
        raise UserError(f"{path}: meshio cannot read it: {trouble}") from None
    check(path, mesh)
    return gather(mesh)


def check(path, mesh) -> None:
    """Refuses what is no plane mesh of three- and four-node faces, with every reason."""
    troubles = [f"{len(block.data)} cells of kind {block.type}; only triangle, quad, line and vertex "
                "(save with Mesh.ElementOrder 1, in two dimensions)"
                for block in mesh.cells if block.type not in TAKEN]
    if not any(block.type in FACES for block in mesh.cells):
        troubles.append("no triangles and no quads")
    used = used_points(mesh)
    if mesh.points.shape[1] > 2 and len(used):
        z = mesh.points[used, 2]
        if np.ptp(z) > 1.0e-9 * max(np.ptp(mesh.points[used, 0]), np.ptp(mesh.points[used, 1])):
            troubles.append(f"z runs from {z.min():.6g} to {z.max():.6g}; the mesh must lie in a plane of constant z")
    if troubles:
        raise UserError(f"{path}: " + "; ".join(troubles))


def used_points(mesh) -> np.ndarray:
    """Points of triangles and quads, ascending."""
    rows = [block.data.ravel() for block in mesh.cells if block.type in FACES]
    return np.unique(np.concatenate(rows)) if rows else np.zeros(0, dtype=int)


def heading(name: str) -> str:
    """A name as a line of text: neither a comment nor a keyword."""
    return (f"_{name}" if name[:1] in "$*" else name)[:80]


def gather(mesh) -> PlaneMesh:
    """Parts and sets by the groups of the mesh; points of no face are left out."""
    used = used_points(mesh)
    place = np.full(len(mesh.points), -1)
    place[used] = np.arange(len(used))
    names = {(int(value[1]), int(value[0])): name for name, value in mesh.field_data.items()}
    result = PlaneMesh(mesh.points[used, :2], {}, {}, {}, [])
    if left := len(mesh.points) - len(used):
        result.notes.append(f"{counted(left, 'point')} of no triangle or quad left out")
    numbers = mesh.cell_data.get("gmsh:physical")
    turned = 0
    for i, block in enumerate(mesh.cells):
        groups = np.asarray(numbers[i] if numbers is not None else np.zeros(len(block.data), int))
        dimension = {"vertex": 0, "line": 1}.get(block.type, 2)
        for group in dict.fromkeys(groups.tolist()):
            name = names.get((dimension, group), f"group {group}" if group else UNGROUPED)
            rows = place[block.data[groups == group]]
            kept = rows[(rows >= 0).all(axis=1)]
            if dimension == 2:
                turned += walk_left(result.points, rows)
                result.parts.setdefault(name, []).extend(rows.tolist())
            elif group and len(kept):
                sets = result.lines if dimension else result.nodes
                sets[name] = np.concatenate([sets[name], kept]) if name in sets else kept
    if turned:
        result.notes.append(f"{counted(turned, 'face')} walked clockwise and turned")
    for name, rows in getattr(mesh, "point_sets", {}).items():  # of Abaqus and Exodus
        rows = place[np.asarray(rows, dtype=int)]
        result.nodes[name] = rows[rows >= 0]
    result.nodes = {name: np.unique(rows) for name, rows in result.nodes.items()}
    return result


def walk_left(points, rows) -> int:
    """Turn faces that are walked with the face on the right; how many were."""
    x, y = points[rows, 0], points[rows, 1]
    area = np.sum(x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y, axis=1)
    rows[area <= 0.0] = rows[area <= 0.0, ::-1]
    return int(np.sum(area <= 0.0))


def deck_of(mesh: PlaneMesh, title: str) -> Deck:
    """The skeleton: parts with a material to fill in, nodes, elements, sets."""
    deck = Deck(title[:80], [
        "A skeleton by slideline-tools from-mesh. To fill in: materials, how long, boundary conditions, "
        "contact (commented out below), what is written. Units are those of the mesh and yours.",
        *mesh.notes])
    deck.block("How long, and how often a state is written.")
    deck.keyword("CONTROL_TERMINATION").card("endtim", 1.0)
    deck.keyword("DATABASE_BINARY_D3PLOT").card("dt", 0.1)
    deck.keyword("DATABASE_GLSTAT").card("dt", 0.01)
    deck.block("Plane strain (ELFORM 13; 15: axisymmetric about x = 0), one point (implicit runs: four; NIP 1 and 4 "
               "say which), and a steel for each part.")
    deck.keyword("SECTION_SHELL").card("secid elform shrf nip", 1, 13, 1.0, None)
    for pid, name in enumerate(mesh.parts, start=1):
        deck.keyword("PART", heading(name)).card("pid secid mid", pid, 1, pid)
        deck.keyword("MAT_ELASTIC").card("mid ro e pr", pid, 7850.0, 2.1e11, 0.3)
    add_sets(deck, mesh)
    deck.block("The mesh.")
    deck.nodes(range(1, len(mesh.points) + 1), mesh.points)
    faces = [(pid, face) for pid, some in enumerate(mesh.parts.values(), start=1) for face in some]
    quads = [[n + 1 for n in (*face, face[-1])[:4]] for _, face in faces]
    return deck.quads(range(1, len(faces) + 1), [pid for pid, _ in faces], quads)


def add_sets(deck: Deck, mesh: PlaneMesh) -> None:
    """Segment and node sets, with the names of their groups, and what to write to use them."""
    for sid, (name, rows) in enumerate([*mesh.lines.items(), *mesh.nodes.items()], start=1):
        if sid <= len(mesh.lines):
            deck.block(f"{name}: edges (segment set {sid}) and their nodes (node set {sid}).")
            deck.keyword("SET_SEGMENT_TITLE", heading(name)).card("sid", sid)
            deck.table("n1 n2", [10, 10], [(a + 1, b + 1) for a, b in rows])
        else:
            deck.block(f"{name}: nodes (node set {sid}).")
        deck.node_set(sid, heading(name), np.unique(rows) + 1)
    if len(mesh.lines) > 1:
        first, second, *_ = mesh.lines
        deck.block(f"Contact between {first} and {second}, type 5: take the $ and the blank off the "
                   "lines below, but for the second.", "*CONTACT_2D_SLIDELINE",
                   "surfa, surfb, ctype, ngauss, pen; a positive number is a segment set where no "
                   "part set has it", "1, 2, 5, 0, 1.0", "0, 0, 2")
