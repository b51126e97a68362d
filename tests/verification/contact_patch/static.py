# SPDX-License-Identifier: MIT
"""The patch test by the implicit program: fully integrated quads, penalties over seven decades, one static step."""
import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck
from patch_layouts import MESHES, consistent_forces, inclined_blocks, inclined_patch, load_edges

YOUNG, RHO, PRESSURE, POINTS = 1.0e6, 1000.0, 1.0, 4
#: Largest |p/p0 - 1| where a type passes: penalties in N/m per contact node up to the first number.
LIMITS = (1.0e6, 1.0e8)
DECADES = 10.0 ** np.arange(3, 11)
FEW = np.array([1.0e3, 1.0e6, 1.0e8, 1.0e10])
FIRM = 1.0e5  # from here on the gaps are of the order of the strains
INCLINED, STIFFEST = (1.0e3, 1.0e6, 1.0e8), 1.0e10
SIDES = ("slave", "master")


def some(run, penalties, number):
    """All; where not in full the softest and another one, in turn by the number."""
    return penalties if run.is_full else np.array([penalties[0], penalties[1 + number % (len(penalties) - 1)]])


def static_deck(title, load=PRESSURE):
    """The load of curve 1 grows over one static step."""
    deck = Deck(title).add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    return deck.curve(1, [(0.0, 0.0), (1.0, load)]).output(plot=1.0, glstat=1.0, rcforc=1.0)


class Answer:
    """One run of the flat patch test; forces over the lengths at the end."""

    def __init__(self, run, kind, penalty, blocks, poisson=0.0):
        deck = static_deck(f"static patch test, type {kind}")
        ids = blocks.put(deck, RHO, (YOUNG, poisson), (YOUNG, poisson), points=4)
        if poisson:  # the ends of the interface stay above each other
            deck.fix(ids[blocks.bottom], y=1).fix(ids[[blocks.bottom[0], blocks.top[0]]], x=1)
        else:
            blocks.hang(deck, ids)
        load_edges(deck, ids[blocks.top])
        result = run.program(deck.contact(1, 2, kind, penalty, gauss=POINTS))
        self.penalty, self.ratios = penalty, result.newton()[-1][:, 0]
        x, force = result.points("Points")[-1, :, 0], result.points("contact_force")[-1, :, 1]
        self.forces = force[blocks.slave], -force[blocks.master]
        self.errors = [np.max(np.abs(found / static_patch.hat_areas(x[nodes]) / PRESSURE - 1.0))
                       for found, nodes in zip(self.forces, (blocks.slave, blocks.master))]
        self.mean_gap = PRESSURE / (penalty * (len(blocks.slave) - 1))
        stress = result.cells("stress")[-1]
        self.stress_error = max(np.max(np.abs(stress[:, 1] / PRESSURE + 1.0)), np.max(np.abs(stress[:, [0, 3]])) / PRESSURE)
        self.sink = -result.points("displacement")[-1, blocks.top, 1]


def check_newton(run, name, answers):
    run.check(f"{name}: Newton iterations", max(len(one.ratios) for one in answers), 3)
    # Turns and strains of a = p/E + gap make second-order gaps of a^2: their energy in the springs
    # p/gap, over that of the load, is a^3/gap. It is squared again in each further iteration.
    second = [one.ratios[1] * one.mean_gap / (PRESSURE / YOUNG + one.mean_gap) ** 3 for one in answers]
    run.check(f"{name}: energy ratio of the second iteration / (a^3/gap)", np.max(second), 10.0)


def report_errors(run, name, answers):
    for one in answers:
        run.report(f"{name}, eps {one.penalty:.0e}: max |p/p0 - 1| on both sides", max(one.errors))


def check_passing(run, name, answers):
    """Uniform pressure on both sides; how it degrades beyond is reported."""
    for limit in LIMITS:
        chosen, text = [one for one in answers if one.penalty <= limit * 1.01], f"{name}, eps up to {limit:.0e}"
        for k, side in enumerate(SIDES):
            run.check(f"{text}: max |p/p0 - 1| on the {side} side", max(one.errors[k] for one in chosen), 0.0)
        run.check(f"{text}: stresses in all elements / p0", max(one.stress_error for one in chosen), 0.0)
    report_errors(run, name, [one for one in answers if one.penalty > max(LIMITS) * 1.01])


