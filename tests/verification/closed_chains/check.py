# SPDX-License-Identifier: MIT
"""Three free bodies with closed chains and an interface between each two, each of its own type."""
import numpy as np

from contact_types import MOMENT_FREE, TYPES
from meshes import Deck, angular_momentum, grid, lumped_mass, rotate

RHO, YOUNG, POISSON, PENALTY = 1000.0, 1.0e6, 0.3, 3.0e5
SEEDS = (1, 2)
SPEED = 1.0


def bodies(seed):
    """Three blocks on a circle, turned and with irregular meshes, and their velocities inwards."""
    rng = np.random.default_rng(seed)
    result = []
    for angle in 2.0 * np.pi * np.arange(3) / 3.0 + rng.uniform(-0.1, 0.1, 3):
        cells = [int(n) for n in rng.integers(3, 7, 2)]
        size = rng.uniform(0.5, 0.8, 2)
        shape, quads = grid(*cells, *size, -0.5 * size)
        shape = shape + rng.uniform(-0.1, 0.1, shape.shape) * np.min(size / cells)
        away = np.array([np.cos(angle), np.sin(angle)])
        shape = rotate(shape, rng.uniform(0.0, 2.0 * np.pi)) + 0.62 * away
        result.append((shape, quads, -SPEED * away))
    return result


def three_bodies(kinds, seed):
    deck = Deck(f"three bodies {seed}, types {kinds}")
    deck.control(0.6, scale=0.2).hourglass(4, 0.1)
    for part, (shape, quads, velocity) in enumerate(bodies(seed), start=1):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
        ids = deck.mesh(shape, quads, part=part)
        deck.node_set(part, ids).add("*SET_PART_LIST", (part,), (part,))
        deck.add("*INITIAL_VELOCITY", (part,), velocity.tolist())
    for kind, (slave, master) in zip(kinds, ((1, 2), (2, 3), (3, 1))):
        deck.add("*CONTACT_2D_SLIDELINE", (slave, master, kind, 3, PENALTY), (0.0, 1.0e20, 1))
    return deck.output(plot=0.01, glstat=0.005, rcforc=0.005)


def check_bodies(run, kinds, seed):
    name = f"bodies {seed}, types {', '.join(str(kind) for kind in kinds)}"
    result = run.program(three_bodies(kinds, seed))
    mass = np.concatenate([lumped_mass(shape, quads, RHO) for shape, quads, _ in bodies(seed)])
    position = result.points("Points")[..., :2]
    velocity = result.points("velocity")[..., :2]
    size = np.sum(mass) * SPEED / 3.0
    momentum = np.einsum("n,tnk->tk", mass, velocity)
    run.check(f"{name}: momentum, drift / |p|", (momentum - momentum[0]) / size, 0.0)
    turning = angular_momentum(mass, position, velocity)
    if all(kind in MOMENT_FREE for kind in kinds):
        run.check(f"{name}: angular momentum, drift / (|p| x 1 m)", (turning - turning[0]) / size,
                  0.0)
    else:
        run.report(f"{name}: angular momentum, drift / (|p| x 1 m)",
                   np.max(np.abs(turning - turning[0])) / size, "VTS-PPT among them")
    forces = result.table("rcforc")
    for number in (1, 2, 3):
        slave = forces.where(interface=number, side="slave")
        master = forces.where(interface=number, side="master")
        peak = np.max(np.hypot(slave["fx"], slave["fy"]))
        run.check(f"{name}: interface {number}: peak force", peak, 100.0)
        for axis in ("fx", "fy"):
            run.check(f"{name}: interface {number}: (slave + master {axis}) / peak",
                      (slave[axis] + master[axis]) / peak, 0.0)
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"{name}: contact energy / initial energy, at least",
              energy["contact"] / energy["total"][0], -0.2)
    run.check(f"{name}: contact energy at the start", energy["contact"][0], 0.0)
    run.report(f"{name}: contact energy at the end / initial energy",
               energy["contact"][-1] / energy["total"][0])


def check(run):
    kinds = list(TYPES)
    for seed in SEEDS:
        for k in range(len(kinds)):
            check_bodies(run, [kinds[(k + j) % len(kinds)] for j in range(3)], seed)
