# SPDX-License-Identifier: MIT
"""Static contact patch test by the implicit program: all types, penalties over seven decades."""
import re

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import (MESHES, SLOPE, consistent_forces, inclined_blocks, load_edges,
                           outer_chains)

YOUNG, RHO, PRESSURE = 1.0e6, 1000.0, 1.0
POINTS = 4
# Largest |p/p0 - 1| where a type passes: penalties in N/m per contact node up to the first number.
LIMITS = {1.0e6: 1e-10, 1.0e8: 1e-9}
DECADES = 10.0 ** np.arange(3, 11)
FEW = np.array([1.0e3, 1.0e6, 1.0e8, 1.0e10])
FIRM = 1.0e5  # from here on the gaps are of the order of the strains
MOST_ITERATIONS = 3
DECAY = 34.0  # of the slowest mode, in powers of e: 2e-15 left
INCLINED, STIFFEST = (1.0e3, 1.0e6, 1.0e8), 1.0e10


def some(run, penalties, number):
    """All; where not in full the softest and another one, in turn by the number."""
    return penalties if run.is_full else np.array([penalties[0], penalties[1 + number % (len(penalties) - 1)]])


def static_deck(title, parts, poisson, load=PRESSURE):
    """Two fully integrated bodies; the load grows over one static step."""
    deck = Deck(title)
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, poisson, part)
    ids = [deck.mesh(*body, part=k + 1) for k, body in enumerate(parts)]
    deck.curve(1, [(0.0, 0.0), (1.0, load)])
    return deck.output(plot=1.0, glstat=1.0, rcforc=1.0), *ids


