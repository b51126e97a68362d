# SPDX-License-Identifier: MIT
"""Frictional patch test by the implicit program: all types, in stick and in full slip."""
import itertools

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import MESHES, block_forces

RHO, SHARE_OF_SHEAR, POINTS = 1000.0, 0.3, 4
PENALTIES = (1.0e3, 1.0e6, 1.0e8)
#: Rules of friction by name: FS, and TFAC.
RULES = {"stick": (0.5, 1.0), "stick, eps_T eps_N/10": (0.5, 0.1), "slip": (SHARE_OF_SHEAR, 1.0)}
#: Slip at the end over that at which the limit is reached and the strain, whose unevenness all places have to pass.
BEYOND = 3.0


class Body:
    """Plane strain under a uniform Cauchy stress: its displacement gradient, without turn of what is level."""

    def __init__(self, young, poisson, pressure, across=0.0):
        """`across`: normal stress in x."""
        shear = SHARE_OF_SHEAR * pressure
        self.young, self.poisson = young, poisson
        self.stress = np.array([[across, shear], [shear, -pressure]])
        part = (1.0 + poisson) / young
        strain = [part * ((1.0 - poisson) * a - poisson * b) for a, b in ((across, -pressure), (-pressure, across))]
        self.gradient = np.array([[strain[0], 2.0 * part * shear], [0.0, strain[1]]])

    def place(self, x):
        """Where a point goes, the bottom of the lower block standing still."""
        return x + (x - [0.0, -1.0]) @ self.gradient.T


def slips_by(kind, penalty, n_slave, share, pressure):
    """Slip at which the tangential springs carry the shear."""
    return SHARE_OF_SHEAR * pressure / (share * penalty * (n_slave - 1)) / (2.0 if kind == 3 else 1.0)


def patch_deck(kind, penalty, blocks, rule, bodies, pressure, is_fixed):
    """One static step for types that pass: a corner that is not flush under pressure alone would leave tractions behind. For
    the others, whose tractions pass the limit here and there, the pressure first and then the shear. The upper block starts
    back by its slip, so that the ends are flush when loaded. In slip its shear is the limit, and one node of the top is led;
    the bottom stands still, or is loaded by its shear and held at one node."""
    friction, share = RULES[rule]
    deck = Deck(f"frictional patch test, {rule}, type {kind}")
    start = 0.0 if kind in PASS_PATCH else 1.0
    deck.add("*CONTROL_TERMINATION", (start + 1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.add("*CONTROL_IMPLICIT_AUTO", (1,))
    slip = slips_by(kind, penalty, len(blocks.slave), share, pressure)
    if rule == "slip":
        slip = BEYOND * (slip + pressure / bodies[0].young)
    ids = blocks.put(deck, RHO, *((body.young, body.poisson) for body in bodies), points=4, shift=(-slip, 0.0))
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)])
    deck.curve(2, [(start - 1.0, 0.0), (start, 0.0), (start + 1.0, 1.0)])
    force, n = np.zeros((2, len(ids) + 1, 2)), len(blocks.upper)
    for rows, columns, body, keep in ((slice(n), len(blocks.slave), bodies[0], (1, 2, 3)),
                                      (slice(n, None), len(blocks.master), bodies[1], (0, 1, 3))):
        first = np.diag(np.diag(body.stress))
        for part, stress in zip(force, (first, body.stress - first)):
            part[ids[rows]] += block_forces(body.place(blocks.x[rows]), columns, stress, keep)
    held = {(int(node), 2) for node in ids[blocks.bottom]}
    held |= {(int(node), 1) for node in (ids[blocks.bottom] if is_fixed else ids[blocks.bottom[:1]])}
    deck.fix(ids[blocks.bottom], y=1).fix(sorted(node for node, dof in held if dof == 1), x=1)
    if rule == "slip":
        led = int(ids[blocks.top[0]])
        way = [body.gradient[0, 1] for body in bodies]
        deck.prescribe(led, 1, 2, 2, sum(way) + slip)
        held.add((led, 1))
    deck.add("*LOAD_NODE_POINT", *[(node, dof, k + 1, force[k, node, dof - 1]) for k in (0, 1) for node in ids.tolist()
                                   for dof in (1, 2) if (node, dof) not in held and force[k, node, dof - 1]])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, POINTS, penalty, friction), (), (0.0, share))
    return deck.output(plot=1.0, glstat=1.0, rcforc=1.0)


class Answer:
    """One run: deviations of pressure and traction on both sides, of stresses, and the iterations."""

    def __init__(self, run, kind, penalty, blocks, rule, bodies, pressure, is_fixed):
        result = run.program(patch_deck(kind, penalty, blocks, rule, bodies, pressure, is_fixed))
        force, x = result.points("contact_force")[-1], result.points("Points")[-1, :, 0]
        wanted = [SHARE_OF_SHEAR * pressure, pressure]
        self.errors = {}
        for side, nodes, sign in (("slave", blocks.slave, [-1.0, 1.0]), ("master", blocks.master, [1.0, -1.0])):
            found = sign * force[nodes, :2] / static_patch.hat_areas(x[nodes])[:, None] / wanted
            self.errors[side] = np.max(np.abs(found - 1.0), axis=0)
        self.iterations = len(result.newton()[-1])


def check_answers(run, name, kind, answers, tilts):
    """Types 4, 5, 7: uniform. In slip the traction of any type deviates as its pressure does, where faces do not tilt."""
    for k, what in enumerate(("traction", "pressure")):
        for side in ("slave", "master"):
            text, error = f"{name}: {what} on the {side} side, largest deviation", max(one.errors[side][k] for one in answers)
            if kind in PASS_PATCH:
                run.check(text, error, 0.0)
            else:
                run.report(text, error)
    if "slip" in name and not tilts:
        traction, pressure = np.array([one.errors[side] for one in answers for side in one.errors]).T
        run.check(f"{name}: traction deviates as pressure does", traction, pressure)
    run.report(f"{name}: most Newton iterations", max(one.iterations for one in answers))


def check(run):
    soft, pressure = 1.0e6, 1.0e-6
    across = -0.3 / 0.7 * pressure
    like = (Body(soft, 0.3, 1.0), Body(soft, 0.3, 1.0))
    unlike = (Body(soft, 0.3, pressure, across), Body(3.0 * soft, 0.3, pressure, across))
    pairs = {"like bodies": (like, 1.0), "unlike bodies": (unlike, pressure)}
    others = [kind for kind in TYPES if kind not in PASS_PATCH]
    rows = [*run.cover(MESHES, sorted(PASS_PATCH), RULES, pairs, PENALTIES, strength=3),
            *run.cover(MESHES, others, ("stick", "slip"), pairs, PENALTIES[1:2], strength=3)]
    for (layout, kind, rule, text), group in itertools.groupby(rows, lambda row: row[:4]):
        mesh, (bodies, load) = MESHES[layout], pairs[text]
        blocks = static_patch.Blocks(*mesh[:2], soft, mesh[2])
        check_answers(run, f"{TYPES[kind]}, {layout}, {text}, {rule}", kind, [
            Answer(run, kind, row[4], blocks, rule, bodies, load, text[0] == "u") for row in group], text[0] == "l")
