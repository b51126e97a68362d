# SPDX-License-Identifier: MIT
"""Kratos (structural mechanics) on the problem of wave.py. usage: kratos_wave.py COLUMNS STEPS"""
import sys

import KratosMultiphysics as kratos
import KratosMultiphysics.StructuralMechanicsApplication as structural
import numpy as np

import wave

ELEMENT = "SmallDisplacementElement2D4N"
VARIABLES = (kratos.DISPLACEMENT, kratos.VELOCITY, kratos.ACCELERATION, kratos.REACTION,
             kratos.VOLUME_ACCELERATION, kratos.NODAL_MASS, kratos.FORCE_RESIDUAL,
             kratos.RESIDUAL_VECTOR, structural.MIDDLE_VELOCITY)


def build(columns):
    """The model part with mesh, material, support and velocities."""
    model = kratos.Model()
    part = model.CreateModelPart("block", 2)
    part.ProcessInfo[kratos.DOMAIN_SIZE] = 2
    part.ProcessInfo[kratos.COMPUTE_LUMPED_MASS_MATRIX] = True
    for variable in VARIABLES:
        part.AddNodalSolutionStepVariable(variable)
    law = part.CreateNewProperties(1)
    for variable, value in ((kratos.DENSITY, wave.RHO), (kratos.YOUNG_MODULUS, wave.YOUNG),
                            (kratos.POISSON_RATIO, 0.0), (kratos.THICKNESS, 1.0)):
        law.SetValue(variable, value)
    law.SetValue(kratos.CONSTITUTIVE_LAW, structural.LinearElasticPlaneStrain2DLaw())
    points, quads = wave.grid(columns)
    for number, (x, y) in enumerate(points.tolist(), start=1):
        part.CreateNewNode(number, x, y, 0.0)
    for number, quad in enumerate((quads + 1).tolist(), start=1):
        part.CreateNewElement(ELEMENT, number, quad, law)
    utility = kratos.VariableUtils()
    for name, reaction in (("DISPLACEMENT_X", "REACTION_X"), ("DISPLACEMENT_Y", "REACTION_Y")):
        utility.AddDof(getattr(kratos, name), getattr(kratos, reaction), part)
    velocity = wave.first_velocity(points).tolist()
    for node, v_x in zip(part.Nodes, velocity):
        node.SetSolutionStepValue(kratos.VELOCITY_X, v_x)
        if node.X == 0.0:
            node.Fix(kratos.DISPLACEMENT_X)
            node.Fix(kratos.DISPLACEMENT_Y)
    return model, part


def main():
    columns, steps = int(sys.argv[1]), int(sys.argv[2])
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    kratos.ParallelUtilities.SetNumThreads(1)
    model, part = build(columns)
    part.SetBufferSize(2)
    scheme = structural.ExplicitCentralDifferencesScheme(1.0, 0.0, 0.0)
    strategy = structural.MechanicalExplicitStrategy(part, scheme, False, False, False)
    strategy.Initialize()
    dt = wave.step(columns)
    part.ProcessInfo[kratos.DELTA_TIME] = dt

    def advance():
        part.ProcessInfo[kratos.STEP] += 1
        part.CloneTimeStep(part.ProcessInfo[kratos.TIME] + dt)
        strategy.Solve()

    advance()
    seconds = wave.timed(advance, steps - 1) * steps / (steps - 1)
    free = [node.GetSolutionStepValue(kratos.DISPLACEMENT_X) for node in part.Nodes
            if node.X == wave.LENGTH]
    wave.report("Kratos", "2x2 points, small strain", columns, steps, seconds,
                np.array(free))


if __name__ == "__main__":
    main()
