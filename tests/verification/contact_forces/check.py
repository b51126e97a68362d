# SPDX-License-Identifier: MIT
"""Nodal contact forces of all seven formulations against an independent brute-force reference."""
import dataclasses
import itertools
import re

import numpy as np

from contact_types import TYPES
from history import entry_offsets
from reference import Rule
from scenes import Pair, Scene, random_pair, random_wedge
from sliding import STRETCHES, TIME_STEP, largest_jump, masters, paths, rigid_line, sliding_scene

PENALTY = 1.0e5
POINTS = range(1, 11)
TOLERANCE = 1.0e-10
SEED = 20240607
N_RANDOM, N_FAR, N_CLOSED, N_WEDGE = 40, 12, 12, 40
N_TURN = 16
SHARE = 3  # of many random pairs and angles one of so many where not in full
RADII = (0.01, 0.3, 40.0)
FAR = 1.0e6
N_JUMP = 7  # slave segments
APART = 1.0e-9  # on either side of a jump
RULES = [*(Rule(kind, PENALTY) for kind in TYPES if kind != 6), Rule(5, PENALTY, strict=True),
         *(Rule(6, PENALTY, gauss=n) for n in POINTS)]
MAIN_RULES = [*(Rule(kind, PENALTY, gauss=4) for kind in TYPES), Rule(5, PENALTY, strict=True)]


def label(rule):
    extra = f", {rule.gauss} points" if rule.kind == 6 else ", strict" if rule.strict else ""
    return f"{TYPES[rule.kind]}{extra}"


def line(x, y):
    x = np.asarray(x, dtype=float)
    return np.stack([x, y(x) if callable(y) else np.broadcast_to(y, x.shape)], axis=1)


