# SPDX-License-Identifier: MIT
"""Contact that makes or loses energy says so; contact that holds it, and its damping, do not."""
import re

import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

RHO, YOUNG, POISSON = 1000.0, 1.0e7, 0.3
SOUND = np.sqrt(YOUNG / RHO)
TOLD = re.compile(r"Warning: interface (\d+): at cycle (\d+), time (\S+), the contact springs have (made|lost) energy: "
                  r"(\S+), (\S+) % of the largest energy so far (\S+) .*?(?:near node (\d+) at \((\S+), (\S+)\))?"
                  r".*", re.I)
IN_ALL = re.compile(r"interface (\d+): in the whole run the contact springs have (made|lost) energy: (\S+),", re.I)


def polygon(rng, radius):
    """Corners of a convex polygon about the origin, counter-clockwise."""
    n = int(rng.integers(3, 9))
    angles = np.sort(2.0 * np.pi * (np.arange(n) + 0.6 * rng.random(n)) / n)
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def quads_of(corners, n):
    """Each corner with the halves of its sides and the centre is a quad of n x n elements."""
    centre, points, quads, known = corners.mean(axis=0), [], [], {}

    def place(point):
        key = tuple(np.round(point, 12))
        if key not in known:
            known[key] = len(points)
            points.append(point)
        return known[key]

    for k, corner in enumerate(corners):
        before, after = 0.5 * (corners[k - 1] + corner), 0.5 * (corner + corners[(k + 1) % len(corners)])
        block = np.empty((n + 1, n + 1), dtype=int)
        for i in range(n + 1):
            for j in range(n + 1):
                a, b = i / n, j / n
                block[i, j] = place((1 - a) * (1 - b) * centre + a * (1 - b) * before + a * b * corner
                                    + (1 - a) * b * after)
        quads += [(block[i, j], block[i + 1, j], block[i + 1, j + 1], block[i, j + 1])
                  for i in range(n) for j in range(n)]
    return np.array(points), quads


def polygons(seed, kind):
    """Two of them on each other, closed outlines."""
    rng = np.random.default_rng(seed)
    deck = Deck(f"polygons {seed}, type {kind}")
    deck.control(60.0 / SOUND, scale=0.5)
    for part, x, speed in ((1, -1.15, 0.025), (2, 1.15, -0.025)):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
        coordinates, quads = quads_of(polygon(rng, 1.0), int(rng.integers(2, 5)))
        turn = 2.0 * np.pi * rng.random()
        turned = coordinates @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        nodes = deck.mesh(turned + (x, 0.6 * rng.random()), quads, part=part)
        deck.node_set(part, nodes).add("*INITIAL_VELOCITY", (part,), (speed * SOUND, 0.0))
        deck.add("*SET_PART_LIST", (part,), (part,))
    deck.hourglass(4, 0.05)
    deck.add("*CONTACT_2D_SLIDELINE", (1, 2, kind, 4, 0.5), (0.0, 1.0e20, 3))
    deck.add("*DATABASE_SLEOUT", (1.0 / SOUND,))
    return deck.output(glstat=1.0 / SOUND)


def log_of(result):
    return (result.folder / f"{result.job}.log").read_text()


def unwrapped(text):
    return re.sub(r"\n\s+", " ", text)


def bodies(energy):
    """What the bodies hold: all but contact."""
    return energy["total"] - energy["contact"]


def explore(run):
    for kind in (5, 6, 7):
        for seed in range(30):
            result = run.program(polygons(seed, kind), name=f"p{kind}_{seed}")
            energy = result.table("glstat")
            sle = result.table("sleout")
            print(kind, seed, bodies(energy)[-1] / bodies(energy)[0] - 1.0, energy["energy_ratio"][-1],
                  (sle["energy"] - sle["stored"])[-1] / energy["total"][0], sle["stored"][-1])
            for line in unwrapped(log_of(result)).split("\n"):
                if "springs have" in line:
                    print("   ", line)


def check(run):
    explore(run)
