# SPDX-License-Identifier: MIT
"""The seven contact formulations by brute force, written from their description alone.

Everything is evaluated from scratch for one configuration: the closest segment is found by
looking at all of them, nothing is tracked, ordered or kept. Positions are handed in relative to a
point near the interface, so that they carry no large common part.

A surface is walked with its body on the left; the outward normal of a segment is (t_y, -t_x).
Whole outlines are in contact by runs of segments that face each other (runs.py).
"""
import functools
from dataclasses import dataclass

import numpy as np

OVERSHOOT = 0.01      # of the end segment of an open chain: still projected, not clamped
SIDE_ON, FACE_ON = -0.1, -0.5  # slave normal . master normal: no facing above, full facing below
SHALLOW = 0.25        # of the segment: how deep a point may be to change sides at a sharp corner
ON_NODE = 1.0e-9     # of the segment: a foot this close to a node stands on it
TINY = 1.0e-300
SHARP = np.cos(np.radians(60.0))  # a projection does not walk across corners that turn more


class Chain:
    """Nodes (n, 2) in walking order and whether the last is joined to the first.

    `taken`: the segments that take part, of all; `cuts`: those of them that the one before does not
    go on to. Together they are runs: chains of their own, with the nodes of the whole.
    `is_round`: axisymmetric, x is the radius: lengths weigh with it.
    """

    def __init__(self, x, closed=False, taken=None, cuts=(), is_round=False):
        self.x = np.asarray(x, dtype=float)
        self.closed = closed
        self.is_round = is_round
        n = len(self.x)
        first = np.arange(n if closed else n - 1)
        taken = first if taken is None else np.asarray(taken, dtype=int)
        self.nodes = np.stack([taken, (taken + 1) % n], axis=1)
        at = {int(segment): k for k, segment in enumerate(taken)}
        follows = [at.get((s + 1) % n if closed else s + 1) for s in taken.tolist()]
        self.after = [None if k is None or taken[k] in cuts else k for k in follows]
        self.behind = [None] * len(taken)
        for k, other in enumerate(self.after):
            if other is not None:
                self.behind[other] = k
        self.start = self.x[self.nodes[:, 0]]
        edge = self.x[self.nodes[:, 1]] - self.start
        self.length = np.hypot(edge[:, 0], edge[:, 1])
        self.tangent = edge / self.length[:, None]
        self.normal = np.stack([self.tangent[:, 1], -self.tangent[:, 0]], axis=1)

    def __len__(self):
        return len(self.length)

    def next(self, segment, step):
        """The neighbour segment in the walking sense (step 1) or against it (-1), or None."""
        return self.after[segment] if step > 0 else self.behind[segment]

    def run(self, segment):
        """The segments of the run that this one is of, in walking order; a closed one from it on."""
        first = segment
        while self.behind[first] is not None and self.behind[first] != segment:
            first = self.behind[first]
        if self.behind[first] == segment:
            first = segment
        found = [first]
        while self.after[found[-1]] not in (None, first):
            found.append(self.after[found[-1]])
        return found

    def nearest(self, point):
        """The segment nearest to a point."""
        away = point - self.start
        at = np.clip(np.sum(away * self.tangent, axis=1), 0.0, self.length)
        return int(np.argmin(np.linalg.norm(away - at[:, None] * self.tangent, axis=1)))

    def used(self):
        """The nodes that take part."""
        return np.unique(self.nodes)

    def chords(self):
        """Direction of the surface at each node: from the node before to the node after."""
        chord = np.zeros(self.x.shape)
        for side in (0, 1):
            np.add.at(chord, self.nodes[:, side], self.length[:, None] * self.tangent)
        return chord / np.maximum(np.hypot(chord[:, 0], chord[:, 1]), TINY)[:, None]

    def radius(self, k, at):
        """In axisymmetry; 1 in the plane."""
        return self.start[k, 0] + at * self.length[k] * self.tangent[k, 0] if self.is_round else 1.0

    def integral(self, k, left, right, values):
        """Of values(at) over a stretch of a segment, by three Gauss points: exact for all that is asked."""
        at, weight = gauss(3)
        at = left + at * (right - left)
        return (right - left) * self.length[k] * np.sum(weight * self.radius(k, at) * values(at))

    def weight(self, k, left, right):
        """Of a stretch of a segment."""
        if not self.is_round:
            return (right - left) * self.length[k]
        return self.integral(k, left, right, np.ones_like)

    def centre(self, k, left, right):
        """Of a stretch of a segment, by weight; on the axis, where there is none, the middle."""
        if not self.is_round:
            return 0.5 * (left + right)
        weight = self.weight(k, left, right)
        return self.integral(k, left, right, lambda at: at) / weight if weight else 0.5 * (left + right)

    def shares(self, k, left, right):
        """What either end of a stretch has of its weight: the integral by its hat function there."""
        size = right - left
        if not self.is_round:
            return 0.5 * size * self.length[k], 0.5 * size * self.length[k]
        return (self.integral(k, left, right, lambda at: (right - at) / size),
                self.integral(k, left, right, lambda at: (at - left) / size))

    def competence(self):
        """Shares of each node in the segments on either side."""
        total = np.zeros(len(self.x))
        for k, ends in enumerate(self.nodes):
            total[ends] += self.shares(k, 0.0, 1.0)
        return total


