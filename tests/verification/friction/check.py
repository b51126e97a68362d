# SPDX-License-Identifier: MIT
"""Coulomb friction of interfaces: blocks that slide, stick, start and stop, by every type."""
import subprocess

import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, rotate

RHO, YOUNG, POISSON = 1000.0, 1.0e8, 0.3
GRAVITY, RAMP = 9.81, 0.02
WIDTH, HEIGHT = 1.0, 0.1
MASS = RHO * WIDTH * HEIGHT
#: Penalty, N/m^2.
PENALTY = 2.0e8


def block(kind, friction, speed=0.0, end=0.5, tilt=0.0, ramp=RAMP, base=(0.6, 2.0), angle=0.0, card_3=None):
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
        deck.add("*DAMPING_GLOBAL", (0, 4000.0, 0.0, 1.0))
    deck.add("*CONTACT_2D_SLIDELINE", (-11, -12, kind, 3, PENALTY, *friction), (0.0, 1.0e20, 1),
             *([card_3] if card_3 else []))
    deck.output(glstat=1.0e-3, matsum=1.0e-3, rcforc=1.0e-3, nodout=1.0e-3, plot=end / 4, nodes=nodes[4:5]).add("*DATABASE_SLEOUT", (1.0e-3,))
    return deck, nodes, along


def check(run):
    for kind in TYPES:
      for mu in (0.1, 0.3):
        speed = 1.0
        slowing = mu * GRAVITY
        deck, nodes, _ = block(kind, (mu,), speed, 1.3 * speed / slowing, base=(0.6, 1.6 + 0.6 * speed**2 / slowing))
        result = run.program(deck, name=f"level{kind}_{mu}")
        e = result.table("glstat"); s = result.table("sleout"); f = result.table("rcforc").where(side="slave")
        node = result.node(int(nodes[4]))
        ramp = 0.5 * speed * RAMP - slowing * RAMP ** 2 / 24.0
        print(kind, mu, "way", node["ux"][-1] / (0.5 * speed ** 2 / slowing + ramp), "diss", e["friction"][-1] / (0.5 * MASS),
              "monot", np.min(np.diff(e["friction"])) / (0.5 * MASS), "bal", np.max(np.abs(e["total"] - e["external_work"] - e["total"][0])) / e["total"][0],
              "ratio", np.max(np.abs(f["fx"]) / np.maximum(f["fy"], 1e-3)), "sle", np.max(np.abs(s["friction"]-e["friction"])), "stops", np.ptp(node["ux"][-100:]), np.ptp(e["contact"]))
    run.true("x", True)
