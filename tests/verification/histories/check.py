# SPDX-License-Identifier: MIT
"""History files against closed forms."""
import numpy as np

from meshes import Deck, grid, lumped_mass, moduli

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3
BULK, SHEAR, _ = moduli(YOUNG, POISSON)


def check_stretch(run, points):
    """Uniaxial strain to 1.2 of two elements in line, the second of which is in elout."""
    name = "four points" if points else "one point"
    deck = Deck("uniaxial strain")
    deck.control(1.0, dt=0.01).part(points=points).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(2, 1, 2.0, 1.0))
    deck.curve(1, [(0.0, 0.0), (1.0, 0.2)])
    deck.fix(nodes, y=1).fix(nodes[[0, 3]], x=1)
    for node, factor in zip(nodes[[1, 4, 2, 5]], (1.0, 1.0, 2.0, 2.0)):
        deck.prescribe(node, 1, 2, 1, factor)
    deck.add("*DATABASE_HISTORY_SHELL", (2, 0)).add("*DATABASE_ELOUT", (0.1,))
    table = run.program(deck, name=f"stretch_{points or 1}").table("elout")
    run.check(f"elout, {name}: elements", table["element"], np.full(11, 2.0))
    strain = np.log(1.0 + 0.2 * table["time"])
    along, across = (BULK + 4.0 * SHEAR / 3.0) * strain, (BULK - 2.0 * SHEAR / 3.0) * strain
    run.check(f"elout, {name}: stress in uniaxial strain", np.stack([table[c] for c in ("sxx", "syy", "szz")]),
              np.stack([along, across, across]))
    run.check(f"elout, {name}: shear stress / stress", table["sxy"] / along[-1], np.zeros(11))


def check_shear(run):
    """Simple shear beyond yield, no hardening."""
    yield_stress, gamma = 1.0e3, 0.02
    deck = Deck("simple shear")
    deck.control(1.0, dt=0.001).part().plastic(RHO, YOUNG, POISSON, yield_stress)
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, [(0.0, 0.0), (1.0, gamma)])
    deck.fix(nodes, y=1).fix(nodes[:2], x=1)
    for node in nodes[2:]:
        deck.prescribe(node, 1, 2, 1)
    deck.add("*DATABASE_HISTORY_SHELL", (1, 0)).add("*DATABASE_ELOUT", (0.1,))
    table = run.program(deck, name="shear").table("elout")
    bound = yield_stress / np.sqrt(3.0)
    first = bound / SHEAR
    now = gamma * table["time"]
    run.check("elout: shear stress beyond yield", table["sxy"], np.minimum(SHEAR * now, bound))
    run.check("elout: plastic strain", table["plastic_strain"],
              np.maximum(0.0, now - first) / np.sqrt(3.0))


def rigid_body(end_time, dt):
    """A rigid rectangle; its deck, mass, centre and moment of inertia of the lumped masses."""
    deck = Deck("rigid rectangle")
    deck.control(end_time, dt=dt).part().add("*MAT_RIGID", (1, RHO, YOUNG, POISSON), (0.0,), (0.0,))
    coordinates, quads = grid(3, 2, 1.5, 0.8, (4.0, -1.0))
    deck.mesh(coordinates, quads)
    mass = lumped_mass(coordinates, quads, RHO)
    centre = mass @ coordinates / mass.sum()
    return deck, mass.sum(), centre, mass @ ((coordinates - centre) ** 2).sum(axis=1)


def check_body(run):
    """Constant force and moment from rest; free flight with spin."""
    deck, mass, centre, inertia = rigid_body(1.0, 1.0e-3)
    force, moment = np.array([300.0, -200.0]), 500.0
    deck.curve(1, [(0.0, 1.0), (2.0, 1.0)])
    deck.add("*LOAD_RIGID_BODY", (1, 1, 1, force[0]), (1, 2, 1, force[1]), (1, 7, 1, moment))
    deck.add("*DATABASE_RBDOUT", (0.05,))
    table = run.program(deck, name="pushed").table("rbdout")
    time = table["time"]
    rate = np.array([*(force / mass), moment / inertia])[:, None]
    pairs = (("ax", "ay", "spin_rate", 1.0 + 0.0 * time), ("vx", "vy", "spin", time),
             ("ux", "uy", "rotation", 0.5 * time ** 2))
    for *columns, factor in pairs:
        run.check(f"rbdout: {', '.join(columns)} under a constant force and moment",
                  np.stack([table[c] for c in columns]), rate * factor)
    run.check("rbdout: centre of mass", np.stack([table["x"] - table["ux"], table["y"] - table["uy"]]),
              centre[:, None] + 0.0 * time)
    deck, _, centre, _ = rigid_body(2.0, 1.0e-3)
    deck.add("*INITIAL_VELOCITY_RIGID_BODY", (1, 0.5, 0.25, 0.0, 0.0, 0.0, 7.0)).add("*DATABASE_RBDOUT", (0.05,))
    table = run.program(deck, name="spins").table("rbdout")
    time = table["time"]
    run.check("rbdout: angle of a free spin, two turns", table["rotation"], 7.0 * time)
    run.check("rbdout: place of its centre", np.stack([table["x"], table["y"]]),
              centre[:, None] + np.array([[0.5], [0.25]]) * time)


