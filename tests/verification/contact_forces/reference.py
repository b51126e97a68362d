# SPDX-License-Identifier: MIT
"""The seven contact formulations by brute force, written from their description alone.

Everything is evaluated from scratch for one configuration: the closest segment is found by
looking at all of them, nothing is tracked, ordered or kept. Positions are handed in relative to a
point near the interface, so that they carry no large common part.

A surface is walked with its body on the left; the outward normal of a segment is (t_y, -t_x).
Closed boundaries are in contact where they are opposed; entry offsets come from history.py.
"""
import functools
from dataclasses import dataclass

import numpy as np

OVERSHOOT = 0.01      # of the end segment of an open surface: still projected, not clamped
SIDE_ON, FACE_ON = -0.1, -0.5  # slave normal . master normal: not opposed above, fully below
GENTLE, SHARP_VERTEX = 0.1, 0.59  # 1 - cosine of the turn at a corner: both segments count, and one of them
SLAVE_SIDE, MASTER_SIDE = (-0.1, 0.1), (0.1, 0.59)  # excess of cosines up to which it counts there, and from which not
AVERTED = 0.25        # cosine of normals from which on a segment is no candidate
BETWEEN = 0.17        # sine of the angle between a direction and those that it lies between
SHALLOW = 0.25        # of the segment: how deep a point may be to change sides at a sharp corner
ON_NODE = 1.0e-9     # of the segment: a projection this close to a node stands on it
STRAIGHT = 1.0e-3  # sine of the turn below which there is no corner
TINY = 1.0e-300
MOST_POINTS = 10     # of a segment
SHARP = np.cos(np.radians(60.0))  # a projection does not walk across corners that turn more

