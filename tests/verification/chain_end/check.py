# SPDX-License-Identifier: MIT
"""A slave chain that slides over the end of the master chain and comes back; a master shorter than it; a slave that
starts just beyond the end."""
import re

import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

RHO, YOUNG, POISSON, GRAVITY = 1000.0, 1.0e7, 0.3, 10.0
WIDTH, HEIGHT, CELL = 0.6, 0.3, 0.1
RAIL, RAIL_CELLS = 1.2, 15
START = 0.5  # left end of the block
PENALTY = 1.0e6  # distributed
WEIGHT = RHO * WIDTH * HEIGHT * GRAVITY
LIMIT = 0.5 * RAIL / RAIL_CELLS
PRESS, OUT, BACK, LIFT, END = 0.15, 0.3, 0.8, 1.3, 1.7
PRESSED, OUTSIDE = 0.003, 0.8  # guided block: pressed in, moved out
RELEASED = re.compile(r"first contacts deeper than the limit were excluded: (\d+)")


def n_released(result):
    found = RELEASED.findall((result.folder / f"{result.job}.log").read_text())
    return sum(int(count) for count in found)


def strokes(*ways):
    """(time, velocity) of smooth strokes (start, end, distance), each 1 - cos, at rest between them."""
    points = [(0.0, 0.0)]
    for start, end, way in ways:
        share = np.linspace(0.0, 1.0, 101)
        speed = way * (1.0 - np.cos(2.0 * np.pi * share)) / (end - start)
        speed[[0, -1]] = 0.0
        points += [(start + (end - start) * s, v) for s, v in zip(share, speed)
                   if start + (end - start) * s > points[-1][0]]
    return [*points, (10.0, 0.0)]


def block_on_rail(title, kind, plot=0.005):
    deck = Deck(f"{title}, type {kind}")
    deck.control(END, scale=0.5)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
    block = deck.mesh(*grid(6, 3, WIDTH, HEIGHT, (START, 0.0)), part=1)
    rail = deck.mesh(*grid(RAIL_CELLS, 3, RAIL, 0.3, (0.0, -0.3)), part=2)
    deck.node_set(1, block[:7]).node_set(2, rail[-RAIL_CELLS - 1:][::-1])
    deck.fix(rail[:RAIL_CELLS + 1], x=1, y=1)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 2, PENALTY), (0.0, 1.0e20, 1))
    deck.output(plot=plot, glstat=0.002, rcforc=0.001)
    return deck, block


def weighted_block(kind, distance):
    """Weight comes on, the block is moved out by its upper face and back, the weight is turned up."""
    deck, block = block_on_rail(f"over the end by {distance:g} m", kind)
    # The weight of the block alone: a force on each node, by its mass.
    mass = np.outer(np.r_[0.5, 1.0, 1.0, 0.5], np.r_[0.5, np.ones(5), 0.5]).ravel()
    mass *= RHO * CELL ** 2
    deck.curve(1, [(0.0, 0.0), (PRESS, 1.0), (LIFT, 1.0), (LIFT + 0.1, -0.3), (10.0, -0.3)])
    deck.add("*LOAD_NODE_POINT", *[(node, 2, 1, -GRAVITY * m)
                                   for node, m in zip(block.tolist(), mass.tolist())])
    deck.curve(2, strokes((OUT, BACK, distance), (BACK, LIFT, -distance)))
    for node in block[-7:]:
        deck.prescribe(node, 1, 0, 2)
    return deck


def guided_block(kind, sink):
    """The upper face is led: down by PRESSED, out, down by `sink` while outside, back, up."""
    deck, block = block_on_rail(f"back {sink:g} m below", kind, END)
    deck.curve(1, strokes((0.0, PRESS, -PRESSED), (BACK, BACK + 0.1, -sink),
                          (LIFT + 0.1, LIFT + 0.3, sink + 2.0 * PRESSED)))
    deck.curve(2, strokes((OUT, BACK, OUTSIDE), (BACK + 0.1, LIFT, -OUTSIDE)))
    for node in block[-7:]:
        deck.prescribe(node, 1, 0, 2)
        deck.prescribe(node, 2, 0, 1)
    return deck


