# SPDX-License-Identifier: MIT
"""Entry offsets of points that have come behind a surface from beside it, from the whole motion.

Each point is followed from the step in which it comes over the end of the other surface: it starts with
the depth that it had one step before, never has more than its present depth, and loses with each slip
the larger of slip / (L/2) of it and 1/20 of the slip. Types 5 and 7: the offset starts with that depth less
the one that overlaps beside the node bore one step before.
"""
import numpy as np

from reference import (MOST_POINTS, OVERSHOOT, Chain, Offsets, gauss, nts_mar, of_node, of_segment, project,
                       segmented_mortar)

RAMP = 0.05


def entries(points, starts, ends):
    """Steps in which points (step, point, 2) come over the open surface of these segments (step, segment,
    2), behind it, with the depth before: rows step, point, depth."""
    edge = ends - starts
    length = np.linalg.norm(edge, axis=2)
    tangent = edge / length[..., None]
    normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=2)
    found = []
    for k, side in ((0, -1), (edge.shape[1] - 1, 1)):
        away = points - starts[:, k, None, :]
        at = np.sum(away * tangent[:, k, None, :], axis=2) / length[:, k, None]
        gap = np.sum(away * normal[:, k, None, :], axis=2)
        is_out = (at < -OVERSHOOT) if side < 0 else (at > 1.0 + OVERSHOOT)
        is_new = is_out[:-1] & ~is_out[1:] & (gap[1:] < 0.0) & (gap[:-1] < 0.0)
        found += [(n + 1, i, min(-gap[n, i], -gap[n + 1, i])) for n, i in zip(*np.nonzero(is_new))]
    return found


def histories(points, own, other, borne=None):
    """Offsets of points (step, point, 2) over all steps; own(step, point): normals of their own surface;
    other: nodes of the open surface that they come upon (step, node, 2); borne(step, offsets in it): depth that
    overlaps beside each point bear."""
    offsets = np.zeros(points.shape[:2])
    for n, i, offset in sorted(entries(points, other[:, :-1], other[:, 1:])):
        if borne:
            offset = max(0.0, offset - borne(n - 1, offsets[n - 1])[i])
        for n in range(n, len(points)):
            chain = Chain(other[n])
            projection = project([points[n, i]], chain, [own(n, i)])[0]
            if not projection or projection.gap >= 0.0:
                break
            limited = min(offset, -projection.gap)
            first, second = (other[n, node] - other[n - 1, node] for node in chain.nodes[projection.segment])
            motion = points[n, i] - points[n - 1, i] - (1.0 - projection.at) * first - projection.at * second
            slip = abs(motion @ chain.tangent[projection.segment])
            offset = max(0.0, limited - slip * max(2.0 * limited / chain.length[projection.segment], RAMP))
            if offset <= 0.0:
                break
            offsets[n, i] = offset
    return offsets


def entry_offsets(rule, slave, master):
    """Offsets (Offsets) in each step, of a slave surface with these nodes (step, node, 2) on a fixed
    master (nodes, 2)."""
    n_step, n = len(slave), slave.shape[1] - 1
    still = np.broadcast_to(master, (n_step, *master.shape))
    of_slave, of_master = np.zeros(slave.shape[:2]), np.zeros(still.shape[:2])
    between = np.zeros((n_step, n, MOST_POINTS))
    rules = {5: lambda *chains, offsets: nts_mar(*chains, 1.0, rule.strict, offsets),
             7: lambda *chains, offsets: segmented_mortar(*chains, 1.0, offsets)}

    def borne(step, offsets):
        found = Offsets((offsets, of_master[step]), between[step])
        rules[rule.kind](Chain(slave[step]), Chain(master), offsets=found)
        return found.borne

    places = {4: np.array([0.25, 0.75]), 6: gauss(rule.gauss)[0]}.get(rule.kind)
    if places is None:
        of_slave = histories(slave, lambda step, i: of_node(Chain(slave[step]), i), still,
                             borne if rule.kind in rules else None)
    else:
        points = slave[:, :-1, None, :] + places[:, None] * np.diff(slave, axis=1)[:, :, None, :]
        of_points = histories(points.reshape(n_step, -1, 2), lambda step, i: of_segment(
            Chain(slave[step]), i // len(places)), still)
        between[:, :, :len(places)] = of_points.reshape(n_step, n, -1)
    if rule.kind == 3:
        of_master = histories(still, lambda step, i: of_node(Chain(master), i), slave)
    return [Offsets(*both) for both in zip(zip(of_slave, of_master), between)]
