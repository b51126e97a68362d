# SPDX-License-Identifier: MIT
"""Akantu on the problem of wave.py. usage: akantu_wave.py COLUMNS STEPS"""
import pathlib
import sys
import tempfile

import akantu
import numpy as np

import wave

MATERIAL = """material elastic [
  name = block
  rho = {rho}
  E = {young}
  nu = 0.0
  Plane_Stress = 0
  finite_deformation = {finite}
]
"""


def build(columns, finite):
    """The model with mesh, material, support and velocities."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "material.dat"
        path.write_text(MATERIAL.format(rho=wave.RHO, young=wave.YOUNG, finite=finite),
                        encoding="ascii")
        akantu.parseInput(str(path))
    points, quads = wave.grid(columns)
    mesh = akantu.Mesh(2)
    access = akantu.MeshAccessor(mesh)
    access.resizeNodes(len(points))
    mesh.getNodes()[:, :] = points
    mesh.addConnectivityType(akantu._quadrangle_4)
    access.resizeConnectivity(len(quads), akantu._quadrangle_4)
    mesh.getConnectivity(akantu._quadrangle_4)[:, :] = quads
    access.makeReady()
    model = akantu.SolidMechanicsModel(mesh)
    model.initFull(akantu._explicit_lumped_mass)
    model.setTimeStep(wave.step(columns))
    model.getBlockedDOFs()[points[:, 0] == 0.0, :] = True
    model.getVelocity()[:, 0] = wave.first_velocity(points)
    return mesh, model, points


def main():
    columns, steps = int(sys.argv[1]), int(sys.argv[2])
    finite = len(sys.argv) > 3
    mesh, model, points = build(columns, int(finite))
    model.solveStep()
    seconds = wave.timed(model.solveStep, steps - 1) * steps / (steps - 1)
    free = np.array(model.getDisplacement())[points[:, 0] == wave.LENGTH, 0]
    wave.report("Akantu", "2x2 points, " + ("large" if finite else "small") + " strain", columns,
                steps, seconds, free)


if __name__ == "__main__":
    main()
