# SPDX-License-Identifier: MIT
"""Contact of bodies of revolution: patch tests on discs, rings and cones, and block-to-block as discs."""
import pathlib
import sys

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "block_to_block"))

import static_patch  # noqa: E402
from chain import Blocks, solve  # noqa: E402
from contact_types import PASS_PATCH, TYPES  # noqa: E402
from meshes import Deck, quad_areas  # noqa: E402
from patch_layouts import inclined_block, lines, load_edges, outer_chains  # noqa: E402
from slideline_tools.scenes import block  # noqa: E402

YOUNG, RHO, PENALTY, HOURGLASS, POINTS = 1.0e6, 1000.0, 1.0e6, 0.1, 4
DECAY = 34.0   # of the slowest mode, in powers of e: 2e-15 left
RADII = {"disc": 0.0, "ring": 0.5}
MESHES = {"5/4": (lines(5), lines(4)), "7/5 graded": (lines(7, 0.35), lines(5, -0.3)),
          "2/7 graded": (lines(2), lines(7, 0.3))}
SLOPE = np.tan(np.radians(20.0))


def areas(r, length=None):
    """Integrals of r by the hat functions of the nodes of a chain: l (2 r_i + r_j)/6 of each segment."""
    length = np.abs(np.diff(r)) if length is None else length
    total = np.zeros(len(r))
    total[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    total[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return total


def longest_sides(coordinates, quads):
    corner = np.asarray(coordinates)[np.asarray(quads)]
    return np.max(np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=-1), axis=1)


class Bodies:
    """Two bodies of revolution on each other, damped to rest under the pressure of curve 1."""

    def __init__(self, title, columns, inner, upper, lower, poisson, penalty, load):
        low, high, springs = static_patch.frequencies(
            static_patch.Blocks(*columns, YOUNG), RHO, penalty)
        sound = np.sqrt(YOUNG * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)) / RHO)
        thin = min(np.min(quad_areas(*part) / longest_sides(*part)) for part in (upper, lower))
        # Axisymmetric bodies are a little stiffer than plane ones: a third off their steps.
        step = min(1.0 / high, 0.6 / springs, 0.5 * thin / sound)
        low *= 0.7
        self.deck = deck = Deck(title)
        end = DECAY / low
        deck.control(end, dt=end / np.ceil(end / step)).hourglass(4, HOURGLASS)
        deck.add("*SECTION_SHELL", (1, 15), (1.0,))
        for part in (1, 2):
            deck.part(part, section=1).elastic(RHO, YOUNG, poisson, part)
        shift = np.array([inner, 0.0])
        self.upper = deck.mesh(upper[0] + shift, upper[1], part=1)
        self.lower = deck.mesh(lower[0] + shift, lower[1], part=2)
        deck.curve(1, [(0.0, 0.0), (0.4 * end, load), (2.0 * end, load)])
        deck.add("*DAMPING_GLOBAL", (0, 2.0 * low))
        deck.output(plot=end / 2, glstat=end / 20, rcforc=end / 20)
        self.faces = [outer_chains(ids, len(x) - 1) for ids, x in zip((self.upper, self.lower), columns)]
        self.slave, self.master = self.faces[0][0], self.faces[1][2]
        deck.node_set(1, self.slave).node_set(2, self.master)
        deck.fix(self.faces[1][0], y=1)


def at_rest(run, name, result):
    energy = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end",
              energy["kinetic"][-1] / energy["internal"][-1], 0.0)


def check_flat(run, layout, body, kind, poisson):
    """Uniform pressure on the top, free sides: uniform axial stress, for any nu."""
    columns, inner, load = MESHES[layout], RADII[body], 1.0
    blocks = [static_patch.block_grid(x, bottom) for x, bottom in zip(columns, (0.0, -1.0))]
    scene = Bodies(f"{body}, type {kind}", columns, inner, *blocks, poisson, PENALTY, load)
    load_edges(scene.deck, scene.faces[0][2])
    result = run.program(scene.deck.contact(1, 2, kind, PENALTY, gauss=POINTS))
    name = f"{TYPES[kind]}, {body}, {layout}, nu {poisson}"
    at_rest(run, name, result)
    force = result.points("contact_force")[-1, :, 1]
    radius = result.points("Points")[-1, :, 0]
    sides = [("slave", scene.slave, 1.0), ("master", scene.master[::-1], -1.0)]
    pressures = [sign * force[ids - 1] / areas(radius[ids - 1]) for _, ids, sign in sides]
    if kind not in PASS_PATCH:
        for (side, *_), pressure in zip(sides, pressures):
            run.report(f"{name}: max |p/p0 - 1| on the {side} side", np.max(np.abs(pressure / load - 1.0)))
        return
    for (side, *_), pressure in zip(sides, pressures):
        run.check(f"{name}: pressure on the {side} side", pressure, load)
    stress = result.cells("stress")[-1]
    run.check(f"{name}: axial stress in all elements", stress[:, 1], -load)
    run.check(f"{name}: other stresses", stress[:, [0, 2, 3]], 0.0)
    last = result.table("contact")
    last = last.where(time=last["time"][-1])
    run.check(f"{name}: table, length", last["length"], areas(radius[scene.slave - 1]))
    run.check(f"{name}: table, pressure", last["pressure"], load)
    side = result.table("rcforc").where(side="slave")
    run.check(f"{name}: resultant per radian", side["fy"][-1],
              load * np.sum(areas(inner + columns[0])))


