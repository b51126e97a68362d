# SPDX-License-Identifier: MIT
"""Ties that break, explicit and implicit, against what springs with a strength must do."""
import numpy as np

from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid

YOUNG, RHO = 1.0e6, 1000.0
#: Penalty of the ties, N/m^2 per m, strengths in tension and in shear, N/m^2.
SPRING, STRENGTH = 1.0e6, (2.0e3, 3.0e3)
FRICTION = 0.4
STEP = 1.0e-4


def spring_of(kind):
    """Stiffness per area: type 3 has two passes."""
    return SPRING * (2.0 if kind == 3 else 1.0)


def tie(deck, kind, slave, master, friction=0.0, penalty=SPRING, strength=STRENGTH):
    deck.node_set(1, slave).node_set(2, master)
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, penalty, friction), (0.0, 1.0e20, 1),
             (0.0, 1.0, 2, *strength))


def led(run, kind, way, name):
    """Two unit blocks of unlike meshes, the upper one led as a whole along `way`: rows of time, u_x and u_y. Springs are
    all that gives way. Returns the result and, for each row of rcforc, the motion."""
    deck = Deck(f"tie that breaks, type {kind}, {name}")
    deck.control(way[-1][0], dt=STEP)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(*grid(7, 1), part=1)
    # five nodes of the lower block stand for the width of the upper one
    lower = deck.mesh(*grid(14, 1, 2.8, 1.0, (-0.9, -1.0)), part=2)
    tie(deck, kind, upper[:8], lower[:14:-1], FRICTION)
    deck.fix(lower, 1, 1)
    for dof in (1, 2):
        rows = [(row[0], row[dof]) for row in way]
        speed = [(time, (b[1] - a[1]) / (b[0] - a[0])) for a, b in zip(rows, rows[1:])
                 for time in (a[0] + 1e-3 * STEP, b[0] - 1e-3 * STEP)]
        deck.curve(dof, speed)
        for node in upper:
            deck.prescribe(node, dof, 0, dof)
    deck.output(plot=way[-1][0], glstat=STEP, rcforc=STEP)
    deck.add("*DATABASE_SLEOUT", (STEP,))
    result = run.program(deck, name=f"{name}_{kind}".replace(" ", "_"))
    row = result.table("rcforc").where(side="slave")
    time = np.array([row[0] for row in way])
    return result, row, [np.interp(row["time"], time, [row[dof] for row in way]) for dof in (1, 2)]


def check_ellipse(run, kind):
    """Led along a straight line: the place where it breaks, the force up to it, and what is spent."""
    k, (most_n, most_s) = spring_of(kind), STRENGTH
    places, forces, energies = [], [], []
    for degrees in (0.0, 25.0, 50.0, 75.0, 90.0):
        direction = np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])
        reach = 1.0 / (k * np.hypot(direction[1] / most_n, direction[0] / most_s))
        end = 1.25 * 100.0 * STEP
        way = [(0.0, 0.0, 0.0), (end, *(1.25 * reach * direction))]
        result, row, (ux, uy) = led(run, kind, way, f"{degrees:.0f} degrees")
        held = np.hypot(row["fx"], row["fy"]) > 0.0
        places.append(row["time"][np.nonzero(held)[0][-1]] / (0.8 * end))
        before = row["time"] <= 0.799 * end
        forces += [np.max(np.abs(row["fx"] + k * ux)[before]) / most_s, np.max(np.abs(row["fy"] + k * uy)[before]) / most_n]
        forces.append(np.max(np.abs(row["fx"])[row["time"] > 0.82 * end]) / most_s)
        energies.append(result.table("sleout")["energy"][-1] / (0.5 * k * reach ** 2))
        run.check(f"type {kind}: {degrees:.0f} degrees from tension, all places are broken",
                  result.table("contact").where(time=result.times[-1])["state"], 4.0)
    run.check(f"type {kind}: break on the ellipse, tension to shear", places, 1.0)
    run.check(f"type {kind}: forces up to the break, and none after", forces, 0.0)
    run.check(f"type {kind}: energy that stays in contact", energies, 1.0)


