# SPDX-License-Identifier: MIT
"""Two spheres pressed together slowly, against Hertz (1881): caps of 8 mm of spheres of 50 mm."""
import numpy as np

from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid_quads

RADIUS, SIZE, YOUNG, POISSON, RHO = 50.0, 8.0, 2.0e4, 0.3, 1.0
STIFF, SINK, END, DT = 1.0e6, 0.04, 3.0, 1.2e-4
POINTS = 4


def graded(fine, reach):
    """Lines from 0 to SIZE: even up to `reach`, then growing."""
    lines = list(np.arange(0.0, reach + 0.5 * fine, fine))
    while lines[-1] < SIZE:
        lines.append(lines[-1] + 1.25 * (lines[-1] - lines[-2]))
    lines = np.array(lines)
    outer = lines > reach + 0.1 * fine
    lines[outer] = reach + (lines[outer] - reach) * (SIZE - reach) / (lines[-1] - reach)
    return lines


def cap(fine, sign):
    """Points row by row from the contact face, and quads, of the upper (1) or lower (-1) cap."""
    r, share = graded(fine, 1.6), graded(fine, 0.8) / SIZE
    face = RADIUS - np.sqrt(RADIUS ** 2 - r ** 2)
    points = np.array([(x, sign * (y + (SIZE - y) * t)) for t in share for x, y in zip(r, face)])
    quads = np.array(grid_quads(len(r) - 1, len(share) - 1))
    return r, points, quads if sign > 0 else quads[:, ::-1]


def spheres(kind):
    deck = Deck(f"spheres, type {kind}").control(END, dt=DT).hourglass(4, 0.05)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,))
    faces = []
    for part, fine, sign in ((1, 0.1, 1.0), (2, 0.12, -1.0)):
        r, points, quads = cap(fine, sign)
        deck.part(part, section=1).elastic(RHO, YOUNG, POISSON, part)
        ids = deck.mesh(points, quads, part=part).reshape(-1, len(r))
        faces.append(ids[0][::int(sign)])
        deck.node_set(part, faces[-1])
        if sign < 0.0:
            deck.fix(ids[-1], y=1)
            continue
        deck.curve(1, [(0.0, 0.0), (0.5 * END, 1.0), (2.0 * END, 1.0)])
        deck.node_set(3, ids[-1])
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 2, 2, 1, -SINK))
    deck.add("*DAMPING_GLOBAL", (0, 25.0)).output(plot=END, glstat=0.1, rcforc=0.1)
    return deck.contact(1, 2, kind, STIFF, unit=1, gauss=POINTS)


def check_spheres(run, kind):
    """Hertz by the force that the run has; what the caps are too small for is in the approach."""
    result = run.program(spheres(kind))
    last = result.table("contact")
    last = last.where(time=last["time"][-1])
    force = 2.0 * np.pi * result.table("rcforc").where(side="slave")["fy"][-1]
    modulus, radius = YOUNG / (2.0 * (1.0 - POISSON ** 2)), 0.5 * RADIUS
    a = (0.75 * force * radius / modulus) ** (1.0 / 3.0)
    peak = 1.5 * force / (np.pi * a ** 2)
    r = last["s"]
    wanted = peak * np.sqrt(np.maximum(0.0, 1.0 - (r / a) ** 2))
    name = f"{TYPES[kind]}, two spheres"
    pressure = last["pressure"]
    error = np.sqrt(np.sum(last["length"] * (pressure - wanted) ** 2) / np.sum(last["length"] * wanted ** 2))
    if kind not in PASS_PATCH:
        run.report(f"{name}: pressure on the axis over that of Hertz - 1", pressure[0] / peak - 1.0)
        run.report(f"{name}: pressure against Hertz, root mean square by area", error)
        return
    # Half spaces would have a = 1 mm: caps of 8 mm are stiffer. Strains p0/E* are 2.5 %.
    run.check(f"{name}: radius of contact by the force, mm", a, 1.0, 0.03, source="Hertz, approach 0.04 mm")
    run.check(f"{name}: pressure on the axis, MPa", pressure[0], peak, 0.05, source="Hertz, from the force")
    run.check(f"{name}: pressure, root mean square by area over that of Hertz", error, 0.0, 0.05, "abs",
              "Hertz, from the force")
