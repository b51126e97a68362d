# SPDX-License-Identifier: MIT
"""Blocks that slide and stick on a plate, by every type, and on a rigid wall; a square that hits a wall; a disc (rolling.py)."""
import numpy as np

import rolling
from contact_types import TYPES
from meshes import Deck, grid, rotate

RHO, YOUNG, POISSON = 1000.0, 1.0e8, 0.3
GRAVITY, RAMP = 9.81, 0.02
WIDTH, HEIGHT = 1.0, 0.1
MASS = RHO * WIDTH * HEIGHT
#: Penalty, N/m^2, and damping of what vibrates upwards, 1/s: a block that rings creeps where it should stick.
PENALTY, DAMPING = 2.0e8, 4000.0
WALL = None  #: instead of a type


def block(kind, friction, speed=0.0, end=0.5, tilt=0.0, ramp=RAMP, base=(0.6, 2.0), angle=0.0, card_3=None, whole=False,
          damping_along=0.0):
    """A block on a held plate (mesh that does not fit) or on a wall, both turned by `angle`; gravity, turned by `tilt`, comes
    within `ramp`. `friction`: FS, FD, DC. Returns the deck, the nodes of the block and the direction along the plate."""
    deck = Deck("block on a plate").control(end).hourglass(4, 0.1)
    deck.part(1).elastic(RHO, YOUNG, POISSON, 1)
    coordinates, quads = grid(8, 2, WIDTH, HEIGHT)
    nodes = deck.mesh(rotate(coordinates, angle), quads, part=1)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    deck.node_set(1, nodes).curve(1, [(0.0, 0.0), (ramp, 1.0), (1.0e6, 1.0)])
    if speed:
        deck.add("*INITIAL_VELOCITY", (1,), (*(speed * along),))
    deck.add("*LOAD_BODY_Y", (1, GRAVITY * np.cos(tilt)))
    if tilt:
        deck.add("*LOAD_BODY_X", (1, -GRAVITY * np.sin(tilt)))
    if not angle:
        deck.add("*DAMPING_GLOBAL", (0, DAMPING, damping_along / DAMPING, 1.0))
    deck.output(glstat=1.0e-3, matsum=1.0e-3, nodout=1.0e-3, nodes=nodes[4:5])
    if kind is WALL:
        if not angle:
            deck.add("*CONTROL_BULK_VISCOSITY", (1.5, 0.5))
        deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, *map(float, normal), 0.0, *friction))
        return deck.add("*DATABASE_RWFORC", (1.0e-3,)), nodes, along
    left, right = base
    n = round(5.4 * (right + left))
    coordinates, quads = grid(n, 1, right + left, HEIGHT, (-left, -HEIGHT))
    plate = deck.part(2).elastic(RHO, YOUNG, POISSON, 2).mesh(rotate(coordinates, angle), quads, part=2)
    deck.fix(plate, x=1, y=1).node_set(11, nodes[:9]).node_set(12, plate[-n - 1:][::-1])
    if whole:
        deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
    sign = 1 if whole else -1
    deck.add("*CONTACT_2D_SLIDELINE", (sign * 11, sign * 12, kind, 3, PENALTY, *friction), (0.0, 1.0e20, 1),
             *([card_3] if card_3 else []))
    return deck.output(rcforc=1.0e-3, plot=end / 4).add("*DATABASE_SLEOUT", (1.0e-3,)), nodes, along


def lag(kind):
    """Time by which the damped block's weight reaches the plate late, s: D/omega^2 with the springs of all types."""
    return 0.0 if kind is WALL else DAMPING * MASS / (PENALTY * WIDTH * (2.0 if kind == 3 else 1.0))


def named(kind, wall, types):
    """Name of a scene on the wall, and by type."""
    return wall if kind is WALL else f"{types}: {TYPES[kind]}"


