# SPDX-License-Identifier: MIT
"""Hanging nodes: patch tests, balances, the stable step, and finer meshes where they matter against fine ones."""
import numpy as np

from contact_types import PASS_PATCH, TYPES
from eigen import quad_stiffness
from meshes import Deck, angular_momentum, distorted_patch, divide, grid, lumped_mass
from static_patch import Blocks

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.25
#: Displacement gradient of the patch at the end.
GRADIENT = 1.0e-4 * np.array([[1.0, 0.6], [-0.3, -0.8]])


def on_boundary(coordinates):
    return np.flatnonzero(np.any((coordinates == 0.0) | (coordinates == 1.0), axis=1))


def check_patch(run, points, implicit, thirds):
    """Linear displacements of the boundary; stress and nodes inside follow them."""
    name = f"patch{', full integration' if points else ''}{', implicit' if implicit else ''}, {thirds} divided"
    coordinates, quads, hanging = divide(*distorted_patch(), range(thirds))
    end = 0.05
    deck = Deck(name)
    if implicit:
        deck.add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, end / 2.0))
    else:
        deck.control(end)
    deck.hourglass(4, 0.1).part(points=points).elastic(RHO, YOUNG, POISSON)
    ids = deck.mesh(coordinates, quads)
    deck.hang(ids, hanging)
    deck.curve(1, [(0.0, 1.0), (1.0, 1.0)] if not implicit else [(0.0, 0.0), (end, 1.0), (1.0, 1.0)])
    speed = coordinates @ GRADIENT.T / end
    for node in on_boundary(coordinates):
        for k in range(2):
            deck.prescribe(ids[node], k + 1, 2 if implicit else 0, 1, speed[node, k] * (end if implicit else 1.0))
    if not implicit:
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), *v) for node, v in zip(ids, speed)])
    result = run.program(deck.output(plot=end, glstat=end / 10.0))
    stress, scale = result.cells("stress")[-1], result.times[-1] / end
    run.check(f"{name}: stress is uniform", stress, np.broadcast_to(np.mean(stress, axis=0), stress.shape))
    shear = YOUNG / 2 / (1 + POISSON)
    lame = 2.0 * shear * POISSON / (1 - 2 * POISSON)
    strain = 0.5 * scale * (GRADIENT + GRADIENT.T)
    expected = lame * np.trace(strain) * np.eye(2) + 2.0 * shear * strain
    run.check(f"{name}: stress", stress[:, [0, 1, 3]], np.broadcast_to([expected[0, 0], expected[1, 1], expected[0, 1]],
                                                                       (len(stress), 3)))
    run.check(f"{name}: displacement", result.points("displacement")[-1][:, :2], coordinates @ (scale * GRADIENT).T)


def check_newton(run):
    """A block bent far in one static step: of one iteration to the next the energy falls with the second power."""
    coordinates, quads, hanging = divide(*grid(4, 8, 0.5, 1.0), (0, 5, 6, 13, 18, 27))
    deck = Deck("bent block with hanging nodes").add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    ids = deck.part(points=4).elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
    deck.hang(ids, hanging).fix(ids[coordinates[:, 1] == 0.0], x=1, y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for node in ids[coordinates[:, 1] == 1.0]:
        deck.prescribe(node, 1, 2, 1, 0.05)
    rows = run.program(deck.output(glstat=1.0), name="bent").newton()[0]
    energy = [ratio for ratio, residual in rows if residual > 100.0]
    orders = [np.log(after) / np.log(before) for before, after in zip(energy[1:], energy[2:])]
    run.check("bent block: order of Newton's method", orders[-1], 2.0)


def free_square(n, seed):
    """A square of n x n elements, some divided, in random motion."""
    rng = np.random.default_rng(seed)
    coordinates, quads, hanging = divide(*grid(n, n), set(rng.permutation(n * n)[:n * n // 3].tolist()))
    deck = Deck("free square with hanging nodes")
    ids = deck.hourglass(4, 0.1).part().elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
    deck.hang(ids, hanging)
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    velocity = [0.3, -0.2] + 2.0 * coordinates @ turn.T + 0.1 * np.sin(3.0 * coordinates @ rng.random((2, 2)))
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), *v) for node, v in zip(ids, velocity)])
    return deck, coordinates, quads, np.array(hanging)


