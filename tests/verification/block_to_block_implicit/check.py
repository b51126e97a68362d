# SPDX-License-Identifier: MIT
"""Two soft blocks with non-matching meshes pressed together, implicit: all contact types."""
import dataclasses
import pathlib
import re
import sys

import numpy as np

from contact_types import PASS_PATCH, TYPES

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "block_to_block"))

from chain import Blocks, solve as solve_explicit  # noqa: E402
from implicit_chain import solve  # noqa: E402
from slideline_tools.scenes import block, block_grids  # noqa: E402

WIDTH, PENALTY, N_SLAVE, N_MASTER = 10.0, 1.0e6, 51, 50
SECTION = "         1        13       1.0         1\n"
ITERATION = re.compile(r"^step to (\S+) iteration (\d+): energy ratio (\S+),", re.M)


def implicit_deck(kind):
    """The scene with full integration and the implicit method (spectral radius 0.8)."""
    text = block(kind, 4, N_SLAVE, N_MASTER)
    if text.count(SECTION) != 1:
        raise RuntimeError("the scene has another section than expected")
    text = text.replace(SECTION, SECTION[:-2] + "4\n")
    return text.replace("*CONTROL_TIMESTEP", "*CONTROL_IMPLICIT_GENERAL\n         1       &dt\n"
                        "*CONTROL_IMPLICIT_DYNAMICS\n         1\n*CONTROL_TIMESTEP")


def half_segments(x):
    """Half of the neighbouring segments of each node of a chain with abscissae x (..., n)."""
    length = np.abs(np.diff(x))
    lumped = np.zeros_like(x)
    lumped[..., :-1] += 0.5 * length
    lumped[..., 1:] += 0.5 * length
    return lumped


class Scene:
    """One run: pressures of both sides as (state, node from left to right), force at every step."""

    def __init__(self, run, kind):
        self.result = run.program(implicit_deck(kind), name=f"type{kind}")
        contact = self.result.table("contact")
        self.slave = contact["pressure"].reshape(len(self.result.times), -1)
        self.step = np.rint(self.result.times / Blocks.step).astype(int)
        sides = self.result.table("rcforc")
        self.force = sides.where(side="slave")["fy"]
        self.reaction = sides.where(side="master")["fy"]
        self.grids = block_grids(N_SLAVE, N_MASTER)
        ids = self.result.points("node_id")[0].astype(int)
        self.row = {node: row for row, node in enumerate(ids)}
        upper = self.rows(self.grids[0].upper[::-1])
        x = self.result.points("Points")[:, upper, 0]
        self.master = -self.result.points("contact_force")[:, upper, 1] / half_segments(x)
        log = (self.result.folder / f"{self.result.job}.log").read_text()
        self.steps = {}
        for time, number, ratio in ITERATION.findall(log):
            self.steps.setdefault(round(float(time) / Blocks.step), []).append(float(ratio))

    def rows(self, nodes):
        return np.vectorize(self.row.get)(nodes)

    def motion(self):
        """Displacement in y at the end as (body, node over the height, node along the width)."""
        u = self.result.points("displacement")[-1, :, 1]
        return [u[self.rows(grid.node)].T for grid in self.grids]


def check_iterations(run, name, scene):
    """Fig. 20 of the paper: the first five steps need at most three iterations."""
    run.check(f"{name}: steps in the log", len(scene.steps), Blocks.steps)
    counts = [len(scene.steps[k]) for k in range(1, Blocks.steps + 1)]
    run.check(f"{name}: iterations of the first five steps", counts[:5], 3.0)
    run.check(f"{name}: iterations of any step", counts, 3.0)
    for step in range(1, 6):
        for number, ratio in enumerate(scene.steps[step][1:], 2):
            run.report(f"{name}: energy ratio, step {step}, iteration {number}", ratio)
    # quadratic: the energy falls with the fourth power of the error, so the second drop (in
    # decades) is at least 1.8 times the first
    ratios = np.array(scene.steps[1])
    if len(ratios) > 2:
        run.check(f"{name}: decades of the third iteration over those of the second",
                  np.log10(ratios[2]) / np.log10(ratios[1]), 1.8)