def pushed_bar(static):
    """A bar under a nodal load and a pressure at one end, prescribed motion at the other; histories of both."""
    deck = Deck("bar under all boundaries")
    deck.control(0.02, dt=1.0e-4).part(points=4).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(*grid(8, 2, 0.8, 0.2))
    left, right = nodes[::9], nodes[8::9]
    deck.node_set(1, left).node_set(2, nodes)
    deck.curve(1, [(0.0, 0.0), (0.02, 0.004)]).curve(2, [(0.0, 0.0), (0.01, 1.0), (1.0, 1.0)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (1, 1, 2, 1, 1.0))
    deck.fix([left[0]], y=1)
    deck.add("*LOAD_NODE_POINT", (int(right[1]), 1, 2, -50.0), (int(right[1]), 2, 2, 20.0))
    deck.add("*LOAD_SEGMENT", *[(2, 1.0e3, 0.0, int(a), int(b)) for a, b in zip(right[:-1], right[1:])])
    if static:
        deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0e-3)).add("*CONTROL_IMPLICIT_SOLUTION", (12, 0, 30, 0.0, 1e-22))
    deck.add("*DATABASE_NODAL_FORCE_GROUP", (1, 0), (2, 0))
    for name in ("BNDOUT", "NODFOR", "SPCFORC", "MATSUM"):
        deck.add(f"*DATABASE_{name}", (1.0e-4,))
    return deck.output(glstat=1.0e-4)


def check_boundaries(run, static):
    """Works against the energy account; forces against the balance of momentum or of forces."""
    name = "implicit" if static else "explicit"
    result = run.program(pushed_bar(static), name=f"bar_{name}")
    table, energies = result.table("bndout"), result.table("glstat")
    n = int(np.sum(table["time"] == 0.0))
    work = table["work"].reshape(-1, n).sum(axis=1)
    run.check(f"bndout, {name}: sum of all works", work, energies["external_work"])
    pressure = table.where(condition=3)
    factor = np.minimum(pressure["time"].reshape(-1, 3)[:, 0] / 0.01, 1.0)
    stretch = pressure["fx"].reshape(-1, 3).sum(axis=1)
    run.check(f"bndout, {name}: pressure on the end", -stretch[1:], 1.0e3 * 0.2 * factor[1:])
    load = table.where(condition=1)
    run.check(f"bndout, {name}: nodal load", np.stack([load["fx"], load["fy"]]),
              np.stack([-50.0 * factor, 20.0 * factor]))
    force = np.stack([table[c].reshape(-1, n).sum(axis=1) for c in ("fx", "fy")])
    support = result.table("spcforc")
    force[1] += support["fy"]
    groups = result.table("nodfor")
    all_nodes = groups.where(group=2)
    m = int(np.sum(all_nodes["time"] == 0.0))
    run.check(f"nodfor, {name}: sum over all nodes / load",
              np.stack([all_nodes[c].reshape(-1, m).sum(axis=1) for c in ("fx", "fy")]) / 50.0, np.zeros((2, len(work))))
    inner = energies["internal"] + energies["hourglass"] + energies["viscous"]
    run.check(f"nodfor, {name}: work of all nodes", all_nodes["work"].reshape(-1, m).sum(axis=1),
              inner)
    if static:
        run.check("bndout, implicit: forces balance / load", force[:, 1:] / 50.0, np.zeros_like(force[:, 1:]))
        return
    momentum = result.table("matsum")
    steps = 0.5 * np.diff(energies["time"]) * (force[:, 1:] + force[:, :-1])
    run.check("bndout, explicit: impulse of all forces in every step", np.cumsum(steps, axis=1),
              np.stack([momentum[c][1:] - momentum[c][0] for c in ("momentum_x", "momentum_y")]))


def check(run):
    check_stretch(run, None)
    check_stretch(run, 4)
    check_shear(run)
    check_body(run)
    for static in (False, True):
        check_boundaries(run, static)
