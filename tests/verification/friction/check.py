# SPDX-License-Identifier: MIT
"""Coulomb friction of interfaces: blocks that slide, stick, start and stop, by every type."""
import subprocess

import numpy as np

import static_patch
from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid, rotate
from patch_layouts import load_edges

RHO, YOUNG, POISSON = 1000.0, 1.0e8, 0.3
GRAVITY, RAMP = 9.81, 0.02
WIDTH, HEIGHT = 1.0, 0.1
MASS = RHO * WIDTH * HEIGHT
#: Penalty, N/m^2.
PENALTY = 2.0e8
#: Of the patch test, Pa: small against Young's modulus, 1e6 Pa, since strains of their ratio change the faces.
PRESSURE, SHEAR = 1.0e-3, 0.3e-3


def block(kind, friction, speed=0.0, end=0.5, tilt=0.0, ramp=RAMP, base=(0.6, 2.0), angle=0.0, card_3=None,
          whole=False, damping_along=0.0):
    """A block on a held plate, both turned by `angle`; gravity, turned by `tilt`, comes within `ramp`. `friction`: FS, FD,
    DC. What vibrates upwards is damped. The plate's mesh does not fit the block's."""
    deck = Deck("block on a plate")
    deck.control(end)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
    deck.hourglass(4, 0.1)
    coordinates, quads = grid(8, 2, WIDTH, HEIGHT)
    nodes = deck.mesh(rotate(coordinates, angle), quads, part=1)
    left, right = base
    n = round(5.4 * (right + left))
    coordinates, quads = grid(n, 1, right + left, HEIGHT, (-left, -HEIGHT))
    plate = deck.mesh(rotate(coordinates, angle), quads, part=2)
    deck.fix(plate, x=1, y=1).node_set(1, nodes).node_set(11, nodes[:9]).node_set(12, plate[-n - 1:][::-1])
    along = np.array([np.cos(angle), np.sin(angle)])
    if speed:
        deck.add("*INITIAL_VELOCITY", (1,), (*(speed * along),))
    deck.curve(1, [(0.0, 0.0), (ramp, 1.0), (1.0e6, 1.0)])
    deck.add("*LOAD_BODY_Y", (1, GRAVITY * np.cos(tilt)))
    if tilt:
        deck.add("*LOAD_BODY_X", (1, -GRAVITY * np.sin(tilt)))
    if not angle:
        deck.add("*DAMPING_GLOBAL", (0, 4000.0, damping_along / 4000.0, 1.0))
    if whole:
        deck.add("*SET_PART_LIST", (11,), (1,)).add("*SET_PART_LIST", (12,), (2,))
    sign = 1 if whole else -1
    deck.add("*CONTACT_2D_SLIDELINE", (sign * 11, sign * 12, kind, 3, PENALTY, *friction), (0.0, 1.0e20, 1),
             *([card_3] if card_3 else []))
    deck.output(glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3, nodout=1.0e-3, plot=end / 4, nodes=nodes[4:5]).add("*DATABASE_SLEOUT", (1.0e-3,))
    return deck, nodes, along

def lag(kind):
    """Time by which the damped block's weight reaches the plate late, s: D/omega^2 with the springs of all types."""
    stiffness = PENALTY * WIDTH * (2.0 if kind == 3 else 1.0)
    return 4000.0 * MASS / stiffness


def check_energy(run, name, result):
    """`total` balances, `friction` takes, and no force passes Coulomb's limit."""
    energies, force = result.table("glstat"), result.table("rcforc").where(side="slave")
    initial = energies["total"][0]
    scale = max(energies["kinetic"].max(), energies["friction"].max(), abs(initial))
    run.check(f"{name}: total - external work, changes", energies["total"] - energies["external_work"],
              np.full_like(energies["time"], initial), 1e-6 * scale, "abs", "leap-frog keeps it")
    run.check(f"{name}: largest fall of the dissipated energy", -np.diff(energies["friction"]).min(), 0.0, 1e-12 * scale, "max")
    interfaces = result.table("sleout")["friction"].reshape(len(energies["time"]), -1)
    run.check(f"{name}: sleout and glstat", interfaces.sum(axis=1), energies["friction"],
              1e-12 * scale if interfaces.shape[1] > 1 else 0.0, "abs")
    return force


