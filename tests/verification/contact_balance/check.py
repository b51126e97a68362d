# SPDX-License-Identifier: MIT
"""Contact returns no more than it took and says where it was limited; what it loses is reported; contact that holds its
energy, and damping, are left alone."""
import re

import numpy as np

from contact_types import TYPES
from meshes import Deck, grid, polygon, polygon_quads

RHO, YOUNG, POISSON = 1000.0, 1.0e7, 0.3
SOUND = np.sqrt(YOUNG / RHO)
ANY = re.compile(r"contact springs (?:created|lost)")
FIRST = re.compile(r"warning: interface (\d+): at cycle (\d+), time (\S+), the contact springs (created|lost) energy: "
                   r"(\S+), (\S+) % of the largest energy so far (\S+) .{0,120}?near node (\d+) at \((\S+), (\S+)\)")
LIMITED = re.compile(r"interface (\d+): contact forces limited to the admissible energy in (\d+) of (\d+) "
                     r"cycles with force, the smallest factor (\S+) at time (\S+)")
AGAIN = re.compile(r"warning: interface (\d+): at cycle (\d+), time \S+, contact forces limited.{0,160}")
IN_ALL = re.compile(r"warning: interface (\d+): in the whole run the contact springs (created|lost) energy: (\S+), "
                    r".*?up to time \S+")


def polygons(seed, kind):
    """Two of them on each other, closed outlines."""
    rng = np.random.default_rng(seed)
    deck = Deck(f"polygons {seed}, type {kind}")
    deck.control(60.0 / SOUND, scale=0.25)
    for part, x, speed in ((1, -1.15, 0.025), (2, 1.15, -0.025)):
        deck.part(part).elastic(RHO, YOUNG, POISSON, part)
        coordinates, quads = polygon_quads(polygon(rng, 1.0), int(rng.integers(2, 5)))
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
    """The log without its line breaks."""
    return " ".join((result.folder / f"{result.job}.log").read_text().split())


def bodies(energy):
    """What the bodies hold: all but contact."""
    return energy["total"] - energy["contact"]


def reported(result, pattern):
    return list(pattern.finditer(log_of(result)))


def end_energy(deck, per_cent):
    """ENDENG of a deck."""
    place = deck.lines.index("*CONTROL_TERMINATION") + 1
    deck.lines[place] = f"{deck.lines[place].rstrip(',')},0,0.0,{per_cent!r}"
    return deck


def flights(title, kind, *pairs):
    """Pairs of bars as below, each with its gap and the times of birth and death of its interface."""
    n, deck = 20, Deck(title)
    deck.control(4.0 / SOUND, scale=0.5)
    for k, (gap, birth, death) in enumerate(pairs):
        sets = [10 * k + i for i in (1, 2, 3)]
        for i in (1, 2):
            deck.part(10 * k + i).elastic(RHO, YOUNG, 0.0, 10 * k + i)
        left = deck.mesh(*grid(n, 1, 1.0, 1.0 / n, (-1.0 - gap, float(k))), part=10 * k + 1)
        right = deck.mesh(*grid(n, 1, 1.0, 1.0 / n, (0.0, float(k))), part=10 * k + 2)
        deck.node_set(sets[0], left).add("*INITIAL_VELOCITY", (sets[0],), (0.01 * SOUND, 0.0))
        deck.node_set(sets[1], left[n::n + 1]).node_set(sets[2], right[::n + 1][::-1])
        deck.add("*CONTACT_2D_SLIDELINE", (-sets[1], -sets[2], kind, 2, 0.05 * YOUNG), (birth, death, 0))
    deck.add("*DATABASE_SLEOUT", (1.0e-4 / SOUND,))
    return deck.output(glstat=1.0e-4 / SOUND)


