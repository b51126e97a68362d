# SPDX-License-Identifier: MIT
"""Random convex polygons that fly at each other, corners first: the decks, and what a run is measured by."""
import dataclasses

import numpy as np

from contact_types import MOMENT_FREE
from meshes import Deck, angular_momentum, lumped_mass, polygon, polygon_quads, rotate
from overlap import overlap_area

RHO, YOUNG, POISSON = 1000.0, 1.0e7, 0.3
SOUND = np.sqrt(YOUNG / RHO)
END = 60.0 / SOUND
APPROACH = 0.025                                   # of the speed of sound, each body to the common centre
FAMILIES = ("pair", "rigid slave", "rigid master", "three")
# TSSFAC, PUNIT and PEN: stiff springs, the stiffest that two longer steps allow, and the built-in ones.
SPRINGS = ((0.25, 3, 0.5), (0.5, 3, 1.0), (0.9, 3, 1.0), (0.9, 2, 1.0))


@dataclasses.dataclass(frozen=True)
class Scene:
    """One random scene: the same bodies, speeds and springs for all contact types."""

    family: str
    seed: int

    @property
    def name(self):
        return f"{self.family}, seed {self.seed}"

    def rng(self):
        return np.random.default_rng([FAMILIES.index(self.family), self.seed])

    def springs(self):
        """TSSFAC, PUNIT and PEN."""
        return SPRINGS[self.seed % len(SPRINGS)]

    def bodies(self):
        """Coordinates, quads and velocity of each body; they come from all sides to the origin."""
        rng = self.rng()
        n = 3 if self.family == "three" else 2
        found = []
        for k in range(n):
            coordinates, quads = polygon_quads(polygon(rng, 1.0), int(rng.integers(2, 5)))
            coordinates = rotate(coordinates, 2.0 * np.pi * rng.random())
            side, way = 0.6 * (rng.random() - 0.5), 2.0 * np.pi * k / n
            away = np.array([np.cos(way), np.sin(way)])
            place = (1.15 if n == 2 else 1.4) * away + side * np.array([-away[1], away[0]])
            found.append((coordinates + place, quads, -APPROACH * SOUND * away))
        return found

    def deck(self, kind, states=6.0):
        """`states`: time between plotted states in lengths over the speed of sound."""
        scale, unit, penalty = self.springs()
        deck = Deck(f"{self.name}, type {kind}")
        deck.control(END, scale=scale)
        bodies = self.bodies()
        for part, (coordinates, quads, velocity) in enumerate(bodies, 1):
            is_rigid = self.family == ("", "rigid slave", "rigid master")[part % 3]
            deck.part(part)
            if is_rigid:
                deck.add("*MAT_RIGID", (part, RHO, YOUNG, POISSON), (1, 0, 0), (0.0,))
            else:
                deck.elastic(RHO, YOUNG, POISSON, part)
            nodes = deck.mesh(coordinates, quads, part=part)
            deck.node_set(part, nodes).add("*INITIAL_VELOCITY", (part,), tuple(velocity))
            deck.add("*SET_PART_LIST", (part,), (part,))
        deck.hourglass(4, 0.05)
        for slave in range(1, len(bodies) + 1):
            for master in range(slave + 1, len(bodies) + 1):
                deck.add("*CONTACT_2D_SLIDELINE", (slave, master, kind, 4, penalty), (0.0, 1.0e20, unit))
        deck.add("*DATABASE_SLEOUT", (0.25 / SOUND,))
        return deck.output(plot=states / SOUND, glstat=1.0 / SOUND, matsum=1.0 / SOUND)


def made_and_lost(result):
    """Energy that the springs made (largest at any time) and that they lost (at the end), over E0. What one
    interface lost pays for nothing that another one made."""
    springs, start = result.table("sleout"), result.table("glstat")["total"][0]
    made = lost = 0.0
    for interface in np.unique(springs["interface"]):
        rows = springs.where(interface=interface)
        balance = rows["energy"] - rows["stored"]
        made += max(0.0, -np.min(balance))
        lost += max(0.0, balance[-1])
    return made / start, lost / start


def measure(run, scene, kind):
    """Run a scene and measure it."""
    result = run.program(scene.deck(kind), name=f"{scene.family.replace(' ', '_')}_{scene.seed}_type{kind}",
                         expect_status=None)
    bodies = scene.bodies()
    made, lost = made_and_lost(result)
    energy, parts = result.table("glstat"), result.table("matsum")
    mass = [lumped_mass(coordinates, quads, RHO) for coordinates, quads, _ in bodies]
    size = sum(m.sum() for m in mass) * APPROACH * SOUND
    momentum = [sum(parts.where(part=k + 1)[f"momentum_{axis}"] for k in range(len(bodies))) for axis in "xy"]
    position, velocity = result.points("Points")[..., :2], result.points("velocity")[..., :2]
    turning = angular_momentum(np.concatenate(mass), position, velocity)
    shared = [overlap_area(places, bodies) for places in position]
    return {
        "family": scene.family, "seed": scene.seed, "kind": kind,
        "ended": result.status == 0,
        "hit": bool(np.max(result.table("sleout")["stored"]) > 0.0),
        "made": made, "lost": lost,
        "ratio": float(np.max(np.abs(energy["energy_ratio"] - 1.0))),
        "momentum": float(max(np.max(np.abs(p - p[0])) for p in momentum) / size),
        "turning": float(np.max(np.abs(turning - turning[0])) / size) if kind in MOMENT_FREE else 0.0,
        "overlap": shared[-1], "deepest": max(shared)}
