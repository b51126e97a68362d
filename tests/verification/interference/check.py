# SPDX-License-Identifier: MIT
"""Press fits by LCINT against Lame: plane and round, all types, both drivers."""
import numpy as np

from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid, grid_quads

YOUNG, POISSON, RHO, BORE, OUTER = 1000.0, 0.3, 1.0, 0.5, 2.0
PENALTY = 2.0e4    # N/m^3 with PUNIT 1
SMALL = 1.0e-7     # interference over the radius: what is not linear is of this size
DECAY, STEP = 40.0, 5.0e-4
CURVE = 7


def lame(interference, held=True, bore=0.0, springs=PENALTY):
    """Pressure of a shaft (with a bore) in a hub of the same material, radius 1 in 1 to 2, with a layer of springs."""
    ends = 1.0 - POISSON ** 2 if held else 1.0
    ratio = POISSON / (1.0 - POISSON) if held else POISSON
    shaft = ((1.0 + bore ** 2) / (1.0 - bore ** 2) - ratio) * ends / YOUNG
    hub = ((OUTER ** 2 + 1.0) / (OUTER ** 2 - 1.0) + ratio) * ends / YOUNG
    return interference / (shaft + hub + 1.0 / springs)


def springs_of(kind, penalty=PENALTY):
    """N/m^3: two passes are two layers."""
    return penalty * (2.0 if kind == 3 else 1.0)


def contact(deck, kind, penalty, grows, sides=(-1, -2)):
    """The interface; its overlap grows over the curve or is there from the start."""
    deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, 4, penalty), (0.0, 1.0e20, 1),
             (0.0, 1.0, 0, None, None, CURVE if grows else 0))


def driver(deck, end, steps, points):
    """Explicit without steps, else static steps."""
    if steps:
        deck.add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, end / steps))
    else:
        deck.control(end, dt=STEP).hourglass(4, 0.1).add("*DAMPING_GLOBAL", (0, 60.0))
    deck.add("*SECTION_SHELL", (1, *points, None, 4 if steps else None), (1.0,))
    for part in (1, 2):
        deck.part(part, section=1).elastic(RHO, YOUNG, POISSON, part)
    return deck


def axisymmetric_fit(kind, rows, interference, held=True, grows=True, steps=0, penalty=PENALTY, columns=8):
    """A shaft too thick by the interference in a hub, ELFORM 15; the overlap grows over a third of the run."""
    end = 1.0 if steps else DECAY / 6.0
    deck = driver(Deck(f"round press fit, type {kind}"), end, steps, (15,))
    deck.curve(CURVE, [(0.0, 0.0), (end if steps else end / 3.0, 1.0)])
    shaft = deck.mesh(*grid(columns, rows[0], 1.0 + interference, 1.0), part=1).reshape(rows[0] + 1, columns + 1)
    hub = deck.mesh(*grid(columns, rows[1], OUTER - 1.0, 1.0, (1.0, 0.0)), part=2).reshape(rows[1] + 1, columns + 1)
    deck.node_set(1, shaft[:, -1]).node_set(2, hub[::-1, 0])
    deck.fix([*shaft[0], *hub[0], *([*shaft[-1], *hub[-1]] if held else [])], y=1)
    contact(deck, kind, penalty, grows)
    every = end / (steps or 40)
    return deck.output(plot=end, glstat=every, rcforc=every), shaft[:, -1], hub[:, 0]


def arc_grid(n_r, n_t, inner, outer):
    """A quarter of a ring, rows of nodes from the x axis to the y axis."""
    r, angle = np.linspace(inner, outer, n_r + 1), 0.5 * np.pi * np.arange(n_t + 1) / n_t
    place = np.array([(a * np.cos(t), a * np.sin(t)) for t in angle for a in r])
    place[np.abs(place) < 1e-12] = 0.0
    return place, grid_quads(n_r, n_t)


def plane_fit(kind, columns, interference, grows=True, steps=10, rows=8, outlines=False):
    """Quarters of two rings in plane strain."""
    end = 1.0 if steps else DECAY / 6.0
    deck = driver(Deck(f"plane press fit, type {kind}"), end, steps, (13,))
    deck.curve(CURVE, [(0.0, 0.0), (end if steps else end / 3.0, 1.0)])
    rings = []
    for part, (n_t, inner, outer) in enumerate([(columns[0], BORE, 1.0 + interference), (columns[1], 1.0, OUTER)], 1):
        ring = deck.mesh(*arc_grid(rows, n_t, inner, outer), part=part).reshape(n_t + 1, rows + 1)
        deck.fix(ring[0], y=1).fix(ring[-1], x=1)
        rings.append(ring)
    deck.node_set(1, rings[0][:, -1]).node_set(2, rings[1][::-1, 0])
    deck.add("*SET_2D_SEGMENT", (11,), (1,)).add("*SET_2D_SEGMENT", (12,), (2,))
    contact(deck, kind, PENALTY, grows, (11, 12) if outlines else (-1, -2))
    every = end / (steps or 40)
    return deck.output(plot=end, glstat=every, rcforc=every), rings[0][:, -1], rings[1][:, 0]