def bars(kind, damping=0.0, load=False):
    """A bar of 20 elements flies onto another at rest; `load`: it is pressed on, and both are held."""
    n = 20
    deck = Deck(f"bars, type {kind}, damping {damping}, load {load}")
    deck.control((20.0 if load else 4.0) / SOUND, scale=0.5)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    left = deck.mesh(*grid(n, 1, 1.0, 1.0 / n, (-1.0, 0.0)), part=1)
    right = deck.mesh(*grid(n, 1, 1.0, 1.0 / n, (0.0, 0.0)), part=2)
    if load:
        deck.curve(1, [(0.0, 0.0), (10.0 / SOUND, 1.0), (1.0, 1.0)]).fix(right[n::n + 1], x=1)
        deck.add("*LOAD_NODE_POINT", *[(int(node), 1, 1, 200.0) for node in left[::n + 1]])
    else:
        deck.node_set(1, left).add("*INITIAL_VELOCITY", (1,), (0.01 * SOUND, 0.0))
    deck.node_set(2, left[n::n + 1]).node_set(3, right[::n + 1][::-1])
    deck.add("*CONTACT_2D_SLIDELINE", (-2, -3, kind, 2, 0.05 * YOUNG), (0.0, 1.0e20, 0, 0.0, damping))
    deck.add("*DATABASE_SLEOUT", (0.05 / SOUND,))
    return deck.output(glstat=0.05 / SOUND)


# Type and seed of polygons, and what their springs would do: without the law they make 10, 16, 17 and 48 % of the energy;
# lose more than 5 %, or neither.
KINDS = ((7, 2, "limited"), (7, 20, "limited"), (5, 5, "limited"), (5, 9, "limited"), (6, 23, "lost"), (7, 25, "lost"),
         (6, 1, "neither"), (7, 29, "neither"))


def check_corners(run):
    """Limited, lost and neither: the log tells what the bodies have lost, which no contact enters, and that nothing is made."""
    for kind, seed, expected in KINDS:
        name = f"{TYPES[kind]}, polygons {seed}"
        result = run.program(polygons(seed, kind), name=f"corners_{kind}_{seed}")
        energy, springs = result.table("glstat"), result.table("sleout")
        start = energy["total"][0]
        gain = (bodies(energy)[-1] - bodies(energy)[0]) / start
        run.check(f"{name}: what the springs gave is what the bodies got / E0",
                  (springs["stored"] - springs["energy"])[-1] / start, gain)
        run.check(f"{name}: made at any time / E0",
                  np.max(springs["stored"] - springs["energy"]) / start, 0.02)
        run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
        first, in_all, limited = reported(result, FIRST), reported(result, IN_ALL), reported(result, LIMITED)
        run.true(f"{name}: nothing is reported to be made", "created" not in [m[4] for m in first] + [m[2] for m in in_all])
        if expected == "limited":
            run.true(f"{name}: the summary tells of limited forces",
                     bool(limited) and 0 < int(limited[-1][2]) < int(limited[-1][3]) and 0.0 <= float(limited[-1][4]) < 1.0)
        elif expected == "lost":
            run.check(f"{name}: lost / E0", -gain, 0.05)
            run.true(f"{name}: a warning in the cycle and one in the summary",
                     [m[4] for m in first] == ["lost"] and [m[2] for m in in_all] == ["lost"])
            run.check(f"{name}: amount of the summary / E0", float(in_all[-1][3]) / start, -gain)
            run.check(f"{name}: first amount / largest energy",
                      float(first[0][5]) / float(first[0][7]), 0.01)
            run.check(f"{name}: the place is where they touch, |x|", abs(float(first[0][9])), 0.6)
        else:
            run.check(f"{name}: neither made nor lost / E0", gain, 0.0)
            run.true(f"{name}: nothing is said in the cycles nor in the summary", not reported(result, ANY))