def check_balance(run, name, result):
    """Energy in total less the work done from outside, over the largest kinetic energy."""
    energy = result.table("glstat")
    error = (energy["total"] - energy["total"][0] - energy["external_work"]) \
        / energy["kinetic"].max()
    run.check(f"{name}: (total energy - external work) / largest kinetic energy", error, 0.0)


def check_out_and_back(run, kind):
    """The centre of mass stays over the rail: two nodes leave it and come back."""
    distance = 0.25
    name = f"{TYPES[kind]}, out and back"
    result = run.program(weighted_block(kind, distance))
    force = result.table("rcforc").where(side="slave")
    energy = result.table("glstat")
    contact = result.table("contact")
    off = contact["x"] > RAIL + 0.1 * RAIL / RAIL_CELLS  # the rail gives a little too
    run.check(f"{name}: slave nodes that leave the rail", len(np.unique(contact["node"][off])), 2)
    run.check(f"{name}: gap of nodes beyond the end", contact["gap"][off], 0.0)
    run.check(f"{name}: contact has ended", force["n_active"][-1], 0)
    moving = (force["time"] > PRESS) & (force["time"] < LIFT)
    mean = force["fy"][moving].mean()
    run.check(f"{name}: mean force while it moves / weight", mean / WEIGHT, 1.0)
    run.check(f"{name}: largest force / weight", force["fy"].max() / WEIGHT, 3.0)
    # Rigid block at the turn: centre of mass 0.15 m inside the end of 0.45 m facing, so a triangle.
    inside = RAIL - START - 0.5 * WIDTH - distance
    edge = 2.0 * WEIGHT / (3.0 * inside * PENALTY)
    tip = edge * WIDTH / (3.0 * inside)
    run.check(f"{name}: deepest gap / static tip of a rigid block", -contact["gap"].min() / tip,
              2.0)
    run.check(f"{name}: the tip / deepest first contact", tip / LIMIT, 0.5)
    run.check(f"{name}: released by the log", n_released(result), 0)
    check_balance(run, name, result)
    # Two nodes can be caught at up to twice the tip: springs of their competence lengths (type 1:
    # a whole length each; type 3: the master nodes under them too).
    lengths = {1: 2.0 * CELL, 3: 1.5 * CELL + 2.0 * CELL}.get(kind, 2.0 * CELL)
    bound = 0.5 * PENALTY * lengths * (2.0 * tip) ** 2
    left = energy["contact"][-1]
    run.check(f"{name}: energy lost or created in contact / bound", abs(left) / bound, 1.0)
    run.report(f"{name}: contact energy left / bound", left / bound, "positive: lost")
    run.report(f"{name}: largest force / weight", force["fy"].max() / WEIGHT)


def check_guided(run, kind):
    """The block leaves the rail altogether and comes back below its surface."""
    for sink in (0.02, 0.06):
        depth = PRESSED + sink
        name = f"{TYPES[kind]}, back {depth:g} m below"
        result = run.program(guided_block(kind, sink))
        force = result.table("rcforc").where(side="slave")
        outside = (force["time"] > BACK) & (force["time"] < BACK + 0.1)
        again = (force["time"] > BACK + 0.1) & (force["time"] < LIFT + 0.1)
        run.check(f"{name}: force outside", force["fy"][outside], 0.0)
        on = PENALTY * WIDTH * (7.0 / 6.0 if kind == 1 else 2.0 if kind == 3 else 1.0)
        run.check(f"{name}: largest force before / rigid press",
                  force["fy"][force["time"] < BACK].max() / (on * PRESSED), 1.3)
        if depth > LIMIT:
            run.check(f"{name}: force after it has come back", force["fy"][again], 0.0)
            nodes = 7 if kind in (1, 2) else 1
            run.check(f"{name}: released by the log", n_released(result), nodes)
            run.report(f"{name}: released by the log", n_released(result))
        else:
            peak = force["fy"][again].max() / (on * depth)
            run.check(f"{name}: largest force after it has come back / rigid press", peak, 1.3)
            run.check(f"{name}: points after it has come back", force["n_active"][again].max(), 1)
            run.check(f"{name}: released by the log", n_released(result), 0)
            created = -result.table("glstat")["contact"][-1]
            bound = 0.5 * on * depth ** 2
            run.check(f"{name}: energy created / (k L g^2/2)", created / bound, 1.0)
            run.report(f"{name}: energy created / (k L g^2/2)", created / bound)
        run.check(f"{name}: contact has ended", force["n_active"][-1], 0)
        check_balance(run, name, result)


