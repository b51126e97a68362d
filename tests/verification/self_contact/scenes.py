# SPDX-License-Identifier: MIT
"""Decks of bodies in contact with themselves and with each other in one part set."""
import numpy as np

import static_patch
from meshes import Deck, grid, polygon_quads, rotate

RHO, YOUNG, POISSON, PENALTY = 1000.0, 1.0e6, 0.3, 3.0e5


def with_itself(deck, parts, kind, penalty, unit, friction=0.0):
    """One set of parts, and its contact with itself."""
    parts = list(parts)
    deck.add("*SET_PART_LIST", (9999,), *[parts[k:k + 8] for k in range(0, len(parts), 8)])
    return deck.add("*CONTACT_2D_SLIDELINE", (9999, 0, kind, 3, penalty, friction), (0.0, 1.0e20, unit))


def octagons(rows, columns, seed, order=None, mirrored=False, cells=2, renumbered=False):
    """Bodies (x, quads, velocity) on a lattice with spaces between them, moving inwards. `renumbered`: nodes of each
    the other way round, and its elements too, which begin at their third node."""
    rng = np.random.default_rng(seed)
    corners = np.array([(0.45 * np.cos(a), 0.45 * np.sin(a)) for a in np.pi * np.arange(8) / 4.0])
    shape, quads = polygon_quads(corners, cells)
    quads, found = np.array(quads), []
    for i in range(rows):
        for j in range(columns):
            x = rotate(shape, rng.uniform(0.0, 2.0 * np.pi)) + np.array([j, i], dtype=float)
            away = np.array([j - 0.5 * (columns - 1), i - 0.5 * (rows - 1)])
            found.append((x, quads, -4.0 * away / columns + rng.uniform(-0.5, 0.5, 2)))
    if mirrored:
        found = [(x * [-1.0, 1.0], q[:, ::-1], v * [-1.0, 1.0]) for x, q, v in found]
    if renumbered:
        found = [(x[::-1], len(x) - 1 - np.roll(q, 2, axis=1)[::-1], v) for x, q, v in found]
    return [found[k] for k in (order if order is not None else range(len(found)))]


def free_bodies(bodies, end, dt, is_axisymmetric=False):
    """A deck with these bodies, part by part, or rings of them about an axis 4 m away; the contact is the caller's."""
    deck = Deck(f"{len(bodies)} bodies")
    deck.control(end, dt=dt).hourglass(4, 0.1)
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    for part, (x, quads, velocity) in enumerate(bodies, start=1):
        x = x + [4.0 if is_axisymmetric else 0.0, 0.0]
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
        deck.node_set(part, deck.mesh(x, quads, part=part))
        deck.add("*SET_PART_LIST", (part,), (part,)).add("*INITIAL_VELOCITY", (part,), velocity.tolist())
    return deck.output(plot=end / 10.0, glstat=end / 100.0)


def fork(kind):
    """A U whose arms are thrown against each other: its deck, coordinates and quads."""
    x, quads = grid(9, 20, 0.9, 2.0)
    quads = np.array(quads)
    middle = x[quads].mean(axis=1)
    quads = quads[~((middle[:, 0] > 0.4) & (middle[:, 0] < 0.5) & (middle[:, 1] > 0.3))]
    used, quads = np.unique(quads, return_inverse=True)
    x, quads = x[used], quads.reshape(-1, 4)
    deck = Deck(f"a U of two arms, type {kind}").control(0.5, scale=0.5).hourglass(4, 0.1).part()
    deck.elastic(RHO, YOUNG, POISSON)
    ids = deck.mesh(x, quads)
    speed = np.where(x[:, 0] < 0.45, 3.0, -3.0) * np.maximum(0.0, x[:, 1] - 0.3)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(n), v, 0.0) for n, v in zip(ids, speed)])
    return with_itself(deck, [1], kind, 3.0, 2).output(plot=0.02, glstat=2.0e-3), x, quads


