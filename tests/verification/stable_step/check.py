# SPDX-License-Identifier: MIT
"""The automatic penalty and the automatic step against the largest eigenvalue, all contact types.

The eigenvalue is that of M^-1 (K_elements + K_contact): elements as one-point quads with stiffness
hourglass control, contact as differences of the brute-force reference forces of contact_forces.
"""
import dataclasses
import pathlib
import re
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "contact_forces"))

from contact_types import TYPES  # noqa: E402
from eigen import Model  # noqa: E402
from meshes import Deck, grid  # noqa: E402
from reference import Chain, Rule, contact_forces  # noqa: E402
from slideline_tools.scenes import block, block_grids  # noqa: E402

MESHES = ((7, 5), (5, 8))
YOUNG, RHO, HOURGLASS = 1.0e6, 1000.0, 0.1
DEPTH, NUDGE = 1.0e-4, 1.0e-6      # m
GAUSS = 4
SLOW = ("p:v0=-1e-3",)                 # m/s: shapes hardly change
INSIDE, OUTSIDE = 1.03, 0.97       # limit by eigenvalue over the step
BOUND, SHARP = 1.0e-4, 1.5       # of |energy ratio - 1|; of limit by eigenvalue over step
#: Share of the cycles in which the energy law holds the springs back, stable and growing.
FEW, MANY = 0.02, 0.25
RULE = "*CONTROL_CONTACT\n\n0,0,0,0,0,0,2\n"


def deck_of(kind, meshes, contact_rules=False):
    """The block scene with stiffness hourglass control."""
    cards = "*CONTROL_HOURGLASS\n4,%g\n" % HOURGLASS + (RULE if contact_rules else "")
    return block(kind, GAUSS, *meshes).replace("*CONTROL_ENERGY", cards + "*CONTROL_ENERGY")


class Eigen:
    """Limits by eigenvalue for penalties in N/m^2 (type 1: N/m per mean slave segment)."""

    def __init__(self, kind, meshes):
        lower, upper = block_grids(*meshes)
        self.model = Model([lower, upper], YOUNG, 0.0, RHO, HOURGLASS)
        self.model.fix(lower.lower, 1)
        self.model.fix(upper.upper, 1)
        slave, master = self.model.rows(upper.lower), self.model.rows(lower.upper)
        self.springs = self.unit_springs(kind, slave, master)

    def unit_springs(self, kind, slave, master):
        """Stiffness in y of all nodes for a penalty of 1 N/m^2, from central differences."""
        x = self.model.x
        start = [Chain(x[slave]), Chain(x[master])]
        length = np.mean(start[0].length)
        rule = Rule(kind, length if kind == 1 else 1.0, 0 if kind == 1 else 1, gauss=GAUSS)
        nodes = np.concatenate([slave, master])
        n = len(slave)
        stiffness = np.zeros((len(x), len(x)))
        for k, node in enumerate(nodes):
            sides = []
            for sign in (-1.0, 1.0):
                y = x[nodes].copy()
                y[:n, 1] -= DEPTH
                y[k, 1] += sign * NUDGE
                sides.append(np.concatenate(
                    contact_forces(rule, Chain(y[:n]), Chain(y[n:]), start))[:, 1])
            stiffness[nodes, node] = (sides[0] - sides[1]) / (2.0 * NUDGE)
        return stiffness

    def limit(self, penalty):
        """2/omega of elements and springs: what stays closed is stable below it."""
        return self.model.limit(penalty * self.springs)

    def opening_limit(self, penalty):
        """1/omega of the springs alone: for springs that open and close."""
        return 0.5 * self.model.limit(penalty * self.springs, with_elements=False)

    def fitting(self, limit):
        """The penalty for which the limit by eigenvalue is this one."""
        low, high = 0.0, 30.0
        for _ in range(32):  # to 1e-8
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.limit(np.exp(middle)) > limit else (low, middle)
        return float(np.exp(low))


@dataclasses.dataclass
class Said:
    """What the log says: penalty in N/m^2 and first step."""
    penalty: float
    step: float


def said(result):
    text = (result.folder / f"{result.job}.log").read_text()
    penalty = re.findall(r"per slave node = (\S+) per unit length", text)[-1]
    return Said(float(penalty), float(re.search(r"first time step ([^,]+),", text).group(1)))


def strayed(result):
    """Largest departure of the energy ratio from one; infinite for a run that broke off."""
    if result.status != 0:
        return np.inf
    return float(np.max(np.abs(result.table("glstat")["energy_ratio"][5:] - 1.0)))


def held_back(result):
    """Share of the cycles with force in which the energy law limited the springs."""
    text = (result.folder / f"{result.job}.log").read_text()
    found = re.findall(r"in (\d+) of (\d+) cycles with force, the smallest", text)
    return int(found[-1][0]) / int(found[-1][1]) if found else 0.0


