# SPDX-License-Identifier: MIT
"""Mass scaling: closed sums of the added mass, the step that is asked for, motions that no mass changes."""
import numpy as np

from meshes import Deck, grid_quads

RHO, YOUNG, POISSON = 1000.0, 1.2e6, 0.0   # nu 0: the limit of the ends of a strip is L/c too
SPEED = np.sqrt(YOUNG / RHO)
COLUMNS = np.array([0.0, 0.1, 0.15, 0.17, 0.3])  # widths 0.1, 0.05, 0.02, 0.13; height 0.1


def strip(title, mass_step, points=1, stays=0, form=13, left=0.0, scale=0.9, hourglass=4):
    """One row of rectangles of unequal widths."""
    coordinates = np.array([(left + x, y) for y in (0.0, 0.1) for x in COLUMNS])
    deck = Deck(title)
    deck.add("*CONTROL_TERMINATION", (0.02,))
    deck.add("*CONTROL_TIMESTEP", (0.0, scale, 0, 0.0, mass_step, 0, 0, stays)).hourglass(hourglass, 0.1)
    deck.add("*PART", "strip", (1, 1, 1)).add("*SECTION_SHELL", (1, form, None, points), (1.0,))
    deck.elastic(RHO, YOUNG, POISSON)
    deck.mesh(coordinates, grid_quads(4, 1))
    deck.output(glstat=0.001, matsum=0.001, nodout=0.001, nodes=range(1, 11))
    return deck


def own_steps():
    """L/c of the rectangles, L = area over longest side."""
    return np.minimum(np.diff(COLUMNS), 0.1) / SPEED


def check_sums(run):
    """The added mass and the step."""
    masses, steps = RHO * np.diff(COLUMNS) * 0.1, own_steps()
    target = 0.07 / SPEED
    for name, sign, expected in (
            ("DT2MS < 0", -1.0, np.sum(masses * np.maximum(0.0, (target / steps) ** 2 - 1.0))),
            ("DT2MS > 0", 1.0, np.sum(masses * ((target / steps) ** 2 - 1.0)))):
        result = run.program(strip(name, sign * target))
        table = result.table("glstat")
        run.check(f"{name}: added mass at the start", table["added_mass"][0], expected)
        run.check(f"{name}: the step", table["dt"], 0.9 * target)
        run.check(f"{name}: mass of the part", result.table("matsum")["mass"][0],
                  masses.sum() + expected)
    run.check("without it there is no column",
              "added_mass" in run.program(strip("off", 0.0)).table("glstat"), False)


def check_fall(run):
    """A block of scaled masses falls with g, and flies on with its velocity."""
    for name, options in (("one point", {}), ("four points", {"points": 4}), ("round", {"form": 15, "left": 0.1}),
                          ("round, four points", {"form": 15, "left": 0.1, "points": 4})):
        deck = strip(f"fall, {name}", -0.09 / SPEED, **options)
        deck.curve(1, [(0.0, 9.81), (1.0, 9.81)]).add("*LOAD_BODY_Y", (1, 1.0))
        deck.add("*INITIAL_VELOCITY", (0,), (0.0, 3.0))
        result = run.program(deck)
        for node in (1, 4, 10):
            history = result.node(node)
            run.check(f"{name}: fall of node {node}", history["uy"],
                      3.0 * history["time"] - 4.905 * history["time"] ** 2)
        table = result.table("glstat")
        run.check(f"{name}: masses were added", table["added_mass"][0] > 1.0, True)
        run.check(f"{name}: kinetic energy of parts and of all", result.table("matsum")["kinetic"],
                  table["kinetic"])
        run.check(f"{name}: balance", table["energy_ratio"], 1.0)


def check_stability(run):
    """A bar that rings at the asked step keeps its energy; without mass the same step is an explosion."""
    target = 0.09 / SPEED
    for points in (1, 4):
        for sign in (-1.0, 1.0):
            deck = strip("ringing", sign * target, points=points, stays=1)
            deck.add("*CONTROL_TERMINATION", (0.3,))
            deck.fix([1, 6], x=1, y=1).add("*INITIAL_VELOCITY", (0,), (0.02, 0.01))
            table = run.program(deck).table("glstat")
            run.check(f"{points} points, sign {sign:g}: balance over {table['cycle'][-1]:.0f} steps", table["energy_ratio"],
                      1.0)
    deck = strip("ringing, no mass added", 0.0, scale=0.9 * target / own_steps().min())
    deck.add("*CONTROL_TERMINATION", (0.3,))
    deck.fix([1, 6], x=1, y=1).add("*INITIAL_VELOCITY", (0,), (0.02, 0.01))
    run.check("without mass the same step ends the run",
              run.program(deck, expect_status=None).status, 2)