def check_again(run, kind):
    """Broken in tension, pressed again, and drawn along while pressed: contact with friction."""
    k, depth, way_along = spring_of(kind), 1.0e-3, 4.0e-3
    broken = 1.2 * STRENGTH[0] / k
    t = 100.0 * STEP
    way = [(0.0, 0.0, 0.0), (t, 0.0, broken), (2.0 * t, 0.0, -depth), (4.0 * t, way_along, -depth)]
    result, row, (_, uy) = led(run, kind, way, "again")
    pressed = (row["time"] > t) & (row["time"] <= 2.0 * t)
    run.check(f"type {kind}: pressed again", row["fy"][pressed], np.maximum(0.0, -k * uy[pressed]))
    run.check(f"type {kind}: drawn along", row["fx"][-1], -FRICTION * k * depth)
    # the tangential springs stretch by mu p/k, then slip
    slipped = way_along - FRICTION * depth
    run.check(f"type {kind}: dissipated", result.table("sleout")["friction"][-1], FRICTION * k * depth * slipped)
    rows = result.table("contact").where(time=result.times[-1])
    run.check(f"type {kind}: slip since the start", rows["slip"], way_along)
    run.check(f"type {kind}: still broken", rows["state"], 4.0)
    run.check(f"type {kind}: energy ratio", result.table("glstat")["energy_ratio"][2:], 1.0)


def check_pressed(run, kind):
    """Pressed, and sheared until it breaks: pressure does not help, and goes on as contact."""
    k, depth = spring_of(kind), 1.0e-3
    reach, t = STRENGTH[1] / k, 100.0 * STEP
    way = [(0.0, 0.0, 0.0), (t, 0.0, -depth), (2.25 * t, 1.25 * reach, -depth)]
    result, row, (ux, uy) = led(run, kind, way, "pressed")
    run.check(f"type {kind}: pressed and sheared, normal force throughout", row["fy"], -k * uy)
    before, after = row["time"] < 1.99 * t, row["time"] > 2.01 * t
    grip = np.minimum(FRICTION * k * depth, k * (ux - reach) + 1.0e-9)
    run.check(f"type {kind}: shear up to its strength", row["fx"][before], -k * ux[before])
    run.check(f"type {kind}: then friction, from nothing", row["fx"][after], -grip[after], scale=STRENGTH[1])
    energy = result.table("sleout")["energy"][-1]
    grip = 0.5 * (FRICTION * k * depth) ** 2 / k
    run.check(f"type {kind}: what stays, with what contact holds", energy,
              0.5 * k * (reach ** 2 + depth ** 2) + grip)


#: A bar of two halves, its height, rows of square elements of either half; drive of its end, m/s over s.
HALF, HEIGHT, ROWS = 8.0, 0.4, (6, 4)
SOUND = np.sqrt(YOUNG / RHO)
RISE = 1.0e-2