def check_level(run, kind, friction, whole=False):
    """Slides to a stop: v0^2/(2 mu g), all energy goes into friction, then it stays."""
    name = f"level, mu {friction:g}{', whole outlines' if whole else ''}: {TYPES[kind]}"
    speed, slowing = 1.0, friction * GRAVITY
    deck, nodes, _ = block(kind, (friction,), speed, 1.3 * speed / slowing,
                           base=(0.6, 1.6 + 0.6 * speed ** 2 / slowing), whole=whole)
    result = run.program(deck)
    node = result.node(int(nodes[4]))
    ramp = 0.5 * speed * RAMP - slowing * RAMP ** 2 / 24.0 + speed * lag(kind)
    run.check(f"{name}: way", node["ux"][-1], 0.5 * speed ** 2 / slowing + ramp, 2e-3,
              source="v0^2/(2 mu g), the ramp of gravity, the lag of the springs")
    force = check_energy(run, name, result)
    run.check(f"{name}: dissipated", result.table("glstat")["friction"][-1], 0.5 * MASS * speed ** 2, 1e-4, source="m v0^2/2")
    slides = (force["time"] > RAMP) & (force["time"] < 0.9 * speed / slowing)
    run.check(f"{name}: friction", -force["fx"][slides], friction * force["fy"][slides], 1e-4,
              source="mu N")
    run.check(f"{name}: stays", np.ptp(node["ux"][node["time"] > 1.2 * speed / slowing]), 0.0, 1e-3 * node["ux"][-1], "max")
    rows = result.table("contact")
    last = (rows["time"] == rows["time"].max()) & np.isin(rows["node"], nodes[:9])
    run.check(f"{name}: traction on the slave is its force", np.sum((rows["traction"] * rows["length"])[last]),
              np.sum(rows["fx"][last]), 1e-4 * friction * MASS * GRAVITY, "abs")
    middle = rows["time"] == np.unique(rows["time"])[2]
    run.true(f"{name}: every node slips on the way", np.all(rows["state"][middle & (rows["pressure"] > 0.0)] == 2.0))
    run.check(f"{name}: slip of the nodes", rows["slip"][last], node["ux"][-1], 1e-2, source="the way of the block")
    field = result.points("contact_traction")[-1, nodes[:9] - 1]
    run.check(f"{name}: field of tractions", field, rows["traction"][last], 1e-12)


def check_incline(run, kind):
    """30 degrees, mu 0.3: a = g (sin - mu cos). The plate is turned, no axis is along it."""
    angle, friction, end = np.radians(-30.0), 0.3, 0.3
    name = f"incline: {TYPES[kind]}"
    deck, _, along = block(kind, (friction,), end=end, angle=angle, base=(0.6, 1.6))
    result = run.program(deck)
    table = result.table("matsum").where(part=1)
    speed = (table["momentum_x"] * along[0] + table["momentum_y"] * along[1]) / MASS
    late = table["time"] > 2.0 * RAMP
    run.check(f"{name}: acceleration", np.polyfit(table["time"][late], speed[late], 1)[0],
              GRAVITY * (np.sin(-angle) - friction * np.cos(angle)), 5e-3, source="g (sin - mu cos)")
    check_energy(run, name, result)


def check_stick(run, kind):
    """Gravity turned by 30 degrees, mu 0.7: the block stays; its weight along the plate is in the tangential springs."""
    tilt, end = np.radians(30.0), 0.3
    name = f"stick: {TYPES[kind]}"
    deck, nodes, _ = block(kind, (0.7,), end=end, tilt=tilt, ramp=0.1, card_3=(0.0, 0.5), damping_along=400.0)
    result = run.program(deck)
    node, energies = result.node(int(nodes[4])), result.table("glstat")
    force = check_energy(run, name, result)
    run.check(f"{name}: force along the plate", -force["fx"][-1], MASS * GRAVITY * np.sin(tilt), 1e-4,
              source="m g sin")
    stiffness = 0.5 * PENALTY * WIDTH * (2.0 if kind == 3 else 1.0)
    run.check(f"{name}: dissipated / stored when all slips", energies["friction"][-1] * 2.0 * stiffness
              / (0.7 * MASS * GRAVITY) ** 2, 0.0, 0.05, "max")
    run.check(f"{name}: way", node["ux"][-1], 0.0, 5.0 * MASS * GRAVITY / stiffness, "max", "springs and elements alone")


