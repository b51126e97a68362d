# SPDX-License-Identifier: MIT
"""Contact of part sets with themselves: all types, plane and round, explicit and static."""
import numpy as np

import scenes
import static_patch
from contact_types import MOMENT_FREE, PASS_PATCH, TYPES
from meshes import angular_momentum, lumped_mass
from patch_layouts import MESHES

STEP = 2.0e-4


def as_two_interfaces(kind, bodies, end, friction, is_axisymmetric):
    """The same bodies with the interfaces (1, 2) and (2, 1) at half the penalty, type 3 once at all of it."""
    deck = scenes.free_bodies(bodies, end, STEP, is_axisymmetric)
    for slave, master in ((1, 2), (2, 1))[:1 if kind == 3 else 2]:
        half = scenes.PENALTY * (1.0 if kind == 3 else 0.5)
        deck.add("*CONTACT_2D_SLIDELINE", (slave, master, kind, 3, half, friction), (0.0, 1.0e20, 0 if kind == 1 else 1))
    return deck


def check_two_bodies(run, kind):
    bodies, end = scenes.octagons(1, 2, 2, cells=3), 0.15
    for friction, is_axisymmetric in [(0.0, False), (0.3, False), (0.3, True)][:3 if kind in PASS_PATCH else 2]:
        pair = run.program(as_two_interfaces(kind, bodies, end, friction, is_axisymmetric))
        deck = scenes.with_itself(scenes.free_bodies(bodies, end, STEP, is_axisymmetric), (1, 2), kind, scenes.PENALTY,
                                  0 if kind == 1 else 1, friction)
        both = run.program(deck)
        name = f"type {kind}, two {'rings' if is_axisymmetric else 'bodies'}, friction {friction}"
        run.check(f"{name}: energy in the springs, most / initial",
                  np.max(both.table("glstat")["contact"]) / both.table("glstat")["total"][0], 0.01)
        run.check(f"{name}: velocities", both.points("velocity"), pair.points("velocity"))


def check_names(run, kind):
    """Nine bodies named and numbered otherwise, begun elsewhere, and in the mirror; until the first bounces are over."""
    order, end = [4, 8, 0, 5, 2, 7, 1, 3, 6], 0.08
    found = []
    for words in ({}, {"order": order}, {"mirrored": True}, {"renumbered": True}):
        bodies = scenes.octagons(3, 3, 1, **words)
        deck = scenes.with_itself(scenes.free_bodies(bodies, end, STEP), range(1, 10), kind, scenes.PENALTY, 1)
        result = run.program(deck)
        found.append(result.points("velocity")[-1, :, :2].reshape(9, -1, 2))
    run.check(f"type {kind}, nine bodies: energy in the springs at the end",
              result.table("glstat")["contact"][-1], 1.0)
    run.check(f"type {kind}, nine bodies: in another order", found[1], found[0][order])
    run.check(f"type {kind}, nine bodies: mirrored", found[2] * [-1.0, 1.0], found[0])
    run.check(f"type {kind}, nine bodies: walked and numbered otherwise", found[3][:, ::-1],
              found[0])


def check_patch(run, kind):
    for layout in list(MESHES)[:3:2] if kind in PASS_PATCH else list(MESHES)[:1]:
        blocks = static_patch.Blocks(*MESHES[layout][:2], scenes.YOUNG, MESHES[layout][2])
        for friction in (0.0, 0.5):
            pressure = 1.0e-4
            result = run.program(scenes.pressed_blocks(kind, blocks, friction, pressure))
            error = scenes.patch_error(result, blocks, pressure, 0.3 * pressure if friction else 0.0)
            name = f"type {kind}, patch {layout}, friction {friction}: tractions of both sides"
            if kind in PASS_PATCH:
                run.check(name, error, 0.0)
            else:
                run.report(name, error)


def check_discs(run, kind):
    for layout in list(MESHES)[:3:2] if kind in PASS_PATCH else list(MESHES)[:1]:
        blocks = static_patch.Blocks(*MESHES[layout][:2], scenes.YOUNG, MESHES[layout][2])
        result = run.program(scenes.pressed_discs(kind, blocks, 1.0e-4))
        error = scenes.disc_error(result, blocks, 1.0e-4)
        name = f"type {kind}, patch of discs {layout}: axial tractions of both sides"
        if kind in PASS_PATCH:
            run.check(name, error, 0.0)
        else:
            run.report(name, error)


def check_energy(run, name, result):
    table = result.table("glstat")
    run.check(f"{name}: energy ratio", table["energy_ratio"], 1.0)
    return table


def check_fork(run, kind):
    deck, x, _ = scenes.fork(kind)
    result = run.program(deck)
    name = f"type {kind}, U"
    table = check_energy(run, name, result)
    run.check(f"{name}: most energy in the springs / initial",
              np.max(table["contact"]) / table["total"][0], 0.05)
    run.check(f"{name}: energy in the springs at the end / most",
              table["contact"][-1] / np.max(table["contact"]), 0.0)
    partner = np.array([np.argmin(np.abs(x - [0.9 - a, b]).sum(axis=1)) for a, b in x])
    moved = result.points("displacement")[..., :2]
    run.check(f"{name}: arm against arm", moved[:, partner] * [-1.0, 1.0], moved)