def axisymmetric_pressure(result, nodes):
    """Radial contact force over the integral of r by the hat functions of a straight chain in y."""
    force = np.abs(result.points("contact_force")[-1, nodes - 1, 0])
    place = result.points("Points")[-1, nodes - 1]
    length, r, area = np.diff(place[:, 1]), place[:, 0], np.zeros(len(nodes))
    area[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    area[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return force / area


def check_growth(run, name, result, pressure, interference, area, tol):
    """Nothing at the start; at the end half of pressure times interference is what bodies and springs hold, damping has
    the rest of what the curve has done, and energies balance."""
    energy = result.table("glstat")
    run.check(f"{name}: forces at the start", result.points("contact_force")[0], 0.0)
    run.check(f"{name}: work of the curve but for damping", energy["external_work"][-1] - energy["damping"][-1],
              0.5 * pressure * interference * area, tol=tol)
    run.true(f"{name}: no warning", "warning" not in (result.folder / f"{result.job}.log").read_text())
    run.check(f"{name}: energy balance", energy["total"][-1], energy["external_work"][-1])


def check_axisymmetric(run, kind, steps, held=True, penalty=PENALTY):
    name = f"round, {TYPES[kind]}, {'static' if steps else 'explicit'}, ends {'held' if held else 'free'}"
    deck, shaft, hub = axisymmetric_fit(kind, (4, 5), SMALL, held, steps=steps, penalty=penalty)
    result = run.program(deck)
    wanted = lame(SMALL, held, springs=springs_of(kind, penalty))
    sides = {"shaft": axisymmetric_pressure(result, shaft), "hub": axisymmetric_pressure(result, hub)}
    for side, pressure in sides.items():
        if kind in PASS_PATCH:
            run.check(f"{name}: pressure on the {side}", pressure, wanted)
        else:
            run.report(f"{name}: largest |p/p_Lame - 1| on the {side}", np.max(np.abs(pressure / wanted - 1.0)))
    mean = np.mean(sides["shaft"])
    run.check(f"{name}: mean pressure", mean, wanted)
    check_growth(run, name, result, wanted, SMALL, 1.0, 5e-3)
    if not steps:
        force = np.abs(result.table("rcforc").where(side="slave")["fx"])
        run.report(f"{name}: largest force on the way over that at the end", force.max() / force[-1])
        kinetic = result.table("glstat")["kinetic"].max() / result.table("glstat")["external_work"][-1]
        run.report(f"{name}: largest kinetic energy over the work of the curve", kinetic)


def check_plane(run, kind, columns, steps=10, outlines=False, interference=1.0e-6):
    matching = columns[0] == columns[1]
    # Where chords of both rings do not fall together, gaps vary by their height.
    tol = 1e-2 if matching else (1.0 - np.cos(0.25 * np.pi / min(columns))) / interference
    name = (f"plane, {TYPES[kind]}, {columns[0]}/{columns[1]}, {'static' if steps else 'explicit'}"
            + (", whole outlines" if outlines else ""))
    results = {}
    for grows in (True, False) if steps and matching else (True,):
        deck, shaft, hub = plane_fit(kind, columns, interference, grows, steps, outlines=outlines)
        results[grows] = run.program(deck)
    # The circles that enclose as much as the chords do.
    radii = [np.sqrt(np.sin(0.5 * np.pi / n) / (0.5 * np.pi / n)) for n in columns]
    overlap = (1.0 + interference) * radii[0] - radii[1]
    wanted = lame(overlap, bore=BORE, springs=springs_of(kind))
    result = results[True]
    force = result.points("contact_force")[-1, shaft - 1]
    found = np.sum(np.abs(force[:, 0]))
    run.check(f"{name}: sum of forces", found, wanted, tol=tol)
    check_growth(run, name, result, wanted, overlap, 0.5 * np.pi, tol)
    if steps and kind == 3:
        # Nodes of the hub stand under the corners of the shaft: round-off says which of two normals they have.
        a, b = (results[grows].points("contact_force")[-1] for grows in (True, False))
        run.report(f"{name}: difference of forces to the overlap there from the start", np.abs(a - b).max() / np.abs(b).max())
    elif steps and matching:
        for field in ("displacement", "contact_force"):
            run.check(f"{name}: {field} at the end", result.points(field)[-1],
                      results[False].points(field)[-1])


def check(run):
    for kind in TYPES:
        check_axisymmetric(run, kind, 0)
        check_axisymmetric(run, kind, 10)
        check_axisymmetric(run, kind, 0, held=False)
        check_plane(run, kind, (16, 16))
    for kind in sorted(PASS_PATCH):
        check_plane(run, kind, (64, 48), interference=3.0e-3)
    check_plane(run, 5, (16, 16), steps=0)
    check_plane(run, 7, (16, 16), steps=0, outlines=True)