def pile(kind, frictions, angle):
    """Three unlike blocks on each other on a plate that is turned by `angle`; friction of each interface from below."""
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
    return deck.output(glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3).add("*DATABASE_SLEOUT", (1.0e-3,))


def check_pile(run, kind):
    """Three blocks on each other slide on the lowest interface alone, as one."""
    name = f"three blocks on 20 degrees: {TYPES[kind]}"
    angle, frictions = np.radians(-20.0), (0.1, 0.5, 0.5)
    result = run.program(pile(kind, frictions, angle))
    slope = GRAVITY * (np.sin(-angle) - frictions[0] * np.cos(angle))
    for part in (2, 3, 4):
        rows = result.table("matsum").where(part=part)
        speed = (rows["momentum_x"] * np.cos(angle) + rows["momentum_y"] * np.sin(angle)) / rows["mass"]
        late = rows["time"] > 0.15
        run.check(f"{name}: acceleration of block {part - 1}", np.polyfit(rows["time"][late], speed[late], 1)[0], slope, 1e-3,
                  source="g (sin - mu cos) of the lowest interface")
    check_energy(run, name, result)


def check_speeds(run, kind):
    """Led at a constant speed: mu(v) N, then the largest stress on the whole length."""
    for card_3, speed in ((None, 0.2), (None, 2.0), ((50.0,), 2.0)):
        name = f"led at {speed:g} m/s{', VC 50' if card_3 else ''}: {TYPES[kind]}"
        deck, nodes, _ = block(kind, (0.5, 0.1, 2.0), speed, 0.15, base=(0.3, 1.6), card_3=card_3)
        deck.curve(2, [(0.0, 1.0), (1.0, 1.0)])
        for node in nodes[-9:]:
            deck.prescribe(node, 1, 0, 2, speed)
        result = run.program(deck)
        force = check_energy(run, name, result)
        friction = 0.1 + 0.4 * np.exp(-2.0 * speed)
        late = force["time"] > 0.1
        # Two passes: the master nodes below have their share too, now more of them, now less.
        length = WIDTH * (2.0 if kind == 3 else 1.0)
        expected = 50.0 * length if card_3 else friction * MASS * GRAVITY
        run.check(f"{name}: mean friction", -np.mean(force["fx"][late]), expected, 0.1 if kind == 3 and card_3 else 0.02,
                  source="VC times the loaded length" if card_3 else "mu(v) m g")


def patch(kind, share):
    """Two blocks of 5 on 4 columns with a pressure, and then a shear of 0.3 of it, on their outer faces, damped to rest.
    `share`: TFAC."""
    upper_lines, lower_lines, young, eps = np.linspace(0, 1, 6), np.linspace(0, 1, 5), 1.0e6, 1.0e6
    blocks = static_patch.Blocks(upper_lines, lower_lines, young)
    slow, end = 6.0, 40.0 / 6.0
    deck = Deck(f"frictional patch test, type {kind}").control(end, scale=0.7).hourglass(4, 0.1)
    for part in (1, 2):
        deck.part(part).elastic(RHO, young, 0.0, part)
    upper = deck.mesh(blocks.upper, blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower, blocks.lower_quads, part=2)
    ids = np.concatenate([upper, lower])
    deck.node_set(1, ids[blocks.slave]).node_set(2, ids[blocks.master][::-1])
    deck.fix(ids[blocks.bottom], x=1, y=1)
    deck.curve(1, [(0.0, 0.0), (0.25 * end, PRESSURE), (2.0 * end, PRESSURE)])
    deck.curve(2, [(0.0, 0.0), (0.25 * end, 0.0), (0.5 * end, SHEAR), (2.0 * end, SHEAR)])
    load_edges(deck, ids[blocks.top])
    forces = {}
    for x, nodes, columns in ((blocks.upper, upper, 6), (blocks.lower, lower, 5)):
        rows = np.asarray(nodes).reshape(columns, columns)
        weight = static_patch.hat_areas(np.linspace(0, 1, columns))
        for node, f in zip(rows[:, -1], weight):
            forces[int(node), 2] = f
        for node, f in zip(rows[:, 0], weight):
            forces[int(node), 2] = -f
    for node, f in zip(ids[blocks.top], blocks.lengths(0)):
        forces[int(node), 1] = f
    deck.add("*LOAD_NODE_POINT", *[(node, dof, 2, f) for (node, dof), f in forces.items()])
    deck.add("*DAMPING_GLOBAL", (0, 2.0 * slow))
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, eps, 0.5), (0.0, 1.0e20), (0.0, share))
    return deck.output(plot=end / 2, glstat=end / 20), ids, blocks


