# SPDX-License-Identifier: MIT
"""Round bodies are round: press fits of faceted circles against Lame, shafts that turn in a bore, fits that spin as one."""
import re

import numpy as np

from contact_types import TYPES
from meshes import Deck, angular_momentum, grid, lumped_mass

BORE, OUTER, HOLE = 1.0, 2.0, 0.5
#: Radial displacement per pressure of both rings together, E 1, nu 0.3, plane strain (Lame): interference / pressure.
COMPLIANCE = 1.0e-3 / 3.296703e-4


def ring(inner, outer, rows, facets, first=0.0, angle=2.0 * np.pi, uneven=0.0):
    """Nodes and quads of a ring, or a part of one, ray by ray; rays of a whole ring close. Every second ray may be turned by a
    part of a facet."""
    whole = angle >= 2.0 * np.pi
    rays = facets if whole else facets + 1
    turns = first + angle * (np.arange(rays) + uneven * (np.arange(rays) % 2)) / facets
    radii = np.linspace(inner, outer, rows + 1)
    nodes = np.array([(r * np.cos(t), r * np.sin(t)) for t in turns for r in radii])
    quads = [[k * (rows + 1) + i, k * (rows + 1) + i + 1, (k + 1) % rays * (rows + 1) + i + 1, (k + 1) % rays * (rows + 1) + i]
             for k in range(facets) for i in range(rows)]
    return nodes, np.array(quads)


class Fit:
    """A hollow shaft in a hub; the springs have the stiffness of one facet of the hub."""

    def __init__(self, facets, interference, rows, first=0.0, angle=2.0 * np.pi, uneven=0.0):
        self.deck = Deck("shaft in a hub")
        for part in (1, 2):
            self.deck.part(part, points=4).elastic(1.0, 1.0, 0.3, part)
        meshes = [ring(HOLE, BORE + interference, rows, facets[0], first, angle, uneven),
                  ring(BORE, OUTER, 2 * rows, facets[1], 0.0, angle)]
        self.shaft = self.deck.mesh(*meshes[0], part=1).reshape(-1, rows + 1)
        self.hub = self.deck.mesh(*meshes[1], part=2).reshape(-1, 2 * rows + 1)
        self.start = np.vstack([mesh[0] for mesh in meshes])
        self.quads = np.vstack([meshes[0][1], meshes[1][1] + self.shaft.size])
        self.facets, self.angle, self.interference = facets, angle, interference
        self.springs = facets[1] / angle

    def contact(self, kind, friction=0.0, damping=0.0, ramp=None, extra=None):
        """The shaft is the slave."""
        closed = self.angle >= 2.0 * np.pi
        slave, master = self.shaft[:, -1], self.hub[::-1, 0]
        self.deck.node_set(1, [*slave, *slave[:int(closed)]]).node_set(2, [*master, *master[:int(closed)]])
        penalty, unit = (self.springs * self.angle / self.facets[0], 0) if kind == 1 else (self.springs, 1)
        if ramp:
            self.deck.curve(1, ramp)
        self.deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 2, penalty, friction, friction), (None, None, unit, None, damping),
                      (None, None, None, None, None, 1 if ramp else None, None, extra))

    def hold_rays(self):
        """Symmetry of a quarter."""
        for body in (self.shaft, self.hub):
            self.deck.fix(body[0], y=1).fix(body[-1], x=1)

    def pressure(self, kind, interference):
        """Lame in series with the springs; two passes are two layers."""
        springs = self.springs * (2.0 if kind == 3 else 1.0)
        return interference / (1.0 / springs + COMPLIANCE)

    def found(self, result):
        """Mean pressure of shaft and hub, and the root mean square of the nodal ones about it, over it."""
        force, place = result.points("contact_force")[-1], result.points("Points")[-1]
        means, spread = [], []
        for nodes in (self.shaft[:, -1] - 1, self.hub[:, 0] - 1):
            radius = np.hypot(place[nodes, 0], place[nodes, 1])
            radial = np.abs(np.einsum("ij,ij->i", force[nodes, :2], place[nodes, :2]) / radius)
            share = np.full(len(nodes), self.angle / (len(nodes) if self.angle >= 6.0 else len(nodes) - 1))
            if self.angle < 6.0:
                share[[0, -1]] *= 0.5
            means.append(radial.sum() / self.angle)
            spread.append(np.sqrt(np.mean((radial / share / means[-1] - 1.0) ** 2)))
        return np.array(means), np.array(spread)


