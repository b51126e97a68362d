# SPDX-License-Identifier: MIT
"""Frictional patch test, static, by the implicit program: all types, in stick and in full slip."""
import itertools
import re

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import MESHES

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

    def loads(self, x, chain, stress):
        """Nodal forces of a stress on the deformed edges of a chain, the body on its left."""
        edge = np.diff(self.place(x)[chain], axis=0)
        half = 0.5 * np.stack([edge[:, 1], -edge[:, 0]], axis=1) @ stress
        total = np.zeros((len(chain), 2))
        total[:-1] += half
        total[1:] += half
        return total


def outer_chains(ids, columns):
    """Bottom, right, top and left chain of a block of any number of rows, counter-clockwise."""
    rows = np.asarray(ids).reshape(-1, columns)
    return rows[0], rows[:, -1], rows[-1, ::-1], rows[::-1, 0]


def slips_by(kind, penalty, n_slave, share, pressure):
    """Slip at which the tangential springs carry the shear."""
    return SHARE_OF_SHEAR * pressure / (share * penalty * (n_slave - 1)) / (2.0 if kind == 3 else 1.0)


def patch_deck(kind, penalty, blocks, rule, bodies, pressure, is_fixed):
    """One static step for types that pass: a corner that is not flush under pressure alone would leave tractions behind. For
    the others, whose tractions pass the limit here and there, the pressure first and then the shear. The upper block starts back by its slip, so that the ends are flush when loaded. In slip its shear
    is the limit, and one node of the top is led; the bottom stands still, or is loaded by its shear and held at one node."""
    friction, share = RULES[rule]
    deck = Deck(f"frictional patch test, {rule}, type {kind}")
    start = 0.0 if kind in PASS_PATCH else 1.0
    deck.add("*CONTROL_TERMINATION", (start + 1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.add("*CONTROL_IMPLICIT_AUTO", (1,))
    for part, body in enumerate(bodies, 1):
        deck.part(part, points=4).elastic(RHO, body.young, body.poisson, part)
    slip = slips_by(kind, penalty, len(blocks.slave), share, pressure)
    if rule == "slip":
        slip = BEYOND * (slip + pressure / bodies[0].young)
    upper = deck.mesh(blocks.upper - [slip, 0.0], blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower, blocks.lower_quads, part=2)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0), (2.0, 1.0)])
    deck.curve(2, [(start - 1.0, 0.0), (start, 0.0), (start + 1.0, 1.0)])
    force = np.zeros((2, len(ids) + 1, 2))
    for chains, body, keep in ((outer_chains(upper, len(blocks.slave)), bodies[0], (1, 2, 3)),
                               (outer_chains(lower, len(blocks.master)), bodies[1], (0, 1, 3))):
        for k in keep:
            for part, stress in zip(force, (np.diag(np.diag(body.stress)), body.stress - np.diag(np.diag(body.stress)))):
                part[chains[k]] += body.loads(blocks.x, chains[k] - 1, stress)
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
        self.result = run.program(patch_deck(kind, penalty, blocks, rule, bodies, pressure, is_fixed))
        force, x = self.result.points("contact_force")[-1], self.result.points("Points")[-1, :, 0]
        wanted = [SHARE_OF_SHEAR * pressure, pressure]
        self.errors = {}
        for side, nodes, sign in (("slave", blocks.slave, [-1.0, 1.0]), ("master", blocks.master, [1.0, -1.0])):
            found = sign * force[nodes, :2] / static_patch.hat_areas(x[nodes])[:, None] / wanted
            self.errors[side] = np.max(np.abs(found - 1.0), axis=0)
        log = (self.result.folder / f"{self.result.job}.log").read_text()
        self.iterations = int(re.findall(r" iteration (\d+): energy ratio", log)[-1])
        self.energies = self.result.table("glstat")


def check_answers(run, name, kind, answers, tilts):
    """Types 4, 5, 7: uniform. In slip the traction of any type deviates as its pressure does, where faces do not tilt."""
    for k, what in enumerate(("traction", "pressure")):
        for side in ("slave", "master"):
            error = max(one.errors[side][k] for one in answers.values())
            if kind in PASS_PATCH:
                run.check(f"{name}: {what} on the {side} side, largest deviation", error, 0.0, 1e-9, "abs", "uniform")
            else:
                run.report(f"{name}: {what} on the {side} side, largest deviation", error)
    if "slip" in name and not tilts:
        run.check(f"{name}: traction deviates as pressure does", np.array([one.errors[s][0] for one in answers.values()
                  for s in ("slave", "master")]), np.array([one.errors[s][1] for one in answers.values()
                                                            for s in ("slave", "master")]), 1e-9, "abs", "T = mu p")
    run.report(f"{name}: most Newton iterations", max(one.iterations for one in answers.values()))


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
        check_answers(run, f"{TYPES[kind]}, {layout}, {text}, {rule}", kind, {
            row[4]: Answer(run, kind, row[4], blocks, rule, bodies, load, text[0] == "u") for row in group}, text[0] == "l")