def check_patch(run, kind, share):
    name = f"patch, stick, eps_T {share:g} eps_N: {TYPES[kind]}"
    deck, ids, blocks = patch(kind, share)
    result = run.program(deck)
    energies = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end", energies["kinetic"][-1] / energies["internal"][-1], 0.0, 1e-12,
              "max", "at rest")
    force = result.points("contact_force")[-1]
    sides = {"slave": force[blocks.slave] / blocks.lengths(0)[:, None],
             "master": -force[blocks.master] / blocks.lengths(1)[:, None]}
    for side, found in sides.items():
        pressure, traction = found[:, 1] / PRESSURE, -found[:, 0] / SHEAR
        if kind in PASS_PATCH:
            run.check(f"{name}: pressure on the {side} side", pressure, 1.0, 1e-7, source="uniform")
            run.check(f"{name}: traction on the {side} side", traction, 1.0, 1e-7, source="uniform")
        else:
            run.report(f"{name}: pressure on the {side} side, largest error", np.max(np.abs(pressure - 1.0)))
            run.report(f"{name}: traction on the {side} side, largest error", np.max(np.abs(traction - 1.0)))


def check_bits(run, kind):
    """The same bits with more threads, and in a run that goes on while the block slides."""
    deck, _, _ = block(kind, (0.3,), 1.0, end=0.04, whole=kind in (5, 7))
    files = ("glstat", "rcforc", "sleout", "contact", "matsum")
    whole = run.program(deck, name=f"whole_{kind}")
    for n in (2, 4):
        other = run.program(deck, f"ncpu={n}", name=f"whole_{kind}_{n}")
        run.true(f"bits with {n} threads: {TYPES[kind]}", all(
            whole.csv_path(file).read_bytes() == other.csv_path(file).read_bytes() for file in files))
    deck.add("*DATABASE_BINARY_D3DUMP", (100,))
    dumped = run.program(deck, name=f"dumped_{kind}")
    folder = run.work / f"goes_on_{kind}"
    folder.mkdir()
    finished = subprocess.run([str(run.program_path), f"r={dumped.folder / f'dumped_{kind}.dump01.h5'}", f"d={folder}"],
                              capture_output=True, text=True, timeout=600)
    run.true(f"restart, it goes on: {TYPES[kind]}", finished.returncode == 0, finished.stderr)
    run.true(f"restart, bits: {TYPES[kind]}", all(whole.csv_path(file).read_bytes() == (
        folder / f"dumped_{kind}.{file}.csv").read_bytes() for file in files))


def check(run):
    levels, shares = (run.cover(TYPES, choice, strength=1) for choice in ((0.1, 0.3, 0.6), (1.0, 0.1)))
    for kind in TYPES:
        for friction in (friction for one, friction in levels if one == kind):
            check_level(run, kind, friction)
        check_level(run, kind, 0.3, whole=True)
        check_incline(run, kind)
        check_stick(run, kind)
        check_pile(run, kind)
        check_speeds(run, kind)
        for share in (share for one, share in shares if one == kind):
            check_patch(run, kind, share)
        check_bits(run, kind)