def check_wave(run, kind):
    """The left end of a bar drawn away ever faster: what comes through the tie is known until it breaks."""
    k = 5.0 * YOUNG
    tau = RHO * SOUND / (2.0 * k * (2.0 if kind == 3 else 1.0))
    rate, wait = RHO * SOUND * RISE, HALF / SOUND
    broken_at = 4.0 / SOUND
    strength = rate * (broken_at - tau * (1.0 - np.exp(-broken_at / tau)))
    deck = Deck(f"tie that breaks, wave, type {kind}")
    deck.control(wait + 1.8 * broken_at, scale=0.8).hourglass(4, 0.05)
    sides = []
    for part, rows in enumerate(ROWS, 1):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
        n = round(HALF * rows / HEIGHT)
        sides.append((deck.mesh(*grid(n, rows, HALF, HEIGHT, (HALF * (part - 1), 0.0)), part=part), n))
    (left, n), (right, m) = sides
    tie(deck, kind, left[n::n + 1], right[::m + 1][::-1], penalty=k, strength=(strength, 1.0e3 * strength))
    deck.curve(1, [(0.0, 0.0), (1.0, -RISE)])
    for node in left[::n + 1]:
        deck.prescribe(node, 1, 0, 1)
    deck.output(glstat=0.05 / SOUND, rcforc=0.05 / SOUND)
    deck.add("*DATABASE_SLEOUT", (0.05 / SOUND,))
    result = run.program(deck, name=f"wave_{kind}")
    row = result.table("rcforc").where(side="slave")
    since = np.maximum(0.0, row["time"] - wait)
    exact = HEIGHT * rate * (since - tau * (1.0 - np.exp(-since / tau)))
    before = since < 0.98 * broken_at
    last = row["time"][np.nonzero(row["fx"])[0][-1]]
    run.check(f"type {kind}: wave, force up to the break", row["fx"][before], exact[before])
    run.check(f"type {kind}: wave, time of the break", last - wait, broken_at)
    spent = HEIGHT * strength ** 2 / (2.0 * k * (2.0 if kind == 3 else 1.0))
    run.check(f"type {kind}: wave, energy that stays in contact", result.table("sleout")["energy"][-1], spent)
    run.check(f"type {kind}: wave, energy ratio", result.table("glstat")["energy_ratio"][2:], 1.0)


def implicit(deck, steps):
    return deck.add("*CONTROL_TERMINATION", (float(steps),)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))


def check_static(run, kind, dof):
    """Two unit columns drawn apart (dof 2) or along (1) by the top, step by step, and pressed together again: in the
    step in which it would be too much it breaks."""
    series = 1.0 / (2.0 * (1.0 / YOUNG if dof == 2 else 2.0 / YOUNG) + 1.0 / spring_of(kind))
    reach, n = STRENGTH[2 - dof] / series, 8
    motion = [0.0] + [reach * (step + 0.5) / n for step in range(n + 2)] + [0.0, -0.5 * reach]
    deck = implicit(Deck(f"tie that breaks, static, type {kind}"), len(motion) - 1)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(*grid(7, 2), part=1)
    lower = deck.mesh(*grid(5, 2, 1.0, 1.0, (0.0, -1.0)), part=2)
    tie(deck, kind, upper[:8], lower[:-7:-1])
    deck.fix(lower[:6], 1, 1)
    deck.fix(np.concatenate([upper[:16], lower[6:]]), *((1, 0) if dof == 2 else (0, 1)))
    deck.curve(1, [*enumerate(motion), (1.0e3, motion[-1])])
    for node in upper[16:]:
        deck.prescribe(node, dof, 2, 1)
        deck.fix([node], *((1, 0) if dof == 2 else (0, 1)))
    deck.output(plot=1.0, rcforc=1.0)
    result = run.program(deck, name=f"static_{kind}_{dof}")
    found = result.table("rcforc").where(side="slave")["fx fy".split()[dof - 1]]
    exact = np.array([-series * u if i <= n and (i < n or (n - 0.5) / n < 1.0) else 0.0 for i, u in enumerate(motion)])
    if dof == 2:
        exact[-1] = -series * motion[-1]
    run.check(f"type {kind}: static, {'tension' if dof == 2 else 'shear'}, force of each step",
              found, exact)
    run.check(f"type {kind}: static, all places are broken",
              result.table("contact").where(time=float(len(motion) - 1))["state"], 4.0)


#: Peel: two arms, their height and length, the crack at the start, elements over the height.
ARM, LENGTH, CRACK, N_ARM = 0.5, 12.0, 3.0, 4
PEEL_SPRING, PEEL_STRENGTH = 1.0e5, 500.0
PEELED = (4, 7)   # where not in full