#: Difference of the gaps to both segments of a corner on its bisector, as a part of the segment.
BISECTOR = 1.0e-10


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def step(value, low, high):
    """Cubic step from 0 at `low` to 1 at `high`."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


class Chain:
    """Nodes (n, 2) in walking order and whether the last is joined to the first.

    `thick`: of the body behind each segment (closed boundaries). `is_axisymmetric`: axisymmetric, x is the
    radius: lengths weigh with it.
    """

    def __init__(self, x, closed=False, thick=None, is_axisymmetric=False):
        self.x = np.asarray(x, dtype=float)
        self.closed = closed
        self.is_axisymmetric = is_axisymmetric
        n = len(self.x)
        first = np.arange(n if closed else n - 1)
        self.nodes = np.stack([first, (first + 1) % n], axis=1)
        self.thick = np.full(len(first), np.inf) if thick is None else np.asarray(thick)
        self.start = self.x[self.nodes[:, 0]]
        edge = self.x[self.nodes[:, 1]] - self.start
        self.length = np.hypot(edge[:, 0], edge[:, 1])
        self.tangent = edge / self.length[:, None]
        self.normal = np.stack([self.tangent[:, 1], -self.tangent[:, 0]], axis=1)

    def __len__(self):
        return len(self.length)

    def next(self, segment, step):
        """The neighbour segment in the walking sense (step 1) or against it (-1), or None."""
        other = segment + step
        return other % len(self) if self.closed else other if 0 <= other < len(self) else None

    def sides(self, node):
        """The segments before and after a node; None at an open end."""
        after = node if node < len(self) else None
        before = node - 1 if node > 0 else len(self) - 1 if self.closed else None
        return before, after

    def is_sharp(self, one, two):
        return np.dot(self.tangent[one], self.tangent[two]) < SHARP

    def nearest(self, point):
        """The segment nearest to a point."""
        away = point - self.start
        at = np.clip(np.sum(away * self.tangent, axis=1), 0.0, self.length)
        return int(np.argmin(np.linalg.norm(away - at[:, None] * self.tangent, axis=1)))

    def radius(self, k, at):
        """In axisymmetry; 1 in the plane."""
        return self.start[k, 0] + at * self.length[k] * self.tangent[k, 0] if self.is_axisymmetric else 1.0

    def integral(self, k, left, right, values):
        """Of values(at) over a stretch of a segment, by three Gauss points: exact for all that is asked."""
        at, weight = gauss(3)
        at = left + at * (right - left)
        return (right - left) * self.length[k] * np.sum(weight * self.radius(k, at) * values(at))

    def weight(self, k, left, right):
        """Of a stretch of a segment."""
        if not self.is_axisymmetric:
            return (right - left) * self.length[k]
        return self.integral(k, left, right, np.ones_like)

    def centre(self, k, left, right):
        """Of a stretch of a segment, by weight; on the axis, where there is none, the middle."""
        if not self.is_axisymmetric:
            return 0.5 * (left + right)
        weight = self.weight(k, left, right)
        return self.integral(k, left, right, lambda at: at) / weight if weight else 0.5 * (left + right)

    def shares(self, k, left, right):
        """What either end of a stretch has of its weight: the integral by its hat function there."""
        size = right - left
        if not self.is_axisymmetric:
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
class Projection:
    """Projection of a point on a chain: x - projection = gap * normal."""
    segment: int
    at: float
    gap: float
    normal: np.ndarray

    def before(self, chain):
        """The segment that the projection is on; at a node the one before the node."""
        return self.beside(chain, abs(self.at) <= ON_NODE, -1)

    def after(self, chain):
        """The same; at a node the one after the node."""
        return self.beside(chain, abs(self.at - 1.0) <= ON_NODE, 1)

    def beside(self, chain, is_on_node, step):
        other = chain.next(self.segment, step) if is_on_node else None
        return self.segment if other is None else other


@dataclass
class Own:
    """Normals of the surface that a point is on: of its segment, or of both at a node."""
    normals: list        # before and after
    is_node: bool = True

    def cosines(self, normals):
        """Of the segment that is most opposed to each of some faces."""
        return np.min(normals @ np.array([own for own in self.normals if own is not None]).T, axis=1)

    def cosine(self, normal):
        return self.cosines(normal[None])[0]

    def is_opposed(self, normal):
        """To a face: within 60 degrees (between nodes: 84) of one of the segments, or between both of a
        convex vertex; at an open end the tangent stands for the missing normal."""
        if self.cosine(normal) < (FACE_ON if self.is_node else SIDE_ON):
            return True
        if not self.is_node:
            return False
        one, two = self.normals
        one = np.array([-two[1], two[0]]) * -1.0 if one is None else one
        two = np.array([-one[1], one[0]]) if two is None else two
        return (cross(one, two) > 0.0 and cross(one, -normal) > BETWEEN
                and cross(-normal, two) > BETWEEN)


def of_node(chain, node):
    return Own([None if s is None else chain.normal[s] for s in chain.sides(node)])


def of_segment(chain, k):
    return Own([chain.normal[k]], is_node=False)


def project(points, chain, owns, averted=AVERTED):
    """Closest-point projections (Projection or None) of all points, each on all segments that its own
    surface (one Own for each point) may face."""
    projections = []
    for point, own in zip(np.atleast_2d(points), owns):
        away = point - chain.start
        at = np.sum(away * chain.tangent, axis=1) / chain.length
        height = np.sum(away * chain.normal, axis=1)
        beyond = (at - np.clip(at, 0.0, 1.0)) * chain.length
        far = np.hypot(beyond, height)
        far[own.cosines(chain.normal) >= averted] = np.inf
        if not np.isfinite(far).any():
            projections.append(None)
            continue
        projections.append(project_one(point, chain, own, int(np.argmin(far)), at, height))
    return projections


def project_one(point, chain, own, k, at, height):
    edge = opposed_edge(chain, k, at, height, own)
    projection = Projection(edge, at[edge], height[edge], chain.normal[edge]) if edge is not None else \
        one_foot(point, chain, k, at, height)
    if projection and projection.gap < 0.0 and not (own.is_opposed(projection.normal) and
                                        projection.gap > -chain.thick[projection.segment]):
        behind = [s for s in range(len(chain)) if 0.0 <= at[s] <= 1.0 and own.is_opposed(chain.normal[s])
                  and -chain.thick[s] < height[s] < 0.0]
        best = max(behind, key=lambda s: height[s], default=None)
        return None if best is None else Projection(best, at[best], height[best], chain.normal[best])
    return projection


def opposed_edge(chain, k, at, height, own):
    """At a sharp corner (the edge of a block): the segment, other than the closest one, that the
    point is under and that its own surface faces more; or None. Without this a corner that lies
    flush on a corner would belong to the side of the block by a hair."""
    if OVERSHOOT < at[k] < 1.0 - OVERSHOOT and own.is_opposed(chain.normal[k]):
        return None
    found = [other for other in (chain.next(k, -1), chain.next(k, 1)) if other is not None
             and chain.is_sharp(k, other) and own.is_opposed(chain.normal[other])]
    found = [s for s in (k, *found) if -OVERSHOOT <= at[s] <= 1.0 + OVERSHOOT]
    best = min(found, key=lambda s: own.cosine(chain.normal[s]), default=k)
    if not (0.0 <= at[best] <= 1.0 or 0.0 <= at[k] <= 1.0):  # over neither: at the vertex
        return None
    return best if best != k and -SHALLOW * chain.length[best] < height[best] < 0.0 else None


def is_on_bisector(chain, k, other, height):
    """Whether a point behind both segments of a corner that is not sharp is as near to both: it belongs to the vertex."""
    return not chain.is_sharp(k, other) and abs(height[k] - height[other]) < BISECTOR * chain.length[k] \
        and np.dot(chain.normal[k], chain.normal[other]) ** 2 < 1.0 - 1.0e-6


def one_foot(point, chain, k, at, height):
    """The projection on segment k or its vertex, given coordinates and heights over all segments."""
    step = 1 if at[k] > 0.5 else -1
    other = chain.next(k, step)
    is_inside = other is not None and height[k] < 0.0 and height[other] < 0.0
    if 0.0 <= at[k] <= 1.0 and not (is_inside and is_on_bisector(chain, k, other, height)):
        return Projection(k, at[k], height[k], chain.normal[k])
    if other is None or (chain.is_sharp(k, other) and height[k] < 0.0 and not is_inside):
        if -OVERSHOOT <= at[k] <= 1.0 + OVERSHOOT:  # the face ends here
            return Projection(k, at[k], height[k], chain.normal[k])
        if other is None:
            return None
    vertex = chain.x[chain.nodes[k, 1 if step == 1 else 0]]
    radius = point - vertex
    distance = np.hypot(*radius)
    if height[other] > height[k]:
        k, other, step = other, k, -step
    gap = -distance if is_inside else distance
    normal = radius / gap if distance > 0.0 else chain.normal[k]
    return Projection(k, 1.0 if step == 1 else 0.0, gap, normal)


@dataclass
class Offsets:
    """Entry offsets: of the nodes of both sides, and of points between nodes, segment by segment. Forces that are formed
    with them leave the depth that overlaps beside each slave node bear (types 5 and 7)."""
    nodes: tuple
    between: np.ndarray
    borne: np.ndarray = None

    def on_segment(self, chain, k, at):
        first, second = self.nodes[0][chain.nodes[k]]
        return (1.0 - at) * first + at * second


def no_offsets(slave, master):
    return Offsets((np.zeros(len(slave.x)), np.zeros(len(master.x))), np.zeros((len(slave), MOST_POINTS)))


class Forces:
    """Sums of nodal forces on both sides."""

    def __init__(self, slave, master, offsets=None):
        self.chains = slave, master
        self.offsets = offsets or no_offsets(slave, master)
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


def facing(slave_normal, master_normal):
    """Share of a slave segment that counts as opposed."""
    return step(-np.dot(slave_normal, master_normal), -SIDE_ON, -FACE_ON)


def tributary(chain, node, normal):
    """Length (axisymmetric: its integral by the radius) of a node on a face: half of its segments; of a
    closed boundary as far as they are opposed to the face, at a sharp corner the more opposed one alone.
    Where the face stands between both normals what the larger share leaves of both counts too."""
    sides = chain.sides(node)
    halves = np.array([0.0 if s is None else chain.shares(s, 0.0, 1.0)[1 - side]
                       for side, s in enumerate(sides)])
    if not chain.closed:
        return np.sum(halves)
    normals = chain.normal[list(sides)]
    shares = np.array([facing(own, normal) for own in normals])
    parts = np.array([corner_part(normals[way], normals[1 - way], normal, SLAVE_SIDE) for way in (0, 1)])
    if cross(*normals) <= 0.0:
        parts[:] = 1.0
    area = halves @ (shares * parts)
    if cross(normals[0], -normal) > 0.0 and cross(-normal, normals[1]) > 0.0 and np.max(shares) < 1.0:
        area += (1.0 - np.max(shares)) * np.mean(parts) * np.sum(halves)
    return area


def corner_part(own, beside, normal, side):
    """How much of a segment with the normal `own` counts on a face where one with the normal `beside`
    follows at a convex corner: all where the corner is gentle."""
    return 1.0 - step(1.0 - own @ beside, GENTLE, SHARP_VERTEX) * step((own - beside) @ normal, *side)


def push_nodes(forces, side, stiffness):
    """Nodes of one side on their closest segment of the other; stiffness(node, normal)."""
    chain, other = forces.chains[side], forces.chains[1 - side]
    nodes = range(len(chain.x))
    for node, projection in zip(nodes, project(chain.x, other, [of_node(chain, node) for node in nodes])):
        if projection and projection.gap < 0.0:
            gap = projection.gap + forces.offsets.nodes[side][node]
            force = -stiffness(node, projection.normal) * gap * projection.normal
            forces.at_node(side, node, force)
            forces.on_segment(1 - side, projection.segment, projection.at, -force)


def nts(slave, master, penalty, offsets=None):
    """Type 1; penalty in N/m."""
    forces = Forces(slave, master, offsets)
    plane = Chain(slave.x, slave.closed)
    push_nodes(forces, 0, lambda *face: penalty * tributary(slave, *face) / tributary(plane, *face))
    return forces.sides


def nts_ar(slave, master, penalty, offsets=None):
    """Type 2; penalty in N/m2, as in all the following."""
    forces = Forces(slave, master, offsets)
    push_nodes(forces, 0, lambda *face: penalty * tributary(slave, *face))
    return forces.sides


def two_pass_ar(slave, master, penalty, penalty_back, offsets=None):
    """Type 3."""
    forces = Forces(slave, master, offsets)
    push_nodes(forces, 0, lambda *face: penalty * tributary(slave, *face))
    push_nodes(forces, 1, lambda *face: penalty_back * tributary(master, *face))
    return forces.sides


def vts_ppt(slave, master, penalty, offsets=None):
    """Type 4."""
    forces = Forces(slave, master, offsets)
    for k in range(len(slave)):
        def position(at, k=k):
            return slave.start[k] + at * slave.length[k] * slave.tangent[k]
        for q, half in enumerate(((0.0, 0.5), (0.5, 1.0))):
            at = slave.centre(k, *half)
            projection = project(position(at), master, [of_segment(slave, k)])[0]
            if not projection or projection.gap >= 0.0:
                continue
            gap = projection.gap + forces.offsets.between[k, q]
            force = -penalty * slave.weight(k, *half) * gap * projection.normal
            forces.on_segment(0, k, at, force)
            ends = [walk(position(end), projection.segment, master) for end in half]
            parts = portions(master, *ends) or [(projection.segment, projection.at, 1.0)]
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
        is_end = other is None or chain.is_sharp(segment, other)
        if is_end and -OVERSHOOT <= at <= 1.0 + OVERSHOOT:
            return steps, segment, at
        if is_end:
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


def overlaps(slave, master, k, projections, strict=False):
    """Overlaps of slave segment k with the master segments that are opposed to it: both nodes of each
    projected on it and clipped.

    Nothing beyond the master segments that its ends are projected on; these reach to its ends. An
    end whose projection is a master node has this node between it and the other end. Returns (left,
    right, master node at the left or None, at the right or None, master segment, part that counts of
    sides of corners).
    """
    ends = [end_projection(slave, master, k, node, projections[node]) for node in slave.nodes[k]]
    if strict and None in ends:
        faces = [projection.normal for projection in (projections[node] for node in slave.nodes[k]) if projection and projection.gap < 0.0]
        is_opposed = any(np.dot(slave.normal[k], normal) < SIDE_ON for normal in faces)
        return [(0.0, 1.0, None, None, None, 1.0)] if is_opposed else []
    first, last = ends[0] and ends[0].after(master), ends[1] and ends[1].before(master)
    touched = {projection.segment for projection in (projections[node] for node in slave.nodes[k]) if projection and projection.gap < 0.0}
    found = []
    for m in range(len(master)):
        if np.dot(slave.normal[k], master.normal[m]) >= SIDE_ON and m not in (first, last):
            continue
        if is_past(master, first, m, 1) or is_past(master, last, m, -1):
            continue
        nodes = master.nodes[m, ::-1]
        away = master.x[nodes] - slave.start[k]
        at, gap = away @ slave.tangent[k] / slave.length[k], away @ slave.normal[k]
        low, high = np.clip(at, 0.0, 1.0)
        left, right = nodes[0] if 0.0 < low else None, nodes[1] if high < 1.0 else None
        if m == first:
            low, left = 0.0, None
        if m == last:
            high, right = 1.0, None
        if at[0] < 0.0 and is_past_corner(master, m, 1, first, projections[slave.nodes[k, 0]]):
            left = nodes[0]
        if at[1] > 1.0 and is_past_corner(master, m, -1, last, projections[slave.nodes[k, 1]]):
            right = nodes[1]
        if not low < high:
            continue
        middle = np.interp(0.5 * (low + high), at, gap) if at[0] < at[1] else np.mean(gap)
        if middle < -0.75 * master.thick[m] and m not in touched:
            continue
        part = sides_part(slave, k, master, m)
        if part > 0.0:
            found.append((low, high, left, right, m, part))
    return sorted(found, key=lambda overlap: overlap[:2])


def is_past_corner(master, m, step, below, projection):
    """Whether an end of a slave segment is in contact with the face next to segment m, past a corner between them."""
    if not (projection and projection.gap < 0.0) or ON_NODE >= abs(abs(projection.at - 0.5) - 0.5):
        return False
    return below == master.next(m, step) and abs(cross(master.normal[m], master.normal[below])) > STRAIGHT


def sides_part(slave, k, master, m):
    """How much of slave segment k counts opposite to master segment m."""
    return side_part(slave, k, master.normal[m], SLAVE_SIDE) * side_part(master, m, slave.normal[k], MASTER_SIDE)


def side_part(chain, k, normal, side):
    """How much of segment k of a closed boundary counts beside the segments next to it at convex
    corners."""
    part = 1.0
    for way in (-1, 1) if chain.closed else ():
        other = chain.next(k, way)
        if cross(chain.normal[k], chain.normal[other]) * way > 0.0:
            part *= corner_part(chain.normal[k], chain.normal[other], normal, side)
    return part


def end_projection(slave, master, k, node, projection):
    """Projection of an end of slave segment k: the one that it is in contact with, or the closest on
    what is opposed to the segment; or None, which it is beside a sharp corner."""
    if projection and projection.gap < 0.0:
        return projection
    projection = project(slave.x[node], master, [of_segment(slave, k)], SIDE_ON)[0]
    if projection and projection.at in (0.0, 1.0):
        other = master.next(projection.segment, 1 if projection.at else -1)
        if other is not None and master.is_sharp(projection.segment, other):
            return None
    return projection


def is_past(master, end, m, step):
    """Whether segment m lies beyond the segment that an end of a slave segment is projected on, in
    walking order or against it, the shorter way round."""
    if end is None or end == m:
        return False
    if not master.closed:
        return (m - end) * step > 0
    n = len(master)
    return (m - end) * step % n < (end - m) * step % n


def nts_mar(slave, master, penalty, strict=False, offsets=None):
    """Type 5, with the extension for slave surfaces that overhang the master unless strict."""
    forces = Forces(slave, master, offsets)
    projections = project(slave.x, master, [of_node(slave, node) for node in range(len(slave.x))])
    weight = np.zeros(len(slave.x))
    extra = {}
    for k in range(len(slave)):
        for left, right, left_node, right_node, segment, part in overlaps(slave, master, k, projections, strict):
            share = part * (1.0 if strict else facing(slave.normal[k], master.normal[segment]))
            shares = slave.shares(k, left, right)
            for end, node in enumerate((left_node, right_node)):
                if node is not None:
                    extra[k, node] = extra.get((k, node), 0.0) + share * shares[end]
                else:
                    weight[slave.nodes[k, end]] += share * shares[end]
    for node, projection in enumerate(projections):
        if not projection or projection.gap >= 0.0:
            continue
        if weight[node] == 0.0 and not any(s is not None and facing(slave.normal[s], projection.normal) > 0.0
                                           for s in slave.sides(node)):
            weight[node] = slave.competence()[node]
        gap = projection.gap + forces.offsets.nodes[0][node]
        force = -penalty * weight[node] * gap * projection.normal
        forces.at_node(0, node, force)
        forces.on_segment(1, projection.segment, projection.at, -force)
    forces.offsets.borne = np.zeros(len(slave.x))
    for (k, node), w in extra.items():
        away = master.x[node] - slave.start[k]
        gap = np.dot(away, slave.normal[k])
        at = np.dot(away, slave.tangent[k]) / slave.length[k]
        if gap < 0.0:
            depth = max(0.0, -gap - forces.offsets.on_segment(slave, k, at))
            if w > 0.0:
                np.maximum.at(forces.offsets.borne, slave.nodes[k], depth * np.array([1.0 - at, at]))
            force = penalty * w * depth * slave.normal[k]
            forces.at_node(1, node, force)
            forces.on_segment(0, k, at, -force)
    return forces.sides


def overlap_projection(point, chain, piece, projection):
    """Across a sharp corner a Gauss point under the segment of its piece stays with it."""
    if piece is None or projection is None or projection.segment not in (chain.next(piece, -1),
                                                             chain.next(piece, 1)):
        return projection
    away = point - chain.start[piece]
    at = np.dot(away, chain.tangent[piece]) / chain.length[piece]
    gap = np.dot(away, chain.normal[piece])
    if (np.dot(chain.tangent[piece], chain.tangent[projection.segment]) < SHARP and 0.0 <= at <= 1.0
            and -SHALLOW * chain.length[piece] < gap < 0.0):
        return Projection(piece, at, gap, chain.normal[piece])
    return projection


def nodal_pressure(slave, master, penalty, sites, offsets=None):
    """Types 6 and 7 from integration points: slave segment, coordinate, length weight, and the
    master segment of the overlap for type 7 (None for type 6)."""
    forces = Forces(slave, master, offsets)
    where = [slave.start[k] + at * slave.length[k] * slave.tangent[k] for k, at, _, _ in sites]
    projections = project(where, master, [of_segment(slave, k) for k, _, _, _ in sites]) if sites else []
    projections = [overlap_projection(point, master, piece, projection)
            for point, (_, _, _, piece), projection in zip(where, sites, projections)]
    kept = [(k, at, w * facing(slave.normal[k], projection.normal)
             * (sides_part(slave, k, master, projection.segment) if piece is None else 1.0), projection)
            for (k, at, w, piece), projection in zip(sites, projections) if projection]
    of_sites = [forces.offsets.on_segment(slave, k, at) if piece is not None else
                forces.offsets.between[k, i % (len(sites) // len(slave))]
                for i, (k, at, _, piece) in enumerate(sites)]
    of_sites = [offset for offset, projection in zip(of_sites, projections) if projection]
    area, volume = np.zeros(len(slave.x)), np.zeros(len(slave.x))
    for (k, at, w, projection), offset in zip(kept, of_sites):
        for node, shape in zip(slave.nodes[k], (1.0 - at, at)):
            area[node] += shape * w
            volume[node] += shape * w * (projection.gap + offset)
    gap = np.divide(volume, area, out=np.zeros_like(area), where=area > 0.0)
    forces.offsets.borne = np.maximum(0.0, -gap)
    pressure = penalty * forces.offsets.borne
    for k, at, w, projection in kept:
        first, second = pressure[slave.nodes[k]]
        force = w * ((1.0 - at) * first + at * second) * projection.normal
        forces.on_segment(0, k, at, force)
        forces.on_segment(1, projection.segment, projection.at, -force)
    return forces.sides


def mortar(slave, master, penalty, n_gauss, offsets=None):
    """Type 6."""
    sites = [(k, at, w * slave.length[k] * slave.radius(k, at), None)
             for k in range(len(slave)) for at, w in zip(*gauss(n_gauss))]
    return nodal_pressure(slave, master, penalty, sites, offsets)


def segmented_mortar(slave, master, penalty, offsets=None):
    """Type 7."""
    projections = project(slave.x, master, [of_node(slave, node) for node in range(len(slave.x))])
    sites = []
    for k in range(len(slave)):
        for left, right, _, _, segment, part in overlaps(slave, master, k, projections):
            if facing(slave.normal[k], master.normal[segment]) > 0.0:
                size = part * (right - left) * slave.length[k]
                places = [(left + at * (right - left), w) for at, w in zip(*gauss(2))]
                sites += [(k, at, w * size * slave.radius(k, at), segment) for at, w in places]
    return nodal_pressure(slave, master, penalty, sites, offsets)


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


def contact_forces(rule, slave, master, initial, estimate=None, offsets=None):
    """Nodal forces (slave, master) of one interface; initial = both surfaces at time zero."""
    penalty, back = distributed(rule, initial, estimate)
    if rule.kind == 1:
        return nts(slave, master, penalty * np.mean(initial[0].length), offsets)
    if rule.kind == 2:
        return nts_ar(slave, master, penalty, offsets)
    if rule.kind == 3:
        return two_pass_ar(slave, master, penalty, back, offsets)
    if rule.kind == 4:
        return vts_ppt(slave, master, penalty, offsets)
    if rule.kind == 5:
        return nts_mar(slave, master, penalty, rule.strict, offsets)
    if rule.kind == 6:
        return mortar(slave, master, penalty, rule.gauss, offsets)
    if rule.kind == 7:
        return segmented_mortar(slave, master, penalty, offsets)
    raise ValueError(f"no reference for type {rule.kind}")
