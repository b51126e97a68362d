# SPDX-License-Identifier: MIT
"""The collision as a full model, its own mirror image: what force there is across the line of symmetry. Random
bodies, their mirror images, and the same with a search in every cycle: alike to round-off."""
import pathlib

import numpy as np

import images
from contact_types import TYPES
from meshes import Deck, grid_quads

HERE = pathlib.Path(__file__).resolve().parent

ALUMINIUM, STEEL = (2700.0, 69.0e9, 0.33), (7850.0, 210.0e9, 0.3)
YIELD, SPEED, GAP = 276.0e6, 80.0, 0.5e-3
STEP, END = 1.0e-7, 6.0e-5
SOFT, STIFF = 1.0e9, 1.0e10   # N/m per node
ROUND_OFF = 1.0e-8    # of the largest force; the bodies' answer to the sideways push too
ALIKE = 1.0e-11       # of the largest displacement, after some hundred cycles


def both_sides(half):
    return np.concatenate([-half[:0:-1], half])


def tensor_grid(x, y):
    return np.array([(a, b) for b in y for a in x]), grid_quads(len(x) - 1, len(y) - 1)


def scene(kind, penalty, is_closed):
    """Deck, faces or whole outlines as surfaces; rows of nodes of the slave and of the master surface, both in the order of x."""
    deck = Deck(f"collision, both halves, type {kind}")
    deck.control(END, STEP)
    deck.part(1).part(2).plastic(*ALUMINIUM, YIELD, material=1).elastic(*STEEL, material=2)
    plate_x = both_sides(np.concatenate([np.linspace(0.0, 0.025, 21), np.linspace(0.025, 0.065, 17)[1:]]))
    plate = deck.mesh(*tensor_grid(plate_x, np.linspace(-0.005, 0.0, 5)), 1).reshape(5, -1)
    block_x = both_sides(np.linspace(0.0, 0.02, 25))
    block = deck.mesh(*tensor_grid(block_x, GAP + np.linspace(0.0, 0.005, 5)), 2).reshape(5, -1)
    deck.fix(np.concatenate([plate[:, 0], plate[:, -1]]), x=1, y=1)
    deck.node_set(1, block.ravel()).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    master = plate[-1][np.abs(plate_x) < 0.0251]
    if is_closed:
        deck.add("*SET_PART_LIST", (1,), (2,)).add("*SET_PART_LIST", (2,), (1,))
        deck.add("*CONTACT_2D_SLIDELINE", (1, 2, kind, 4, penalty))
    else:
        deck.node_set(2, block[0]).node_set(3, master[::-1]).contact(2, 3, kind, penalty, gauss=4)
    return deck.output(plot=4.0 * STEP), block[0] - 1, master - 1


def half_kinks(line):
    """Half of the turn at each inner node of a line of places, 0 at its ends."""
    way = np.diff(line, axis=0)
    angle = np.arctan2(way[:, 1], way[:, 0])
    return np.abs(0.5 * np.diff(angle, prepend=angle[0], append=angle[-1]))


def tied(force, places, sides):
    """Most that round-off can turn sideways: where nodes stand on each other one of two neighbouring
    segments has the node, and its normal leans by half of the kink."""
    kinks = [half_kinks(places[side]) for side in sides]
    total = 0.0
    for i, slave in enumerate(sides[0]):
        beside = np.abs(places[sides[1], 0] - places[slave, 0])
        j = int(np.argmin(beside))
        if beside[j] < 1.0e-6:
            total += np.hypot(*force[slave]) * np.sin(max(kinks[0][i], kinks[1][j]))
    return total


def judge(run, kind, penalty=SOFT, is_closed=False):
    name = f"{TYPES[kind]}{', stiff, whole outlines' if is_closed else ''}"
    deck, *sides = scene(kind, penalty, is_closed)
    result = run.program(deck, name=f"type{kind}{'_closed' * is_closed}")
    force, places = (result.points(field)[..., :2] for field in ("contact_force", "Points"))
    sums = force[:, sides[0]].sum(axis=1)
    largest = np.max(np.abs(sums[:, 1]))
    allowed = np.array([tied(*state, sides) for state in zip(force, places)])
    run.check(f"{name}: sideways force beyond that of nodes on nodes / largest force",
              np.max(np.abs(sums[:, 0]) - allowed) / largest, ROUND_OFF)
    run.report(f"{name}: largest sideways force / largest force",
               np.max(np.abs(sums[:, 0])) / largest)


def judge_images(run, deck):
    """A scene, its mirror image and both with FREQ 1: the same displacements."""
    text = deck.read_text()
    moved = {}
    for name, marks in (("", {}), ("mirror image", {"is_mirrored": True}), ("FREQ 1", {"is_searched": True})):
        result = run.program(images.image(text, **marks), "smooth=-1", name=f"{deck.stem}_{name.replace(' ', '_')}")
        moved[name] = result.points("displacement")[..., :2] * ([-1.0, 1.0] if "is_mirrored" in marks else 1.0)
    largest = np.max(np.abs(moved[""]))
    for name in ("mirror image", "FREQ 1"):
        run.check(f"{deck.stem}, {name}: difference of displacements / largest",
                  np.max(np.abs(moved[name] - moved[""])) / largest, ALIKE)


def check(run):
    for kind in TYPES:
        judge(run, kind)
    judge(run, 3, STIFF, True)
    for deck in sorted(HERE.glob("*.k")):
        judge_images(run, deck)