@dataclass
class Foot:
    """Projection of a point on a chain: x - foot = gap * normal."""
    segment: int
    at: float
    gap: float
    normal: np.ndarray

    def before(self, chain):
        """The segment that the foot is on; at a node the one before the node."""
        return self.beside(chain, abs(self.at) <= ON_NODE, -1)

    def after(self, chain):
        """The same; at a node the one after the node."""
        return self.beside(chain, abs(self.at - 1.0) <= ON_NODE, 1)

    def beside(self, chain, is_on_node, step):
        other = chain.next(self.segment, step) if is_on_node else None
        return self.segment if other is None else other


def project(points, chain, along):
    """Closest-point projections (Foot or None) of all points, each on the whole chain.

    along: direction of the points' own surface, one for all or one per point.
    """
    points = np.atleast_2d(points)
    along = np.asarray(along)
    if along.ndim == 1:
        along = [along] * len(points)
    if not len(chain):
        return [None] * len(points)
    away = points[:, None, :] - chain.start[None, :, :]
    at = np.sum(away * chain.tangent, axis=2) / chain.length
    height = np.sum(away * chain.normal, axis=2)
    beyond = (at - np.minimum(np.maximum(at, 0.0), 1.0)) * chain.length
    nearest = np.argmin(np.hypot(beyond, height), axis=1)
    feet = []
    for i, k in enumerate(nearest):
        edge = facing_edge(chain, int(k), at[i], height[i], along[i])
        feet.append(one_foot(points[i], chain, int(k), at[i], height[i]) if edge is None else
                    Foot(edge, at[i, edge], height[i, edge], chain.normal[edge]))
    return feet


def facing_edge(chain, k, at, height, along):
    """At a sharp corner (the edge of a block): the segment, other than the closest one, that the
    point is under and that its own surface faces more; or None. Without this a corner that lies
    flush on a corner would belong to the side of the block by a hair."""
    if OVERSHOOT < at[k] < 1.0 - OVERSHOOT and np.dot(along, chain.tangent[k]) < 0.0:
        return None
    found = [other for other in (chain.next(k, -1), chain.next(k, 1)) if other is not None
             and np.dot(chain.tangent[k], chain.tangent[other]) < SHARP
             and np.dot(along, chain.tangent[other]) <= SIDE_ON]
    found = [s for s in (k, *found) if -OVERSHOOT <= at[s] <= 1.0 + OVERSHOOT]
    best = min(found, key=lambda s: np.dot(along, chain.tangent[s]), default=k)
    if not (0.0 <= at[best] <= 1.0 or 0.0 <= at[k] <= 1.0):  # over neither: at the vertex
        return None
    return best if best != k and -SHALLOW * chain.length[best] < height[best] < 0.0 else None


def one_foot(point, chain, k, at, height):
    """The foot on segment k or its vertex, given coordinates and heights over all segments."""
    if 0.0 <= at[k] <= 1.0:
        return Foot(k, at[k], height[k], chain.normal[k])
    step = 1 if at[k] > 1.0 else -1
    other = chain.next(k, step)
    if other is None:
        if -OVERSHOOT <= at[k] <= 1.0 + OVERSHOOT:
            return Foot(k, at[k], height[k], chain.normal[k])
        return None
    vertex = chain.x[chain.nodes[k, 1 if step == 1 else 0]]
    radius = point - vertex
    distance = np.hypot(*radius)
    if height[other] > height[k]:
        k, other, step = other, k, -step
    inside = height[k] < 0.0 and height[other] < 0.0
    gap = -distance if inside else distance
    normal = radius / gap if distance > 0.0 else chain.normal[k]
    return Foot(k, 1.0 if step == 1 else 0.0, gap, normal)