#: Two arms: their thickness, elements over it, length, the slot between them, their speed and that of sound (nu = 0).
ARM, N_ARM, ARM_LENGTH, SLOT, ARM_SPEED = 0.25, 16, 1.5, 1.0e-4, 0.1
ARM_SOUND = np.sqrt(YOUNG / RHO)


def arms(kind):
    """A U whose arms meet flat, nu = 0: far from base and tips the contact is that of two bars as long as the arms are
    thick. Returns the deck, coordinates and nodes on the inner side of the left arm."""
    h = ARM / N_ARM
    x, quads = grid(2 * N_ARM + 1, round(ARM_LENGTH / h), 2.0 * ARM + h, ARM_LENGTH)
    quads = np.array(quads)
    middle, axis = x[quads].mean(axis=1), ARM + 0.5 * h
    quads = quads[~((np.abs(middle[:, 0] - axis) < 0.1 * h) & (middle[:, 1] > 0.25))]
    used, quads = np.unique(quads, return_inverse=True)
    x, quads = x[used], quads.reshape(-1, 4)
    side = np.where(x[:, 0] < axis, 1.0, -1.0)
    share = side * np.clip((x[:, 1] - 0.25) / 0.25, 0.0, 1.0)
    inner = np.nonzero((np.abs(x[:, 0] - axis) < 0.51 * h) & (side > 0.0) & (x[:, 1] > 0.9) & (x[:, 1] < 1.3))[0]
    x[:, 0] += 0.5 * (h - SLOT) * share
    deck = Deck(f"a U of arms that meet flat, type {kind}").control(3.5 * ARM / ARM_SOUND, scale=0.6).hourglass(4, 0.1)
    deck.part().elastic(RHO, YOUNG, 0.0)
    ids = deck.mesh(x, quads)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(n), v, 0.0) for n, v in zip(ids, ARM_SPEED * share)])
    every = 2.0 * ARM / ARM_SOUND / 50.0
    return with_itself(deck, [1], kind, 7.5, 2).output(plot=every, glstat=every), x, inner


def plates(deck, boxes, speed, end):
    """Elastic plates from boxes (origin, width, height), parts from 2 on: the first is driven downwards, the last stands."""
    found = []
    for part, (origin, width, height, columns) in enumerate(boxes, start=2):
        x, quads = grid(columns, 1, width, height, origin)
        deck.part(part)
        ids = deck.mesh(x, quads, part=part)
        deck.node_set(part, ids).fix(ids, x=1, y=int(part == 3))
        found.append((x, np.array(quads)))
    deck.curve(2, [(0.0, 0.0), (0.05 * end, -speed), (2.0 * end, -speed)])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (2, 2, 0, 2, 1.0))
    return found


def stacked(meshes):
    """Coordinates and quads of several meshes as one."""
    first = np.cumsum([0] + [len(x) for x, _ in meshes[:-1]])
    return np.vstack([x for x, _ in meshes]), np.vstack([np.asarray(q) + k for (_, q), k in zip(meshes, first)])


def ring(kind, columns=64, layers=2):
    """A ring pressed flat between two plates until it closes on itself. The plates are shifted against each other, so that no vertex
    of the ring meets a node of theirs: there round-off decides on which segment it is."""
    inner, thick, gap, end = 0.9, 0.1, 1.0e-4, 1.0
    angle = 2.0 * np.pi * np.arange(columns) / columns
    x = np.array([(r * np.cos(a), r * np.sin(a)) for r in inner + thick * np.arange(layers + 1) / layers for a in angle])
    quads = np.array([(j * columns + i, (j + 1) * columns + i, (j + 1) * columns + (i + 1) % columns,
                       j * columns + (i + 1) % columns) for j in range(layers) for i in range(columns)])
    deck = Deck(f"a ring pressed flat, type {kind}").control(end).hourglass(4, 0.1).part()
    deck.plastic(RHO, YOUNG, POISSON, 0.01 * YOUNG, 0.01 * YOUNG)
    deck.mesh(x, quads)
    meshes = [(x, quads)]
    for part, left, low in ((2, -1.78, 1.0 + gap), (3, -1.82, -1.2 - gap)):
        y, q = grid(24, 2, 3.6, 0.2, (left, low))
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
        ids = deck.mesh(y, q, part=part)
        deck.node_set(part, ids).fix(ids, x=1).curve(part, [(0.0, 0.0), (end, 0.88 if part == 3 else -0.88)])
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (part, 2, 2, part, 1.0))
        meshes.append((y, q))
    return with_itself(deck, (1, 2, 3), kind, 10.0, 2).output(plot=0.1, glstat=0.01), *stacked(meshes)