def check_lives(run):
    """Springs that are born loaded make what they hold, springs that die loaded lose it; the log says so."""
    for kind, name in TYPES.items():
        birth = 0.49 / SOUND
        result = run.program(flights("born loaded", kind, (0.0, birth, 1.0e20)), name=f"born_{kind}")
        energy, springs = result.table("glstat"), result.table("sleout")
        row = int(np.argmax(springs["stored"] > 0.0))
        share = energy["dt"][row - 1] / springs["time"][row]
        run.check(f"{name}: born at the time of birth / dt", (springs["time"][row] - birth) / energy["dt"][row], 1.0)
        if kind == 1:
            run.check(f"{name}: held at birth / J", springs["stored"][row],
                      0.5 * 2.0 * 0.05 * YOUNG * (0.01 * SOUND * springs["time"][row]) ** 2)
        run.check(f"{name}: born loaded, made / held at birth",
                  -springs["energy"][-1] / springs["stored"][row], 1.0 - share)
        run.true(f"{name}: born loaded, the log says created",
                 [m[4] for m in reported(result, FIRST)] == ["created"] and [m[2] for m in reported(result, IN_ALL)] == ["created"])
        death = 0.99 / SOUND
        result = run.program(flights("dies loaded", kind, (0.0, 0.0, death)), name=f"dead_{kind}")
        energy, springs = result.table("glstat"), result.table("sleout")
        row = int(np.argmax(springs["time"] > death)) - 1
        run.check(f"{name}: held at death / E0", springs["stored"][row] / energy["total"][0], 0.05)
        run.check(f"{name}: dies loaded, lost / held at death",
                  springs["energy"][-1] / springs["stored"][row], 1.0)
        run.check(f"{name}: dies loaded, nothing is held", springs["stored"][-1], 0.0)
        run.true(f"{name}: dies loaded, the log says lost",
                 [m[4] for m in reported(result, FIRST)] == ["lost"] and [m[2] for m in reported(result, IN_ALL)] == ["lost"])


def check_endeng(run):
    """Energy that springs make ends the run though the balance holds, and what another interface has lost is no excuse."""
    dies, born = (0.0, 0.0, 1.0 / SOUND), (8.5e-3, 1.05 / SOUND, 1.0e20)
    for name, deck, per_cent in (("born loaded", flights("born", 1, (0.0, 0.49 / SOUND, 1.0e20)), 2.0),
                                 ("one dies, then one is born", flights("two", 1, dies, born), 2.0)):
        result = run.program(end_energy(deck, per_cent), name=f"endeng_{name.split()[0]}", expect_status=2)
        said = " ".join(result.stderr.split())
        run.true(f"ENDENG {per_cent:g}, {name}: ended by what the springs made",
                 "the contact springs created energy: " in said and "(ENDENG)" in said)
        energy = result.table("glstat")
        run.check(f"ENDENG {per_cent:g}, {name}: energy ratio", energy["energy_ratio"], 1.0)
        if name != "born loaded":
            balance = energy["contact"][-1] - np.sum(result.table("sleout")["stored"][-2:])
            run.check(f"{name}: lost beyond what is made / E0", balance / energy["total"][0], 0.005)


def check_sound(run):
    """Bars that bounce return all; what damping takes is no loss; loaded springs hold theirs."""
    for kind, name in TYPES.items():
        result = run.program(bars(kind), name=f"bars_{kind}")
        energy, springs = result.table("glstat"), result.table("sleout")
        balance = (springs["energy"] - springs["stored"]) / energy["total"][0]
        run.check(f"{name}: bars, made or lost at any time / E0", balance, 0.0)
        run.true(f"{name}: bars, the springs did take energy", np.max(springs["stored"]) > 0.05 * energy["total"][0])
        run.true(f"{name}: bars, no warning", not reported(result, ANY))
        result = run.program(bars(kind, damping=50.0), name=f"damped_{kind}")
        energy, springs = result.table("glstat"), result.table("sleout")
        run.check(f"{name}: damped bars, taken by damping / E0",
                  springs["damping"][-1] / energy["total"][0], 0.01)
        run.check(f"{name}: damped bars, the bodies lose what damping takes / E0",
                  (bodies(energy)[-1] - bodies(energy)[0] + springs["damping"][-1])
                  / energy["total"][0], 0.0)
        run.check(f"{name}: damped bars, glstat has both / E0",
                  (springs["energy"] + springs["damping"] - energy["contact"]) / energy["total"][0],
                  0.0)
        run.true(f"{name}: damped bars, no warning", not reported(result, ANY))
        result = run.program(bars(kind, load=True), name=f"pressed_{kind}")
        energy, springs = result.table("glstat"), result.table("sleout")
        run.check(f"{name}: pressed bars, held by the springs / all",
                  springs["stored"][-1] / energy["total"][-1], 0.05)
        run.check(f"{name}: pressed bars, energy is what is stored / all",
                  (springs["energy"] - springs["stored"])[-1] / energy["total"][-1], 0.0)
        run.true(f"{name}: pressed bars, no warning", not reported(result, ANY))