def check_one(run, kind, meshes):
    name = f"{TYPES[kind]}, {meshes[0]}/{meshes[1]} quads"
    eigen, deck = Eigen(kind, meshes), deck_of(kind, meshes)
    stem = f"type{kind}_{meshes[0]}"

    def go(suffix, *options, deck=deck, expect=0):
        return run.program(deck, *options, name=f"{stem}_{suffix}", expect_status=expect)

    first = go("share", "punit=3", "pen=1", *SLOW, "dt=1", "tssfac=0.9", "endtim=2.0")
    auto = said(first)
    limit = eigen.limit(auto.penalty)
    run.check(f"{name}: automatic penalty: limit by eigenvalue / step", limit / auto.step, 1.0)
    run.check(f"{name}: the same, sharpness", limit / auto.step, SHARP)
    run.check(f"{name}: energy ratio with it", strayed(first), BOUND)
    half = said(go("half", "punit=3", "pen=0.5", "dt=1", "tssfac=0.9", "endtim=0.01"))
    run.check(f"{name}: half the share, half the penalty", half.penalty, 0.5 * auto.penalty)
    for what, factor in (("inside", INSIDE), ("outside", OUTSIDE)):
        penalty = eigen.fitting(factor * auto.step)
        options = ("punit=1", f"pen={penalty!r}", *SLOW, "dt=1", "tssfac=0.9", "endtim=2.0")
        away = go(what, *options)
        is_stable = factor > 1.0
        run.check(f"{name}: share of cycles held back, limit by eigenvalue {factor:g} times the step", held_back(away),
                  FEW if is_stable else MANY)
        if is_stable:
            run.check(f"{name}: energy ratio there", strayed(away), BOUND)
        else:
            run.report(f"{name}: energy ratio there", strayed(away))
    stiff = 1.0e3 * auto.penalty
    ruled = said(go("ruled", "punit=1", f"pen={stiff!r}", "dt=1", "tssfac=1.0", "endtim=0.05",
                    deck=deck_of(kind, meshes, True)))
    true = min(eigen.limit(stiff), eigen.opening_limit(stiff))
    run.check(f"{name}: automatic step: limit by eigenvalue / step", true / ruled.step, 1.0)
    run.check(f"{name}: the same, sharpness", true / ruled.step, SHARP)
    slower = said(go("slower", "punit=3", "pen=1", "dt=1", "tssfac=0.7", "endtim=0.01"))
    true = eigen.opening_limit(slower.penalty)
    run.check(f"{name}: automatic penalty at TSSFAC 0.7: limit by eigenvalue / step",
              true / slower.step, 1.0)
    run.check(f"{name}: the same, sharpness", true / slower.step, SHARP)


def rubber_and_steel(unit, form, with_itself, step_rule=0, soft="*MAT_BLATZ-KO_RUBBER"):
    """A fine block of rubber (or of steel) and a coarse one of steel, parts of one surface, fall on a plate of steel."""
    deck = Deck("rubber and steel in one surface")
    deck.add("*CONTROL_TERMINATION", (1.0e-3, 0, 0.5)).add("*CONTROL_TIMESTEP", (0.0, 0.8))
    deck.add("*CONTROL_CONTACT", (0.1,), (None,) * 6 + (step_rule,))
    deck.add("*SECTION_SHELL", (1, form), (1.0,))
    for part, material in ((1, 1), (2, 2), (3, 2)):
        deck.add("*PART", f"part {part}", (part, 1, material))
    if soft == "*MAT_ELASTIC":
        deck.elastic(7850.0, 2.1e11, 0.3, material=1)
    else:
        deck.add(soft, (1, 1100.0, 1.0e6))
    deck.elastic(7850.0, 2.1e11, 0.3, material=2)
    bodies = [deck.mesh(*grid(*shape), part=part) for part, shape in (
        (1, (24, 12, 0.04, 0.02, (0.02, 0.0005))), (2, (8, 4, 0.08, 0.04, (0.07, 0.0005))), (3, (16, 2, 0.16, 0.02, (0.0, -0.02))))]
    deck.node_set(1, np.concatenate(bodies[:2]))
    deck.add("*INITIAL_VELOCITY", (1,), (0.0, -5.0))
    deck.fix(bodies[2][:17], x=1, y=1)
    for number, parts in enumerate(((1, 2), (3, None), (1, 2, 3)), 1):
        deck.add("*SET_PART_LIST", (number,), parts)
    deck.add("*CONTACT_2D_SLIDELINE", (3, 0, 5, 2, 1.0) if with_itself else (2, 1, 5, 2, 1.0), (0.0, 1.0e20, unit))
    return deck.output(glstat=5.0e-5)


def check_mixed(run):
    """The built-in penalty of a surface of soft and stiff materials is no more than the step bears; others stand."""
    def go(name, *options, **more):
        result = run.program(rubber_and_steel(*options, **more), name=name)
        return result.table("glstat"), " ".join((result.folder / f"{result.job}.log").read_text().split())

    lowered = "has soft and stiff materials"
    for place, form, with_itself in (("plane", 13, False), ("round", 15, False), ("plane, with itself", 13, True)):
        stem = "mixed_" + place.replace(", ", "_").replace(" ", "_")
        found, text = go(stem, 2, form, with_itself)
        share, _ = go(stem + "_share", 3, form, with_itself)
        name = f"rubber and steel in one surface, {place}"
        run.true(f"{name}: the log tells of the lower penalty", lowered in text)
        run.check(f"{name}: energy", found["energy_ratio"], 1.0)
        run.true(f"{name}: no cycle is held back", "cycles with force" not in text)
        run.check(f"{name}: kinetic energy as with PUNIT 3, PEN 1", found["kinetic"], share["kinetic"])
    for name, options, more in (("ECDT 1", (2, 13, False), {"step_rule": 1}), ("ECDT 2", (2, 13, False), {"step_rule": 2}),
                                ("steel alone", (2, 13, False), {"soft": "*MAT_ELASTIC"})):
        _, text = go("mixed_" + name.replace(" ", "_"), *options, **more)
        run.true(f"{name}: the penalty stands", lowered not in text and "1.000000E+00 times the built-in estimate" in text)


def check(run):
    check_mixed(run)
    for meshes, kind in run.cover(MESHES, TYPES, strength=1):
        check_one(run, kind, meshes)
