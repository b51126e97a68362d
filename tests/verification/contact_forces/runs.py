# SPDX-License-Identifier: MIT
"""Which segments of two whole outlines face each other, by brute force, from the description alone.

All places of all segments are held against all segments of the other outline; there is no grid and
nothing is remembered.
"""
from dataclasses import dataclass

import numpy as np

from reference import FACE_ON, SHARP, Chain

PLACES = (0.1, 0.5, 0.9)
BETWEEN = np.sin(np.radians(10.0))  # of the opposite of a normal between those at a corner
HALF = 0.5                          # of the mean segment of the finer side: motion until the next look


@dataclass
class Outline:
    """A closed chain, and how thick its body is behind each segment."""
    chain: Chain
    thick: np.ndarray


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def faced(outline, place, is_against, capture):
    """The segment that a place faces, of several the one whose line is nearest; or None."""
    chain = outline.chain
    away = place - chain.start
    at = np.sum(away * chain.tangent, axis=1) / chain.length
    gap = np.sum(away * chain.normal, axis=1)
    fits = (at >= 0.0) & (at <= 1.0) & (gap < capture) & (gap > -0.5 * outline.thick)
    found = [s for s in np.flatnonzero(fits) if is_against(chain.normal[s])]
    return min(found, key=lambda s: abs(gap[s]), default=None)


def turns_sharply(chain, one, two):
    return np.dot(chain.tangent[one], chain.tangent[two]) < SHARP


def look(own, other, capture):
    """Segments of `own` that face `other`, and those that are faced."""
    chain, mine, theirs = own.chain, set(), set()
    for s in range(len(chain)):
        for share in PLACES:
            place = chain.start[s] + share * chain.length[s] * chain.tangent[s]
            found = faced(other, place, lambda n, s=s: np.dot(chain.normal[s], n) < FACE_ON, capture)
            if found is not None:
                mine.add(s)
                theirs.add(found)
    by_place = set(mine)
    for s in range(len(chain)):
        after = chain.next(s, 1)
        one, two = chain.normal[s], chain.normal[after]
        if s in by_place or after in by_place or not turns_sharply(chain, s, after) or \
                cross(one, two) <= 0.0:
            continue
        found = faced(other, chain.x[chain.nodes[s, 1]], lambda n, one=one, two=two:
                      cross(one, -n) > BETWEEN and cross(-n, two) > BETWEEN, capture)
        if found is None:
            continue
        theirs.add(found)
        within = [k for k in (s, after) if np.dot(chain.normal[k], other.chain.normal[found]) < FACE_ON]
        mine.update(within or (s, after))
    return mine, theirs


def longer(chain, active, way):
    """Active segments, and those before and behind until more than `way` has been walked, up to a
    sharp corner or the next run."""
    found = set(active)
    for s in active:
        for step in (-1, 1):
            at, walked = s, 0.0
            while walked <= way:
                other = chain.next(at, step)
                if other in active or turns_sharply(chain, at, other):
                    break
                found.add(other)
                walked += chain.length[other]
                at = other
    return found


def runs_of(chain, active):
    """The chains of the active segments; at a sharp convex corner one ends and the next begins."""
    cuts = [s for s in active if chain.next(s, -1) in active
            and turns_sharply(chain, chain.next(s, -1), s)
            and cross(chain.tangent[chain.next(s, -1)], chain.tangent[s]) > 0.0]
    return Chain(chain.x, True, sorted(active), cuts, chain.is_round)


def facing_runs(slave, master):
    """Slave and master as runs that face each other, at the first look."""
    margin = HALF * min(np.mean(side.chain.length) for side in (slave, master))
    capture = max(np.max(side.chain.length) for side in (slave, master)) + margin
    (own, back), (own_back, there) = look(slave, master, capture), look(master, slave, capture)
    return [runs_of(side.chain, longer(side.chain, active, 2.0 * margin))
            for side, active in ((slave, own | there), (master, own_back | back))]
