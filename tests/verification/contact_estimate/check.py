# SPDX-License-Identifier: MIT
"""How good is this answer: the estimate of contact against states whose pressures and stresses are known."""
import re

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid
from patch_layouts import load_edges, lines

YOUNG, RHO, PRESSURE, SOFT = 1.0e6, 1000.0, 1.0, 1.0e7
FAIL = sorted(set(TYPES) - set(PASS_PATCH) - {6})
PULL, DAMPING = 0.01, 20.0  # of the bars, m/s^2 and 1/s


def blocks(title, meshes, form=13, points=4, implicit=True, every=(1.0, 1.0, 1.0)):
    """Deck of two bodies, lower and upper, and the node ids of each; sleout, states and rcforc `every` so long."""
    deck = Deck(title)
    if implicit:
        deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.add("*SECTION_SHELL", (1, form, None, points), (1.0,))
    ids = []
    for part, mesh in enumerate(meshes, 1):
        deck.part(part, section=1).elastic(RHO, YOUNG, 0.0, part)
        ids.append(deck.mesh(*mesh, part=part))
    sleout, plot, rcforc = every
    return deck.add("*DATABASE_SLEOUT", (sleout,)).output(plot=plot, glstat=1.0, rcforc=rcforc), *ids


def patch(kind, form=13, skew=0.35):
    """5 columns upon 4 under a uniform pressure; discs where the form is that of bodies of revolution."""
    upper, lower = (static_patch.block_grid(lines(n, skew), bottom) for n, bottom in ((5, 0.0), (4, -1.0)))
    deck, below, above = blocks(f"patch, type {kind}", (lower, upper), form)
    deck.curve(1, [(0.0, 0.0), (1.0, PRESSURE)]).fix(below[:5], y=1)
    if form == 13:
        deck.fix([below[2], above[-3]], x=1)
    load_edges(deck, above[-6:])
    deck.node_set(1, above[:6]).node_set(2, below[:-6:-1])
    return deck.contact(1, 2, kind, SOFT, unit=1)


def final(result, name="sleout"):
    rows = result.table(name)
    return rows.where(time=rows["time"][-1])


def independent(result, slave, master):
    """The same from the fields of the states: nodal pressures, and stresses of the two rows behind, which are
    flat and of equal height."""
    misfit, load = 0.0, 0.0
    place, pressure = (result.points(name)[-1] for name in ("Points", "contact_pressure"))
    stress = -result.cells("stress")[-1][:, 1]
    for nodes, rows in (slave, master):
        x = place[np.asarray(nodes) - 1, 0]
        half = 0.5 * np.abs(np.diff(x))
        face = 1.5 * stress[rows[0]] - 0.5 * stress[rows[1]]
        area, carried = np.zeros(len(x)), np.zeros(len(x))
        for k, (width, value) in enumerate(zip(half, face)):
            area[k:k + 2] += width
            carried[k:k + 2] += width * value
        p = pressure[np.asarray(nodes) - 1]
        misfit += np.sum((p - carried / area) ** 2 * area, where=p != 0)
        load += np.sum(p ** 2 * area)
    return np.sqrt(misfit / load)


def check_patch(run):
    for kind, form in run.cover(PASS_PATCH, (13, 15), strength=2):
        result = run.program(patch(kind, form))
        text = f"{TYPES[kind]}, {'discs' if form == 15 else 'blocks'}"
        run.check(f"{text}: estimate of a uniform state", final(result)["estimate"], 0.0)
        run.check(f"{text}: row stress at each slave node", final(result, "contact")["row_stress"],
                  PRESSURE)
    for kind in FAIL:
        result = run.program(patch(kind))
        lower, upper = np.arange(16).reshape(4, 4), 16 + np.arange(25).reshape(5, 5)
        wanted = independent(result, (np.arange(26, 32), upper[:2]), (np.arange(21, 26), lower[:-3:-1]))
        run.check(f"{TYPES[kind]}: estimate where the patch test fails", final(result)["estimate"],
                  wanted)
        run.check(f"{TYPES[kind]}: and it is no small number", final(result)["estimate"], 1e-3)


def check_held(run):
    """A body that is held everywhere has no stress to be judged by."""
    upper, lower = (static_patch.block_grid(lines(n, 0.35), bottom) for n, bottom in ((5, 0.0), (4, -1.0)))
    deck, below, above = blocks("held", (lower, upper))
    deck.curve(1, [(0.0, 0.0), (1.0, PRESSURE)]).fix(below, x=1, y=1).fix([above[-3]], x=1)
    load_edges(deck, above[-6:])
    deck.node_set(1, above[:6]).node_set(2, below[:-6:-1]).contact(1, 2, 5, SOFT, unit=1)
    run.check("pressed on a held body: estimate", final(run.program(deck))["estimate"], 0.0)


def column(rows, weight):
    """Two unit squares of `rows` elements each, one above the other, under their own weight."""
    deck, below, above = blocks(f"column, {rows} rows", (grid(1, rows, origin=(0.0, -1.0)), grid(1, rows)))
    deck.curve(1, [(0.0, 0.0), (1.0, weight / RHO)]).add("*LOAD_BODY_Y", (1,))
    deck.fix(below[:2], y=1).fix([below[0], above[0]], x=1)
    return deck.node_set(1, above[:2]).node_set(2, below[:-3:-1]).contact(1, 2, 5, SOFT, unit=1)