def tube(kind, is_axisymmetric, crushed=0.55, layers=2, points=None, speed=60.0, rows=48, hardening=500.0):
    """Mild steel in mm, ms, N: a tube of radius 20 and thickness 1 (or a strip clamped at its ends), crushed between two
    plates; its upper end goes with the plate. `layers` of elements, with `points` integration points; `hardening`: ETAN."""
    radius, length, end = 20.0, 40.0, crushed * 40.0 / speed
    x, quads = grid(layers, rows, 1.0, length, (radius - 0.5, 0.0))
    x[:, 0] += 0.15 * np.exp(-((x[:, 1] - 0.85 * length) / (0.06 * length)) ** 2)
    deck = Deck(f"a folding {'tube' if is_axisymmetric else 'strip'}, type {kind}").control(end).hourglass(3, 0.05)
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13, None, points), (1.0,)).part()
    for material, stress in ((1, 300.0), (2, 3.0e4), (3, 3.0e4)):
        deck.plastic(7.8e-3, 2.0e5, POISSON, stress, hardening, material=material)
    ids = deck.mesh(x, quads)
    across = 1.0e-3
    others = plates(deck, (((radius - 14.0, length + across), 28.0, 2.0, 14), ((radius - 14.0, -2.0 - across), 28.0, 2.0, 14)),
                    speed, end)
    deck.fix(ids[:layers + 1], 1, 1).fix(ids[-layers - 1:], x=1).node_set(8, ids[-layers - 1:])
    deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (8, 2, 0, 2, 1.0))
    return with_itself(deck, (1, 2, 3), kind, 10.0, 2).output(plot=end / 10.0, glstat=end / 200.0), \
        *stacked([(x, quads), *others])


def tumbling_ring(kind, end=1.0):
    """A ring one element thick that flies and spins, wrinkled by its speed: nothing of it ever touches."""
    columns = 48
    angle = 2.0 * np.pi * np.arange(columns) / columns
    x = np.array([(r * np.cos(a), r * np.sin(a)) for r in (0.95, 1.0) for a in angle])
    quads = [(i, columns + i, columns + (i + 1) % columns, (i + 1) % columns) for i in range(columns)]
    deck = Deck(f"a tumbling ring, type {kind}").control(end).hourglass(4, 0.1).part().elastic(RHO, YOUNG, POISSON)
    ids = deck.mesh(x, quads)
    wrinkle = 1.0 * np.cos(2.0 * np.arctan2(x[:, 1], x[:, 0]))
    velocity = 6.0 * x[:, ::-1] * [-1.0, 1.0] + wrinkle[:, None] * x + [3.0, 1.0]
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(n), *v) for n, v in zip(ids, velocity)])
    return with_itself(deck, [1], kind, 10.0, 2).output(plot=end / 10.0, glstat=end / 100.0), x, quads