class Forces:
    """Sums of nodal forces on both sides."""

    def __init__(self, slave, master):
        self.chains = slave, master
        self.sides = np.zeros(slave.x.shape), np.zeros(master.x.shape)

    def at_node(self, side, node, force):
        self.sides[side][node] += force

    def on_segment(self, side, segment, at, force):
        first, second = self.chains[side].nodes[segment]
        self.sides[side][first] += (1.0 - at) * force
        self.sides[side][second] += at * force


@functools.cache
def gauss(n):
    """Points and weights over 0 to 1."""
    points, weights = np.polynomial.legendre.leggauss(n)
    return 0.5 * (points + 1.0), 0.5 * weights


def push_nodes(forces, side, stiffness):
    """Nodes of one side on their closest segment of the other; stiffness per node."""
    chain, other = forces.chains[side], forces.chains[1 - side]
    used = chain.used()
    for node, foot in zip(used, project(chain.x[used], other, chain.chords()[used])):
        if foot and foot.gap < 0.0:
            force = -stiffness[node] * foot.gap * foot.normal
            forces.at_node(side, node, force)
            forces.on_segment(1 - side, foot.segment, foot.at, -force)


def nts(slave, master, penalty):
    """Type 1; penalty in N/m."""
    forces = Forces(slave, master)
    plane = Chain(slave.x, slave.closed, slave.nodes[:, 0]).competence()
    share = np.divide(slave.competence(), plane, out=np.ones_like(plane), where=plane > 0.0)
    push_nodes(forces, 0, penalty * share)
    return forces.sides


def nts_ar(slave, master, penalty):
    """Type 2; penalty in N/m2, as in all the following."""
    forces = Forces(slave, master)
    push_nodes(forces, 0, penalty * slave.competence())
    return forces.sides


def two_pass_ar(slave, master, penalty, penalty_back):
    """Type 3."""
    forces = Forces(slave, master)
    push_nodes(forces, 0, penalty * slave.competence())
    push_nodes(forces, 1, penalty_back * master.competence())
    return forces.sides


def vts_ppt(slave, master, penalty):
    """Type 4."""
    forces = Forces(slave, master)
    for k in range(len(slave)):
        def position(at, k=k):
            return slave.start[k] + at * slave.length[k] * slave.tangent[k]
        for half in ((0.0, 0.5), (0.5, 1.0)):
            at = slave.centre(k, *half)
            foot = project(position(at), master, slave.tangent[k])[0]
            if not foot or foot.gap >= 0.0:
                continue
            force = -penalty * slave.weight(k, *half) * foot.gap * foot.normal
            forces.on_segment(0, k, at, force)
            ends = [walk(position(end), foot.segment, master) for end in half]
            parts = portions(master, *ends) or [(foot.segment, foot.at, 1.0)]
            total = sum(length for _, _, length in parts)
            for segment, centre, length in parts:
                forces.on_segment(1, segment, centre, -force * length / total)
    return forces.sides


def walk(point, segment, chain):
    """Steps (turns of the closed chain not reduced), segment and coordinate of the projection
    that is reached from `segment` by going to the neighbour wherever the point lies beyond."""
    steps, direction = 0, 0
    while True:
        at = np.dot(point - chain.start[segment], chain.tangent[segment]) / chain.length[segment]
        wanted = 1 if at > 1.0 else -1 if at < 0.0 else 0
        if wanted == 0:
            return steps, segment, at
        if direction and wanted != direction:  # between two neighbours: on the vertex
            return steps, segment, 0.0 if wanted == -1 else 1.0
        other = chain.next(segment, wanted)
        if other is None and -OVERSHOOT <= at <= 1.0 + OVERSHOOT:
            return steps, segment, at
        if other is None or np.dot(chain.tangent[segment], chain.tangent[other]) <= SHARP:
            return steps, segment, 1.0 if wanted == 1 else 0.0
        segment, direction, steps = other, wanted, steps + wanted


def portions(chain, one, two):
    """(segment, centre, weight) of the stretch between two places reached by walk()."""
    (steps, segment, at), (last, _, end) = sorted((one, two), key=lambda place: place[0] + place[2])
    found = []
    while steps <= last:
        stop = end if steps == last else 1.0
        if stop > at:
            found.append((segment, chain.centre(segment, at, stop), chain.weight(segment, at, stop)))
        segment, at, steps = chain.next(segment, 1), 0.0, steps + 1
    return found