def shared(mass, hanging):
    """Lumped masses, those of hanging nodes by halves at their parents."""
    for node, *parents in hanging:
        mass[parents] += 0.5 * mass[node]
        mass[node] = 0.0
    return mass


def check_balances(run):
    """Momentum, angular momentum and energy of a free body; mean of the parents at all times."""
    for method in ("explicit", "implicit"):
        deck, coordinates, quads, hanging = free_square(6, 3)
        mass = shared(lumped_mass(coordinates, quads, RHO), hanging)
        end = 0.1
        if method == "implicit":
            deck.add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1e-3))
            deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1, 0.5, 0.25))
        else:
            deck.control(end)
        deck.output(plot=end / 10, glstat=end / 50, matsum=end / 50)
        result = run.program(deck, name=f"free_{method}")
        velocity, places = result.points("velocity")[..., :2], result.points("Points")[..., :2]
        for field, what in ((velocity, "velocity"), (result.points("displacement")[..., :2], "displacement")):
            run.check(f"free square, {method}: {what} of hanging nodes", field[:, hanging[:, 0]],
                      0.5 * (field[:, hanging[:, 1]] + field[:, hanging[:, 2]]))
        part, table = result.table("matsum"), result.table("glstat")
        momentum = np.stack([part["momentum_x"], part["momentum_y"]], axis=1)
        run.check(f"free square, {method}: momentum", momentum, np.broadcast_to(momentum[0], momentum.shape))
        run.check(f"free square, {method}: kinetic energy of parts", part["kinetic"], table["kinetic"])
        run.check(f"free square, {method}: energy ratio", table["energy_ratio"], 1.0)
        if method == "explicit":
            turning = angular_momentum(mass, places, velocity)
            run.check("free square, explicit: momentum of the lumped masses", momentum[0], mass @ velocity[0])
            run.check("free square, explicit: angular momentum", turning, turning[0])
    run.goes_on(free_square(6, 3)[0].control(0.02).output(glstat=1e-3, matsum=1e-3),
                60, run.program(free_square(6, 3)[0].control(0.02).output(glstat=1e-3, matsum=1e-3), name="whole"),
                "glstat", "matsum")


def stable_limit(coordinates, quads, hanging):
    """2/omega of the elements, with hanging nodes condensed."""
    n = len(coordinates)
    stiffness = np.zeros((2 * n, 2 * n))
    for quad in quads:
        rows = np.ravel([[2 * k, 2 * k + 1] for k in quad])
        stiffness[np.ix_(rows, rows)] += quad_stiffness(coordinates[list(quad)], YOUNG, POISSON, 0.1)[0]
    follow = np.eye(n)
    for node, *parents in hanging:
        follow[node] = 0.0
        follow[node, parents] = 0.5
    kept = np.setdiff1d(np.arange(n), [row[0] for row in hanging])
    follow = np.kron(follow[:, kept], np.eye(2))
    root = np.repeat(shared(lumped_mass(coordinates, quads, RHO), hanging)[kept], 2) ** -0.5
    return 2.0 / np.sqrt(np.linalg.eigvalsh(root[:, None] * (follow.T @ stiffness @ follow) * root)[-1])


def check_step(run):
    """The step of the elements is below 2/omega, and not by much."""
    for seed in range(4):
        deck, coordinates, quads, hanging = free_square(4, seed)
        result = run.program(deck.control(1e-4, scale=1.0).output(glstat=1e-4), name=f"step{seed}")
        ratio = stable_limit(coordinates, quads, hanging) / result.table("glstat")["dt"][0]
        run.check(f"stable step, mesh {seed}: limit over step, at least", ratio, 1.0)
        run.check(f"stable step, mesh {seed}: limit over step, at most", ratio, 1.0)


