# SPDX-License-Identifier: MIT
"""Skewed impact of two blocks: what contact must conserve, whatever its type."""
import numpy as np

from contact_types import MOMENT_FREE, TYPES
from meshes import Deck, angular_momentum, grid, lumped_mass, rotate, trapezoid

RHO, YOUNG, POISSON = (2000.0, 1000.0), (2.0e6, 1.0e6), 0.3


def blocks():
    """A tilted block above a flat one of another mesh and material."""
    below, below_quads = grid(10, 4, 2.0, 0.8, (-1.0, -0.8))
    above, above_quads = grid(7, 5, 1.0, 0.7, (-0.6, 0.0))
    above = rotate(above, 0.15, (-0.6, 0.0)) + (0.0, 0.012)
    return (above, above_quads), (below, below_quads)


def skewed_impact(kind):
    upper, lower = blocks()
    deck = Deck(f"skewed impact, type {kind}")
    deck.control(0.25, scale=0.5)
    for part in (1, 2):
        deck.part(part).elastic(RHO[part - 1], YOUNG[part - 1], POISSON, part)
    top = deck.mesh(*upper, part=1)
    bottom = deck.mesh(*lower, part=2)
    deck.node_set(1, top).node_set(2, top[:8])
    deck.node_set(3, bottom[-11:][::-1])
    deck.add("*INITIAL_VELOCITY", (1,), (0.5, -1.0))
    deck.contact(2, 3, kind, 1.0e6)
    interval = 1.0e-3
    return deck.output(plot=interval, glstat=interval, matsum=interval, rcforc=interval)


def check_type(run, kind):
    name = TYPES[kind]
    (upper, upper_quads), (lower, lower_quads) = blocks()
    result = run.program(skewed_impact(kind), name=f"type{kind}")
    mass = np.concatenate([lumped_mass(upper, upper_quads, RHO[0]),
                           lumped_mass(lower, lower_quads, RHO[1])])
    moving = mass[:len(upper)].sum()
    size = moving * np.hypot(0.5, 1.0)
    parts = result.table("matsum")
    for axis, wanted in (("x", 0.5 * moving), ("y", -moving)):
        total = sum(parts.where(part=p)[f"momentum_{axis}"] for p in (1, 2))
        run.check(f"{name}: total momentum {axis}, drift / |p|", (total - wanted) / size, 0.0)
    forces = result.table("rcforc")
    slave, master = forces.where(side="slave"), forces.where(side="master")
    peak = np.max(np.hypot(slave["fx"], slave["fy"]))
    run.check(f"{name}: the blocks touched: peak force", peak, 1000.0)
    for axis in ("fx", "fy"):
        run.check(f"{name}: (slave + master {axis}) / peak force",
                  (slave[axis] + master[axis]) / peak, 0.0)
    contact = result.points("contact_force")[..., :2]
    run.check(f"{name}: sum of nodal contact forces / peak force", contact.sum(axis=1) / peak, 0.0)
    position = result.points("Points")[..., :2]
    moment = np.sum(position[..., 0] * contact[..., 1] - position[..., 1] * contact[..., 0], axis=1)
    found = angular_momentum(mass, position, result.points("velocity")[..., :2])
    if kind in MOMENT_FREE:
        run.check(f"{name}: moment of the contact forces / (peak force x 1 m)", moment / peak, 0.0)
        run.check(f"{name}: angular momentum", found, found[0])
    else:
        run.report(f"{name}: moment of the contact forces / (peak force x 1 m)",
                   np.max(np.abs(moment)) / peak, "portion centres on a bent master")
        run.report(f"{name}: angular momentum, largest drift / initial",
                   np.max(np.abs(found / found[0] - 1.0)))
    change = parts.where(part=1)["momentum_y"]
    run.check(f"{name}: change of momentum is the impulse / |p|",
              (change[-1] - change[0] - trapezoid(slave["fy"], slave["time"])) / size, 0.0)
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    columns = ("kinetic", "internal", "hourglass", "viscous", "damping", "contact", "leapfrog")
    run.check(f"{name}: columns add up to the total", sum(energy[c] for c in columns),
              energy["total"])
    run.report(f"{name}: energy ratio furthest from 1",
               1.0 + max(energy["energy_ratio"] - 1.0, key=abs))


def check(run):
    for kind in TYPES:
        check_type(run, kind)