def static_fit(run, name, kind, fit):
    """The fit at rest, by four static steps; the rings stand on single nodes, a quarter on its rays."""
    fit.deck.add("*CONTROL_TERMINATION", (1.0,)).add("*CONTROL_IMPLICIT_GENERAL", (1, 0.25))
    fit.deck.add("*CONTROL_IMPLICIT_DYNAMICS", (0,))
    if fit.angle < 6.0:
        fit.hold_rays()
    else:
        for body, column in ((fit.shaft, 0), (fit.hub, -1)):
            fit.deck.fix([int(body[0, column]), int(body[len(body) // 2, column])], y=1)
        fit.deck.fix([int(fit.shaft[fit.facets[0] // 4, 0])], x=1)
    fit.contact(kind, ramp=[(0.0, 0.0), (1.0, 1.0)])
    result = run.program(fit.deck.output(plot=1.0))
    run.check(f"{name}: largest number of iterations", max(map(len, result.newton())), 5)
    run.true(f"{name}: all segments stand for arcs",
             reported("{0} of {0}".format(fit.facets[0]), "{0} of {0}".format(fit.facets[1])) in log_of(result))
    return fit.found(result)


def reported(slave, master):
    """What the log says of arcs."""
    return f"arcs: {slave} slave segments, {master} master"


def log_of(result):
    """Text of the log."""
    return (result.folder / f"{result.job}.log").read_text()


def judge_fit(run, name, kind, fit, found, size, spread=None):
    """Mean pressure of both sides within `size`, nodal ones of types 4, 5, 7 within `spread`, where there is one."""
    run.check(f"{name}: mean pressure over that of Lame", found[0] / fit.pressure(kind, fit.interference), 1.0, tol=size)
    if kind in (4, 5, 7) and spread:
        run.check(f"{name}: nodal pressures over their mean, root mean square", found[1], 0.0, tol=spread)


def check_fits(run):
    """A quarter with symmetry, static; 24 against 30 facets as whole rings."""
    for facets in ((12, 15), (15, 12), (24, 30), "24/30", "60/60, half a pitch", "48/60, long facets twice the short ones"):
        whole = isinstance(facets, str)
        counts = tuple(map(int, re.findall(r"\d+", facets))) if whole else facets
        label = facets if whole else f"{4 * counts[0]}/{4 * counts[1]}"
        size = 0.02 if label == "24/30" else 0.003 if counts[0] == 24 else 0.01
        for kind in TYPES:
            fit = Fit(counts, 1.0e-3, 6, np.pi / 60.0 if "pitch" in label else 0.0, 2.0 * np.pi if whole else 0.5 * np.pi,
                      1.0 / 3.0 if "long" in label else 0.0)
            name = f"{TYPES[kind]}, {label}"
            judge_fit(run, name, kind, fit, static_fit(run, name, kind, fit), size,
                      0.0 if "long" in label else 3.0 * size if label == "24/30" else 2.0 * size)
    for angle, kind in run.cover(range(12), TYPES, strength=1):
        fit = Fit((60, 60), 1.0e-3, 4, angle * np.pi / 1440.0)
        name = f"{TYPES[kind]}, 60/60, {angle}/48 of a pitch"
        judge_fit(run, name, kind, fit, static_fit(run, name, kind, fit), 0.01, 0.02)


def check_explicit(run):
    """The quarter of 48 against 60 facets, explicit: interference and damping bring it to rest."""
    end = 60.0
    for kind in TYPES:
        fit = Fit((12, 15), 1.0e-3, 6, angle=0.5 * np.pi)
        fit.hold_rays()
        fit.deck.control(end, scale=0.8).add("*DAMPING_GLOBAL", (0, 1.0))
        fit.contact(kind, ramp=[(0.0, 0.0), (end / 3.0, 1.0), (2.0 * end, 1.0)])
        result = run.program(fit.deck.output(plot=end, glstat=end))
        energies = result.table("glstat")
        name = f"{TYPES[kind]}, 48/60, explicit"
        run.check(f"{name}: kinetic / internal energy at the end", energies["kinetic"][-1] / energies["internal"][-1], 0.0)
        judge_fit(run, name, kind, fit, fit.found(result), 0.01, 0.02)


def momentum(fit, nodes, result):
    """Angular momentum of some nodes about the origin at all states, over the first."""
    mass = lumped_mass(fit.start, fit.quads, 1.0)
    values = np.array([angular_momentum(mass[nodes], x[nodes], v[nodes])
                       for x, v in zip(result.points("Points")[..., :2], result.points("velocity")[..., :2])])
    return values / values[0]


def spin(run, kind, facets, interference, both, turns, *, friction=0.0, damping=0.0, rise=0.05, extra=None):
    """A shaft that spins, or shaft and hub as one, explicit: the fit, nodes that move (from 0), what came
    out; the interference rises during a share of the time."""
    speed = 0.02
    end = 2.0 * np.pi * turns / speed
    fit = Fit(facets, interference, 3)
    fit.deck.control(end, scale=0.8)
    moves = np.arange(fit.shaft.size + (fit.hub.size if both else 0))
    if not both:
        fit.deck.fix(fit.hub[:, -1], x=1, y=1)
    fit.deck.add("*INITIAL_VELOCITY_NODE", *[(int(k + 1), -speed * fit.start[k, 1], speed * fit.start[k, 0]) for k in moves])
    fit.contact(kind, friction, damping, [(0.0, 0.0), (rise * end, 1.0), (2.0 * end, 1.0)], extra)
    return fit, moves, run.program(fit.deck.output(plot=end / 10.0))


def check_spin(run):
    """Without friction the bore takes nothing from the shaft; what spins as one keeps its spin, damped or held by friction."""
    for kind in TYPES:
        name = TYPES[kind]
        left = momentum(*spin(run, kind, (26, 30), 2.0e-3, False, 3.0))[-1]
        run.check(f"{name}: spin of a shaft in a bore after three turns", left, 1.0)
        left = momentum(*spin(run, kind, (26, 30), 1.0e-3, True, 1.0, damping=20.0))[-1]
        run.check(f"{name}: spin of a damped fit after a turn", left, 1.0)
        left = momentum(*spin(run, kind, (13, 15), 1.0e-3, True, 1.5, friction=0.3, extra=29))[-1]
        run.check(f"{name}: spin of a fit held by friction after a turn and a half", left, 1.0)


def check_torque(run, mu=0.1):
    """A shaft that turns in the bore, explicit: the moment of its contact forces over mu times radius times normal forces."""
    for kind in TYPES:
        fit, _, result = spin(run, kind, (26, 30), 2.0e-3, False, 0.1, friction=mu, rise=0.5)
        nodes = fit.shaft[:, -1] - 1
        place, force = (result.points(name)[-1, nodes, :2] for name in ("Points", "contact_force"))
        moment = np.sum(place[:, 0] * force[:, 1] - place[:, 1] * force[:, 0])
        normal = np.sum(np.abs(np.einsum("ij,ij->i", force, place)))
        run.check(f"{TYPES[kind]}: moment of friction over mu times normal forces times radius", -moment / (mu * normal), 1.0)


def rolling_height(run, kind):
    """Heights of the axis of a rigid disc of 48 facets, radius 1, that rolls by three of them on a rigid floor, the slave, over
    the sagitta. It sinks in by 1e-3 under its weight: three nodes of the floor touch at a time, of one facet."""
    facets, sink, end, mass, spacing = 48, 1.0e-3, 150.0, 0.03, 0.008
    way = 6.0 * np.pi / facets
    deck = Deck("rolling disc").control(end, dt=0.04)
    for part, held in ((1, 0), (2, 7)):
        deck.part(part).add("*MAT_RIGID", (part, mass / (0.75 * np.pi), 1.0e-3, 0.3), (1, held, held), (0.0,))
    nodes, quads = ring(0.5, 1.0, 1, facets, -0.5 * np.pi)
    disc = deck.mesh(nodes + [0.0, 1.0 - sink], quads, part=1).reshape(-1, 2)
    columns = round((way + 0.3) / spacing)
    floor = deck.mesh(*grid(columns, 1, way + 0.3, 0.1, (-0.15, -0.1)), part=2)[-columns - 1:]
    deck.node_set(1, floor[::-1]).node_set(2, [*disc[:, 1], disc[0, 1]])
    deck.add("*LOAD_BODY_Y", (1, 4.0 / 3.0 * sink * np.sqrt(2.0 * sink) / mass)).curve(1, [(0.0, 1.0), (1.0e6, 1.0)])
    deck.add("*INITIAL_VELOCITY_GENERATION", (1, 2, -way / end, way / end, 0.0), (0.0, 1.0 - sink))
    deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4, 0.5 if kind == 3 else 1.0), (None, None, 1, None, 20.0))
    pair = [int(disc[0, 0]), int(disc[facets // 2, 0])]
    result = run.program(deck.output(nodout=end / 300.0, nodes=pair))
    height = sum(result.node(node)["y"] for node in pair) / 2.0
    return height[len(height) // 3:] / (0.5 * (np.pi / facets) ** 2)


def check_rolling(run):
    """The height stays; with two passes nodes of the disc, which are further apart than contact is wide, act besides."""
    for kind in TYPES:
        height = rolling_height(run, kind)
        text = f"{TYPES[kind]}: height of a rolling disc over the sagitta, less its mean"
        if kind == 3:
            run.report(text, np.max(np.abs(height - height.mean())))
        else:
            run.check(text, height - height.mean(), 0.0)


def polygon(sides, radius=0.0, facets=1, parts=4):
    """Outline of a regular polygon about the origin, inner radius 1, counter-clockwise: `parts` segments a side, corners with
    fillets of `facets` segments each where there is a radius."""
    turn = 2.0 * np.pi / sides
    half = (1.0 - radius) * np.tan(0.5 * turn)
    share = np.linspace(0.0, 1.0, facets + 1)[:-1] if radius else np.zeros(0)
    points = []
    for k in range(sides):
        outward, along = (np.array([np.cos(k * turn + shift), np.sin(k * turn + shift)]) for shift in (0.0, 0.5 * np.pi))
        side = np.linspace(-half, half, parts + 1)
        points += [outward + along * way for way in side[:-1]]
        centre = (1.0 - radius) * outward + half * along
        points += [centre + radius * np.array([np.cos((k + part) * turn), np.sin((k + part) * turn)]) for part in share]
    return np.array(points)


def check_outlines(run):
    """Neither a line nor a corner has an arc; fillets have."""
    for name, outline, arcs in (("square", polygon(4), 0), ("hexagon", polygon(6), 0),
                                ("square with fillets", polygon(4, 0.3, 6), 24)):
        deck = Deck(name).control(1.0e-3)
        deck.part(1).elastic(1.0, 1.0, 0.3)
        rays = np.arange(len(outline))
        quads = [[2 * k, 2 * k + 1, 2 * after + 1, 2 * after] for k, after in zip(rays, np.roll(rays, -1))]
        body = deck.mesh(np.column_stack([0.5 * outline, outline]).reshape(-1, 2), quads).reshape(-1, 2)
        nodes, quads = ring(2.0, 3.0, 1, 24)
        bore = deck.mesh(nodes, quads).reshape(-1, 2)
        deck.node_set(1, [*body[:, 1], body[0, 1]]).node_set(2, [*bore[::-1, 0], bore[-1, 0]]).contact(1, 2, 5, 1.0, unit=1)
        run.true(f"{name}: arcs on fillets alone", reported(f"{arcs} of {len(outline)}", "24 of 24") in log_of(run.program(deck)))


def check_pin(run):
    """A pin with a rounded nose goes through a bore with a sharp edge, axisymmetric, without friction: no axial force while it
    slides in the bore. Virtual nodes of the nose come through the edge's two faces."""
    end, nose, radius = 300.0, 0.2, 1.005
    angles = np.linspace(-0.25 * np.pi, 0.0, 7)
    arc = np.stack([radius - nose + nose * np.cos(angles), 1.001 + nose * (np.sin(angles) + np.sqrt(0.5))], axis=1)
    shank = [(radius, arc[-1, 1] + (4.001 - arc[-1, 1]) * k / 30.0) for k in range(1, 31)]
    flank = np.vstack([arc, shank])
    for kind in TYPES if run.is_full else (2, 4, 6):
        deck = Deck("pin pressed into a bore").control(end, scale=0.8).hourglass(4, 0.1)
        deck.add("*SECTION_SHELL", (1, 15), (1.0,)).add("*DAMPING_GLOBAL", (0, 0.3))
        for part in (1, 2):
            deck.add("*PART", f"part {part}", (part, 1, part)).elastic(1.0, 1.0, 0.3, part)
        pin = deck.mesh(*rows([(x * k / 8.0, y) for x, y in flank for k in range(9)], 9)).reshape(-1, 9)
        hub = deck.mesh(*rows([(1.0 + 0.1 * k, y) for y in np.linspace(0.0, 1.0, 17) for k in range(11)], 11), part=2)
        hub = hub.reshape(-1, 11)
        deck.fix(pin[:, 0], x=1).fix(hub[0, 5:], y=1)
        deck.node_set(1, pin[:, -1]).node_set(2, [*hub[-1, 3::-1], *hub[-2::-1, 0]]).node_set(3, pin[-1])
        deck.curve(1, [(0.0, 0.0), (0.9 * end, -2.0), (2.0 * end, -2.0)])
        deck.add("*BOUNDARY_PRESCRIBED_MOTION_SET", (3, 2, 2, 1, 1.0)).contact(1, 2, kind, 5.0)
        force = run.program(deck.output(plot=end, rcforc=1.0)).table("rcforc")
        last = (force["side"] == "slave") & (force["time"] > 0.98 * end)
        run.check(f"{TYPES[kind]}: axial force of a pin in a bore over the radial one",
                  np.abs(force["fy"][last]).max() / np.abs(force["fx"][last]).max(), 0.0)


def rows(nodes, width):
    """Nodes in rows from below, each of so many, and their quads."""
    first = [row * width + k for row in range(len(nodes) // width - 1) for k in range(width - 1)]
    return np.array(nodes), np.array([[i, i + 1, i + width + 1, i + width] for i in first])


def check(run):
    check_fits(run)
    check_explicit(run)
    check_spin(run)
    check_torque(run)
    check_rolling(run)
    check_pin(run)
    check_outlines(run)
