# SPDX-License-Identifier: MIT
"""Kratos (contact structural mechanics) on the contact patch of calculix.py. usage: kratos_patch.py COLUMNS

Mortar contact by an augmented Lagrangian, without springs; the upper face is pushed down so far that the exact pressure
is 1 Pa. The time is that of the analysis, from reading its mesh on: Python and the libraries are there already.
"""
import json
import os
import pathlib
import sys
import tempfile
import time

import KratosMultiphysics as kratos
import KratosMultiphysics.ContactStructuralMechanicsApplication  # noqa: F401 registers its variables and conditions
from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis

import numpy as np

import wave
from calculix import RHO, YOUNG

PUSH = 2.0 / YOUNG  # of two blocks of 1 m, for 1 Pa
CONTACT_APPLICATION = "KratosMultiphysics.ContactStructuralMechanicsApplication"
APPLICATION = "KratosMultiphysics"


def block(name, lines):
    """A block of a mesh file."""
    return f"Begin {name}\n" + "".join(f"{line}\n" for line in lines) + f"End {name.split()[0]}\n"


def part(name, nodes, conditions=(), elements=()):
    """A set of the mesh file."""
    inner = [block(f"SubModelPart{what}", members) for what, members in (
        ("Nodes", nodes), ("Elements", elements), ("Conditions", conditions))]
    return f"Begin SubModelPart {name}\n{''.join(inner)}End SubModelPart\n"


def mesh_text(columns):
    """Two blocks of 1 m; the lower one has 4/5 of the columns."""
    below = columns * 4 // 5
    (upper, upper_quads), (lower, lower_quads) = wave.grid(columns), wave.grid(below)
    points = np.vstack([upper, lower - [0.0, 1.0]])
    quads = np.vstack([upper_quads, lower_quads + len(upper)]) + 1
    first = {columns: 1 + np.arange(columns + 1) * (columns + 1), below: len(upper) + 1 + np.arange(below + 1) * (below + 1)}
    slave, top, base, master = first[columns], first[columns] + columns, first[below], first[below] + below
    lines = [*zip(slave[:-1], slave[1:]), *zip(master[1:], master[:-1])]
    numbers = range(1, len(lines) + 1)
    return "".join((
        block("Properties 0", ()), block("Properties 1", ()),
        block("Nodes", (f"{k} {x!r} {y!r} 0.0" for k, (x, y) in enumerate(points.tolist(), 1))),
        block("Elements TotalLagrangianElement2D4N",
              (f"{k} 1 " + " ".join(map(str, quad)) for k, quad in enumerate(quads.tolist(), 1))),
        block("Conditions LineCondition2D2N", (f"{k} 0 {a} {b}" for k, (a, b) in zip(numbers, lines))),
        part("quads", range(1, len(points) + 1), (), range(1, len(quads) + 1)),
        part("slave", slave, range(1, columns + 1)), part("faces", [*slave, *master], numbers),
        part("base", base), part("top", top), part("pins", (base[below // 2], top[columns // 2]))))


def hold(name, x=None, y=None):
    """Displacements of a set that are given."""
    return {"python_module": "assign_vector_variable_process", "kratos_module": APPLICATION, "Parameters": {
        "model_part_name": f"Structure.{name}", "variable_name": "DISPLACEMENT", "value": [x, y, None],
        "constrained": [x is not None, y is not None, False], "interval": [0.0, "End"]}}


def settings():
    """One static step with contact of the two faces."""
    return {
        "problem_data": {"problem_name": "patch", "parallel_type": "OpenMP", "echo_level": 0, "start_time": 0.0, "end_time": 1.0},
        "solver_settings": {
            "model_part_name": "Structure", "domain_size": 2, "solver_type": "Static", "echo_level": 0,
            "analysis_type": "non_linear", "model_import_settings": {"input_type": "mdpa", "input_filename": "patch"},
            "material_import_settings": {"materials_filename": "material.json"},
            "contact_settings": {"mortar_type": "ALMContactFrictionless"}, "time_stepping": {"time_step": 1.1},
            "clear_storage": False, "convergence_criterion": "contact_residual_criterion",
            "displacement_relative_tolerance": 1.0e-10, "displacement_absolute_tolerance": 1.0e-14,
            "residual_relative_tolerance": 1.0e-10, "residual_absolute_tolerance": 1.0e-12, "max_iteration": 30,
            "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"}},
        "processes": {
            "constraints_process_list": [hold("base", y=0.0), hold("top", y=-PUSH), hold("pins", x=0.0)],
            "loads_process_list": [],
            "contact_process_list": [{
                "python_module": "alm_contact_process", "kratos_module": CONTACT_APPLICATION, "Parameters": {
                    "model_part_name": "Structure", "contact_model_part": {"0": ["faces"]},
                    "assume_master_slave": {"0": ["slave"]}, "contact_type": "Frictionless"}}]},
        "output_processes": {}}


def material():
    """The elastic law of all quads."""
    return {"properties": [{"model_part_name": "Structure.quads", "properties_id": 1, "Material": {
        "constitutive_law": {"name": "LinearElasticPlaneStrain2DLaw"},
        "Variables": {"DENSITY": RHO, "YOUNG_MODULUS": YOUNG, "POISSON_RATIO": 0.0, "THICKNESS": 1.0}, "Tables": {}}}]}


def main():
    columns = int(sys.argv[1])
    kratos.Logger.GetDefaultOutput().SetSeverity(kratos.Logger.Severity.WARNING)
    kratos.ParallelUtilities.SetNumThreads(1)
    model = kratos.Model()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        pathlib.Path("patch.mdpa").write_text(mesh_text(columns), encoding="ascii")
        pathlib.Path("material.json").write_text(json.dumps(material()), encoding="ascii")
        start = time.process_time()
        StructuralMechanicsAnalysis(model, kratos.Parameters(json.dumps(settings()))).Run()
        seconds = time.process_time() - start
        os.chdir("/")
    structure = model["Structure"]
    found = {quad.Id: float(np.mean([point[1] for point in points])) for quad in structure.GetSubModelPart("quads").Elements
             for points in [quad.CalculateOnIntegrationPoints(kratos.CAUCHY_STRESS_VECTOR, structure.ProcessInfo)]}
    print("\n" + json.dumps({"stress": found, "processor_seconds": seconds}), flush=True)


if __name__ == "__main__":
    main()
