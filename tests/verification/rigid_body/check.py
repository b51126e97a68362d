# SPDX-License-Identifier: MIT
"""Rigid bodies: spin, torque, fall on springs, prescribed motion, impact, and bodies with elastic parts on them."""
import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, lumped_mass, rotate

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3


def rigid(deck, material=1, hold=(0, 0), rho=RHO, young=YOUNG):
    """*MAT_RIGID; hold: CON1 and CON2."""
    return deck.add("*MAT_RIGID", (material, rho, young, POISSON), (1, *hold), (0.0,))


def l_shape(n):
    """L of three unit squares, n x n elements each, off the origin."""
    coordinates, quads = grid(2 * n, 2 * n, 2.0, 2.0, (3.0, -1.0))
    middle = coordinates[np.array(quads)].mean(axis=1)
    quads = [quad for quad, (x, y) in zip(quads, middle) if x < 4.0 or y < 0.0]
    kept = np.unique(quads)
    number = np.zeros(len(coordinates), dtype=int)
    number[kept] = np.arange(len(kept))
    return coordinates[kept], [tuple(number[list(quad)]) for quad in quads]


def body_of(coordinates, quads, rho=RHO):
    """Mass, centre and moment of inertia from the lumped masses."""
    mass = lumped_mass(coordinates, quads, rho)
    centre = mass @ coordinates / mass.sum()
    return mass.sum(), centre, mass @ ((coordinates - centre) ** 2).sum(axis=1)


def free_body(title, dt, n_step, shape, every=1, hold=(0, 0)):
    """One rigid body with a constant step; all nodes in nodout."""
    coordinates, quads = shape
    deck = Deck(title)
    deck.control(dt * n_step, dt=dt).part()
    rigid(deck, hold=hold)
    nodes = deck.mesh(coordinates, quads)
    interval = every * dt
    deck.node_set(1, nodes)
    return deck.output(glstat=interval, matsum=interval, nodout=interval, nodes=nodes), nodes


def paths(result, nodes):
    """Places (row, node, 2) and times of all nodes."""
    table = result.table("nodout")
    n = len(nodes)
    order = np.lexsort((table["node"], table["time"]))
    place = np.stack([table["x"][order], table["y"][order]], axis=-1).reshape(-1, n, 2)
    velocity = np.stack([table["vx"][order], table["vy"][order]], axis=-1).reshape(-1, n, 2)
    return table["time"][order][::n], place, velocity


def turned(coordinates, centre, angles):
    """Coordinates turned by each angle about the centre."""
    return np.array([rotate(coordinates, angle, centre) for angle in angles])