def check_restart(run):
    """A run that goes on from a restart file tells the same and writes the same tables."""
    deck = polygons(2, 7)
    whole = run.program(deck, name="whole")
    first = int(reported(whole, AGAIN)[0][2])
    for label, cycle in (("before", first - 7), ("after", first + 9)):
        deck = polygons(2, 7)
        deck.add("*DATABASE_BINARY_D3DUMP", (cycle,))
        run.program(deck, name=f"first_{label}")
        dump = run.work / f"first_{label}" / f"first_{label}.dump01.h5"
        again = run.program(deck, f"r={dump}", name=f"again_{label}")
        for table in ("glstat", "sleout"):
            run.true(f"restart {label} the warning: {table} has the same bytes",
                     again.csv_path(table).read_bytes() == whole.csv_path(table).read_bytes())
        run.true(f"restart {label} the warning: the summary is the same",
                 [m[0] for m in reported(again, LIMITED)][-1:] == [m[0] for m in reported(whole, LIMITED)][-1:] != [])
        run.true(f"restart {label} the warning: it is reported once",
                 [m[0] for m in reported(again, AGAIN)] == ([m[0] for m in reported(whole, AGAIN)] if label == "before" else []))
    lost = run.program(polygons(12, 7), name="lost")
    cycle = int(reported(lost, FIRST)[0][2])
    for label, at in (("before", cycle - 7), ("after", cycle + 9)):
        run.program(polygons(12, 7).add("*DATABASE_BINARY_D3DUMP", (at,)), name=f"lost_{label}")
        dump = run.work / f"lost_{label}" / f"lost_{label}.dump01.h5"
        again = run.program(polygons(12, 7).add("*DATABASE_BINARY_D3DUMP", (at,)), f"r={dump}", name=f"lost_again_{label}")
        run.true(f"restart {label} the loss: the summary is the same",
                 [m[0] for m in reported(again, IN_ALL)] == [m[0] for m in reported(lost, IN_ALL)] != [])
        run.true(f"restart {label} the loss: first warnings are those not reported before",
                 [m[0] for m in reported(again, FIRST)] == [m[0] for m in reported(lost, FIRST) if int(m[2]) >= at])
    for kind, name in TYPES.items():
        whole_damped = run.program(bars(kind, damping=50.0), name=f"whole_{kind}")
        run.program(bars(kind, damping=50.0).add("*DATABASE_BINARY_D3DUMP", (41,)), name=f"first_{kind}")
        dump = run.work / f"first_{kind}" / f"first_{kind}.dump01.h5"
        again = run.program(bars(kind, damping=50.0).add("*DATABASE_BINARY_D3DUMP", (41,)), f"r={dump}", name=f"again_{kind}")
        for table in ("glstat", "sleout"):
            run.true(f"{name}: restart with VDC, pressed: {table} has the same bytes",
                     again.csv_path(table).read_bytes() == whole_damped.csv_path(table).read_bytes())
    threads = run.program(polygons(2, 7), "ncpu=2", name="threads")
    for table in ("glstat", "sleout"):
        run.true(f"two threads: {table} has the same bytes",
                 threads.csv_path(table).read_bytes() == whole.csv_path(table).read_bytes())


def check(run):
    check_corners(run)
    check_sound(run)
    check_lives(run)
    check_endeng(run)
    check_restart(run)
