# SPDX-License-Identifier: MIT
"""Taylor bar of 42CrMo4 by the law of Johnson and Cook against two other programs."""
import numpy as np

from meshes import Deck, grid

LENGTH, RADIUS, SPEED, END = 32.4e-3, 3.2e-3, 287.0, 80.0e-6
YOUNG, POISSON, DENSITY, HEAT, SHARE = 206.0e9, 0.3, 7830.0, 460.0, 0.9
ROOM, MELT = 20.0, 1540.0
#: Final length and diameter in mm, temperature in deg C and plastic strain of the element in the middle of the impact end.
PUBLISHED = {"DynELA": (26.52, 11.15, 582.34, 1.78), "Abaqus": (26.56, 11.16, 590.96, 1.81)}


def bar(columns, rows, points=None, kind=1):
    """Its impact end stays on the wall and slides on it. CP over the share of the work that heats: the law heats by all of it."""
    deck = Deck("Taylor bar of 42CrMo4").control(END).hourglass(kind, 0.1)
    deck.add("*PART", "rod", (1, 1, 1)).add("*SECTION_SHELL", (1, 15, None, points), (1.0,))
    deck.add("*MAT_JOHNSON_COOK", (1, DENSITY, YOUNG / (2.0 * (1.0 + POISSON)), YOUNG, POISSON, 0.0, 1.0),
             (806.0e6, 614.0e6, 0.168, 0.0089, 1.1, MELT, ROOM, 1.0), (HEAT / SHARE,), (0.0,))
    nodes = deck.mesh(*grid(columns, rows, RADIUS, LENGTH))
    deck.fix(nodes[:columns + 1], y=1).node_set(1, nodes).add("*INITIAL_VELOCITY", (1,), (0.0, -SPEED))
    return deck.output(plot=END / 4, glstat=END / 100)


def measure(run, name, deck, columns, rows):
    result = run.program(deck, name=name)
    places = result.points("Points")[-1][:, :2]
    temperature, strain = result.cells("temperature")[-1].ravel(), result.cells("plastic_strain")[-1].ravel()
    table = result.table("glstat")
    run.check(f"{name}: energy ratio", table["energy_ratio"], np.ones_like(table["time"]))
    # Mass of each quad per radian over its height: r dr.
    edge = RADIUS * np.arange(columns + 1) / columns
    mass = np.tile(DENSITY * 0.5 * np.diff(edge ** 2) * LENGTH / rows, rows)
    heat = np.sum(mass * HEAT / SHARE * (temperature - ROOM))
    # What is left of the blow without heat is elastic: 2 GPa^2/(2E) of a part of the bar.
    run.check(f"{name}: heat beside the internal energy", heat, table["internal"][-1])
    diameter = 2e3 * places[:columns + 1, 0].max()
    return 1e3 * (places[-1, 1] - places[:, 1].min()), diameter, temperature[0], strain[0]


def check(run):
    what = ("length, mm", "diameter of the impact end, mm", "temperature of the middle of the impact end", "plastic strain there")
    for name, points in (("one point", None), ("2x2 points", 4)):
        found = measure(run, name, bar(5, 50, points), 5, 50)
        for quantity, value, *published in zip(what, found, *PUBLISHED.values()):
            low, high = min(published), max(published)
            run.check(f"{name}: {quantity}, beyond the two programs",
                      max(low - value, value - high, 0.0) / high, 0.0)
            run.report(f"{name}: {quantity}", value)
