# SPDX-License-Identifier: MIT
"""The punch by a small static program of its own: linear elasticity, fully integrated axisymmetric quads with four nodes,
node to node contact with active sets (normal: no penetration, no tension; tangential: stick or Coulomb), numpy alone.

`python independent.py MU [CELL]` prints the sink of the axis in the contact and the mean axial stress next to it.
"""
import sys

import numpy as np

POISSON, PRESSURE = 0.3, 100.0


def grown(start, end, cell):
    """Lines from start to end whose spacing grows by about 1.25 from `cell`."""
    n = int(np.ceil(np.log(1.0 + 0.25 * (end - start) / cell) / np.log(1.25)))
    steps = 1.25 ** np.arange(n)
    return start + (end - start) * np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()


def body(r, heights, rise):
    """Nodes row by row (rise of each column at the contact row) and quads, anticlockwise for growing heights."""
    nodes = np.array([(x, up + h * (1.0 - up / heights[-1])) for h in heights for x, up in zip(r, rise)])
    w = len(r)
    quads = np.array([(j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i)
                      for j in range(len(heights) - 1) for i in range(w - 1)])
    return nodes, quads if heights[-1] > 0 else quads[:, ::-1]


def stiffness(nodes, quads, young):
    """Dense stiffness per radian, and the operator of s_zz at the middle of each quad."""
    factor = young / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
    law = factor * np.array([[1 - POISSON, POISSON, POISSON, 0], [POISSON, 1 - POISSON, POISSON, 0],
                             [POISSON, POISSON, 1 - POISSON, 0], [0, 0, 0, 0.5 - POISSON]])
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    total = np.zeros((2 * len(nodes),) * 2)
    axial = np.zeros((len(quads), 8))
    g = 1.0 / np.sqrt(3.0)
    for e, quad in enumerate(quads):
        x, own = nodes[quad], np.zeros((8, 8))
        for a, b, weight in ((-g, -g, 1), (g, -g, 1), (g, g, 1), (-g, g, 1), (0, 0, 0)):
            n = 0.25 * (1 + corners[:, 0] * a) * (1 + corners[:, 1] * b)
            dn = 0.25 * np.stack([corners[:, 0] * (1 + corners[:, 1] * b), corners[:, 1] * (1 + corners[:, 0] * a)])
            jacobian = dn @ x
            gradient, radius = np.linalg.solve(jacobian, dn), n @ x[:, 0]
            strain = np.zeros((4, 8))
            strain[0, 0::2], strain[1, 1::2], strain[2, 0::2] = gradient[0], gradient[1], n / radius
            strain[3, 0::2], strain[3, 1::2] = gradient[1], gradient[0]
            own += weight * np.linalg.det(jacobian) * radius * strain.T @ law @ strain
            if not weight:
                axial[e] = law[1] @ strain
        at = np.stack([2 * quad, 2 * quad + 1], 1).ravel()
        total[np.ix_(at, at)] += own
    return total, axial