def designed_pairs():
    """What can go wrong, one by one; penetration 0.002 unless said otherwise."""
    lower = np.linspace(0.0, 1.0, 5)
    seven = np.linspace(0.0, 1.0, 8)
    bend = lambda x: 0.3 * np.abs(x - 0.45)      # noqa: E731  re-entrant
    ridge = lambda x: -0.3 * np.abs(x - 0.45)    # noqa: E731  convex
    arc = lambda x: -0.25 * (x - 0.47) ** 2      # noqa: E731  not symmetric: that makes ties
    wave = lambda x: 0.03 * np.sin(9.0 * x)      # noqa: E731
    under = lambda y, d=0.002: lambda x: y(x) - d  # noqa: E731
    uneven = np.array([0.0, 0.1, 0.37, 0.45, 0.8, 1.0])
    tilted = lambda x: -0.001 - 0.004 * x        # noqa: E731
    wedge = lambda slope: lambda x: slope * np.abs(x - 0.5) - 0.002  # noqa: E731
    return [
        Pair("flat, slave finer", line(np.linspace(0, 1, 8), -0.002), line(lower, 0.0)),
        Pair("flat, master finer", line(lower, -0.002), line(np.linspace(0, 1, 12), 0.0)),
        Pair("one slave segment over seven", line([0.0, 1.0], -0.002), line(seven, 0.0)),
        Pair("tilted, over three segments", line([0.05, 0.5, 0.95], tilted), line(seven, 0.0), 0.4),
        Pair("uneven both", line(uneven, tilted), line(1.0 - uneven[::-1], 0.0), -2.0),
        Pair("slave overhangs left", line(np.linspace(-0.3, 0.9, 6), -0.002),
             line(seven, 0.0), 1.0),
        Pair("slave overhangs right", line(np.linspace(0.1, 1.3, 6), tilted),
             line(seven, 0.0), 2.0),
        Pair("slave overhangs both ends", line(np.linspace(-0.21, 1.3, 6), -0.002),
             line(lower, 0.0), 3.0),
        Pair("master inside one slave segment", line([-0.6, -0.2, 1.2, 1.9], -0.002),
             line(lower, 0.0), -1.0),
        Pair("one segment each, shifted", line([0.3, 1.3], tilted), line([0.0, 1.0], 0.0), 0.2),
        Pair("overhang within the end tolerance", line(np.linspace(-0.001, 1.002, 5), -0.002),
             line(seven, 0.0), 0.7),
        Pair("flush but for round-off", line(np.linspace(1e-11, 1.0 + 1e-11, 5), -0.002),
             line(seven, 0.0), 0.7),
        Pair("re-entrant corner", line(uneven, under(bend)), line(lower, bend), 0.3),
        Pair("node in a re-entrant corner", line([0.1, 0.46, 0.9], under(bend, 0.01)),
             line([0.0, 0.45, 1.0], bend), 1.3),
        Pair("ridge", line(uneven, under(ridge)), line([0.0, 0.45, 1.0], ridge), 0.3),
        Pair("over a ridge with positive gaps", line(np.linspace(0, 1, 9), under(ridge, -0.001)),
             line([0.0, 0.45, 0.7, 1.0], ridge), 0.3),
        Pair("arc, slave finer", line(np.linspace(0, 1, 13), under(arc)), line(lower, arc), 2.4),
        Pair("arc, master finer", line(lower, under(arc)), line(np.linspace(0, 1, 13), arc), -2.4),
        Pair("waves", line(np.linspace(0, 1, 10), under(wave)), line(np.linspace(0, 1, 14), wave)),
        Pair("waves, partly facing", line(np.linspace(0.4, 1.5, 10), under(wave)),
             line(np.linspace(0, 1, 9), wave), 1.1),
        Pair("closed", line(np.linspace(0.1, 0.85, 5), -0.002), line(seven, 0.0), 0.5, closed=True),
        Pair("closed, flush", line(lower, -0.002), line(seven, 0.0), 0.5, closed=True),
        Pair("closed, overhanging", line(np.linspace(-0.3, 1.4, 5), -0.002), line(seven, 0.0), -1.5,
             closed=True),
        Pair("closed, slave slides on by one segment", line(np.linspace(0.8, 1.8, 6), -0.002),
             line(seven, 0.0), 2.5, closed=True),
        Pair("closed, as deep as two segments", line(np.linspace(0.02, 0.93, 4), -0.1),
             line(np.linspace(0, 1, 21), 0.0), 1.7, closed=True),
        Pair("closed, overhanging, as deep as two segments", line(np.linspace(-0.3, 1.4, 5), -0.1),
             line(np.linspace(0, 1, 21), 0.0), -0.7, closed=True),
        Pair("closed, blunt wedge on a plate", line(np.linspace(0, 1, 7), wedge(0.9)), line(seven, 0.0),
             0.9, closed=True),
        Pair("closed, sharp wedge on a plate", line(np.linspace(0, 1, 7), wedge(2.2)), line(seven, 0.0),
             -0.4, closed=True),
        Pair("closed, plate on a sharp wedge", line(seven, 0.0), line(
            np.linspace(0, 1, 7), lambda x: -wedge(2.2)(x)), -0.4, closed=True),
        Pair("closed, lopsided wedge on a plate", line([0.3, 0.4, 0.52, 0.6, 0.9], lambda x: np.where(
            x < 0.52, 3.0 * (0.52 - x), 0.3 * (x - 0.52)) - 0.002), line(seven, 0.0), 0.7, closed=True),
        Pair("closed, wedge in a valley", line(np.linspace(0.2, 0.8, 7), lambda x: wedge(1.0)(x)),
             line(np.linspace(0, 1, 6), lambda x: 0.9 * np.abs(x - 0.5)), -2.2, closed=True),
    ]


def flush_pairs():
    """Closed outlines whose ends meet exactly, at many angles: round-off must decide nothing."""
    lower, seven = line(np.linspace(0.0, 1.0, 5), -0.002), line(np.linspace(0.0, 1.0, 8), 0.0)
    layouts = {"both ends": (lower, seven), "same nodes": (lower, line(lower[:, 0], 0.0)),
               "left end": (line(np.linspace(0.0, 0.8, 5), -0.002), seven)}
    return [Pair(f"{name}, turned by {angle:.3g}", slave, master, angle, closed=True)
            for name, (slave, master) in layouts.items()
            for angle in np.linspace(0.0, 6.0, N_TURN)]


def some(run, pairs):
    """All; where not in full each third. Those left out are made all the same, so that the others are as in full."""
    return pairs if run.is_full else pairs[::SHARE]