# --- a master shorter than the slave ---------------------------------------------------------------

SLAVE, MASTER, DEPTH = np.linspace(0.0, 1.0, 11), np.linspace(0.23, 0.87, 6), 1.0e-3


def short_master(kind, strict, n_gauss=3):
    """A slave block overlaps a narrower master block by DEPTH at time zero."""
    deck = Deck(f"short master, type {kind}")
    deck.control(1.0e-4, dt=1.0e-4)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
    upper = deck.mesh(*grid(10, 3, 1.0, 0.3, (0.0, -DEPTH)), part=1)
    lower = deck.mesh(*grid(5, 3, 0.64, 0.3, (0.23, -0.3)), part=2)
    deck.node_set(1, upper[:11]).node_set(2, lower[-6:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, n_gauss, PENALTY),
             (0.0, 1.0e20, 1, 0.0, 0.0, strict))
    return deck.output(plot=1.0, rcforc=1.0), upper[:11], lower[-6:]


def hats(x, spot):
    return np.array([np.interp(spot, x, row) for row in np.eye(len(x))])


def spread(points):
    """Nodal forces on slave and master of points (x, force)."""
    slave = sum(f * hats(SLAVE, x) for x, f in points)
    return slave, -sum(f * hats(MASTER, x) for x, f in points)


def uniform(x, low, high):
    """Consistent nodal forces of a pressure DEPTH * PENALTY between low and high."""
    cuts = np.unique(np.r_[low, high, x[(x > low) & (x < high)]])
    return DEPTH * PENALTY * sum(0.5 * (b - a) * (hats(x, a) + hats(x, b))
                                 for a, b in zip(cuts[:-1], cuts[1:]))


def expected_forces(kind, strict, n_gauss=3):
    """Nodal forces at the overlap DEPTH, by the definition of the type."""
    over = [x for x in SLAVE if MASTER[0] < x < MASTER[-1]]
    force = DEPTH * PENALTY * 0.1
    nodes = spread([(x, force) for x in over])
    if kind in (1, 2):  # competence length = mean length = 0.1 for all of these nodes
        return nodes
    if kind == 3:
        second = spread([(x, DEPTH * PENALTY * w) for x, w in
                         zip(MASTER, 0.128 * np.r_[0.5, 1, 1, 1, 1, 0.5])])
        return nodes[0] + second[0], nodes[1] + second[1]
    if kind == 5 and strict:
        # Between the outermost nodes over the master all is covered; each of these has the half of
        # its outer segment too.
        slave, master = uniform(SLAVE, over[0], over[-1]), -uniform(MASTER, over[0], over[-1])
        outer = spread([(over[0], 0.5 * force), (over[-1], 0.5 * force)])
        return slave + outer[0], master + outer[1]
    if kind in (5, 7):
        return uniform(SLAVE, MASTER[0], MASTER[-1]), -uniform(MASTER, MASTER[0], MASTER[-1])
    if kind == 4:
        # Virtual nodes over the master; the half segment of the outermost is cut at the end of the master,
        # its force goes to the part that is covered.
        slave, master = np.zeros(len(SLAVE)), np.zeros(len(MASTER))
        for x in 0.05 * np.arange(20) + 0.025:
            if not MASTER[0] < x < MASTER[-1]:
                continue
            low, high = max(x - 0.025, MASTER[0]), min(x + 0.025, MASTER[-1])
            slave += 0.5 * force * hats(SLAVE, x)
            cuts = np.unique(np.r_[low, high, MASTER[(MASTER > low) & (MASTER < high)]])
            for a, b in zip(cuts[:-1], cuts[1:]):
                master -= 0.5 * force * (b - a) / (high - low) * hats(MASTER, 0.5 * (a + b))
        return slave, master
    xi, weight = np.polynomial.legendre.leggauss(n_gauss)
    return spread([(x, force * w) for m in SLAVE[:-1] + 0.05
                   for x, w in zip(m + 0.05 * xi, 0.5 * weight) if MASTER[0] < x < MASTER[-1]])