def pressed_blocks(kind, penalty, blocks, poisson=0.0):
    """Bottom held in y. u_x held at the middle of bottom and top as in the explicit case, or, with
    lateral strain, on the left, so that the ends of the interface stay above each other."""
    deck, upper, lower = static_deck(f"static patch test, type {kind}",
                                     ((blocks.upper, blocks.upper_quads),
                                      (blocks.lower, blocks.lower_quads)), poisson)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    if poisson:
        deck.fix(ids[blocks.bottom], y=1).fix(ids[[blocks.bottom[0], blocks.top[0]]], x=1)
    else:
        held = blocks.fixed()
        deck.fix(ids[held[held % 2 == 0] // 2], x=1).fix(ids[held[held % 2 == 1] // 2], y=1)
    load_edges(deck, ids[blocks.top])
    return deck.contact(1, 2, kind, penalty, gauss=POINTS)


def energy_ratios(result):
    """Energy ratios of the iterations of the last step, from the log."""
    log = (result.folder / f"{result.job}.log").read_text()
    rows = re.findall(r"iteration (\d+): energy ratio (\S+),", log)
    first = max(k for k, row in enumerate(rows) if row[0] == "1")
    return np.array([float(row[1]) for row in rows[first:]])


class Side:
    """Nodes of one side of a flat interface at the end: forces over the present lengths."""

    def __init__(self, result, nodes, sign):
        x = result.points("Points")[-1, nodes, 0]
        self.force = sign * result.points("contact_force")[-1, nodes, 1]
        self.error = np.max(np.abs(self.force / static_patch.hat_areas(x) / PRESSURE - 1.0))


class Answer:
    """One run of the flat patch test."""

    def __init__(self, run, kind, penalty, blocks, poisson=0.0):
        self.result = run.program(pressed_blocks(kind, penalty, blocks, poisson))
        self.penalty = penalty
        self.sides = [Side(self.result, nodes, sign)
                      for nodes, sign in ((blocks.slave, 1.0), (blocks.master, -1.0))]
        self.ratios = energy_ratios(self.result)
        self.mean_gap = PRESSURE / (penalty * (len(blocks.slave) - 1))
        stress = self.result.cells("stress")[-1]
        self.stress_error = max(np.max(np.abs(stress[:, 1] / PRESSURE + 1.0)),
                                np.max(np.abs(stress[:, [0, 3]])) / PRESSURE)
        self.sink = -self.result.points("displacement")[-1, blocks.top, 1]


def check_newton(run, name, answers):
    run.check(f"{name}: Newton iterations", max(len(one.ratios) for one in answers),
              MOST_ITERATIONS, 0, "max", "the blocks touch: one active set")
    # Turns and strains of a = p/E + gap make second-order gaps of a^2: their energy in the springs
    # p/gap, over that of the load, is a^3/gap. It is squared again in each further iteration.
    second = [one.ratios[1] * one.mean_gap / (PRESSURE / YOUNG + one.mean_gap) ** 3
              for one in answers]
    run.check(f"{name}: energy ratio of the second iteration / (a^3/gap)", np.max(second), 10.0,
              0.0, "max", "quadratic convergence, a = p/E + gap; order of magnitude")


def check_passing(run, name, answers, poisson=0.0):
    """Uniform pressure on both sides; how it degrades beyond is reported."""
    for limit, tolerance in LIMITS.items():
        chosen = [one for one in answers if one.penalty <= limit * 1.01]
        for k, side in enumerate(("slave", "master")):
            run.check(f"{name}, eps up to {limit:.0e}: max |p/p0 - 1| on the {side} side",
                      max(one.sides[k].error for one in chosen), 0.0, tolerance, "abs", "uniform")
        run.check(f"{name}, eps up to {limit:.0e}: stresses in all elements / p0",
                  max(one.stress_error for one in chosen), 0.0, tolerance, "abs",
                  "uniaxial in the plane")
    for one in answers:
        if one.penalty > max(LIMITS) * 1.01:
            run.report(f"{name}, eps {one.penalty:.0e}: max |p/p0 - 1| on both sides",
                       max(side.error for side in one.sides))


def check_failing(run, name, answers, kind, blocks):
    """Types that do not pass: nodal forces against an independent small-strain solution."""
    reference = {one.penalty: static_patch.solve(blocks, kind, one.penalty, PRESSURE, POINTS,
                                                 hourglass=None) for one in answers}
    firm = [one for one in answers if one.penalty >= FIRM]
    soft = [one for one in answers if one.penalty < FIRM]
    # Soft springs let a block turn by about a gap over its width.
    for text, chosen, tolerance in (("from 1e5 on", firm, 1e-5),
                                    ("below 1e5", soft, max(2.0 * one.mean_gap for one in soft))):
        for k, side in enumerate(("slave", "master")):
            wanted = [(1.0, -1.0)[k] * reference[one.penalty][k] for one in chosen]
            run.check(f"{name}, eps {text}: nodal forces on the {side} side",
                      np.array([one.sides[k].force for one in chosen]), np.array(wanted), tolerance,
                      source="independent small-strain static solution")
    for one in answers:
        run.report(f"{name}, eps {one.penalty:.0e}: max |p/p0 - 1| on both sides",
                   max(side.error for side in one.sides))


def check_layout(run, layout, kind, blocks):
    name = f"{TYPES[kind]}, {layout}"
    number = kind + list(MESHES).index(layout)
    penalties = some(run, FEW, number)
    if layout == "5/4":
        penalties = DECADES if run.is_full else DECADES[kind % 2::2]
    answers = [Answer(run, kind, penalty, blocks) for penalty in penalties]
    check_newton(run, name, answers)
    if kind in PASS_PATCH:
        check_passing(run, name, answers)
        gaps = [one.mean_gap for one in answers]
        run.check(f"{name}: top sinks, all penalties", np.concatenate([one.sink for one in answers]),
                  np.repeat(2.0 * PRESSURE / YOUNG + np.array(gaps), len(blocks.top)), 1e-5,
                  source="2 p/E + p/eps_hat, to second order in p/E")
    else:
        check_failing(run, name, answers, kind, blocks)


def inclined_patch(kind, penalty, load, matching):
    """Interface inclined by 20 degrees, the load on every outer face: a hydrostatic state."""
    _, x_lower, upper, lower = inclined_blocks(matching)
    n_lower = len(x_lower) - 1
    deck, upper_ids, lower_ids = static_deck(f"inclined static patch test, type {kind}",
                                             (upper, lower), 0.3, load)
    slave, *upper_faces = outer_chains(upper_ids, 5)
    *lower_faces, left = outer_chains(lower_ids, n_lower)
    master = lower_faces.pop()
    for chain in (*upper_faces, *lower_faces, left):
        load_edges(deck, chain)
    deck.node_set(1, slave).node_set(2, master)
    # p / eps_hat, eps_hat = eps / mean segment; half of it in two passes (exact if meshes match).
    gap = load / (penalty * 5.0 * np.cos(np.arctan(SLOPE))) / (2.0 if kind == 3 else 1.0)
    deck.fix([lower_ids[0]], x=1, y=1).fix([lower_ids[n_lower]], y=1)
    # The top left corner's u_x in the hydrostatic state, so that the pin holds nothing.
    deck.curve(2, [(0.0, 0.0), (1.0, 1.0)])
    deck.prescribe(upper_faces[1][-1], 1, 2, 2, gap * np.sin(np.arctan(SLOPE)))
    return deck.contact(1, 2, kind, penalty, gauss=POINTS), slave, master


def inclined_errors(run, kind, penalty, load, matching):
    """Largest |p/p0 - 1| of slave and master, with forces as vectors; reactions and stresses / p0;
    the number of iterations."""
    deck, slave, master = inclined_patch(kind, penalty, load, matching)
    result = run.program(deck)
    position = result.points("Points")[-1, :, :2]
    force = result.points("contact_force")[-1, :, :2]
    errors, reaction = [], 0.0
    for ids in (slave, master):
        wanted = consistent_forces(position[ids - 1], load)
        size = np.linalg.norm(wanted, axis=1)
        errors.append(np.max(np.linalg.norm(force[ids - 1] - wanted, axis=1) / size))
        # The loads on the outer faces add up to minus the load on the closing side.
        reaction = max(reaction, np.max(np.abs(np.sum(force[ids - 1] - wanted, axis=0))) / load)
    stress = result.cells("stress")[-1] / load
    return (*errors, reaction,
            max(np.max(np.abs(stress[:, [0, 1]] + 1.0)), np.max(np.abs(stress[:, 3]))),
            len(energy_ratios(result)))


def check_inclined(run, kind, matching):
    """Nodes on an inclined line lie on it to 1e-17 m only, so the load of the stiffest penalty is
    larger: the penetration is 2e-7 m there too."""
    name = f"{TYPES[kind]}, {'matching' if matching else '5/4'}, inclined by 20 degrees"
    loads = {penalty: PRESSURE * max(1.0, penalty / 1.0e6) for penalty in some(run, INCLINED, kind + matching)}
    answers = [inclined_errors(run, kind, penalty, load, matching)
               for penalty, load in loads.items()]
    if not matching:  # the residual cannot fall below the rounding of places in gaps of 2e-11 m
        stiffest = inclined_errors(run, kind, STIFFEST, PRESSURE, matching)
        run.check(f"{name}: Newton iterations", max(one[-1] for one in (*answers, stiffest)),
                  MOST_ITERATIONS + 1, 0, "max", "one active set, the last ones in round-off")
        run.report(f"{name}, eps {STIFFEST:.0e}: max |p/p0 - 1| on both sides", max(stiffest[:2]))
    if kind in PASS_PATCH or (matching and kind > 1):
        for k, text in enumerate(("max |p/p0 - 1| on the slave side",
                                  "max |p/p0 - 1| on the master side")):
            run.check(f"{name}: {text}", max(one[k] for one in answers), 0.0, 1e-9, "abs", "uniform")
        run.check(f"{name}: forces of the pins / p0", max(one[2] for one in answers), 0.0, 1e-9,
                  "abs", "equilibrium without them")
        run.check(f"{name}: stresses / p0", max(one[3] for one in answers), 0.0, 1e-9, "abs",
                  "hydrostatic")
    else:
        for penalty, one in zip(loads, answers):
            run.report(f"{name}, eps {penalty:.0e}: max |p/p0 - 1| on both sides", max(one[:2]))


def damped_forces(run, kind, penalty, blocks):
    """The explicit program on the same deck, damped to rest: contact forces in y of all nodes."""
    low, high, _ = static_patch.frequencies(blocks, RHO, penalty, hourglass=None)
    end = DECAY / low
    deck = pressed_blocks(kind, penalty, blocks)
    start = deck.lines.index("*CONTROL_TERMINATION")
    del deck.lines[start:start + 4]
    deck.control(end, dt=end / np.ceil(end * high / 1.6))
    deck.add("*DAMPING_GLOBAL", (0, 2.0 * low))  # critical for the slowest mode
    start = deck.lines.index("*DATABASE_BINARY_D3PLOT")
    del deck.lines[start:start + 6]
    deck.output(plot=end, glstat=end, rcforc=end)
    result = run.program(deck)
    energy = result.table("glstat")
    return result, energy["kinetic"][-1] / energy["internal"][-1]


def check_drivers(run, kind, penalty=1.0e6):
    """One answer from both drivers, on fully integrated quads."""
    blocks = static_patch.Blocks(*MESHES["5/4"][:2], YOUNG)
    name = f"{TYPES[kind]}, 5/4, explicit damped to rest against static"
    explicit, kinetic = damped_forces(run, kind, penalty, blocks)
    static = Answer(run, kind, penalty, blocks).result
    run.check(f"{name}: kinetic / internal energy", kinetic, 0.0, 1e-16, "abs", "at rest")
    for field, text in (("contact_force", "nodal contact forces"), ("displacement", "displacements")):
        run.check(f"{name}: {text}", explicit.points(field)[-1, :, :2],
                  static.points(field)[-1, :, :2], 1e-9, source="the other driver")


def check(run):
    for layout, mesh in MESHES.items():
        blocks = static_patch.Blocks(*mesh[:2], YOUNG, mesh[2])
        for kind in TYPES:
            check_layout(run, layout, kind, blocks)
    blocks = static_patch.Blocks(*MESHES["5/4"][:2], YOUNG)
    for kind in sorted(PASS_PATCH):
        name = f"{TYPES[kind]}, 5/4, nu = 0.3"
        answers = [Answer(run, kind, penalty, blocks, 0.3) for penalty in some(run, FEW, kind)]
        check_newton(run, name, answers)
        check_passing(run, name, answers)
    for kind in TYPES:
        check_inclined(run, kind, matching=False)
        if kind > 1:
            check_inclined(run, kind, matching=True)
        check_drivers(run, kind)
