# SPDX-License-Identifier: MIT
"""Press fit of a solid shaft in a hub against Lame, all contact types."""
import numpy as np

from contact_types import PASS_PATCH, TYPES
from meshes import Deck, grid

YOUNG, POISSON, RHO, OUTER, HEIGHT = 1000.0, 0.3, 1.0, 2.0, 1.0
PENALTY = 2.0e4   # N/m^3 with PUNIT 1: a layer of springs, 1.9 % of the compliance of the bodies
ROWS, COLUMNS = {"4/5": (4, 5), "7/5": (7, 5)}, 8
SMALL = 1.0e-7   # interference over the radius: what is not linear is of this size
#: Springs so soft that the hub does not leave the shaft when the interference is let go: README.md.
SOFT = 1.0e3
DECAY, STEP = 40.0, 5.0e-4


def lame(interference, held, springs):
    """Pressure of a solid shaft in a hub of the same material, radius 1 in 1 to 2, with a layer of springs and with
    rigid ones."""
    ends = 1.0 - POISSON ** 2 if held else 1.0
    ratio = POISSON / (1.0 - POISSON) if held else POISSON
    shaft = (1.0 - ratio) * ends / YOUNG
    hub = ((OUTER ** 2 + 1.0) / (OUTER ** 2 - 1.0) + ratio) * ends / YOUNG
    return interference / (shaft + hub + 1.0 / springs), interference / (shaft + hub)


def press_fit(kind, rows, interference, held, exchanged=False, penalty=PENALTY):
    """The shaft is too thick by the interference; both bodies find their rest under damping."""
    deck = Deck(f"press fit, type {kind}")
    end = DECAY / 18.0
    deck.control(end, dt=STEP).hourglass(4, 0.1)
    deck.add("*SECTION_SHELL", (1, 15), (1.0,))
    for part in (1, 2):
        deck.part(part, section=1).elastic(RHO, YOUNG, POISSON, part)
    # As much too thick as makes both radii the same at rest but for a part of second order.
    shaft_grid = grid(COLUMNS, rows[0], 1.0 + interference, HEIGHT)
    hub_grid = grid(COLUMNS, rows[1], OUTER - 1.0, HEIGHT, (1.0, 0.0))
    shaft = deck.mesh(*shaft_grid, part=1).reshape(rows[0] + 1, COLUMNS + 1)
    hub = deck.mesh(*hub_grid, part=2).reshape(rows[1] + 1, COLUMNS + 1)
    deck.node_set(1, shaft[:, -1]).node_set(2, hub[::-1, 0])
    ends = [*shaft[0], *hub[0], *([*shaft[-1], *hub[-1]] if held else [])]
    deck.fix(ends, y=1)
    deck.add("*DAMPING_GLOBAL", (0, 60.0))
    deck.contact(*((2, 1) if exchanged else (1, 2)), kind, penalty, unit=1, gauss=4)
    deck.output(plot=end, glstat=end / 10, rcforc=end / 10)
    return deck, shaft, hub


def pressures(result, nodes):
    """Radial contact force over the integral of r by the hat functions of a straight chain in y."""
    force = np.abs(result.points("contact_force")[-1, nodes - 1, 0])
    place = result.points("Points")[-1, nodes - 1]
    length = np.diff(place[:, 1])
    area = np.zeros(len(nodes))
    r = place[:, 0]
    area[:-1] += length * (2.0 * r[:-1] + r[1:]) / 6.0
    area[1:] += length * (r[:-1] + 2.0 * r[1:]) / 6.0
    return force / area


def springs_of(kind, penalty):
    """N/m^3: two passes are two layers."""
    return penalty * (2.0 if kind == 3 else 1.0)


def check_fit(run, kind, layout, held, interference=SMALL, exchanged=False, penalty=None):
    penalty = penalty or (PENALTY if held else SOFT)
    deck, shaft, hub = press_fit(kind, ROWS[layout], interference, held, exchanged, penalty)
    result = run.program(deck)
    name = (f"{TYPES[kind]}, {layout}, ends {'held' if held else 'free'}" + (", hub the slave" if exchanged else "")
            + (f", interference {interference:g}" if interference != SMALL else "")
            + (", stiff springs" if penalty > SOFT and not held else ""))
    energy = result.table("glstat")
    run.check(f"{name}: kinetic / internal energy at the end",
              energy["kinetic"][-1] / energy["internal"][-1], 0.0)
    expected = lame(interference, held, springs_of(kind, penalty))[0]
    sides = {"shaft": pressures(result, shaft[:, -1]), "hub": pressures(result, hub[:, 0])}
    # Strains, and where ends are free the part of the end segment that slides off: 0.3 of the interference.
    bound = (2.0 if held else 2.0 + 0.3 * max(ROWS[layout])) * interference + 1e-8
    exact = kind in PASS_PATCH and (held or penalty == SOFT)
    for side, pressure in sides.items():
        if exact:
            run.check(f"{name}: pressure on the {side}", pressure, expected, tol=bound)
        else:
            run.report(f"{name}: largest |p/p_Lame - 1| on the {side}", np.max(np.abs(pressure / expected - 1.0)))
    if exact:
        r = grid(COLUMNS, 1, 1.0 + interference, HEIGHT)[0][:COLUMNS + 1, 0]
        found = result.points("displacement")[-1, shaft - 1, 0]
        ratio = (1.0 + POISSON) * (1.0 - 2.0 * POISSON) if held else 1.0 - POISSON
        run.check(f"{name}: radial displacement of all nodes of the shaft", found,
                  np.broadcast_to(-ratio * expected / YOUNG * r, found.shape), scale=bound)
    return np.mean([pressure.mean() for pressure in sides.values()])


def check(run):
    for kind in TYPES:
        for held in (True, False):
            for layout in ROWS:
                check_fit(run, kind, layout, held)
        check_fit(run, kind, "4/5", True, exchanged=True)
        check_fit(run, kind, "4/5", False, penalty=PENALTY)
        for held, number in ((True, 0.412088), (False, 0.375)):
            mean = check_fit(run, kind, "7/5", held, 1.0e-3)
            stiff = lame(1.0, held, springs_of(kind, PENALTY if held else SOFT))
            text = f"{TYPES[kind]}, ends {'held' if held else 'free'}, interference 1e-3: mean pressure, rigid springs"
            if kind in PASS_PATCH:
                run.check(text, mean * stiff[1] / stiff[0], number)
            else:
                run.report(text, mean * stiff[1] / stiff[0], f"Lame: {number}")
