# SPDX-License-Identifier: MIT
"""Two soft blocks with non-matching meshes pressed together, explicit: all contact types."""
import dataclasses

import numpy as np

import plane
from chain import Blocks, solve
from contact_types import PASS_PATCH, TYPES
from slideline_tools.scenes import block, block_grids

WIDTH, PENALTY, N_SLAVE, N_MASTER = 10.0, 1.0e6, 51, 50


def chain_of(*springs):
    """The chain whose interface is as stiff as these springs (N/m) spread over the width."""
    return solve(dataclasses.replace(Blocks(), penalty=sum(springs) / WIDTH))


class Scene:
    """One run of the scene: pressures of both sides as (state, node from left to right)."""

    def __init__(self, run, kind, n_slave=N_SLAVE, n_master=N_MASTER, n_gauss=4):
        self.grids = block_grids(n_slave, n_master)
        self.result = run.program(block(kind, n_gauss, n_slave, n_master),
                                  name=f"type{kind}_{n_slave}_{n_master}_{n_gauss}")
        contact = self.result.table("contact")
        states = len(self.result.times)
        self.slave = contact["pressure"].reshape(states, -1)
        self.gap = contact["gap"].reshape(states, -1)
        self.step = np.rint(self.result.times / Blocks.step).astype(int)
        sides = self.result.table("rcforc")
        self.force = sides.where(side="slave")["fy"]
        self.reaction = sides.where(side="master")["fy"]
        ids = self.result.points("node_id")[0].astype(int)
        self.row = {node: row for row, node in enumerate(ids)}
        upper = self.rows(self.grids[0].upper[::-1])
        x = self.result.points("Points")[:, upper, 0]
        self.master = -self.result.points("contact_force")[:, upper, 1] / half_segments(x)

    def rows(self, nodes):
        """Places of deck nodes (any shape) in the arrays of the results."""
        return np.vectorize(self.row.get)(nodes)

    def motion(self, layers):
        """Displacement in y at the end as (body, node over the height, node along the width)."""
        u = self.result.points("displacement")[-1, :, 1]
        return [u[self.rows(grid.node)].T for grid in self.grids]

    def stress(self):
        """Stress sigma_yy at the end as (body, layer, element along the width)."""
        values = self.result.cells("stress")[-1, :, 1]
        ids = self.result.cells("element_id")[0].astype(int)
        place = {element: row for row, element in enumerate(ids)}
        return [values[np.vectorize(place.get)(grid.element)].T for grid in self.grids]


def half_segments(x):
    """Half of the neighbouring segments of each node of a chain with abscissae x (..., n)."""
    length = np.abs(np.diff(x))
    lumped = np.zeros_like(x)
    lumped[..., :-1] += 0.5 * length
    lumped[..., 1:] += 0.5 * length
    return lumped


def check_uniform(run, name, scene, chain):
    """The run is the chain: pressure on both sides at every state, force at every step."""
    scale = chain.pressure.max()
    for side, pressure in (("slave", scene.slave), ("master", scene.master)):
        run.check(f"{name}: pressure along the {side} surface, all states", pressure / scale,
                  np.broadcast_to(chain.pressure[scene.step, None] / scale, pressure.shape))
        run.check(f"{name}: spread of the pressure on the {side} side at 0.2 s",
                  np.ptp(pressure[-1]) / chain.pressure[-1], 0.0)
    run.check(f"{name}: total force, every step", scene.force, WIDTH * chain.pressure)
    for body, (u, stress) in enumerate(zip(scene.motion(2), scene.stress())):
        where = ("lower", "upper")[body]
        run.check(f"{name}: displacement at 0.2 s, all nodes of the {where} block", u,
                  np.broadcast_to(chain.displacement[-1, body][:, None], u.shape))
        run.check(f"{name}: stress at 0.2 s, all elements of the {where} block", stress,
                  np.broadcast_to(chain.stress[-1, body][:, None], stress.shape))


def check_deviating(run, name, kind, scene, n_gauss=4):
    """A type that fails the patch test deviates as the linearised plane model says."""
    total = {1: N_SLAVE + 1, 3: N_SLAVE + N_MASTER}.get(kind, N_SLAVE)
    chain = chain_of(PENALTY * total)
    run.check(f"{name}: total force, every step", scene.force, WIDTH * chain.pressure)
    mean = scene.force[-1] / WIDTH
    expected = plane.solve(kind, N_SLAVE, N_MASTER, WIDTH, PENALTY, Blocks(), n_gauss)
    deviation = [pressure[-1] / mean - 1.0 for pressure in (scene.slave, scene.master)]
    for side, found, linear in zip(("slave", "master"), deviation, expected):
        length = plane.lumped(np.linspace(0.0, WIDTH, len(linear)))
        run.check(f"{name}: deviation from uniform pressure, {side} side", found,
                  WIDTH * linear / np.sum(length * linear) - 1.0)
        run.report(f"{name}: largest deviation from uniform pressure, {side} side",
                   np.max(np.abs(found)))
        run.check(f"{name}: left and right end alike, {side} side", found[::-1], found)
    return deviation


def check_signs(run, deviation, depth):
    """Which end nodes are pressed too much or too little, from the weights alone."""
    ends = {kind: (slave[0], master[0]) for kind, (slave, master) in deviation.items()}
    run.true("NTS: end nodes carry too much on both sides", min(ends[1]) > 0.0)
    run.true("NTS-AR: the slave's end nodes carry too little, the master's too much",
             ends[2][0] < 0.0 < ends[2][1])
    run.true("two-pass NTS-AR: end nodes carry too much on both sides", min(ends[3]) > 0.0)
    run.true("two-pass NTS-AR: penetration of the slave's end nodes is too small",
             depth[0] < np.mean(depth))
    run.true("two-pass NTS-AR: nearer to uniform than NTS-AR, and that than NTS",
             largest(deviation[3]) < largest(deviation[2]) < largest(deviation[1]))
    run.true("mortar: nearer to uniform than NTS-AR", largest(deviation[6]) < largest(deviation[2]))
    fine = check_deviating(run, "mortar, 10 points", 6, Scene(run, 6, n_gauss=10), 10)
    run.true("mortar: 10 points are nearer to uniform than 4, both sides",
             all(np.ptp(a) < np.ptp(b) for a, b in zip(fine, deviation[6])))
    run.check("two-pass NTS-AR: mean pressure over mean penetration", 1.0 / np.mean(depth),
              PENALTY * (N_SLAVE + N_MASTER) / WIDTH)


def largest(deviation):
    return max(np.max(np.abs(side)) for side in deviation)


def check(run):
    matching = Scene(run, 2, N_MASTER, N_MASTER)
    check_uniform(run, "matching meshes, NTS-AR", matching, chain_of(PENALTY * N_MASTER))
    deviation = {}
    for kind, name in TYPES.items():
        scene = Scene(run, kind)
        run.check(f"{name}: forces of the two sides cancel", scene.reaction, -scene.force)
        if kind in PASS_PATCH:
            check_uniform(run, name, scene, chain_of(PENALTY * N_SLAVE))
        else:
            deviation[kind] = check_deviating(run, name, kind, scene)
        if kind == 3:
            depth = -scene.gap[-1] * WIDTH / scene.force[-1]
    check_signs(run, deviation, depth)
