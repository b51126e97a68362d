# SPDX-License-Identifier: MIT
"""Random polygons meet with their corners: energy that contact makes, momentum, and who ends inside whom."""
import concurrent.futures
import csv
import os

import numpy as np

from contact_types import MOMENT_FREE, TYPES
from meshes import Deck, grid, rotate
from scene import FAMILIES, Scene, measure

#: Most energy that contact may make, over E0.
MADE = 0.02
#: Bodies that share more of the smaller one's area than type 2 leaves, and than this, are inside each other.
OVERLAP = 0.01
ONE_PASS = 2
#: With friction: in the first one forces are limited in most cycles.
RUBBED = [("three", 52004), ("pair", 52004)]
#: A block of 1 m x 1 m that rocks: its energy from the corner to the side, springs that it goes 3 mm into by a half segment.
GRAVITY, ROCKING_PENALTY = 10.0, 1000.0 * 10.0 / 0.003 * 8.0
FALL, AT_ONCE = 1000.0 * GRAVITY * (np.sqrt(0.5) - 0.5), 0.03
#: Types, angles in degrees and segments of the plate.
ROCKING = ((5, 41, 40), (5, 41, 24), (5, 38, 32))
#: Scenes of every family that are run with all types, in full and in CI.
FIXED = {"pair": range(5), "rigid slave": range(3), "rigid master": range(3), "three": range(3)}
FEW = {"pair": range(4), "rigid slave": range(2), "rigid master": range(2), "three": range(2)}


def measure_all(run, scenes):
    """Rows of all types in all scenes, as many at a time as there are cores."""
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        rows = list(pool.map(lambda pair: measure(run, *pair), [(scene, kind) for scene in scenes for kind in TYPES]))
    left = {(row["family"], row["seed"]): row["overlap"] for row in rows if row["kind"] == ONE_PASS}
    for row in rows:
        row["excess"] = row["overlap"] - max(OVERLAP, left[row["family"], row["seed"]])
    return rows


def columns(rows, **wanted):
    """The rows with the wanted values, column by column."""
    kept = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    return {key: np.array([row[key] for row in kept]) for key in rows[0]}


def judge(run, rows):
    """What holds for each type in all scenes."""
    for kind, name in TYPES.items():
        found = columns(rows, kind=kind)
        run.check(f"{name}: momentum, largest change / sum of |p|", found["momentum"], 0.0)
        if kind in MOMENT_FREE:
            run.check(f"{name}: angular momentum, largest change / (sum of |p| x 1 m)",
                      found["turning"], 0.0)
        run.check(f"{name}: runs that ended early", np.sum(~found["ended"]), 0)
        run.check(f"{name}: made by contact / E0, largest", np.max(found["made"]), MADE)
        run.report(f"{name}: made by contact / E0, share of scenes above {MADE}", np.mean(found["made"] > MADE))
        run.report(f"{name}: lost by contact / E0, largest", np.max(found["lost"]))
        run.check(f"{name}: bodies inside each other, scenes", np.sum(found["excess"] > 0.0), 0)