def pieces(slave, master, k, feet, strict=False):
    """Cuts of slave segment k by the master nodes between the feet of its two ends.

    The two chains are walked in opposite senses. An end whose foot is a master node has this node
    between it and the other end. Beyond the end of a master chain there is no piece; where the two
    ends are nearest to two chains those of either count. Returns (left, right, master node at the left or None, at the
    right or None, master segment).
    """
    first, second = (feet[node] for node in slave.nodes[k])
    if strict and not (first and second):
        return [(0.0, 1.0, None, None, None)]
    if not len(master):
        return []
    high, low = first.after(master) if first else None, second.before(master) if second else None
    if high is None:
        high = master.nearest(slave.x[slave.nodes[k, 0]])
    if low is None:
        low = master.nearest(slave.x[slave.nodes[k, 1]])
    run, far = master.run(high), master.run(low)
    starts, ends = first is not None, second is not None
    cuts = Cuts(slave, master, k)
    if low in run:
        cuts.walk(way_back(master, run, high if starts else None, low if ends else None), starts, ends)
    else:
        cuts.walk(way_back(master, run, high if starts else None, None), starts, False)
        cuts.walk(way_back(master, far, None, low if ends else None), False, ends)
    return cuts.found


def way_back(master, run, high, low):
    """Segments of a run from `high` back to `low` (None: its end), of a closed one the shorter way;
    none where slave and master run along with each other."""
    closed = master.next(run[-1], 1) == run[0] and len(run) > 1
    high = len(run) - 1 if high is None else run.index(high)
    low = 0 if low is None else run.index(low)
    if closed and high - low < -0.5 * len(run):
        high += len(run)
    if closed and high - low > 0.5 * len(run):
        low += len(run)
    return [run[index % len(run)] for index in range(high, low - 1, -1)]


class Cuts:
    """Pieces of slave segment k, met on the way back along a master chain."""

    def __init__(self, slave, master, k):
        self.slave, self.master, self.k = slave, master, k
        self.left, self.left_node, self.found = 0.0, None, []

    def at(self, node):
        away = self.master.x[node] - self.slave.start[self.k]
        return np.dot(away, self.slave.tangent[self.k]) / self.slave.length[self.k]

    def cut(self, at, node):
        if at > self.left:
            self.left, self.left_node = at, node

    def walk(self, way, starts, ends):
        """`starts`, `ends`: the first foot is on the first segment of the way, the second one on
        the last; otherwise the chain ends there."""
        if way and not starts:
            node = self.master.nodes[way[0], 1]
            if self.at(node) >= 1.0:
                return
            self.cut(self.at(node), node)
        for segment in way:
            if ends and segment == way[-1]:
                self.found.append((self.left, 1.0, self.left_node, None, segment))
                return
            node = self.master.nodes[segment, 0]
            at = self.at(node)
            if at > self.left:
                self.found.append((self.left, min(at, 1.0), self.left_node,
                                   node if at < 1.0 else None, segment))
            if at >= 1.0:
                return
            self.cut(at, node)