def check_failing(run, name, answers, kind, blocks):
    """Types that do not pass: nodal forces against an independent small-strain solution."""
    reference = {one.penalty: static_patch.solve(blocks, kind, one.penalty, PRESSURE, POINTS, hourglass=None)
                 for one in answers}
    soft = [one for one in answers if one.penalty < FIRM]
    # Soft springs let a block turn by about a gap over its width.
    for text, chosen, tolerance in (("from 1e5 on", [one for one in answers if one not in soft], None),
                                    ("below 1e5", soft, max(2.0 * one.mean_gap for one in soft))):
        for k, side in enumerate(SIDES):
            wanted = [(1.0, -1.0)[k] * reference[one.penalty][k] for one in chosen]
            run.check(f"{name}, eps {text}: nodal forces on the {side} side", [one.forces[k] for one in chosen], wanted,
                      tol=tolerance)
    report_errors(run, name, answers)


def check_layout(run, layout, kind, blocks):
    name = f"{TYPES[kind]}, {layout}"
    penalties = some(run, FEW, kind + list(MESHES).index(layout))
    if layout == "5/4":
        penalties = DECADES if run.is_full else DECADES[kind % 2::2]
    answers = [Answer(run, kind, penalty, blocks) for penalty in penalties]
    check_newton(run, name, answers)
    if kind in PASS_PATCH:
        check_passing(run, name, answers)
        gaps = np.array([one.mean_gap for one in answers])
        run.check(f"{name}: top sinks, all penalties", np.concatenate([one.sink for one in answers]),
                  np.repeat(2.0 * PRESSURE / YOUNG + gaps, len(blocks.top)))
    else:
        check_failing(run, name, answers, kind, blocks)


def inclined_errors(run, kind, penalty, load, matching):
    """Largest |p/p0 - 1| of slave and master, with forces as vectors; reactions and stresses / p0;
    the number of iterations."""
    deck = static_deck(f"inclined static patch test, type {kind}", load)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.3, part)
    ids = [deck.mesh(*body, part=part) for part, body in enumerate(inclined_blocks(matching)[2:], 1)]
    sides = inclined_patch(deck, ids, kind, penalty, load)
    result = run.program(deck)
    place, force = result.points("Points")[-1, :, :2], result.points("contact_force")[-1, :, :2]
    errors, reaction = [], 0.0
    for nodes in sides:
        wanted = consistent_forces(place[nodes - 1], load)
        off = force[nodes - 1] - wanted
        errors.append(np.max(np.linalg.norm(off, axis=1) / np.linalg.norm(wanted, axis=1)))
        # The loads on the outer faces add up to minus the load on the closing side.
        reaction = max(reaction, np.max(np.abs(np.sum(off, axis=0))) / load)
    stress = result.cells("stress")[-1] / load
    return (*errors, reaction, max(np.max(np.abs(stress[:, [0, 1]] + 1.0)), np.max(np.abs(stress[:, 3]))),
            len(result.newton()[-1]))


def check_inclined(run, kind, matching):
    """Nodes on an inclined line lie on it to 1e-17 m only, so the load of the stiffest penalty is
    larger: the penetration is 2e-7 m there too."""
    name = f"{TYPES[kind]}, {'matching' if matching else '5/4'}, inclined by 20 degrees"
    loads = {penalty: PRESSURE * max(1.0, penalty / 1.0e6) for penalty in some(run, INCLINED, kind + matching)}
    answers = [inclined_errors(run, kind, penalty, load, matching) for penalty, load in loads.items()]
    if not matching:  # the residual cannot fall below the rounding of places in gaps of 2e-11 m
        stiffest = inclined_errors(run, kind, STIFFEST, PRESSURE, matching)
        run.check(f"{name}: Newton iterations", max(one[-1] for one in (*answers, stiffest)), 4)
        run.report(f"{name}, eps {STIFFEST:.0e}: max |p/p0 - 1| on both sides", max(stiffest[:2]))
    if kind in PASS_PATCH or (matching and kind > 1):
        for k, text in enumerate(("max |p/p0 - 1| on the slave side", "max |p/p0 - 1| on the master side",
                                  "forces of the pins / p0", "stresses / p0")):
            run.check(f"{name}: {text}", max(one[k] for one in answers), 0.0)
    else:
        for penalty, one in zip(loads, answers):
            run.report(f"{name}, eps {penalty:.0e}: max |p/p0 - 1| on both sides", max(one[:2]))


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
        for matching in (False, True) if kind > 1 else (False,):
            check_inclined(run, kind, matching)