def table(rows):
    """Types by families: share of scenes above 2 %, the largest, and those with bodies inside each other."""
    lines = ["| type | " + " | ".join(FAMILIES) + " |", "|---" * (1 + len(FAMILIES)) + "|"]
    for kind, name in TYPES.items():
        cells = []
        for family in FAMILIES:
            found = columns(rows, kind=kind, family=family)
            if not len(found["made"]):
                cells.append("")
                continue
            cells.append(f"{np.sum(found['made'] > MADE)} of {len(found['made'])}, {np.max(found['made']):.2g}; "
                         f"lost {np.max(found['lost']):.2g}; inside {np.sum(found['excess'] > 0.0)}, "
                         f"{np.max(found['overlap']):.2g}; ended {np.sum(~found['ended'])}")
        lines.append(f"| {kind} {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def check_rubbing(run, family, seed, kind):
    """With mu 1: what friction has dissipated does not come back, though forces are limited, and all energies balance."""
    name = f"{TYPES[kind]}, mu 1, {family} {seed}"
    result = run.program(Scene(family, seed).deck(kind), "fs=1", name=f"rubbed_{family}_{seed}_type{kind}")
    energy = result.table("glstat")
    start = energy["total"][0]
    run.check(f"{name}: largest fall of the dissipated energy / E0", -np.diff(energy["friction"]).min() / start, 0.0)
    run.check(f"{name}: dissipated / E0", energy["friction"][-1] / start, 1e-4)
    run.check(f"{name}: total / E0", energy["total"] / start, 1.0)


def rolling_deck(kind):
    """A rigid square of 2 x 2 quads strikes a plate with a corner at 41 degrees and rolls over on to its side."""
    end, turn = 0.44, np.radians(21.0)
    deck = Deck(f"rolling corner, type {kind}").control(2.0 * end, scale=0.5).output(glstat=end / 200)
    square, quads = grid(2, 2, 1.0, 1.0)
    deck.part(1).add("*MAT_RIGID", (1, 1000.0, 1.0e7, 0.3), (1, 0, 0), (0.0,))
    deck.mesh(rotate(square, np.radians(41.0)) + (0.03, 1.0e-9), quads, part=1)
    deck.add("*INITIAL_VELOCITY_RIGID_BODY", (1, 0.0, -0.3, 0.0, 0.0, 0.0, -turn / end))
    plate, quads = grid(4, 2, 4.0, 1.0, (-2.0, -1.0))
    nodes = deck.part(2).elastic(1000.0, 1.0e9, 0.3, 2).mesh(plate, quads, part=2)
    deck.fix(nodes[:5], 1, 1).hourglass(4, 0.05).add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
    return deck.add("*CONTACT_2D_SLIDELINE", (1, 2, kind, 2, 1.0e5)).add("*DATABASE_SLEOUT", (end / 200,))


def check_rolling(run, kind):
    """The spring of a corner that goes on from one side to the other stays as it is: it gives back what it took."""
    springs = run.program(rolling_deck(kind), name=f"rolling_{kind}").table("sleout")
    run.check(f"{TYPES[kind]}, rolling corner: made or lost / largest stored",
              np.max(np.abs(springs["energy"] - springs["stored"])) / np.max(springs["stored"]), 0.001)


def rocking_deck(kind, angle, segments):
    """A rigid square of 4 x 4 quads, the master, falls with a corner on a plate of so many segments and rocks."""
    deck = Deck(f"rocking block, type {kind}").control(1.0, scale=0.5)
    square, quads = grid(4, 4, 1.0, 1.0)
    deck.part(1).add("*MAT_RIGID", (1, 1000.0, 1.0e7, 0.3), (1, 0, 0), (0.0,))
    deck.mesh(rotate(square, np.radians(angle)) + (0.03, 0.0), quads, part=1)
    plate, quads = grid(segments, 2, 6.0, 1.0, (-3.0, -1.0))
    nodes = deck.part(2).elastic(1000.0, 1.0e9, 0.3, 2).mesh(plate, quads, part=2)
    deck.fix(nodes[:segments + 1], 1, 1).hourglass(4, 0.05).curve(1, [(0.0, 1.0), (1.0, 1.0)])
    deck.add("*LOAD_BODY_Y", (1, GRAVITY)).add("*SET_PART_LIST", (1,), (1,)).add("*SET_PART_LIST", (2,), (2,))
    deck.add("*CONTACT_2D_SLIDELINE", (2, 1, kind, 2, ROCKING_PENALTY))
    return deck.output(glstat=0.0025).add("*DATABASE_SLEOUT", (0.0025,))


def check_rocking(run, kind, angle, segments):
    """Where a corner of the master passes a slave node, this bears what the springs beside it bore: nothing is lost at once."""
    springs = run.program(rocking_deck(kind, angle, segments), name=f"rocking_{kind}_{angle}_{segments}").table("sleout")
    lost = np.diff(springs["energy"] - springs["stored"])
    run.check(f"{TYPES[kind]}, rocking block, {angle} degrees, {segments} segments: lost at once / energy of the fall",
              lost.max() / FALL, AT_ONCE)


def check(run):
    for kind in (2, 3, 6, 7):
        check_rolling(run, kind)
    for kind, angle, segments in ROCKING:
        check_rocking(run, kind, angle, segments)
    chosen = FIXED if run.is_full else FEW
    judge(run, measure_all(run, [Scene(family, seed) for family, seeds in chosen.items() for seed in seeds]))
    for family, seed in RUBBED if run.is_full else RUBBED[:1]:
        for kind in TYPES:
            check_rubbing(run, family, seed, kind)


def sweep(run, seed, count):
    """`count` new scenes of each family from `seed` on, all types; a table and a row for each run."""
    rows = measure_all(run, [Scene(family, seed + k) for family in FAMILIES for k in range(count)])
    with open(run.work / "sweep.csv", "w", newline="") as stream:
        writer = csv.DictWriter(stream, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    print(f"\nMade by contact / E0: scenes above {MADE}, largest; lost, largest; bodies inside each other, scenes, largest "
          f"share of an area; runs that ended early\n\n{table(rows)}\n\nall runs: {run.work / 'sweep.csv'}\n")
    judge(run, rows)
