# SPDX-License-Identifier: MIT
"""Ironing after Fischer and Wriggers: a die with a round foot goes down into a soft slab and along it, with friction."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.decks import Deck, Grid
from slideline_tools.histories import read_csv
from slideline_tools.scenes.common import elastic, energies_on, part, plane_strain

FRICTION = 0.3
YOUNG, POISSON = (6.896e8, 68.96e8), 0.32    # slab, die
RHO = 1000.0                                 # of the slab; the die is ten times as heavy: waves run as fast in both
#: Time in which a wave goes a unit of length.
UNIT = 1.0 / np.sqrt(YOUNG[0] / RHO)
SLAB, HEIGHT = 12.0, 4.0
RADIUS, CENTRE, TOP, HALF = 0.75, (0.8, 0.95), 1.4, 0.6
PRESS, DRAW = 150.0, 240.0                   # UNITs: way of 1 down, of 4 along
ALONG = 4.0
IRON_PENALTY = 2.0e10                        # N/m^2 at level 2, the mesh of the example
SOFT = 0.04                                  # of each way: until the speed is steady
DAMPING = 0.3                                # over a UNIT
SHARE = 0.3                                  # TSSFAC
#: Part of the way along in which forces are judged, places there, and cells of the slab at level 1.
JUDGED, PLACES, CELLS = (0.25, 0.975), 1001, 60


def passes(ctype, penalty):
    """The same stiffness for all types: two passes lie side by side."""
    return 0.5 * penalty if ctype == 3 else penalty


def ironing_grids(level):
    """Slab and die; level 2 has the example's 120 x 30 and 12 x 6 quads."""
    slab = Grid(np.linspace(0.0, SLAB, 60 * level + 1), np.linspace(-HEIGHT, 0.0, 15 * level + 1))
    die = Grid(np.linspace(CENTRE[0] - HALF, CENTRE[0] + HALF, 6 * level + 1), np.linspace(0.0, 1.0, 3 * level + 1),
               first_node=100001, first_element=100001)
    x, share = die.points[:, :, 0], die.points[:, :, 1]
    foot = CENTRE[1] - np.sqrt(RADIUS ** 2 - (x - CENTRE[0]) ** 2)
    die.points[:, :, 1] = foot + share * (TOP - foot)
    return slab, die


def way(start, length, distance):
    """(time, place) of a way at a steady speed, but for its first `SOFT` part."""
    rise = np.linspace(0.0, 1.0, 41)
    gone = 0.5 * SOFT * (rise - np.sin(np.pi * rise) / np.pi)
    speed = distance / (1.0 - 0.5 * SOFT)
    return [(UNIT * (start + length * SOFT * r), speed * s) for r, s in zip(rise, gone)] + [(UNIT * (start + length), distance)]


def ironing(ctype, level):
    """Down by 1, then along by `ALONG`; explicit, slow against the waves and damped. Foot and sides of the die are the
    slave, since it goes in deeper than its foot is high."""
    slab, die = ironing_grids(level)
    end = (PRESS + DRAW) * UNIT
    deck = Deck(f"ironing, type {ctype}, N_r = {level}")
    deck.keyword("CONTROL_TERMINATION").card("endtim", end)
    deck.keyword("CONTROL_TIMESTEP").card("dtinit tssfac", 0.0, SHARE)
    deck.keyword("CONTROL_HOURGLASS").card("ihq qh", 4, 0.05)
    energies_on(deck)
    for number, grid, rho in ((1, slab, RHO), (2, die, 10.0 * RHO)):
        part(deck, number, "slab" if number == 1 else "die", 1, number)
        elastic(deck, number, rho, YOUNG[number - 1], POISSON)
        grid.write(deck, number)
    plane_strain(deck, 1)
    deck.node_set(1, "bottom", slab.lower).spc_set(1, True, True)
    deck.node_set(2, "top of the die", die.upper)
    deck.node_set(3, "slave", [*die.left[1:-1], *die.lower, *die.right[1:-1]]).node_set(4, "master", slab.upper)
    deck.curve(1, "down", [*way(0.0, PRESS, -1.0), (2.0 * end, -1.0)])
    deck.curve(2, "along", [(0.0, 0.0), *way(PRESS, DRAW, ALONG), (2.0 * end, ALONG)])
    for direction in (2, 1):
        deck.keyword("BOUNDARY_PRESCRIBED_MOTION_SET").card("nsid dof vad lcid sf", 2, direction, 2, 3 - direction, 1.0)
    deck.keyword("DAMPING_GLOBAL").card("lcid valdmp", 0, DAMPING / UNIT)
    deck.keyword("CONTACT_2D_SLIDELINE").card("surfa surfb ctype ngauss pen fs", -3, -4, ctype, 4,
                                              passes(ctype, IRON_PENALTY * 0.5 * level), FRICTION)
    deck.card("tbirth tdeath punit", 0.0, 1.0e20, 1)
    return deck.database(glstat=end / 500.0, sleout=end / 500.0, rcforc=DRAW * UNIT / 2000.0, binary_d3plot=end / 100.0).text()


def forces_along(folder, jobid):
    """(horizontal, vertical) force of the die at even places of the judged part of the way, N/m."""
    rows = read_csv(folder / f"{jobid}.rcforc.csv").where(side="slave")
    share = np.linspace(*JUDGED, PLACES)
    times = (PRESS + DRAW * share) * UNIT
    if rows["time"][-1] < times[-1]:
        raise UserError(f"{folder}: ended before the way did")
    return np.array([np.interp(times, rows["time"], sign * rows[name]) for sign, name in ((-1.0, "fx"), (1.0, "fy"))])


def roughness(force, level):
    """Standard deviation from the running mean over one element of the slab, over the mean; the largest deviation too."""
    window = int(round(SLAB / (CELLS * level) / (ALONG * (JUDGED[1] - JUDGED[0])) * (PLACES - 1))) | 1
    mean = np.convolve(force, np.full(window, 1.0 / window), mode="valid")
    rest = force[window // 2:][:len(mean)] - mean
    return float(np.std(rest) / abs(np.mean(force))), float(np.max(np.abs(rest)) / abs(np.mean(force)))