def check_balance(run, name, result, friction):
    """`total` balances and `friction` takes. Returns time, friction and normal force, which the wall limits here."""
    energies = result.table("glstat")
    initial, balance = energies["total"][0], energies["total"] - energies["external_work"]
    if not result.csv_path("rcforc").exists():
        force = result.table("rwforc")
        tangential, normal = force["tangential_force"], force["normal_force"]
        run.check(f"{name}: friction above mu times the normal force",
                  (np.abs(tangential) - friction * normal).max() / normal.max(), 0.0)
        run.check(f"{name}: energy", balance, np.full_like(balance, initial), scale=max(energies["kinetic"].max(), initial))
        run.check(f"{name}: friction of glstat and of rwforc", energies["friction"], force["friction"])
        run.true(f"{name}: friction takes energy", np.all(np.diff(force["friction"]) > -1e-9 * force["friction"].max()))
        return force["time"], tangential, normal
    scale = max(energies["kinetic"].max(), energies["friction"].max(), abs(initial))
    run.check(f"{name}: total - external work, changes", balance, np.full_like(balance, initial), scale=scale)
    run.check(f"{name}: largest fall of the dissipated energy", -np.diff(energies["friction"]).min(), 0.0, scale=scale)
    interfaces = result.table("sleout")["friction"].reshape(len(balance), -1)
    run.check(f"{name}: sleout and glstat", interfaces.sum(axis=1), energies["friction"],
              scale=scale if interfaces.shape[1] > 1 else 0.0)
    force = result.table("rcforc").where(side="slave")
    return force["time"], -force["fx"], force["fy"]


def speed_of(result, part, along):
    rows = result.table("matsum").where(part=part)
    return rows["time"], (rows["momentum_x"] * along[0] + rows["momentum_y"] * along[1]) / rows["mass"]


def check_level(run, kind, friction, whole=False):
    """Slides to a stop: v0^2/(2 mu g), all energy goes into friction, then it stays."""
    name = named(kind, "level", f"level, mu {friction:g}{', whole outlines' if whole else ''}")
    speed, slowing = 1.0, friction * GRAVITY
    deck, nodes, _ = block(kind, (friction,), speed, 1.3 * speed / slowing,
                           base=(0.6, 1.6 + 0.6 * speed ** 2 / slowing), whole=whole)
    result = run.program(deck)
    node = result.node(int(nodes[4]))
    ramp = 0.5 * speed * RAMP - slowing * RAMP ** 2 / 24.0 + speed * lag(kind)
    run.check(f"{name}: way", node["ux"][-1], 0.5 * speed ** 2 / slowing + ramp)
    time, tangential, normal = check_balance(run, name, result, friction)
    run.check(f"{name}: dissipated", result.table("glstat")["friction"][-1], 0.5 * MASS * speed ** 2)
    slides = (time > RAMP) & (time < (0.8 if kind is WALL else 0.9) * speed / slowing)
    run.check(f"{name}: friction{' is mu times the normal force' if kind is WALL else ''}", tangential[slides],
              friction * normal[slides])
    if kind is WALL:
        run.check(f"{name}: force along the wall is what fx says", result.table("rwforc")["fx"], -tangential)
        return
    run.check(f"{name}: stays", np.ptp(node["ux"][node["time"] > 1.2 * speed / slowing]), 0.0, scale=node["ux"][-1])
    rows = result.table("contact")
    last = (rows["time"] == rows["time"].max()) & np.isin(rows["node"], nodes[:9])
    run.check(f"{name}: traction on the slave is its force", np.sum((rows["traction"] * rows["length"])[last]),
              np.sum(rows["fx"][last]), scale=friction * MASS * GRAVITY)
    middle = rows["time"] == np.unique(rows["time"])[2]
    run.true(f"{name}: every node slips on the way", np.all(rows["state"][middle & (rows["pressure"] > 0.0)] == 2.0))
    run.check(f"{name}: slip of the nodes", rows["slip"][last], node["ux"][-1])
    run.check(f"{name}: field of tractions", result.points("contact_traction")[-1, nodes[:9] - 1], rows["traction"][last])


def check_incline(run, kind):
    """30 degrees, mu 0.3: a = g (sin - mu cos). The plate is turned, no axis is along it."""
    angle, friction = np.radians(-30.0), 0.3
    name = named(kind, "incline", "incline")
    deck, _, along = block(kind, (friction,), end=0.5 if kind is WALL else 0.3, angle=angle, base=(0.6, 1.6))
    result = run.program(deck)
    time, speed = speed_of(result, 1, along)
    expected = GRAVITY * (np.sin(-angle) - friction * np.cos(angle))
    late = time > 2.0 * RAMP
    run.check(f"{name}: acceleration", np.polyfit(time[late], speed[late], 1)[0], expected)
    if kind is WALL:
        run.check(f"{name}: speed at the end", speed[-1], expected * (time[-1] - 0.5 * RAMP))
    check_balance(run, name, result, friction)