#: Contact patch (friction_patch has the same loads): pressure, friction, penalty per node; times of loads and end, s.
PRESSURE, FRICTION, PENALTY, WAY = 2.0e-4, 0.3, 1.0e6, 8.0e-10
RISE, SLOWS, END = 2.0, 0.6, 20.0
LINES = (np.linspace(0, 1, 6), np.linspace(0, 1, 5))


def outer_forces(coordinates, quads, hanging, stress, left_out):
    """Nodal forces of a stress on the edges of the body but for those on which both ends have y = left_out."""
    number, force = {}, np.zeros_like(coordinates)
    for quad in quads:
        for a, b in zip(quad, np.roll(quad, -1)):
            number.setdefault((min(a, b), max(a, b)), []).append((a, b))
    inner = {(min(a, b), max(a, b)) for row in hanging for a, b in ((row[0], row[1]), (row[0], row[2]), (row[1], row[2]))}
    for key, ((a, b), *others) in number.items():
        if others or key in inner or np.all(coordinates[[a, b], 1] == left_out):
            continue
        along = coordinates[b] - coordinates[a]
        force[[a, b]] += 0.5 * stress @ [along[1], -along[0]]
    return force


def contact_patch(kind):
    """Two blocks, the rows at the contact divided: pressed and dragged into full slip, damped to rest. The upper one starts
    back by its slip, and nothing strains along x, so that the ends are flush at rest."""
    blocks = Blocks(*LINES, 1.0)
    deck = Deck(f"contact patch over hanging nodes, type {kind}").control(END, scale=0.6).hourglass(4, 0.1)
    stress = PRESSURE * np.array([[0.0, FRICTION], [FRICTION, -1.0]])
    slip = WAY - 2.0 * FRICTION * PRESSURE * (1.0 / YOUNG + 1.0 / (3.0 * YOUNG))
    nodes, loads = [], []
    for part, (mesh, young, level) in enumerate(((blocks.upper, YOUNG, 1.0), (blocks.lower, 3.0 * YOUNG, -1.0)), 1):
        quads = (blocks.upper_quads, blocks.lower_quads)[part - 1]
        row = {k for k, quad in enumerate(quads) if np.any(mesh[list(quad), 1] == 0.0)}
        coordinates, quads, hanging = divide(mesh, quads, row)
        ids = deck.part(part).elastic(RHO, young, 0.0, part).mesh(
            coordinates - [slip if part == 1 else 0.0, 0.0], quads, part=part)
        deck.hang(ids, hanging)
        force = outer_forces(coordinates, quads, hanging, stress, 0.0)
        face = np.flatnonzero(coordinates[:, 1] == 0.0)
        face = face[np.argsort(coordinates[face, 0])]
        deck.node_set(part, ids[face[::(1 if part == 1 else -1)]])
        nodes.append((ids, face))
        end = ids[np.flatnonzero(coordinates[:, 1] == level)]
        if part == 2:
            deck.fix(end, y=1).fix(end[len(end) // 2:len(end) // 2 + 1], x=1)
            force[coordinates[:, 1] == level, 1] = 0.0
        loads += [(int(node), dof + 1, 1, row[dof]) for node, row in zip(ids, force) for dof in (0, 1) if row[dof]]
        if part == 1:
            led = int(end[len(end) // 2])
    ramp, since = np.linspace(0.0, 1.0, 41), np.linspace(0.0, END - RISE, 801)
    deck.curve(1, [*zip(RISE * ramp, ramp - np.sin(2.0 * np.pi * ramp) / (2.0 * np.pi)), (2.0 * END, 1.0)])
    deck.curve(2, [(0.0, 0.0), *zip(RISE + since, WAY * (1.0 - (1.0 + since / SLOWS) * np.exp(-since / SLOWS)))])
    deck.add("*LOAD_NODE_POINT", *loads).add("*BOUNDARY_PRESCRIBED_MOTION_NODE", (led, 1, 2, 2, 1.0))
    deck.add("*DAMPING_GLOBAL", (0, 12.0))
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, PENALTY, FRICTION), (0.0, 1.0e20), (0.0, 0.1))
    return deck.output(plot=END, glstat=END / 20), nodes


def check_contact_patch(run):
    """Uniform pressure and traction mu p over rows of small elements, and uniform stress behind them."""
    for kind in sorted(PASS_PATCH):
        deck, nodes = contact_patch(kind)
        result = run.program(deck, name=f"contact_patch_{kind}")
        force, x = result.points("contact_force")[-1], result.points("Points")[-1, :, 0]
        for (ids, face), side, sign in zip(nodes, ("upper", "lower"), (1.0, -1.0)):
            length = np.diff(x[ids[face] - 1])
            length = 0.5 * (np.append(length, 0.0) + np.append(0.0, length))
            found = sign * force[ids[face] - 1, :2] / length[:, None] / PRESSURE
            run.check(f"contact patch, {TYPES[kind]}: pressure, {side} side", found[:, 1], 1.0)
            run.check(f"contact patch, {TYPES[kind]}: traction is mu p, {side} side", -found[:, 0], FRICTION * found[:, 1])
        stress = result.cells("stress")[-1]
        run.check(f"contact patch, {TYPES[kind]}: stress of all elements", stress[:, [1, 3]] / PRESSURE,
                  np.broadcast_to([-1.0, FRICTION], (len(stress), 2)))


#: Taylor bar of copper (as the case taylor_bar).
BAR, SPEED, STOPS = (3.2e-3, 32.4e-3), 227.0, 80.0e-6


def taylor(coordinates, quads, hanging):
    """The impact end slides on a plane that does not give way."""
    deck = Deck("Taylor bar with hanging nodes").control(STOPS).hourglass(1, 0.1)
    deck.add("*PART", "rod", (1, 1, 1)).add("*SECTION_SHELL", (1, 15), (1.0,))
    deck.plastic(8930.0, 117.0e9, 0.35, 400.0e6, 117.0e9 * 100.0e6 / (117.0e9 + 100.0e6))
    ids = deck.mesh(coordinates, quads)
    if hanging:
        deck.hang(ids, hanging)
    deck.fix(ids[coordinates[:, 1] == 0.0], y=1).node_set(1, ids).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    return deck.output(plot=STOPS, glstat=STOPS / 100.0)


def check_taylor(run):
    """The lower half divided once against the whole bar: radius, length and largest plastic strain, and the updates."""
    coarse, quads = grid(5, 50, *BAR)
    low = {k for k, quad in enumerate(quads) if coarse[quad[0], 1] < 0.5 * BAR[1]}
    outcomes = []
    for marked in (set(range(len(quads))), low):
        result = run.program(taylor(*divide(coarse, quads, marked)), name=f"taylor_{len(marked)}")
        places, energy = result.points("Points")[-1], result.table("glstat")
        run.check(f"Taylor bar, {len(marked)} divided: energy ratio", energy["energy_ratio"], 1.0)
        outcomes.append((places[:, 0].max(), np.ptp(places[:, 1]), result.cells("plastic_strain")[-1].max(),
                         len(result.cells("plastic_strain")[-1]) * energy["cycle"][-1]))
    for what, found, expected in zip(("radius", "length", "largest plastic strain"), outcomes[1], outcomes[0]):
        run.check(f"Taylor bar: {what} with hanging nodes", found, expected)
    run.report("Taylor bar: updates over those of the whole bar divided", outcomes[1][3] / outcomes[0][3])


def expected_errors(places, quads, stress, jump, segments):
    """Energy of the nodal means less the stress of each element, 2x2 points, and of the jumps at the loaded ends of segments."""
    s = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    shapes = [0.25 * (1 + s[:, 0] * x) * (1 + s[:, 1] * y) for x, y in s / np.sqrt(3.0)]
    slopes = [0.25 * np.array([s[:, 0] * (1 + s[:, 1] * y), s[:, 1] * (1 + s[:, 0] * x)]) for x, y in s / np.sqrt(3.0)]
    volumes = np.array([[np.linalg.det(slope @ places[quad]) for slope in slopes] for quad in quads])
    sums, weights = np.zeros((len(places), 4)), np.zeros(len(places))
    for quad, volume, row in zip(quads, volumes.sum(1), stress):
        sums[quad] += volume * row
        weights[quad] += volume
    means = sums / weights[:, None]

    def density(row):
        trace = row[:3].sum()
        return ((1 + POISSON) * (row[:3] @ row[:3] + 2.0 * row[3] ** 2) - POISSON * trace ** 2) / (2.0 * YOUNG)

    energy = np.array([sum(volume * density(shape @ means[quad] - row) for volume, shape in zip(parts, shapes))
                       for quad, parts, row in zip(quads, volumes, stress)])
    for element, ends in segments:
        energy[element] += volumes[element].sum() * 0.5 * (jump[ends] @ jump[ends]) / (2.0 * YOUNG)
    return energy


def check_errors(run):
    """The field `error` of two bodies of one row in contact, from stress and contact pressure of the same state."""
    deck = Deck("error of each element").control(0.006).hourglass(4, 0.1).add("*DATABASE_ERROR_INDICATOR")
    meshes = [grid(3, 1, 0.7, 0.2, (0.2, 0.0)), grid(4, 1, 1.0, 0.3, (0.0, -0.3))]
    ids = [deck.part(part).elastic(RHO, YOUNG, POISSON, part).mesh(*mesh, part=part) for part, mesh in enumerate(meshes, 1)]
    deck.node_set(1, ids[0][:4]).node_set(2, ids[1][:4:-1]).node_set(3, ids[0]).fix(ids[1][:5], x=1, y=1)
    deck.add("*INITIAL_VELOCITY", (3,), (0.0, -1.0)).contact(1, 2, 7, 1.0e7)
    result = run.program(deck.output(plot=0.006, glstat=0.006), name="errors")
    places = result.points("Points")[-1, :, :2]
    stress, pressure = result.cells("stress")[-1], result.points("contact_pressure")[-1]
    found = []
    for part, (nodes, (_, quads)) in enumerate(zip((ids[0] - 1, ids[1] - 1), meshes)):
        elements = slice(0, 3) if part == 0 else slice(3, 7)
        # The pressure -s_nn of an element of the only row, with the normal of its face, by lengths at the nodes.
        faces = [[a, a + 1] for a in range(3)] if part == 0 else [[a + 6, a + 5] for a in range(4)]
        row, length = np.zeros(len(nodes)), np.zeros(len(nodes))
        for ends, (xx, yy, _, xy) in zip(faces, stress[elements, :4]):
            along = np.diff(places[nodes[ends]], axis=0)[0]
            size = np.linalg.norm(along)
            x, y = along[1] / size, -along[0] / size
            row[ends] -= size * (xx * x ** 2 + yy * y ** 2 + 2.0 * xy * x * y)
            length[ends] += size
        loaded = (pressure[nodes] != 0.0) & (length > 0.0)
        jump = np.where(loaded, pressure[nodes] - row / np.where(length > 0.0, length, 1.0), 0.0)
        run.true(f"two bodies of one row, part {part + 1}: nodes are loaded", loaded.any())
        found.append(expected_errors(places[nodes], np.array(quads), stress[elements, :4], jump, enumerate(faces)))
    run.check("two bodies of one row: error of elements", result.cells("error")[-1], np.concatenate(found))


def check(run):
    for points, implicit in ((None, False), (4, False), (4, True)):
        for n in (1, 3):
            check_patch(run, points, implicit, n)
    check_newton(run)
    check_balances(run)
    check_step(run)
    check_contact_patch(run)
    check_taylor(run)
    check_errors(run)