def check_column(run):
    """One element each: p = W, the stress in the middles is W/2 and 3 W/2. Two rows: linear, so exact."""
    weight = 1.0
    one, two = (run.program(column(rows, weight)) for rows in (1, 2))
    strain = weight / YOUNG
    run.check("two squares under their weight: estimate", final(one)["estimate"], 0.5, scale=strain)
    run.check("two squares: energy of the elements", final(one)["row_energy"],
              0.5 * (0.5 ** 2 + 1.5 ** 2) * weight ** 2 / YOUNG, scale=strain)
    run.check("two squares: energy of the springs", final(one)["stored"], 0.5 * weight ** 2 / SOFT,
              scale=strain)
    run.check("two squares: row stress of the slave", final(one, "contact")["row_stress"], 0.5 * weight, scale=strain)
    run.check("two rows each: estimate", final(two)["estimate"], 0.0, scale=strain)
    log = (one.folder / f"{one.job}.log").read_text()
    reported = re.search(r"interface 1: contact pressure and the stress behind it differ by ([\d.]+) %.*springs store "
                     r"([\d.]+) times", log)
    run.check("the summary tells the same", [float(one) for one in reported.groups()],
              [50.0, 0.5 / 1.25 * 0.1])


def check_shared(run):
    """Two interfaces on the same faces, roles exchanged too: what both press is what the elements bear."""
    upper, lower = (static_patch.block_grid(lines(n, 0.35), bottom) for n, bottom in ((5, 0.0), (4, -1.0)))
    for text, second, kind in (("same roles", (1, 2), 5), ("roles exchanged", (2, 1), 7)):
        deck, below, above = blocks(text, (lower, upper))
        deck.curve(1, [(0.0, 0.0), (1.0, PRESSURE)]).fix(below[:5], y=1)
        deck.fix([below[2], above[-3]], x=1)
        load_edges(deck, above[-6:])
        deck.node_set(1, above[:6]).node_set(2, below[:-6:-1])
        result = run.program(deck.contact(1, 2, kind, 0.3 * SOFT, unit=1).contact(*second, kind, 0.7 * SOFT, unit=1))
        run.check(f"two interfaces, {text}: estimate of each", final(result)["estimate"], 0.0)


def check_waves(run):
    """Two bars of one or several elements collide: pressure less the stress is mass times acceleration, nothing else.

    Body loads and damping act on the masses of each row: they are no part of it.
    """
    for columns, acted_on in ((1, False), (6, False), (1, True), (6, True)):
        name = f"bars of {columns} columns" + ", pulled and damped" * acted_on
        deck, left, right = blocks(name, (grid(columns, 1, 1.0, 0.2, (-1.0, 0.0)),
                                                                  grid(columns, 1, 1.0, 0.2)), points=None, implicit=False,
                                   every=(1.0e-4, 1.0, 1.0))
        deck.control(0.1, scale=0.5)
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 1.0e-3, 0.0) for node in left])
        deck.node_set(1, left[columns::columns + 1]).node_set(2, right[::columns + 1][::-1]).contact(1, 2, 5, 0.5, unit=3)
        if acted_on:
            deck.curve(1, [(0.0, PULL), (1.0, PULL)]).add("*LOAD_BODY_X", (1,)).curve(2, [(0.0, DAMPING), (1.0, DAMPING)])
            deck.add("*DAMPING_PART_MASS", (1, 2)).add("*DAMPING_PART_MASS", (2, 2))
        result = run.program(deck)
        reported = re.search(r"differ by ([\d.]+) % .*, without waves by ([\d.]+) %", (result.folder / f"{result.job}.log").read_text())
        run.check(f"{name}: estimate", float(reported[1]), 5.0)
        run.check(f"{name}: without waves", float(reported[2]), 0.0)


def check_step(run):
    """Explicit: the step that springs rule (ECDT 2) is TSSFAC of the step that sleout tells."""
    deck, below, above = blocks("step", (grid(1, 1, origin=(0.0, -1.0)), grid(1, 1)), points=None, implicit=False)
    deck.control(0.1).add("*CONTROL_CONTACT", "", (0, 0, 0, 0, 0, 0, 2))
    deck.node_set(1, above[:2]).node_set(2, below[:-3:-1]).contact(1, 2, 5, 1.0e8, unit=1)
    result = run.program(deck)
    run.check("step over TSSFAC of the stable step",
              final(result, "glstat")["dt"] / final(result)["step_limit"], 0.9)


def check_roughness(run):
    """Second differences of the force over all instants, those of sleout and of plot states, from its history."""
    deck, below, above = blocks("roughness", (grid(2, 2, origin=(0.0, -1.0)), grid(2, 2)), points=None, implicit=False,
                                every=(5.0e-3, 7.0e-3, 1.0e-3))
    deck.control(0.2, dt=1.0e-3).fix(below[:3], x=1, y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 0.0, -1.0) for node in above])
    deck.node_set(1, above[:3]).node_set(2, below[:-4:-1]).contact(1, 2, 1, 1.0e6, unit=1)
    result = run.program(deck)
    slave = result.table("rcforc").where(side="slave")
    force = np.stack([slave["fx"], slave["fy"]], 1)
    instants = sorted({round(time / 1.0e-3) for time in (*result.table("sleout")["time"], *result.times)} - {0})
    jumps = forces = 0.0
    for a, b, c in zip(instants, instants[1:], instants[2:]):
        r = (c - b) / (b - a)
        jumps += np.sum((force[c] - force[b] - r * (force[b] - force[a])) ** 2) / (1 + (1 + r) ** 2 + r ** 2)
        forces += np.sum(force[c] ** 2)
    log = (result.folder / f"{result.job}.log").read_text()
    reported = float(re.search(r"noise of the force ([\d.]+) %", log)[1])
    run.check("roughness of the force in the summary, two series of instants", reported,
              100.0 * np.sqrt(jumps / forces))


def check(run):
    check_roughness(run)
    check_patch(run)
    check_held(run)
    check_column(run)
    check_shared(run)
    check_waves(run)
    check_step(run)