def peel_traction(length, opening, ahead):
    """Traction a little ahead of the tip of the crack between two beams on elastic foundation, opened by so much at their
    ends."""
    stiffness, foundation = YOUNG * ARM ** 3 / 12.0, 2.0 * PEEL_SPRING
    root = (foundation / (4.0 * stiffness)) ** 0.25
    unit = length ** 3 / (3.0 * stiffness) + (2.0 * root ** 2 * (1.0 + 2.0 * root * length) * length
                                             + 2.0 * root * (1.0 + root * length)) / foundation
    force = 0.5 * opening / unit
    moved = 2.0 * root * force / foundation * np.exp(-root * ahead) * (
        np.cos(root * ahead) * (1.0 + root * length) - root * length * np.sin(root * ahead))
    return 2.0 * PEEL_SPRING * moved


def check_peel(run, kind):
    """Two arms drawn apart at their ends: the crack grows as far as the tip of beams on an elastic foundation holds."""
    opening, n = 0.4, 40
    deck = implicit(Deck(f"peel, type {kind}"), n)
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.0, part)
    columns = round(LENGTH * N_ARM / ARM)
    upper = deck.mesh(*grid(columns, N_ARM, LENGTH, ARM), part=1)
    lower = deck.mesh(*grid(columns, N_ARM, LENGTH, ARM, (0.0, -ARM)), part=2)
    first = round(CRACK * N_ARM / ARM)
    tie(deck, kind, upper[first:columns + 1], lower[-1:-1 - columns - 1 + first:-1], penalty=PEEL_SPRING,
        strength=(PEEL_STRENGTH, PEEL_STRENGTH))
    deck.curve(1, [(0.0, 0.0), (float(n), 0.5 * opening)])
    middle = (columns + 1) * (N_ARM // 2)
    for ids, factor in ((upper, 1.0), (lower, -1.0)):
        deck.prescribe(ids[middle], 2, 2, 1, factor)
    deck.fix([upper[middle + columns], lower[middle + columns]], 1, 0)
    deck.output(plot=float(n), rcforc=1.0)
    deck.add("*DATABASE_SPCFORC", (1.0,))
    result = run.program(deck, name=f"peel_{kind}")
    rows = result.table("contact").where(time=float(n))
    broken = rows["state"] == 4
    # A place stands for the length about it: its traction is that of half of this ahead of the tip.
    size = ARM / N_ARM
    ahead = size / (4.0 if kind == 4 else 2.0)
    low, high = CRACK, LENGTH
    for _ in range(60):
        length = 0.5 * (low + high)
        low, high = (length, high) if peel_traction(length, opening, ahead) > PEEL_STRENGTH else (low, length)
    run.true(f"type {kind}: peel, broken from the crack on and nowhere else", not np.any(np.diff(broken.astype(int)) > 0))
    run.check(f"type {kind}: peel, length of the crack", CRACK + size * (np.sum(broken) - 0.5),
              length)


def check_nodes(run):
    """Type 1: as many springs as nodes, so that those of the ends, which stand for half a length, break first."""
    way = [(0.0, 0.0, 0.0), (125.0 * STEP, 0.0, 1.25 * STRENGTH[0] / SPRING)]
    _, row, (_, uy) = led(run, 1, way, "nodes")
    share = SPRING * uy / STRENGTH[0]
    clear = np.min(np.abs(share[:, None] - [0.5, 1.0]), axis=1) > 0.011
    exact = -SPRING / 7.0 * uy * np.where(share < 0.5, 8.0, np.where(share < 1.0, 6.0, 0.0))
    run.check("type 1: eight springs, then six, then none", row["fy"][clear], exact[clear])


def check(run):
    check_nodes(run)
    for kind in TYPES:
        for dof in (1, 2):
            if kind != 1:
                check_static(run, kind, dof)
        if kind == 1:
            continue
        check_ellipse(run, kind)
        check_again(run, kind)
        check_pressed(run, kind)
        if kind in PASS_PATCH:
            check_wave(run, kind)
        if kind in (PASS_PATCH if run.is_full else PEELED):
            check_peel(run, kind)