def check_spin(run):
    """An L with spin about a point that is not its centre: steady turn of the centre's flight."""
    shape = l_shape(3)
    coordinates, quads = shape
    mass, centre, inertia = body_of(*shape)
    spin, point, drift = 7.0, np.array([1.0, 2.0]), np.array([0.3, -0.2])
    n_step = 1_000_000
    deck, nodes = free_body("spinning L", 1.0e-4, n_step, shape, every=n_step // 20)
    deck.add("*INITIAL_VELOCITY_GENERATION", (1, 2, spin, *drift), (*point,))
    result = run.program(deck)
    time, place, velocity = paths(result, nodes)
    arm = centre - point
    start = drift + spin * np.array([-arm[1], arm[0]])
    flight = centre + time[:, None] * start
    expected = turned(coordinates, centre, spin * time) + (flight - centre)[:, None, :]
    run.check("spin: places of all nodes / size, 1e6 steps, 111 turns", place[:-1] / 2.0,
              expected[:-1] / 2.0)
    sides = np.linalg.norm(place - np.roll(place, 1, axis=1), axis=2)
    run.check("spin: distances between nodes after 1e6 steps", sides,
              np.broadcast_to(sides[0], sides.shape))
    energy = result.table("glstat")
    kinetic = 0.5 * mass * start @ start + 0.5 * inertia * spin ** 2
    run.check("spin: kinetic energy", energy["kinetic"], kinetic)
    part = result.table("matsum")
    run.check("spin: mass", part["mass"], 3.0 * RHO)
    run.check("spin: momentum", np.stack([part["momentum_x"], part["momentum_y"]]),
              np.broadcast_to((mass * start)[:, None], (2, len(part["mass"]))))


def check_mass(run):
    """Moment of inertia of a rectangle against that of its lumped masses and of the continuum."""
    for n in (1, 4):
        width, height, spin = 3.0, 1.0, 2.0
        shape = grid(3 * n, n, width, height)
        deck, nodes = free_body("rectangle", 1.0e-3, 10, shape)
        deck.add("*INITIAL_VELOCITY_GENERATION", (1, 2, spin), (0.5 * width, 0.5 * height))
        energy = run.program(deck).table("glstat")["kinetic"][0]
        mass, cell = RHO * width * height, 1.0 / n
        inertia = mass / 12.0 * (width ** 2 + height ** 2 + 4.0 * cell ** 2)
        run.check(f"inertia of a rectangle, cells {cell:g}", 2.0 * energy / spin ** 2, inertia)
        run.report(f"inertia of a rectangle, cells {cell:g}: over the continuum's",
                   inertia / (mass / 12.0 * (width ** 2 + height ** 2)))


def check_torque(run):
    """A couple of pressures that follow the body: constant torque."""
    n, dt, n_step, pressure = 4, 1.0e-3, 2000, 5.0e3
    shape = grid(n, n, 2.0, 2.0, (-1.0, -1.0))
    coordinates, quads = shape
    _, centre, inertia = body_of(*shape)
    deck, nodes = free_body("constant torque", dt, n_step, shape, every=20)
    deck.curve(1, [(0.0, pressure), (1.0, pressure)])
    right = nodes[n::n + 1]
    left = nodes[::n + 1]
    # upper half of the left side, lower half of the right side: both turn clockwise
    edges = [(right[k], right[k + 1]) for k in range(n // 2)] \
        + [(left[k + 1], left[k]) for k in range(n // 2, n)]
    deck.add("*LOAD_SEGMENT", *[(1, 1.0, 0.0, a, b, b, b) for a, b in edges])
    result = run.program(deck)
    time, place, _ = paths(result, nodes)
    torque = -2.0 * pressure * 1.0 * 0.5
    angle = 0.5 * torque / inertia * time ** 2
    run.check("torque: places of all nodes", place, turned(coordinates, centre, angle))
    run.report("torque: angle at the end, rad", angle[-1])
    energy = result.table("glstat")
    run.check("torque: kinetic energy", energy["kinetic"], 0.5 * (torque * time) ** 2 / inertia)
    run.check("torque: external work", energy["external_work"], torque * angle)
    run.check("torque: energy ratio", energy["energy_ratio"][1:], 1.0)


def check_held(run):
    """Gravity, damping and constraints."""
    dt, n_step, g = 1.0e-3, 500, 9.81
    shape = l_shape(1)
    coordinates, quads = shape
    for hold, name in (((0, 0), "free"), ((1, 0), "x held"), ((7, 0), "x and y held"),
                       ((2, 7), "y and turn held")):
        deck, nodes = free_body(f"gravity, {name}", dt, n_step, shape, hold=hold)
        deck.curve(1, [(0.0, g), (1.0, g)]).add("*LOAD_BODY_X", (1, 1.0)).add("*LOAD_BODY_Y", (1, 2.0))
        result = run.program(deck)
        time, place, _ = paths(result, nodes)
        free = np.array([hold[0] not in (1, 4, 6, 7), hold[0] not in (2, 4, 5, 7)])
        fall = -0.5 * g * time[:, None] ** 2 * np.array([1.0, 2.0]) * free
        run.check(f"gravity, {name}: places", place, coordinates + fall[:, None, :])
        energy = result.table("glstat")
        run.check(f"gravity, {name}: external work", energy["external_work"] + 1.0,
                  3.0 * RHO * g * -(fall @ np.array([1.0, 2.0])) + 1.0)
    mass, centre, inertia = body_of(*shape)
    damping, spin = 5.0, 3.0
    for factors, name in (((1.0, 1.0), "both"), ((1.0, 0.0), "x")):
        deck, nodes = free_body(f"damping, {name}", dt, n_step, shape)
        deck.add("*INITIAL_VELOCITY_GENERATION", (1, 2, spin, 1.0, 1.0), (*centre,))
        deck.add("*DAMPING_GLOBAL", (0, damping, *factors))
        result = run.program(deck)
        energy = result.table("glstat")
        run.check(f"damping in {name}: energy ratio", energy["energy_ratio"], 1.0)
        part = result.table("matsum")
        for axis, factor in zip("xy", factors):
            run.check(f"damping in {name}: momentum along {axis}", part[f"momentum_{axis}"],
                      mass * np.exp(-factor * damping * part["time"]))


def springs(kind, fixed_turn, dt=1.0e-3, damping=0.0):
    """A rigid block on a rigid table that does not move: a mass on contact springs."""
    n, penalty, g = 10, 4.0e4, 9.81
    deck = Deck(f"rigid block on contact springs, type {kind}")
    # eps_hat times the length in contact; type 1: nodes; type 3: five master segments' length besides
    stiffness = penalty * {1: n + 1, 3: n + 5}.get(kind, n)
    mass = RHO * 0.5
    omega = np.sqrt(stiffness / mass)
    n_step = max(3, int(0.9 * 2.0 * np.pi / omega / dt))
    deck.control(n_step * dt, dt=dt).part(1, 1).part(2, 2)
    rigid(deck, 1, (0, 7 if fixed_turn else 0))
    rigid(deck, 2, (7, 7))
    block = deck.mesh(*grid(n, 5, 1.0, 0.5), part=1)
    table = deck.mesh(*grid(8, 1, 1.6, 0.2, (-0.3, -0.2)), part=2)
    deck.node_set(1, block[:n + 1]).node_set(2, table[9:][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 2, penalty), (0.0, 1.0e20, 0, 0.0, damping))
    deck.curve(1, [(0.0, g), (1.0, g)]).add("*LOAD_BODY_Y", (1, 1.0))
    deck.output(glstat=dt, rcforc=dt, nodout=dt, nodes=[block[0], block[-1]])
    frequency = 2.0 * np.arcsin(min(0.5 * omega * dt, 1.0)) / dt
    return deck, block, mass, g / omega ** 2, frequency


def check_springs(run):
    for kind, name in TYPES.items():
        deck, block, mass, rest, frequency = springs(kind, kind % 2 == 0)
        result = run.program(deck)
        history = result.node(block[0])
        expected = -rest * (1.0 - np.cos(frequency * history["time"]))
        run.check(f"{name}: fall of a rigid block on springs", history["uy"], expected)
        run.check(f"{name}: no turn", result.node(block[-1])["ux"] - history["ux"], 0.0, scale=rest)
        run.check(f"{name}: energy ratio", result.table("glstat")["energy_ratio"][5:], 1.0)


def check_contact_mass(run):
    """Damping and the limit of the step that contact allows know the mass of the body."""
    share = 0.2
    deck, block, mass, rest, frequency = springs(2, True, 1.0e-4, 100.0 * share)
    history = run.program(deck).node(block[0])
    swing = frequency * np.sqrt(1.0 - share ** 2)
    time = history["time"]
    expected = -rest * (1.0 - np.exp(-share * frequency * time) * (
        np.cos(swing * time) + share * frequency / swing * np.sin(swing * time)))
    run.check("damped contact: fall of a rigid block on springs", history["uy"], expected)
    _, _, _, rest, _ = springs(2, True)
    limit = np.sqrt(rest / 9.81)
    for factor in (0.99, 1.01):
        for turns in (True, False):
            result = run.program(springs(2, turns, factor * limit)[0])
            said = "its penalty requires" in (result.folder / f"{result.job}.log").read_text()
            run.true(f"step of {factor} of the limit, turn {'held' if turns else 'free'}: warning",
                     said == (factor > 1.0 or not turns))


def pressed(kind, variant, young=YOUNG, free=False):
    """A block on the ground is pressed by a wider die that also moves sideways; variants of the die: rigid,
    nodal (all its nodes prescribed) and elastic (its upper face prescribed)."""
    size, dt, n_step = 6, 2.0e-4, 1000
    scale = np.sqrt(max(young / YOUNG, 1.0))
    deck = Deck(f"pressed block, type {kind}, {variant} die")
    deck.control(dt * n_step, dt=dt / np.ceil(scale))
    deck.part(1, 1).part(2, 2).elastic(RHO, YOUNG, POISSON, 1)
    if variant == "rigid":
        rigid(deck, 2, (0, 7))
    else:
        deck.elastic(RHO, young, POISSON, 2)
    block = deck.mesh(*grid(size, size), part=1)
    die = deck.mesh(*grid(7, 3, 1.6, 0.5, (-0.3, 1.001)), part=2)
    deck.fix(block[:size + 1], x=1, y=1)
    end = dt * n_step
    deck.curve(1, [(0.0, 0.0), (0.3 * end, -1.0), (end, 0.0)])
    deck.curve(2, [(0.0, 0.2), (end, -0.4)])
    if variant == "rigid":
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (2, 2, 0, 1, 0.5), (2, 1, 0, 2, 1.0))
    else:
        deck.node_set(5, die if variant == "nodal" else die[-8:])
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (5, 2, 0, 1, 0.5), (5, 1, 0, 2, 1.0))
    deck.node_set(1, block[-size - 1:][::-1]).node_set(2, die[:8])
    deck.contact(2, 1, kind, 0.5 * YOUNG) if kind % 2 else deck.contact(1, 2, kind, 0.5 * YOUNG)
    return deck.output(glstat=10 * dt, rcforc=dt, matsum=10 * dt)


def check_pressed(run):
    for kind, name in TYPES.items():
        found = {}
        for variant in ("rigid", "nodal"):
            found[variant] = run.program(pressed(kind, variant))
        forces = {key: result.table("rcforc")["fy"] for key, result in found.items()}
        run.check(f"{name}: force of the pressed block", forces["rigid"], forces["nodal"])
        for column in ("external_work", "kinetic", "contact"):
            one, other = (found[key].table("glstat")[column] for key in ("rigid", "nodal"))
            run.check(f"{name}: {column}, rigid die", one, other)
        run.check(f"{name}: energy ratio, rigid die",
                  found["rigid"].table("glstat")["energy_ratio"][1:], 1.0)


def check_stiff(run):
    """An elastic die comes near the rigid one as it gets stiffer."""
    rigid_force = run.program(pressed(4, "rigid")).table("rcforc").where(side="slave")["fy"]
    errors, moduli = [], (1.0, 4.0, 16.0)
    for factor in moduli:
        table = run.program(pressed(4, "elastic", factor * YOUNG)).table("rcforc").where(side="slave")
        impulse = np.abs(np.sum(table["fy"]) - np.sum(rigid_force)) / np.abs(np.sum(rigid_force))
        errors.append(impulse)
        run.report(f"elastic die {factor:g} times as stiff: impulse less than under the rigid die", impulse)
    run.check("elastic die: difference falls with its compliance, order",
              run.order([1.0 / factor for factor in moduli], errors), 1.0)


def check_turned_die(run):
    """A die that turns about its centre while it presses, against the same motion node by node."""
    dt, n_step, spin = 2.0e-4, 400, 2.5
    size = 4
    results = {}
    angles = spin * dt * np.arange(n_step + 2)
    for variant in ("rigid", "nodal"):
        deck = Deck(f"turning die, {variant}")
        deck.control(dt * n_step, dt=dt)
        deck.part(1, 1).part(2, 2).elastic(RHO, YOUNG, POISSON, 1)
        shape = grid(4, 2, 1.5, 0.5, (-0.25, 1.0))
        if variant == "rigid":
            rigid(deck, 2, (7, 0))
        else:
            deck.elastic(RHO, YOUNG, POISSON, 2)
        block = deck.mesh(*grid(size, size), part=1)
        die = deck.mesh(*shape, part=2)
        deck.fix(block[:size + 1], x=1, y=1)
        if variant == "rigid":
            deck.curve(1, [(0.0, spin), (1.0, spin)])
            deck.add("*BOUNDARY_PRESCRIBED_MOTION_RIGID", (2, 7, 0, 1, 1.0))
        else:
            shift = turned(shape[0], np.array([0.5, 1.25]), angles) - shape[0]
            for k, node in enumerate(die):
                for axis in (0, 1):
                    number = 100 + 2 * k + axis
                    deck.curve(number, [(dt * i, value) for i, value in enumerate(shift[:, k, axis])])
                    deck.prescribe(node, axis + 1, 2, number)
        deck.node_set(1, block[-size - 1:][::-1]).node_set(2, die[:5])
        deck.contact(1, 2, 5, 0.5 * YOUNG)
        deck.output(glstat=10 * dt, rcforc=10 * dt)
        results[variant] = run.program(deck)
    tables = [results[key].table("rcforc").where(side="slave") for key in ("rigid", "nodal")]
    run.check("turning die: contact force x", tables[0]["fx"], tables[1]["fx"])
    run.check("turning die: contact force y", tables[0]["fy"], tables[1]["fy"])
    energies = [results[key].table("glstat") for key in ("rigid", "nodal")]
    for energy, key in zip(energies, ("rigid", "node by node")):
        run.check(f"turning die, {key}: energy ratio", energy["energy_ratio"][2:], 1.0)
    run.check("turning die: internal energy", energies[0]["internal"], energies[1]["internal"])


def check_impact(run):
    """A rigid block flies into an elastic one; both are free."""
    for kind, name in TYPES.items():
        deck = Deck(f"rigid block hits an elastic one, type {kind}")
        deck.control(0.15, scale=0.6).part(1, 1).part(2, 2)
        rigid(deck, 1, rho=3.0 * RHO)
        deck.elastic(RHO, YOUNG, POISSON, 2)
        hit = grid(4, 4)
        flying = deck.mesh(rotate(hit[0] + (-1.3, 0.35), 0.1, (-0.8, 0.85)), hit[1], part=1)
        deck.mesh(*grid(6, 6), part=2)
        deck.node_set(1, flying)
        deck.add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
        deck.add("*INITIAL_VELOCITY", (1,), (4.0, 0.0))
        sides = (1, 2) if kind % 2 else (2, 1)
        deck.add("*CONTACT_2D_SLIDELINE", (*sides, kind, 2, 0.2 * YOUNG), (0.0, 1.0e20, 0))
        deck.output(plot=0.01, glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3)
        result = run.program(deck)
        parts = [result.table("matsum").where(part=k) for k in (1, 2)]
        start = parts[0]["momentum_x"][0]
        for axis, expected in (("x", start), ("y", 0.0)):
            total = parts[0][f"momentum_{axis}"] + parts[1][f"momentum_{axis}"]
            run.check(f"{name}: momentum {axis} of both / initial", total / start, expected / start)
        run.check(f"{name}: energy ratio of the impact", result.table("glstat")["energy_ratio"], 1.0)
        run.check(f"{name}: momentum given / initial", parts[1]["momentum_x"][-1] / start, 0.2)
        first = result.points("Points")[:, :25, :2]
        sides = np.linalg.norm(np.diff(first, axis=1), axis=2)
        run.check(f"{name}: shape of the rigid block", sides,
                  np.broadcast_to(sides[0], sides.shape))
        stress = np.abs(result.cells("stress"))
        run.check(f"{name}: stress in the rigid block / in the elastic one",
                  stress[:, :16].max() / stress.max(), 0.0)


def check_attached(run):
    """A rigid body on the end of an elastic bar that is held at the other end, in its first mode."""
    n, length, height, share, body = 40, 1.0, 0.1, 1.0, 4
    width = body * length / n
    low, high = 1e-6, 0.5 * np.pi - 1e-9
    for _ in range(100):
        z = 0.5 * (low + high)
        low, high = (z, high) if z * np.tan(z) < share else (low, z)
    omega = z * np.sqrt(YOUNG / RHO) / length
    deck = Deck("rigid body on a bar")
    deck.control(6.0 * np.pi / omega, scale=0.5).part(1, 1).part(2, 2)
    deck.elastic(RHO, YOUNG, 0.0, 1)
    rigid(deck, 2, rho=RHO * length / width / share)
    coordinates, quads = grid(n + body, 4, length + width, height)
    middle = coordinates[np.array(quads)].mean(axis=1)[:, 0]
    nodes = deck.mesh(coordinates, [quad for quad, x in zip(quads, middle) if x < length])
    deck.add("*ELEMENT_SHELL", *[(10001 + k, 2, *(nodes[list(quad)].tolist()))
                                 for k, (quad, x) in enumerate(zip(quads, middle)) if x > length])
    deck.fix(nodes[::n + body + 1], x=1, y=1)
    speed = 0.01
    shape = speed * np.sin(z * np.minimum(coordinates[:, 0] / length, 1.0)) / np.sin(z)
    deck.add("*INITIAL_VELOCITY_NODE", *[(node, v, 0.0) for node, v in zip(nodes, shape)])
    tip = nodes[n + body]
    deck.output(glstat=1.0e-3, nodout=1.0e-3, nodes=[tip])
    result = run.program(deck)
    history = result.node(tip)
    run.check("body on a bar: velocity of the body over three periods / start",
              history["vx"] / speed, np.cos(omega * history["time"]))
    run.check("body on a bar: body stays level", history["uy"] * omega / speed, 0.0)
    run.check("body on a bar: energy ratio", result.table("glstat")["energy_ratio"], 1.0)


def check_threads(run):
    """Bits do not depend on the number of threads."""
    found = []
    for n_thread in (1, 3):
        deck = Deck("rigid block hits a plate")
        deck.control(0.02, scale=0.6).part(1, 1).part(2, 2)
        rigid(deck, 1)
        deck.elastic(RHO, YOUNG, POISSON, 2)
        flying = deck.mesh(*grid(30, 30, 1.0, 1.0, (-1.01, 0.1)), part=1)
        target = deck.mesh(*grid(40, 40, 1.0, 1.0), part=2)
        deck.node_set(1, flying).node_set(2, flying[30::31]).node_set(3, target[::41][::-1])
        deck.add("*INITIAL_VELOCITY", (1,), (4.0, 0.0)).contact(2, 3, 7, 0.2 * YOUNG)
        deck.output(glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3)
        result = run.program(deck, f"ncpu={n_thread}", name=f"threads{n_thread}")
        found.append([result.csv_path(name).read_bytes() for name in ("glstat", "matsum", "rcforc")])
    run.true("same bits with one and three threads", found[0] == found[1])


def check(run):
    check_mass(run)
    check_spin(run)
    check_torque(run)
    check_held(run)
    check_springs(run)
    check_contact_mass(run)
    check_pressed(run)
    check_stiff(run)
    check_turned_die(run)
    check_impact(run)
    check_attached(run)
    check_threads(run)