def check_uniform(run, name, scene, chain):
    scale = chain.pressure.max()
    for side, pressure in (("slave", scene.slave), ("master", scene.master)):
        run.check(f"{name}: pressure along the {side} surface, all states", pressure / scale,
                  np.broadcast_to(chain.pressure[scene.step, None] / scale, pressure.shape))
        run.check(f"{name}: spread of the pressure on the {side} side at 0.2 s",
                  np.ptp(pressure[-1]) / chain.pressure[-1], 0.0)
    run.check(f"{name}: total force, every step", scene.force, WIDTH * chain.pressure)
    for body, u in enumerate(scene.motion()):
        where = ("lower", "upper")[body]
        run.check(f"{name}: displacement at 0.2 s, all nodes of the {where} block", u,
                  np.broadcast_to(chain.displacement[-1, body][:, None], u.shape))


def check_deviating(run, name, kind, scene):
    total = {1: N_SLAVE + 1, 3: N_SLAVE + N_MASTER}.get(kind, N_SLAVE)
    chain = solve(dataclasses.replace(Blocks(), penalty=PENALTY * total / WIDTH))
    run.check(f"{name}: total force, every step", scene.force, WIDTH * chain.pressure)
    mean = scene.force[-1] / WIDTH
    deviation = [pressure[-1] / mean - 1.0 for pressure in (scene.slave, scene.master)]
    for side, found in zip(("slave", "master"), deviation):
        run.check(f"{name}: left and right end alike, {side} side", found[::-1], found)
        run.report(f"{name}: lowest pressure over mean - 1, {side} side", np.min(found))
        run.report(f"{name}: highest pressure over mean - 1, {side} side", np.max(found))
        run.report(f"{name}: pressure of the end node over mean - 1, {side} side", found[0])
    return deviation


def report_drivers(run):
    """Explicit (lumped mass) and implicit (consistent mass) chain; the runs equal them."""
    for layers, step in ((2, 1.0e-3), (8, 1.0e-3), (16, 2.5e-4)):
        blocks = dataclasses.replace(Blocks(), penalty=PENALTY * N_SLAVE / WIDTH, layers=layers,
                                     step=step, steps=round(0.2 / step))
        explicit = solve_explicit(blocks).pressure
        distance = np.sqrt(np.mean((solve(blocks).pressure - explicit) ** 2)) / explicit.max()
        run.report(f"explicit and implicit chain of {layers} layers a block: rms difference of the "
                   "pressure / its maximum", distance)


def check(run):
    chain = solve(dataclasses.replace(Blocks(), penalty=PENALTY * N_SLAVE / WIDTH))
    if run.is_full:
        report_drivers(run)
    ends = {}
    for kind, name in TYPES.items():
        scene = Scene(run, kind)
        run.check(f"{name}: both sides, every step", scene.reaction, -scene.force)
        check_iterations(run, name, scene)
        energy = scene.result.table("glstat")["energy_ratio"]
        run.report(f"{name}: lowest energy ratio", np.min(energy), "numerical dissipation")
        run.report(f"{name}: highest energy ratio", np.max(energy))
        if kind in PASS_PATCH:
            check_uniform(run, name, scene, chain)
        else:
            ends[kind] = [side[0] for side in check_deviating(run, name, kind, scene)]
    run.true("NTS: end nodes carry too much on both sides", min(ends[1]) > 0.0)
    run.true("NTS-AR: the slave's end nodes carry too little, the master's too much",
             ends[2][0] < 0.0 < ends[2][1])
    run.true("two-pass NTS-AR: end nodes carry too much on both sides", min(ends[3]) > 0.0)