def solve(friction, cell):
    """(sink of the axis, axial stress next to it in punch and foundation)."""
    flat = 40.0 - grown(0.0, 40.0, cell)[::-1]
    arc = np.arcsin(np.arange(1, int(4.0 / cell) + 1) * cell / 10.0)
    arc = np.concatenate([arc, arc[-1] + grown(0.0, 0.5 * np.pi - arc[-1], cell / 10.0)[1:]])
    r = np.concatenate([flat, 40.0 + 10.0 * np.sin(arc)])
    rise = np.concatenate([np.zeros(len(flat)), 10.0 * (1.0 - np.cos(arc))])
    upper = body(r, grown(0.0, 100.0, cell), rise)
    pairs = int(np.sum(r < 44.0 - 0.5 * cell))
    outside = r[pairs - 1] + grown(0.0, 100.0 - r[pairs - 1], cell)[1:]
    below = np.concatenate([r[:pairs], outside])
    lower = body(below, -grown(0.0, 200.0, cell), np.zeros(len(below)))
    (k1, s1), (k2, s2) = stiffness(*upper, 210.0e3), stiffness(*lower, 70.0e3)
    n1, n = len(upper[0]), len(upper[0]) + len(lower[0])
    k = np.zeros((2 * n, 2 * n))
    k[:2 * n1, :2 * n1], k[2 * n1:, 2 * n1:] = k1, k2
    f = np.zeros(2 * n)
    top = np.arange(n1 - len(r), n1)
    for a, b in zip(top, top[1:]):
        ra, rb = upper[0][a, 0], upper[0][b, 0]
        f[2 * a + 1] -= PRESSURE * (rb - ra) * (2 * ra + rb) / 6.0
        f[2 * b + 1] -= PRESSURE * (rb - ra) * (ra + 2 * rb) / 6.0
    x = np.concatenate([upper[0], lower[0]])
    fixed = np.zeros(2 * n, dtype=bool)
    fixed[0::2] = x[:, 0] == 0.0
    fixed[np.repeat(np.arange(n) >= n - len(below), 2)] = True
    free = np.flatnonzero(~fixed)
    # Flexibility of what is free, the punch held by weak springs that are taken out again by the constraints' system.
    place = np.zeros(2 * n, dtype=int)
    place[free] = np.arange(len(free))
    soft = k[np.ix_(free, free)]
    soft[place[1], place[1]] += 1.0e3   # removed below: one more unknown force at that node
    high, low = np.arange(pairs), n1 + np.arange(pairs)
    columns = np.zeros((len(free), 2 * pairs + 2))
    for i in range(pairs):
        columns[place[2 * high[i] + 1], i], columns[place[2 * low[i] + 1], i] = 1.0, -1.0
        if i:
            columns[place[2 * high[i]], pairs + i], columns[place[2 * low[i]], pairs + i] = 1.0, -1.0
    columns[:, -2] = f[free]
    columns[place[1], -1] = 1.0
    flexible = np.linalg.solve(soft, columns)
    gram = columns.T @ flexible      # relative motions under unit forces
    gap = rise[:pairs]
    closed, stick, sign = gap == 0.0, np.full(pairs, friction > 0.0), np.zeros(pairs)
    stick[0] = False
    load, spring = 2 * pairs, 2 * pairs + 1
    for _ in range(200):
        slip = closed & ~stick & (friction > 0.0) & (np.arange(pairs) > 0)
        held = closed & stick
        unknown = np.concatenate([np.flatnonzero(closed), pairs + np.flatnonzero(held), [spring]])
        # A slipping pair's tangential force is a multiple of its normal one.
        carry = np.zeros((2 * pairs + 2, len(unknown)))
        for j, one in enumerate(unknown):
            carry[one, j] = 1.0
            if one < pairs and slip[one]:
                carry[pairs + one, j] = friction * sign[one]
        system = gram[unknown] @ carry
        right = -gram[unknown, load]
        right[:closed.sum()] -= gap[closed]
        # The spring's force goes against its own motion: q = 1e3 u there, so that it is gone.
        system[-1] -= carry[spring] / 1.0e3
        answer = carry @ np.linalg.solve(system, right)
        motion = gram @ answer + gram[:, load]
        force, shear = answer[:pairs], answer[pairs:2 * pairs]
        new_closed = np.where(closed, force > 0.0, motion[:pairs] + gap < -1e-12)
        new_stick = np.where(stick, np.abs(shear) <= friction * force, motion[pairs:2 * pairs] * sign > 0.0)
        new_stick[0] = False
        new_stick |= ~new_closed & (friction > 0.0)
        new_sign = np.where(stick & ~new_stick, np.sign(shear), sign)
        if np.all(new_closed == closed) and np.all(new_stick == stick):
            break
        if not np.all(new_closed == closed):
            closed = new_closed
            stick = stick | ~closed if friction > 0.0 else stick
        else:
            stick, sign = new_stick, new_sign
    else:
        raise ArithmeticError("no contact found")
    u = np.zeros(2 * n)
    u[free] = flexible @ np.concatenate([answer[:load], [1.0], answer[spring:]])
    pick = [np.stack([2 * q, 2 * q + 1], 1).ravel() for q in (upper[1][0], lower[1][0] + n1)]
    return (u[2 * n1 + 1], u[1], float(s1[0] @ u[pick[0]]), float(s2[0] @ u[pick[1]]), force.sum() / (PRESSURE * 1250.0),
            r[:pairs][closed].max(), int(np.sum(closed & stick)), int(closed.sum()))


if __name__ == "__main__":
    print(*solve(float(sys.argv[1]), float(sys.argv[2]) if len(sys.argv) > 2 else 1.0))