def check_growth(run):
    """A bar that is pushed together gets more mass, the step stays and the balance holds."""
    target = 0.06 / SPEED
    deck = strip("pushed", -target, hourglass=5)
    deck.add("*CONTROL_TERMINATION", (0.02,))
    deck.curve(1, [(0.0, -5.0), (1.0, -5.0)])
    for node in (5, 10):
        deck.prescribe(node, 1, 0, 1)
    deck.fix([1, 6], x=1)
    table = run.program(deck).table("glstat")
    run.check("growth: step", table["dt"], 0.9 * target)
    run.check("growth: mass grows", np.all(np.diff(table["added_mass"]) >= 0.0)
              and table["added_mass"][-1] > 1.2 * table["added_mass"][0], True)
    run.check("growth: balance", table["energy_ratio"][-1], 1.0)


def pair(mass_step, stays, most=0.0):
    """Two strips with their thin rectangles towards each other, free, at 5 m/s each; most: ENDMAS, per cent."""
    deck = Deck("two strips")
    deck.add("*CONTROL_TERMINATION", (0.06, 0, 0.0, 0.0, most))
    deck.add("*CONTROL_TIMESTEP", (0.0, 0.5, 0, 0.0, mass_step, 0, 0, stays)).hourglass(4, 0.1)
    deck.add("*SECTION_SHELL", (1, 13), (1.0,)).elastic(RHO, YOUNG, POISSON)
    for part, side in ((1, -1.0), (2, 1.0)):
        deck.add("*PART", f"strip {part}", (part, 1, 1))
        columns = np.sort(side * (0.001 + np.cumsum([0.0, 0.02, 0.05, 0.13, 0.1])))
        nodes = deck.mesh(np.array([(x, y) for y in (0.0, 0.1) for x in columns]), grid_quads(4, 1), part=part)
        deck.fix(nodes, y=1).add("*SET_PART_LIST", (part,), (part, None)).node_set(part, nodes)
        deck.add("*INITIAL_VELOCITY", (part,), (-5.0 * side, 0.0))
    deck.add("*CONTACT_2D_SLIDELINE", (1, 2, 5, 2, 3.0), (0.0, 1.0e20, 2))
    return deck.output(glstat=1.0e-6, matsum=1.0e-6, rcforc=1.0e-6)


def check_contact(run):
    """Contact moves the scaled masses; what is crushed between two bodies gets more until ENDMAS ends the run."""
    target = 0.07 / SPEED
    result = run.program(pair(-target, 1), name="contact")
    table, second, force = result.table("glstat"), result.table("matsum").where(part=2), result.table("rcforc").where(side="master")
    run.check("contact: the first step", table["dt"][0], 0.5 * target)
    run.check("contact: they meet and part", force["n_active"][-1] == 0 and second["momentum_x"][-1] > 3.0 * second["mass"][-1],
              True)
    steps = np.diff(table["time"])
    impulse = np.concatenate([[0.0], np.cumsum(0.5 * steps * (force["fx"][1:] + force["fx"][:-1]))])
    run.check("contact: momentum of the scaled masses",
              second["momentum_x"] - second["momentum_x"][0], impulse)
    run.check("contact: balance", table["energy_ratio"], 1.0)
    for most in (0.0, 1.01):
        start = table["added_mass"][0] / (second["mass"][0] * 2.0 - table["added_mass"][0])
        result = run.program(pair(-target, 0, most * 100.0 * start), name=f"endmas_{most:g}", expect_status=2 if most else 0)
        grown = result.table("glstat")["added_mass"]
        if most:
            run.check("ENDMAS: what was added up to the last row", grown[-1], most * table["added_mass"][0])
            run.true("ENDMAS: it ends the run by name", "of ENDMAS" in result.stderr)
        else:
            run.check("and without it more is added", grown[-1], 1.02 * table["added_mass"][0])


def check(run):
    check_contact(run)
    check_sums(run)
    check_fall(run)
    check_stability(run)
    check_growth(run)