def check_arms(run, kind):
    """Contact lasts 2 L/c, L the thickness of the arms, under the pressure rho c v."""
    deck, x, inner = scenes.arms(kind)
    result = run.program(deck)
    name, lasting = f"type {kind}, flat arms", 2.0 * scenes.ARM / scenes.ARM_SOUND
    time, force = result.times, result.points("contact_force")[:, inner, 0]
    pressure = -force.mean(axis=1) / (scenes.ARM / scenes.N_ARM) / (scenes.RHO * scenes.ARM_SOUND * scenes.ARM_SPEED)
    first, last = np.nonzero(pressure > 0.5)[0][[0, -1]]

    def passing(a, b):
        return time[a] + (0.5 - pressure[a]) / (pressure[b] - pressure[a]) * (time[b] - time[a])

    run.check(f"{name}: contact lasts", passing(last, last + 1) - passing(first - 1, first),
              lasting)
    inside = (time > time[first] + 0.2 * lasting) & (time < time[first] + 0.8 * lasting)
    run.check(f"{name}: mean pressure", pressure[inside].mean(), 1.0)
    run.check(f"{name}: pressure at the end", pressure[-1], 0.0)
    check_energy(run, name, result)


def check_ring(run, kind):
    deck, x, quads = scenes.ring(kind)
    result = run.program(deck)
    name = f"type {kind}, ring pressed flat"
    check_energy(run, name, result)
    moved = result.points("displacement")[..., :2]
    deep = scenes.deepest(x + moved[-1], quads)
    run.check(f"{name}: deepest node / element", deep / 0.05, 0.0)
    turn = np.array([np.argmin(np.abs(x + a).sum(axis=1)) for a in x])
    inner = np.linalg.norm(result.points("contact_force")[-1, :64], axis=1)
    run.check(f"{name}: largest force on the inner side", np.max(inner), 1.0)
    error = np.max(np.abs(moved + moved[:, turn]), axis=(1, 2))
    run.check(f"{name}: turned by half a turn", error, 0.0)


def check_tube(run, kind, is_axisymmetric, text="", **words):
    deck, x, quads = scenes.tube(kind, is_axisymmetric, **words)
    result = run.program(deck)
    name = f"type {kind}, folding {'tube' if is_axisymmetric else 'strip'}{text}"
    table = check_energy(run, name, result)
    run.true(f"{name}: ends normally", "N o r m a l" in result.stdout)
    run.check(f"{name}: contact makes no energy, over the work done",
              table["contact"] / np.max(table["external_work"]), -0.01)
    deep = scenes.deepest(x + result.points("displacement")[-1, :, :2], quads)
    run.check(f"{name}: deepest node / element", deep * words.get("layers", 2), 0.0)


def check_mean_force(run, kind, speed=30.0):
    """The mean force of folds without hardening: Alexander's formula, whose folds close over all of their length, on the
    shorter way over which folds of this thickness close."""
    result = run.program(scenes.tube(kind, True, crushed=0.72, speed=speed, hardening=1.0)[0])
    energies = result.table("glstat")
    way, diameter, thickness, stress = speed * energies["time"], 40.0, 1.0, 300.0
    formula = stress * thickness * np.sqrt(np.pi * diameter * thickness / (2.0 * np.sqrt(3.0)))  # of a radian
    closes = 0.86 - 0.57 * np.sqrt(thickness / diameter)
    mean = np.interp(np.array([0.4, 0.5, 0.6, 0.7]) * 40.0, way[1:], (energies["external_work"] - energies["kinetic"])[1:] / way[1:])
    run.check(f"type {kind}, folding tube: mean force over 0.4 to 0.7 of the length", mean,
              formula / closes)
    run.check(f"type {kind}, folding tube: kinetic energy / work",
              energies["kinetic"][-1] / energies["external_work"][-1], 0.0)


def check_tumbling(run, kind):
    deck, x, quads = scenes.tumbling_ring(kind)
    result = run.program(deck)
    name = f"type {kind}, tumbling ring one element thick"
    check_energy(run, name, result)
    run.check(f"{name}: contact force", result.points("contact_force"), 0.0)


def check_many(run, kind):
    bodies = scenes.octagons(7, 7, 1)
    deck = scenes.with_itself(scenes.free_bodies(bodies, 0.15, STEP), range(1, 50), kind, scenes.PENALTY, 1)
    result = run.program(deck)
    name = f"type {kind}, 49 bodies"
    check_energy(run, name, result)
    mass = np.concatenate([lumped_mass(x, q, scenes.RHO) for x, q, _ in bodies])
    position, velocity = result.points("Points")[..., :2], result.points("velocity")[..., :2]
    momentum = np.einsum("n,tnk->tk", mass, velocity)
    size = np.sum(mass * np.linalg.norm(velocity[0], axis=1))
    run.check(f"{name}: momentum, drift / sum |p|", (momentum - momentum[0]) / size, 0.0)
    turning = angular_momentum(mass, position, velocity)
    if kind in MOMENT_FREE:
        run.check(f"{name}: angular momentum, drift / (sum |p| x 1 m)",
                  (turning - turning[0]) / size, 0.0)


def check(run):
    for kind in TYPES:
        check_two_bodies(run, kind)
        check_patch(run, kind)
        check_discs(run, kind)
        check_ring(run, kind)
    for kind, is_axisymmetric in run.cover(TYPES, (False, True), strength=1):
        check_tube(run, kind, is_axisymmetric, " one element thick, crushed by 0.9", layers=1, points=4, crushed=0.9,
                   speed=60.0 if is_axisymmetric else 100.0)
    for kind in (5, 6, 7) if run.is_full else (5,):
        check_tube(run, kind, True, " of two one-point elements, crushed by 0.9", crushed=0.9)
    check_mean_force(run, 5)
    for kind in (1, 3, 4, 5, 7) if run.is_full else (1, 4, 7):
        check_arms(run, kind)
    for kind in (1, 4, 7):
        check_fork(run, kind)
        check_tumbling(run, kind)
    for kind in (1, 5, 7):
        check_names(run, kind)
    check_many(run, 5)