def check_stop(run):
    """On the wall, mu 0.7 at 30 degrees, v0 = 1: stops and stays."""
    tilt, friction, speed = np.radians(30.0), 0.7, 1.0
    slowing = GRAVITY * (friction * np.cos(tilt) - np.sin(tilt))
    deck, nodes, _ = block(WALL, (friction,), speed, 2.0 * speed / slowing, tilt)
    result = run.program(deck)
    node = result.node(int(nodes[4]))
    ramp = 0.5 * speed * RAMP - slowing * RAMP ** 2 / 24.0
    run.check("stop: way", node["ux"][-1], 0.5 * speed ** 2 / slowing + ramp)
    stays = node["time"] > 1.3 * (speed / slowing + RAMP)
    run.check("stop: it stays", np.ptp(node["ux"][stays]), 0.0, scale=node["ux"][-1])
    check_balance(run, "stop", result, friction)


def check_stick(run, kind):
    """Gravity turned by 30 degrees, mu 0.7: the block stays; its weight along the plate is in the tangential springs. On the
    wall, mu 1 at 45 degrees: no node at it moves along it."""
    name, tilt = named(kind, "sticks", "stick"), np.radians(45.0 if kind is WALL else 30.0)
    deck, nodes, _ = block(kind, (1.0,) if kind is WALL else (0.7,), end=0.3, tilt=tilt, ramp=0.1, card_3=(0.0, 0.5),
                           damping_along=0.0 if kind is WALL else 400.0)
    result = run.program(deck)
    node, friction = result.node(int(nodes[4])), result.table("glstat")["friction"][-1]
    weight = MASS * GRAVITY * np.sin(tilt)
    if kind is WALL:
        force = result.table("rwforc")
        run.check(f"{name}: the foot stays", node["ux"], 0.0)
        run.check(f"{name}: mean force along the wall", np.mean(force["tangential_force"][force["time"] > 0.15]), weight)
        run.check(f"{name}: no energy goes into friction", friction, 0.0)
        return
    _, tangential, _ = check_balance(run, name, result, 0.7)
    run.check(f"{name}: force along the plate", tangential[-1], weight)
    stiffness = 0.5 * PENALTY * WIDTH * (2.0 if kind == 3 else 1.0)
    run.check(f"{name}: dissipated / stored when all slips", friction * 2.0 * stiffness / (0.7 * MASS * GRAVITY) ** 2, 0.0)
    run.check(f"{name}: way", node["ux"][-1], 0.0, scale=MASS * GRAVITY / stiffness)


def check_pile(run, kind):
    """Three unlike blocks on each other on an incline slide on the lowest interface alone, as one."""
    name, angle, frictions = f"three blocks on 20 degrees: {TYPES[kind]}", np.radians(-20.0), (0.1, 0.5, 0.5)
    deck = Deck("three blocks on an incline").control(0.3).hourglass(4, 0.1)
    for part, (rho, young) in enumerate(((1000.0, 1e8), (1000.0, 1e8), (500.0, 3e7), (2000.0, 1e8)), 1):
        deck.part(part).elastic(rho, young, POISSON, part)
    coordinates, quads = grid(23, 1, 2.5, HEIGHT, (-0.5, -HEIGHT))
    below = deck.mesh(rotate(coordinates, angle), quads, part=1).reshape(2, -1)
    deck.fix(below.ravel(), x=1, y=1)
    y = 0.0
    for k, (width, n, height) in enumerate(((0.6, 7, 0.1), (0.5, 5, 0.12), (0.4, 6, 0.08))):
        coordinates, quads = grid(n, 2, width, height, (0.3 - 0.5 * width, y))
        nodes = deck.mesh(rotate(coordinates, angle), quads, part=k + 2).reshape(3, -1)
        deck.node_set(10 + k, nodes[0]).node_set(20 + k, below[-1][::-1])
        deck.add("*CONTACT_2D_SLIDELINE", (-10 - k, -20 - k, kind, 3, 1e8, frictions[k]), (0.0, 1.0e20, 1, None, 20.0))
        below, y = nodes, y + height
    deck.curve(1, [(0.0, 0.0), (0.05, 1.0), (1.0e6, 1.0)]).add("*LOAD_BODY_Y", (1, GRAVITY))
    result = run.program(deck.output(glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3).add("*DATABASE_SLEOUT", (1.0e-3,)))
    for part in (2, 3, 4):
        time, speed = speed_of(result, part, (np.cos(angle), np.sin(angle)))
        late = time > 0.15
        run.check(f"{name}: acceleration of block {part - 1}", np.polyfit(time[late], speed[late], 1)[0],
                  GRAVITY * (np.sin(-angle) - frictions[0] * np.cos(angle)))
    check_balance(run, name, result, None)


