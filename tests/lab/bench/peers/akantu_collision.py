# SPDX-License-Identifier: MIT
"""Akantu on the problem of collision.py. usage: akantu_collision.py COLUMNS [STEPS]"""
import pathlib
import sys
import tempfile

import akantu
import numpy as np

import collision
import wave

MATERIAL = """material elastic [
  name = {name}
  rho = {rho}
  E = {young}
  nu = 0.0
]
"""
CONTACT = """contact_detector [
  type = explicit
  master = master
  slave = slave
  projection_tolerance = 1e-10
  max_iterations = 100
  extension_tolerance = 1e-5
]
contact_resolution penalty_linear [
  name = springs
  mu = 0.0
  epsilon_n = {slope}
  epsilon_t = 0.0
  is_master_deformable = true
]
"""


def mesh_text(columns):
    """Both blocks and their faces in the format of gmsh, and the places of the nodes."""
    points, lines = [], []
    for block, (n, low) in enumerate(((columns, 0.0), (collision.below(columns), -1.0))):
        at, quads = wave.grid(n)
        first = sum(map(len, points)) + 1
        points.append(at + [0.0, low])
        lines += [f"3 2 {block + 1} {block + 1} " + " ".join(map(str, quad)) for quad in (quads + first).tolist()]
        face = first + np.arange(n + 1) * (n + 1) + (n if block else 0)
        pairs = np.stack([face[:-1], face[1:]], axis=1)
        lines += [f"1 2 {block + 3} {block + 3} {a} {b}" for a, b in (pairs[:, ::-1] if block else pairs).tolist()]
    points = np.vstack(points)
    names = ['2 1 "upper"', '2 2 "lower"', '1 3 "slave"', '1 4 "master"']
    nodes = [f"{number} {x!r} {y!r} 0" for number, (x, y) in enumerate(points.tolist(), 1)]
    cells = [f"{number} {line}" for number, line in enumerate(lines, 1)]
    sections = (("MeshFormat", ["2.2 0 8"]), ("PhysicalNames", ["4", *names]), ("Nodes", [str(len(nodes)), *nodes]),
                ("Elements", [str(len(cells)), *cells]))
    return "".join(f"${name}\n" + "\n".join(text) + f"\n$End{name}\n" for name, text in sections), points


def build(columns):
    """The coupled model at its first speeds, and the number of nodes of the upper block."""
    text, points = mesh_text(columns)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "blocks.msh").write_text(text, encoding="ascii")
        (folder / "blocks.dat").write_text(
            "".join(MATERIAL.format(name=name, rho=collision.RHO, young=collision.YOUNG) for name in ("upper", "lower"))
            + CONTACT.format(slope=collision.PENALTY * columns), encoding="ascii")
        akantu.parseInput(str(folder / "blocks.dat"))
        mesh = akantu.Mesh(2)
        mesh.read(str(folder / "blocks.msh"))
    model = akantu.CouplerSolidContact(mesh)
    solid = model.getSolidMechanicsModel()
    selector = akantu.MeshDataMaterialSelectorString("physical_names", solid)
    solid.setMaterialSelector(selector)
    model.initFull(_analysis_method=akantu._explicit_lumped_mass)
    model.getContactMechanicsModel().getContactDetector().setSurfaceSelector(akantu.PhysicalSurfaceSelector(mesh))
    model.setTimeStep(collision.step(columns))
    n_upper = (columns + 1) ** 2
    if not np.allclose(np.array(mesh.getNodes()), points):
        raise SystemExit("the mesh has another order of nodes")
    speed = solid.getVelocity()
    speed[:n_upper, 1] = -0.5 * collision.V
    speed[n_upper:, 1] = 0.5 * collision.V
    return mesh, selector, model, solid, n_upper


def main():
    columns = int(sys.argv[1])
    steps = int(sys.argv[2]) if len(sys.argv) > 2 else collision.steps(columns)
    mesh, selector, model, solid, n_upper = build(columns)
    model.solveStep()
    seconds = wave.timed(model.solveStep, steps - 1) * steps / max(1, steps - 1)
    speed = np.array(solid.getVelocity())[:, 1]
    collision.report("Akantu", "node to segment, penalty", columns, steps, seconds, (speed[:n_upper], speed[n_upper:]))
    del model, selector, mesh


if __name__ == "__main__":
    main()