class Verdicts:
    """Largest differences by rule; and that forces were there to compare."""

    def __init__(self):
        self.worst = {}
        self.count = {}
        self.active = {}

    def add(self, key, error, size):
        self.worst[key] = max(self.worst.get(key, 0.0), error)
        self.count[key] = self.count.get(key, 0) + 1
        self.active[key] = self.active.get(key, 0) + (size > 0.0)

    def judge(self, run, what, least=0.8):
        for key, error in self.worst.items():
            run.check(f"{what}, {key}: nodal forces of both sides / largest ({self.count[key]} "
                      "interfaces)", error, 0.0)
        together = {}
        for key in self.worst:  # few pairs have the same number of points where not in full
            together.setdefault(key if run.is_full else re.sub(r", \d+ points", "", key), []).append(key)
        for name, keys in together.items():
            active, count = (sum(numbers[key] for key in keys) for numbers in (self.active, self.count))
            run.check(f"{what}, {name}: interfaces in contact", active, least * count)


def compare(run, name, scene, verdicts, key=lambda interface: label(interface.rule)):
    """Run a scene and compare the forces at time zero."""
    found = run.program(scene.deck, "smooth=-1", name=name).points("contact_force")[0, :, :2]
    for interface in scene.interfaces:
        error, size, _ = interface.compare(scene.nodes, found)
        if error > TOLERANCE:
            print(f"      differs: {interface.pair.name}: {label(interface.rule)}: {error:.3g}")
        verdicts.add(key(interface), error, size)
    return found


def rules_of(run, rules, number):
    """All; where not in full, of several of type 6 one, another for each pair."""
    mortar = [rule for rule in rules if rule.kind == 6]
    if run.is_full or len(mortar) < 2:
        return rules
    return [*(rule for rule in rules if rule.kind != 6), mortar[number % len(mortar)]]


def one_interface_each(run, name, pairs, rules, what, least=0.8, is_axisymmetric=False):
    """Every rule on bodies of its own, all in one deck."""
    scene = Scene(name, is_axisymmetric=is_axisymmetric)
    for number, pair in enumerate(pairs):
        for rule in rules_of(run, rules, number):
            scene.add(pair, rule)
    verdicts = Verdicts()
    compare(run, name, scene, verdicts)
    verdicts.judge(run, what, least)


def beside_the_axis(pairs, distances):
    """The same pairs, shifted so that their bodies begin at these distances from the axis x = 0."""
    return [dataclasses.replace(pair, name=f"{pair.name}, r from {distance}", shift=(
        pair.shift[0] + distance - min(np.min(rows[:, 0]) for body in pair.bodies() for rows in body), 0.0))
        for pair, distance in zip(pairs, itertools.cycle(distances))]


def axisymmetric(run):
    """Designed and random pairs as bodies of revolution: forces per radian, weights by radius."""
    # Not turned a closed pair is one of ties.
    pairs = beside_the_axis([dataclasses.replace(pair, angle=0.0) for pair in designed_pairs()
                             if not pair.closed], [0.0])
    one_interface_each(run, "discs", pairs, RULES, "axisymmetric, from the axis on", is_axisymmetric=True)
    one_interface_each(run, "rings", beside_the_axis(designed_pairs(), RADII), RULES,
                       "axisymmetric, rings", is_axisymmetric=True)
    rng = np.random.default_rng(SEED + 5)
    pairs = beside_the_axis(some(run, [random_pair(rng, number) for number in range(N_RANDOM)]), RADII)
    one_interface_each(run, "random_rings", pairs, RULES, "axisymmetric, random", is_axisymmetric=True)
    rng = np.random.default_rng(SEED + 6)
    pairs = beside_the_axis([random_pair(rng, number, closed=True) for number in range(N_CLOSED)], RADII)
    one_interface_each(run, "closed_rings", pairs, [rule for rule in MAIN_RULES if not rule.strict],
                       "axisymmetric, closed chains", is_axisymmetric=True)


def penalty_units(run):
    """PUNIT 0, 1, 2 and a penalty of its own for the master pass."""
    x = np.linspace(0.0, 1.0, 6), np.linspace(0.0, 1.0, 5)
    pair = Pair("units", line(x[0], -0.002), line(x[1], 0.0), 0.6)
    scene = Scene("penalty units")
    for kind in TYPES:
        for unit, penalty in ((0, 3.0e4), (1, 2.0e5), (2, 0.7)):
            scene.add(pair, Rule(kind, penalty, unit, back=0.4 * penalty if kind == 3 else 0.0))
    verdicts = Verdicts()
    compare(run, "penalty_units", scene, verdicts,
            lambda interface: f"{TYPES[interface.rule.kind]}, PUNIT {interface.rule.unit}")
    verdicts.judge(run, "penalty units")