def check_speeds(run, kind):
    """Led at a constant speed: mu(v) N, then the largest stress on the whole length."""
    for card_3, speed in ((None, 0.2), (None, 2.0), ((50.0,), 2.0)):
        name = f"led at {speed:g} m/s{', VC 50' if card_3 else ''}: {TYPES[kind]}"
        deck, nodes, _ = block(kind, (0.5, 0.1, 2.0), speed, 0.15, base=(0.3, 1.6), card_3=card_3)
        deck.curve(2, [(0.0, 1.0), (1.0, 1.0)])
        for node in nodes[-9:]:
            deck.prescribe(node, 1, 0, 2, speed)
        time, tangential, _ = check_balance(run, name, run.program(deck), None)
        # Two passes: the master nodes below have their share too, now more of them, now less.
        expected = (50.0 * WIDTH * (2.0 if kind == 3 else 1.0) if card_3
                    else (0.1 + 0.4 * np.exp(-2.0 * speed)) * MASS * GRAVITY)
        run.check(f"{name}: mean friction", np.mean(tangential[time > 0.1]), expected)


def hit(run, friction, slide, angle=0.0, speed=2.0, steps=40, dt=1.0e-6):
    """A stiff square flies obliquely at a wall, turned by `angle`, and hits it inside a step: its speed along the wall, and
    tangential and normal force."""
    deck = Deck("oblique impact").control(steps * dt, dt=dt)
    deck.part(points=4).elastic(8000.0, 2.0e11, 0.0)
    coordinates, quads = grid(1, 1, 1.0, 1.0, (0.0, 7.3 * speed * dt))
    nodes = deck.mesh(rotate(coordinates, angle), quads)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    deck.add("*INITIAL_VELOCITY", (0,), (*(slide * along - speed * normal),))
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, float(normal[0]), float(normal[1]), 0.0, friction))
    deck.output(glstat=dt, matsum=dt, nodout=dt, nodes=nodes[:1]).add("*DATABASE_RWFORC", (dt,))
    result = run.program(deck)
    node, force = result.node(int(nodes[0])), result.table("rwforc")
    return node["vx"] * along[0] + node["vy"] * along[1], force["tangential_force"], force["normal_force"]


def check_impact(run):
    """The impulse along the wall is mu times the normal one, or what stops the nodes; the same at an oblique wall."""
    for friction, slide in ((0.1, 0.5), (0.4, 0.5), (1.0, 0.5), (0.1, -0.5)):
        name, sign = f"impact with {friction} at {slide}", np.sign(slide)
        speed, tangential, normal = hit(run, friction, slide)
        left = slide - sign * min(abs(slide), friction * 2.0) if friction < 1.0 else 0.0
        run.check(f"{name}: speed after it", speed[10], left, scale=abs(slide))
        run.check(f"{name}: force in its first step", tangential[7], sign * min(
            friction * normal[7] if friction < 1.0 else np.inf, 2000.0 * 2.0 * abs(slide) / 1.0e-6))
    flat, turned = (hit(run, 0.1, 0.5, angle) for angle in (0.0, np.radians(37.0)))
    run.check("oblique wall: speed along it", turned[0][:15], flat[0][:15])
    run.check("oblique wall: friction", turned[1][:15], flat[1][:15])


def check(run):
    levels = run.cover(TYPES, (0.1, 0.3, 0.6), strength=1)
    for kind in TYPES:
        for friction in (friction for one, friction in levels if one == kind):
            check_level(run, kind, friction)
        check_level(run, kind, 0.3, whole=True)
        check_incline(run, kind)
        check_stick(run, kind)
        check_pile(run, kind)
        check_speeds(run, kind)
    check_level(run, WALL, 0.3)
    check_incline(run, WALL)
    check_stop(run)
    check_stick(run, WALL)
    check_impact(run)
    rolling.check(run)