def check_cone(run, body, kind, load):
    """An interface inclined by 20 degrees, the load on all outer faces: hydrostatic. A slave place
    stands d = g sin(20 degrees) sideways of its foot: the radii of both sides differ by that, and of
    the master's end segment as much is not covered. Both are parts of d/h, which falls with the load."""
    columns, inner, penalty = (lines(5, 0.2), lines(4, -0.2)), RADII[body], 1.0e6
    upper = inclined_block(columns[0], lambda x: SLOPE * x, lambda x: 1.0 + 0.0 * x)
    lower = inclined_block(columns[1], lambda x: -1.0 + 0.0 * x, lambda x: SLOPE * x)
    scene = Bodies(f"cone, {body}, type {kind}", columns, inner, upper, lower, 0.3, penalty, load)
    for faces, contact in zip(scene.faces, (0, 2)):
        for k, chain in enumerate(faces):
            if k == contact or faces is scene.faces[1] and k == 0 or inner == 0.0 and k == 3:
                continue
            load_edges(scene.deck, chain)
    result = run.program(scene.deck.contact(1, 2, kind, penalty, gauss=POINTS))
    name = f"{TYPES[kind]}, cone on a {body}, load {load:.0e}"
    at_rest(run, name, result)
    position = result.points("Points")[-1, :, :2]
    force = result.points("contact_force")[-1, :, :2]
    gap = load / (penalty * 5.0 * np.cos(np.arctan(SLOPE)))
    errors = []
    for ids in (scene.slave, scene.master):
        x = position[ids - 1]
        edge = np.diff(x, axis=0)
        t = edge.sum(axis=0) / np.linalg.norm(edge.sum(axis=0))
        wanted = load * areas(x[:, 0], np.linalg.norm(edge, axis=1))
        errors.append(np.max(np.abs(force[ids - 1] / wanted[:, None] - [-t[1], t[0]])))
    if kind in PASS_PATCH:
        # An end node on the axis has an area h^2/6, one farther out some r h/2: at most 3 d/h of it.
        shortest = min(np.min(np.diff(x)) for x in columns)
        limit = 3.0 * gap * np.sin(np.arctan(SLOPE)) / shortest + 2.0e-9
        for side, error in zip(("slave", "master"), errors):
            run.check(f"{name}: nodal forces on the {side} side over those of uniform pressure",
                      error, 0.0, tol=limit)
    else:
        for side, error in zip(("slave", "master"), errors):
            run.report(f"{name}: max |p/p0 - 1| on the {side} side", error)


def check_discs(run, kind):
    """Block-to-block with x as the radius: nu = 0, so every column moves as in the plane."""
    text = block(kind, POINTS)
    text = text if isinstance(text, str) else text.text()
    head, tail = text.split("*SECTION_SHELL", 1)
    assert tail.count("13", 0, 200) >= 1
    result = run.program(head + "*SECTION_SHELL" + tail.replace("13", "15", 1), name=f"discs{kind}")
    chain = solve(Blocks())
    contact = result.table("contact")
    pressure = contact["pressure"].reshape(len(result.times), -1)
    step = np.rint(result.times / Blocks.step).astype(int)
    scale = chain.pressure.max()
    name = f"{TYPES[kind]}, block-to-block as discs"
    force = result.points("contact_force")[-1, :, 1]
    radius = result.points("Points")[-1, :, 0]
    on_master = np.flatnonzero(force < 0.0)
    on_master = on_master[np.argsort(radius[on_master])]
    master = -force[on_master] / areas(radius[on_master])
    if kind not in PASS_PATCH:
        for side, found in (("slave", pressure[-1]), ("master", master)):
            run.report(f"{name}: largest deviation from uniform pressure, {side} side",
                       np.max(np.abs(found / np.mean(found) - 1.0)))
        return
    run.check(f"{name}: pressure along the slave surface, all states", pressure / scale,
              np.broadcast_to(chain.pressure[step, None] / scale, pressure.shape))
    run.check(f"{name}: pressure on the slave at 0.2 s", pressure[-1], 8119.9718)
    run.check(f"{name}: pressure on the master at 0.2 s", master, 8119.9718)


def check(run):
    for kind in TYPES:
        for layout in MESHES if kind in PASS_PATCH else ["5/4"]:
            for body in RADII:
                for poisson in (0.0, 0.3):
                    check_flat(run, layout, body, kind, poisson)
        for body in RADII:
            for load in ((1.0, 0.1) if kind in PASS_PATCH else (1.0,)):
                check_cone(run, body, kind, load)
        check_discs(run, kind)