def check_short_master(run, kind):
    for strict in (0, 1) if kind == 5 else (0,):
        name = f"{TYPES[kind]}{' strict' if strict else ''}, master shorter than the slave"
        deck, slave, master = short_master(kind, strict)
        result = run.program(deck)
        found = result.points("contact_force")[0, :, 1]
        wanted = expected_forces(kind, strict)
        for side, ids, force in zip(("slave", "master"), (slave, master), wanted):
            run.check(f"{name}: nodal forces on the {side}", found[ids - 1], force)
        share = np.array([0.5, 1, 1, 1, 1, 0.5]) * 0.128 * DEPTH * PENALTY
        deviation = np.max(np.abs(-found[master - 1] / share - 1.0))
        if kind in (5, 7) and not strict:
            run.check(f"{name}: max |p/p0 - 1| on the master", deviation, 0.0)
        elif kind == 5:
            run.check(f"{name}: max |p/p0 - 1| on the master", deviation, 0.1)
        run.report(f"{name}: max |p/p0 - 1| on the master", deviation)
        run.report(f"{name}: total force / (k g x facing length)",
                   found[slave - 1].sum() / (DEPTH * PENALTY * 0.64))


# --- places of the slave just beyond the end ---------------------------------------------------------

# Overhang in slave elements: a node, virtual node or Gauss point stands up to a tenth beyond the end.
OVERHANG = {1: 0.1, 2: 1.1, 3: 1.02, 4: 0.3, 5: 0.1, 6: 0.38, 7: 0.1}
CATCH = 0.1  # of the default limit


def overhanging(kind, start, catch):
    """A block of 1 m falls at 3 % of the wave speed on one of 2 m, beyond whose end it stands by `start` m."""
    deck = Deck(f"{start:g} m beyond the end, type {kind}").control(0.12, scale=0.8).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(1000.0, 1.0e6, 0.0, part)
    lower = deck.mesh(*grid(8, 2, 2.0, 0.5, (0.0, -0.5)), part=1)
    upper = deck.mesh(*grid(5, 2, 1.0, 0.5, (1.0 + start, 0.002)), part=2)
    deck.node_set(1, upper[:6]).node_set(2, lower[-9:][::-1]).fix(lower[:9], x=1, y=1)
    deck.add("*INITIAL_VELOCITY_GENERATION", (2, 2, 0.0, 0.0, -0.03 * np.sqrt(1000.0), 0.0), [0.0] * 6)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 0.5), (0.0, 1.0e20, 3, 0.0, 0.0, 0, 0, catch))
    return deck.output(plot=0.005, glstat=0.0004, rcforc=0.0004)


def check_overhang(run, kind):
    """A block falls on another, beyond whose end it starts; with the default limit and a tenth of it."""
    overhang, limit = OVERHANG[kind], 0.1
    for catch in (0.0, CATCH):
        name = f"{TYPES[kind]}, {overhang:g} elements beyond the end, SRCH {catch * limit:g}"
        result = run.program(overhanging(kind, overhang * 0.2, catch * limit))
        energy = result.table("glstat")
        run.check(f"{name}: energy created / kinetic energy",
                  -energy["contact"].min() / energy["kinetic"][0], 0.01)
        run.check(f"{name}: points in contact", result.table("rcforc")["n_active"].max(), 1)


def check(run):
    for kind in TYPES:
        check_overhang(run, kind)
        check_out_and_back(run, kind)
        check_guided(run, kind)
        check_short_master(run, kind)