def facing(slave_normal, master_normal):
    """Share of a slave segment that counts as facing: a cubic step between the two cosines."""
    share = np.clip((SIDE_ON - np.dot(slave_normal, master_normal)) / (SIDE_ON - FACE_ON), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def nts_mar(slave, master, penalty, strict=False):
    """Type 5, with the extension for slave chains that overhang the master unless strict."""
    forces = Forces(slave, master)
    feet = project(slave.x, master, slave.chords())
    weight = np.zeros(len(slave.x))
    extra = {}
    for k in range(len(slave)):
        for left, right, left_node, right_node, segment in pieces(slave, master, k, feet, strict):
            share = 1.0 if strict else facing(slave.normal[k], master.normal[segment])
            shares = slave.shares(k, left, right)
            for end, node in enumerate((left_node, right_node)):
                if node is not None:
                    extra[k, node] = extra.get((k, node), 0.0) + share * shares[end]
                else:
                    weight[slave.nodes[k, end]] += share * shares[end]
    used = set(slave.used().tolist())
    for node, foot in enumerate(feet):
        if node not in used:
            continue
        beside = [k for k in range(len(slave)) if node in slave.nodes[k]]
        if foot and weight[node] == 0.0 and not any(facing(slave.normal[k], foot.normal) > 0.0
                                                    for k in beside):
            weight[node] = slave.competence()[node]
        if foot and foot.gap < 0.0:
            force = -penalty * weight[node] * foot.gap * foot.normal
            forces.at_node(0, node, force)
            forces.on_segment(1, foot.segment, foot.at, -force)
    for (k, node), w in extra.items():
        away = master.x[node] - slave.start[k]
        gap = np.dot(away, slave.normal[k])
        if gap < 0.0:
            force = -penalty * w * gap * slave.normal[k]
            forces.at_node(1, node, force)
            at = np.dot(away, slave.tangent[k]) / slave.length[k]
            forces.on_segment(0, k, at, -force)
    return forces.sides


def piece_foot(point, chain, piece, foot):
    """Across a sharp corner a Gauss point under the segment of its piece stays with it."""
    if piece is None or foot is None or foot.segment not in (chain.next(piece, -1),
                                                             chain.next(piece, 1)):
        return foot
    away = point - chain.start[piece]
    at = np.dot(away, chain.tangent[piece]) / chain.length[piece]
    gap = np.dot(away, chain.normal[piece])
    if (np.dot(chain.tangent[piece], chain.tangent[foot.segment]) < SHARP and 0.0 <= at <= 1.0
            and -SHALLOW * chain.length[piece] < gap < 0.0):
        return Foot(piece, at, gap, chain.normal[piece])
    return foot


def nodal_pressure(slave, master, penalty, spots):
    """Types 6 and 7 from integration points: slave segment, coordinate, length weight, and the
    master segment of the piece for type 7 (None for type 6)."""
    forces = Forces(slave, master)
    where = [slave.start[k] + at * slave.length[k] * slave.tangent[k] for k, at, _, _ in spots]
    feet = project(where, master, [slave.tangent[k] for k, _, _, _ in spots]) if spots else []
    feet = [piece_foot(point, master, piece, foot)
            for point, (_, _, _, piece), foot in zip(where, spots, feet)]
    kept = [(k, at, w * facing(slave.normal[k], foot.normal), foot)
            for (k, at, w, _), foot in zip(spots, feet) if foot]
    area, volume = np.zeros(len(slave.x)), np.zeros(len(slave.x))
    for k, at, w, foot in kept:
        for node, shape in zip(slave.nodes[k], (1.0 - at, at)):
            area[node] += shape * w
            volume[node] += shape * w * foot.gap
    gap = np.divide(volume, area, out=np.zeros_like(area), where=area > 0.0)
    pressure = penalty * np.maximum(0.0, -gap)
    for k, at, w, foot in kept:
        first, second = pressure[slave.nodes[k]]
        force = w * ((1.0 - at) * first + at * second) * foot.normal
        forces.on_segment(0, k, at, force)
        forces.on_segment(1, foot.segment, foot.at, -force)
    return forces.sides


def mortar(slave, master, penalty, n_gauss):
    """Type 6."""
    spots = [(k, at, w * slave.length[k] * slave.radius(k, at), None)
             for k in range(len(slave)) for at, w in zip(*gauss(n_gauss))]
    return nodal_pressure(slave, master, penalty, spots)


def segmented_mortar(slave, master, penalty):
    """Type 7."""
    feet = project(slave.x, master, slave.chords())
    spots = []
    for k in range(len(slave)):
        for left, right, _, _, segment in pieces(slave, master, k, feet):
            if facing(slave.normal[k], master.normal[segment]) > 0.0:
                size = (right - left) * slave.length[k]
                places = [(left + at * (right - left), w) for at, w in zip(*gauss(2))]
                spots += [(k, at, w * size * slave.radius(k, at), segment) for at, w in places]
    return nodal_pressure(slave, master, penalty, spots)


@dataclass
class Rule:
    """One contact card. unit: 0 N/m per contact node, 1 N/m2, 2 factor on the built-in estimate."""
    kind: int
    penalty: float
    unit: int = 0
    gauss: int = 2
    strict: bool = False
    back: float = 0.0  # PENT; 0 = as penalty

    def name(self):
        extra = f", {self.gauss} points" if self.kind == 6 else ", strict" if self.strict else ""
        return f"type {self.kind}{extra}, unit {self.unit}"


def distributed(rule, initial, estimate):
    """eps_hat of the slave and of the master pass, from the initial chains."""
    given = rule.penalty, rule.back or rule.penalty
    if rule.unit == 0:
        return [value / np.mean(chain.length) for value, chain in zip(given, initial)]
    return [value * (estimate if rule.unit == 2 else 1.0) for value in given]


def contact_forces(rule, slave, master, initial, estimate=None):
    """Nodal forces (slave, master) of one interface; initial = both chains at time zero."""
    penalty, back = distributed(rule, initial, estimate)
    if rule.kind == 1:
        return nts(slave, master, penalty * np.mean(initial[0].length))
    if rule.kind == 2:
        return nts_ar(slave, master, penalty)
    if rule.kind == 3:
        return two_pass_ar(slave, master, penalty, back)
    if rule.kind == 4:
        return vts_ppt(slave, master, penalty)
    if rule.kind == 5:
        return nts_mar(slave, master, penalty, rule.strict)
    if rule.kind == 6:
        return mortar(slave, master, penalty, rule.gauss)
    if rule.kind == 7:
        return segmented_mortar(slave, master, penalty)
    raise ValueError(f"no reference for type {rule.kind}")
