# SPDX-License-Identifier: MIT
"""Hertz line contact: half width and largest pressure, all types, two or three meshes for some."""
import functools

import numpy as np

from contact_types import PASS_PATCH, TYPES
import hertz_line as lines
from slideline_tools.scenes import hertz, hertz_grids
from slideline_tools.scenes.common import ALUMINIUM, STEEL
from slideline_tools.scenes.hertz import (BLOCK_CELL, CYLINDER_CELL, PENALTY,
                                          RADIUS)

LEVELS = (1, 2)
STATIC = (2, 5, 7)  # types with the implicit method too
FINEST, REFINED = 3, (5, 7)
FEW = (7,)  # of the latter, and of the implicit ones on the second mesh, where not in full
TWO_MESHES = (2, 7)  # explicit, where not in full
MODULUS = lines.effective_modulus(STEEL, ALUMINIUM)


@functools.cache
def scene(level, exchanged, static):
    """The deck, whose contact type is set from the command line."""
    return hertz(level, exchanged=exchanged, static=static)


class Answer:
    """What one run gives, over the closed form for its own contact force."""

    def __init__(self, run, kind, level, exchanged=False, static=False):
        self.kind, self.level = kind, level
        self.slave_body = ALUMINIUM if exchanged else STEEL
        name = (f"type{kind}_level{level}" + ("_exchanged" if exchanged else "")
                + ("_static" if static else ""))
        self.result = run.program(scene(level, exchanged, static), f"ctype={kind}", name=name)
        self.name = (f"{TYPES[kind]}, N_r = {level}" + (", exchanged" if exchanged else "")
                     + (", static" if static else ""))
        rows = self.result.table("contact")
        self.nodes = rows.where(time=rows["time"][-1])
        self.found = lines.measure(*(self.nodes[key] for key in ("x", "length", "pressure")))
        self.exact = lines.hertz(self.found.force, RADIUS, MODULUS)
        self.half_width = self.found.half_width / self.exact[0]
        self.peak = self.found.peak / self.exact[1]
        cells = np.array([BLOCK_CELL, CYLINDER_CELL] if exchanged
                         else [CYLINDER_CELL, BLOCK_CELL]) / level
        self.cell = cells[0] / self.exact[0]
        self.softness = MODULUS / self.exact[0] / lines.layer_stiffness(kind, PENALTY, *cells)
        self.layer = lines.layer_profile(self.softness)

    def mesh_error(self):
        """Bound of the error of a and p0 that mesh and linear theory leave, see README.md."""
        young, poisson = self.slave_body["young"], self.slave_body["poisson"]
        strain = (1.0 + poisson) * (1.0 - 2.0 * poisson) * self.exact[1] / young
        return 0.85 * self.cell ** 2.5 + self.cell ** 2 / 3.0 + strain

    def support_force(self):
        """Force through the lowest row of the block, from its stress."""
        block = hertz_grids(self.level)[0]
        stress = self.result.cells("stress")[-1, :block.element.size, 1]
        x = self.result.points("Points")[-1, :block.node.size, 0].reshape(block.node.shape)
        return -float(np.sum(stress.reshape(block.element.shape)[:, 0] * np.diff(x[:, 0])))


def check_rest(run, answer):
    """Equilibrium, and energies that may not matter."""
    slave = answer.result.table("rcforc").where(side="slave")["fy"][-1]
    run.check(f"{answer.name}: pressures add up to the contact force", answer.found.force,
              abs(slave), scale=(answer.exact[0] / RADIUS) ** 2)
    run.check(f"{answer.name}: stress above the rollers times width", answer.support_force(),
              abs(slave))
    energy = answer.result.table("glstat")
    run.check(f"{answer.name}: kinetic / internal energy",
              energy["kinetic"][-1] / energy["internal"][-1], 0.0)
    run.check(f"{answer.name}: hourglass / internal energy",
              energy["hourglass"][-1] / energy["internal"][-1], 0.0)


def check_answer(run, answer):
    """Half width and peak against Hertz, and against Hertz with the penalty as a layer."""
    mesh, layer = answer.mesh_error(), answer.layer
    scatter = 2.0 * answer.found.scatter / answer.exact[1]
    run.check(f"{answer.name}: half width / Hertz", answer.half_width, 1.0,
              tol=mesh + abs(layer.half_width - 1.0))
    run.check(f"{answer.name}: peak pressure / Hertz", answer.peak, 1.0,
              tol=mesh + scatter + abs(layer.peak - 1.0))
    if answer.level > 1:
        run.check(f"{answer.name}: half width / Hertz on springs",
                  answer.half_width / layer.half_width, 1.0, tol=mesh)
        run.check(f"{answer.name}: peak pressure / Hertz on springs", answer.peak / layer.peak, 1.0,
                  tol=mesh + scatter)
    inside, _ = lines.deviation(answer.nodes["x"], answer.nodes["pressure"], *answer.exact)
    if answer.kind in PASS_PATCH:
        run.check(f"{answer.name}: profile inside 0.8 a / p0", inside, 0.0,
                  tol=(mesh + abs(layer.half_width - 1.0)) / 0.6)
    else:
        run.report(f"{answer.name}: largest deviation of the profile inside 0.8 a / p0", inside)


def check_refinement(run, answers):
    """Errors against Hertz fall by at least 2 where the cell falls by 3, or with that order down to the finest there is."""
    name, finest = TYPES[answers[0].kind], answers[-1].level
    for text, errors in (("half width", [abs(one.half_width - 1.0) for one in answers]),
                         ("peak pressure", [abs(one.peak - 1.0) for one in answers])):
        run.check(f"{name}: error of the {text}, N_r = {finest} over 1", errors[-1] / errors[0],
                  0.5 ** (np.log(finest) / np.log(FINEST)))


def check_static(run, kind, explicit):
    """The implicit method on fully integrated quads; the force, for the same way, is that of the
    one-point quads but for what the meshes leave."""
    answers = [Answer(run, kind, level, static=True) for level in (LEVELS if run.is_full or kind in FEW else LEVELS[:1])]
    for answer, other in zip(answers, explicit):
        check_rest(run, answer)
        check_answer(run, answer)
        run.check(f"{answer.name}: contact force", answer.found.force, other.found.force,
                  tol=answer.mesh_error())


def check(run):
    refined = REFINED if run.is_full else FEW
    for kind in TYPES:
        levels = LEVELS if run.is_full or kind in TWO_MESHES else LEVELS[:1]
        answers = [Answer(run, kind, level) for level in levels + ((FINEST,) if run.is_full and kind in refined else ())]
        for answer in answers:
            check_rest(run, answer)
            check_answer(run, answer)
        if kind in refined:
            check_refinement(run, answers)
        if kind in STATIC:
            check_static(run, kind, answers)
        swapped = Answer(run, kind, 1, exchanged=True)
        check_rest(run, swapped)
        check_answer(run, swapped)