def shared_chains(run):
    """All rules as interfaces between the same two bodies: the forces are the sum."""
    rng = np.random.default_rng(SEED + 3)
    scene = Scene("shared chains")
    for number in range(4):
        pair = random_pair(rng, number)
        made = None
        for rule in MAIN_RULES:
            made = scene.add(pair, rule, made)
    found = run.program(scene.deck, "smooth=-1", name="shared_chains").points("contact_force")[0, :, :2]
    wanted = np.zeros_like(found)
    for interface in scene.interfaces:
        _, _, (slave, master) = interface.compare(scene.nodes, found)
        wanted[interface.slave] += slave
        wanted[interface.master] += master
    run.check("eight interfaces between the same two chains: sum of forces", found, wanted)


def sliding(run):
    """Force histories while the slave slides over many nodes, off both ends and back."""
    scene = sliding_scene(MAIN_RULES)
    result = run.program(scene.deck, "smooth=-1", name="sliding")
    found, moved = (result.points(name)[..., :2] for name in ("contact_force", "displacement"))
    verdicts = Verdicts()
    states = list(enumerate(result.times))[::1 if run.is_full else 3]
    for interface in scene.interfaces:
        offsets = entry_offsets(interface.rule, *paths(interface.pair))
        for state, time in states:
            error, size, _ = interface.compare(scene.nodes, found[state], moved[state],
                                               offsets[round(time / TIME_STEP)])
            if error > TOLERANCE:
                print(f"      differs: {interface.pair.name}: {label(interface.rule)} "
                      f"at {time:.4g}: {error:.3g}")
            verdicts.add(label(interface.rule), error, size)
    verdicts.judge(run, "sliding", 0.5)


def jumps(run):
    """Largest jump of the total force: its place found with the reference, its size measured with
    the program on either side of that place, where the nodal forces are compared as well."""
    scene = Scene("jumps")
    places = []
    cases = run.cover(STRETCHES.items(), masters().items(), MAIN_RULES, strength=1)
    for (stretch, lefts), (name, master), rule in cases:
        left, mean = largest_jump(rule, master, N_JUMP, lefts)
        places.append((f"{stretch}, {name}", rule, mean))
        for side in (-1.0, 1.0):
            line = rigid_line(master, N_JUMP, left + side * APART)
            scene.add(Pair(name, line, master), rule)
    verdicts = Verdicts()
    found = compare(run, "jumps", scene, verdicts)
    verdicts.judge(run, "on either side of a jump")
    for k, (name, rule, mean) in enumerate(places):
        before, after = (found[interface.slave].sum(axis=0)
                         for interface in scene.interfaces[2 * k:2 * k + 2])
        run.report(f"largest jump / mean of the total force while {name}, {label(rule)}",
                   np.hypot(*(after - before)) / mean)


def check(run):
    one_interface_each(run, "designed", designed_pairs(), RULES, "designed")
    one_interface_each(run, "flush", some(run, flush_pairs()), MAIN_RULES, "closed and flush, turned")
    rng = np.random.default_rng(SEED)
    pairs = some(run, [random_pair(rng, number) for number in range(N_RANDOM)])
    one_interface_each(run, "random", pairs, RULES, "random")
    rng = np.random.default_rng(SEED + 1)
    pairs = [random_pair(rng, number, far=FAR) for number in range(N_FAR)]
    one_interface_each(run, "far", pairs, MAIN_RULES, "far from the origin")
    rng = np.random.default_rng(SEED + 2)
    pairs = [random_pair(rng, number, closed=True) for number in range(N_CLOSED)]
    rules = [rule for rule in MAIN_RULES if not rule.strict]
    one_interface_each(run, "closed", pairs, rules, "closed chains")
    rng = np.random.default_rng(SEED + 4)
    pairs = some(run, [random_wedge(rng, number) for number in range(N_WEDGE)])
    # Types 4, 6 and 7 see nothing of a tip so short; types 1 and 2 not with the wedge as master.
    rules = [rule for rule in MAIN_RULES if rule.kind in (1, 2, 3, 5)]
    one_interface_each(run, "wedges", pairs, rules, "closed wedges", 0.4)
    axisymmetric(run)
    penalty_units(run)
    shared_chains(run)
    sliding(run)
    jumps(run)