def pressed_blocks(kind, blocks, friction, pressure, share=0.3, eps=1.0e6):
    """The frictional patch test of whole outlines, static: two blocks (nu 0) in one set under a pressure and a shear that
    their sides carry, the upper one back by the shift of its tangential springs."""
    deck = Deck(f"patch test in one set, type {kind}")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0)).add("*CONTROL_IMPLICIT_AUTO", (1,))
    shear = share * pressure if friction else 0.0
    for part in (1, 2):
        deck.part(part, points=4).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(blocks.upper - [shear / eps, 0.0], blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower, blocks.lower_quads, part=2)
    stress = np.array([[0.0, shear], [shear, -pressure]])
    force = np.zeros((len(blocks.x), 2))
    for first, x, columns, sides in ((0, blocks.upper, len(blocks.slave), (1, 2, 3)),
                                     (len(upper), blocks.lower, len(blocks.master), (1, 3))):
        rows = first + np.arange(len(x)).reshape(-1, columns)
        for k, chain in enumerate((rows[0], rows[:, -1], rows[-1, ::-1], rows[::-1, 0])):
            if k not in sides:
                continue
            edge = np.diff(blocks.x[chain] + np.outer(blocks.x[chain, 1] + 1.0, [2.0 * shear, -pressure]) / YOUNG, axis=0)
            half = 0.5 * np.stack([edge[:, 1], -edge[:, 0]], axis=1) @ stress
            np.add.at(force, chain[:-1], half)
            np.add.at(force, chain[1:], half)
    deck.fix(lower[:len(blocks.master)], 1, 1)
    if not friction:
        deck.fix(upper[-len(blocks.slave):][:1], x=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(k + 1, dof + 1, 1, force[k, dof]) for k in range(len(force)) for dof in (0, 1)
                                   if force[k, dof]])
    return with_itself(deck, (1, 2), kind, eps, 1, friction).output(plot=1.0, glstat=1.0)


def ring_areas(r):
    """Integrals of the hat functions of a chain along the radius, times it."""
    length, total = np.diff(r), np.zeros(len(r))
    total[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    total[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return total


def pressed_discs(kind, blocks, pressure, eps=1.0e6):
    """The patch test of two whole discs (nu 0) in one set, axisymmetric and static, under a pressure on the upper one."""
    deck = Deck(f"patch test of discs in one set, type {kind}")
    deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0))
    deck.add("*SECTION_SHELL", (1, 15, None, 4), (1.0,))
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(blocks.upper, blocks.upper_quads, part=1)
    lower = deck.mesh(blocks.lower, blocks.lower_quads, part=2)
    deck.fix(lower[:len(blocks.master)], y=1).curve(1, [(0.0, 0.0), (1.0, 1.0)])
    deck.add("*LOAD_NODE_POINT", *[(int(n), 2, 1, -pressure * a) for n, a in
                                   zip(upper[-len(blocks.slave):], ring_areas(blocks.lines[0]))])
    return with_itself(deck, (1, 2), kind, eps, 1).output(plot=1.0, glstat=1.0)


def disc_error(result, blocks, pressure):
    """Largest deviation of the axial tractions of both sides, over the pressure."""
    force, r = result.points("contact_force")[-1], result.points("Points")[-1, :, 0]
    return max(np.max(np.abs(sign * force[nodes, 1] / ring_areas(r[nodes]) / pressure - 1.0))
               for nodes, sign in ((blocks.slave, 1.0), (blocks.master, -1.0)))


def patch_error(result, blocks, pressure, shear):
    """Largest deviation of the tractions of both sides from uniform ones, over the pressure."""
    force, x = result.points("contact_force")[-1], result.points("Points")[-1, :, 0]
    worst = 0.0
    for nodes, sign in ((blocks.slave, 1.0), (blocks.master, -1.0)):
        found = sign * force[nodes, :2] / static_patch.hat_areas(x[nodes])[:, None]
        worst = max(worst, np.max(np.abs(found - [-shear, pressure])) / pressure)
    return worst


def deepest(x, quads):
    """How deep a node lies in an element that it is no node of, m."""
    x, quads = np.asarray(x)[:, :2], np.asarray(quads)
    corner = x[quads]
    edge = np.roll(corner, -1, axis=1) - corner
    length = np.maximum(np.linalg.norm(edge, axis=2), 1.0e-30)
    low, high, worst = corner.min(axis=1), corner.max(axis=1), 0.0
    for k, place in enumerate(x):
        for e in np.nonzero(np.all((place > low) & (place < high), axis=1) & ~np.any(quads == k, axis=1))[0]:
            d = place - corner[e]
            worst = max(worst, np.min((edge[e, :, 0] * d[:, 1] - edge[e, :, 1] * d[:, 0]) / length[e]))
    return worst
