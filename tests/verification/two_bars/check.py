# SPDX-License-Identifier: MIT
"""Two equal elastic bars (nu = 0) meet end to end: all contact types."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, rotate, trapezoid

RHO, YOUNG, LENGTH, SPEED = 1000.0, 1.0e6, 1.0, 0.1
SOUND = np.sqrt(YOUNG / RHO)
DURATION = 2.0 * LENGTH / SOUND


def bars(n, kind, rows=1, gap=0.0, angle=0.0, origin=0.0, closed=False, plots=True):
    """Left bar moving with SPEED against the right one, which rests.

    n by `rows` square elements each, ends `gap` apart, turned by `angle`, moved by `origin` in
    x and y; `closed`: the surfaces are the whole boundaries (part sets) instead of the two ends.
    """
    size = LENGTH / n
    interval = DURATION / 400.0
    deck = Deck(f"two bars of {n} x {rows} elements, type {kind}")
    deck.control(2.0 * DURATION, scale=0.6)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    ends = []
    for part, start in ((1, -LENGTH - gap), (2, 0.0)):
        coordinates, quads = grid(n, rows, LENGTH, rows * size, (start, 0.0))
        if angle:
            coordinates = rotate(coordinates, angle)
        ends.append(deck.mesh(coordinates + origin, quads, part=part))
    deck.node_set(1, ends[0])
    deck.add("*INITIAL_VELOCITY", (1,), (SPEED * np.cos(angle), SPEED * np.sin(angle)))
    # half the stiffness of an element in front of each surface node
    if closed:
        deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
        deck.add("*CONTACT_2D_SLIDELINE", (1, 2, kind, 2, 0.25 * YOUNG), (0.0, 1.0e20, 0))
    else:
        deck.node_set(2, ends[0][n::n + 1]).node_set(3, ends[1][::n + 1][::-1])
        deck.contact(2, 3, kind, 0.25 * YOUNG)
    return deck.output(plot=4.0 * interval if plots else None, glstat=interval, matsum=interval, rcforc=interval)


def half_height_duration(time, force, plateau):
    """Time between the passages of half the plateau, up and down."""
    inside = np.flatnonzero(force > 0.5 * plateau)
    first, last = inside[0], inside[-1]

    def crossing(a, b):
        return time[a] + (0.5 * plateau - force[a]) / (force[b] - force[a]) * (time[b] - time[a])

    return crossing(last, last + 1) - (crossing(first - 1, first) if first else time[0])


def check_type(run, kind):
    name, n = TYPES[kind], 100
    result = run.program(bars(n, kind), name=f"type{kind}")
    height = LENGTH / n
    slave = result.table("rcforc").where(side="slave")
    plateau = 0.5 * RHO * SOUND * SPEED * height
    momentum = RHO * LENGTH * height * SPEED
    force = np.abs(slave["fx"])
    run.check(f"{name}: contact duration at half height",
              half_height_duration(slave["time"], force, plateau), DURATION)
    middle = np.abs(slave["time"] - 0.5 * DURATION) < 0.3 * DURATION
    run.check(f"{name}: contact force", force[middle].mean(), plateau)
    run.check(f"{name}: contact impulse", trapezoid(force, slave["time"]), momentum)
    run.check(f"{name}: duration from impulse over plateau",
              trapezoid(force, slave["time"]) / force[middle].mean(), DURATION)
    stress = result.cells("stress")[:, n // 2, 0]
    passing = np.abs(result.times - 0.5 * DURATION) < 0.15 * DURATION
    run.check(f"{name}: stress in the middle of the left bar", stress[passing].mean(),
              -0.5 * RHO * SOUND * SPEED)
    left = result.table("matsum").where(part=1)
    right = result.table("matsum").where(part=2)
    run.check(f"{name}: momentum left in the first bar / initial",
              left["momentum_x"][-1] / momentum, 0.0)
    run.check(f"{name}: momentum of the second bar", right["momentum_x"][-1], momentum)
    run.check(f"{name}: total momentum", left["momentum_x"] + right["momentum_x"], momentum)
    run.check(f"{name}: no force at the end", force[-1] / plateau, 0.0)
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"{name}: contact energy at the end / initial",
              energy["contact"][-1] / energy["total"][0], 0.0)
    run.report(f"{name}: internal energy left / initial", energy["internal"][-1]
               / energy["total"][0], "ringing after the release")


def check_places(run):
    """Turned, and far from the origin: the same collision."""
    n = 64  # sizes and origin are sums of few powers of two, so the moved mesh is the same mesh
    plain = run.program(bars(n, 2, rows=2, plots=False), name="plain").table("rcforc")
    far = run.program(bars(n, 2, rows=2, origin=2.0 ** 30, plots=False), name="far").table("rcforc")
    run.check("NTS-AR: force 1e9 m from the origin", far["fx"], plain["fx"])
    angle = 0.7
    turned = run.program(bars(n, 2, rows=2, angle=angle, plots=False), name="turned").table("rcforc")
    force = np.cos(angle) * turned["fx"] + np.sin(angle) * turned["fy"]
    peak = np.max(np.abs(plain["fx"]))
    run.check("NTS-AR: force of the turned bars / peak", force / peak, plain["fx"] / peak)
    across = np.cos(angle) * turned["fy"] - np.sin(angle) * turned["fx"]
    run.check("NTS-AR: force across the turned bars / peak", across / peak, 0.0)


def check_closed(run):
    """Whole boundaries as surfaces: nodes at flush corners drift by round-off only."""
    n = 50
    chosen = run.cover(TYPES, (1, 2, 3), (0.0, 0.0007, 0.001, 0.0011, 0.002))
    for kind, name in TYPES.items():
        exchanged = []
        for rows, gap in (row[1:] for row in chosen if row[0] == kind):
            result = run.program(bars(n, kind, rows=rows, gap=gap, closed=True, plots=False),
                                 name=f"closed{kind}_{rows}_{gap}")
            right = result.table("matsum").where(part=2)["momentum_x"][-1]
            exchanged.append(right / (RHO * LENGTH * rows * LENGTH / n * SPEED))
        run.check(f"{name}: momentum exchanged, part sets, 1 to 3 rows, five gaps", exchanged, 1.0)


def check(run):
    check_places(run)
    for kind in TYPES:
        check_type(run, kind)
    check_closed(run)
