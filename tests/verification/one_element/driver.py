# SPDX-License-Identifier: MIT
"""One quad with given corner positions, plane strain or axisymmetric: full 3x3 tensors, nothing saved.

Written from the documents alone (README.md), apart from the program. The third axis is out of the plane: the
thickness, or the hoop of an axisymmetric body.
"""
import numpy as np

ONE = np.eye(3)
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
#: 3x3 Gauss points: exact for every integral that is needed
GAUSS = [(a, b, wa * wb) for a, wa in zip(_POINTS, _WEIGHTS) for b, wb in zip(_POINTS, _WEIGHTS)]


def deviator(tensor):
    return tensor - np.trace(tensor) / 3.0 * ONE


def dot(a, b):
    return float(np.vdot(a, b))


def shapes(xi, eta):
    """Bilinear functions of the corners and their derivatives, rows d/dxi and d/deta."""
    n = 0.25 * np.array([(1 - xi) * (1 - eta), (1 + xi) * (1 - eta), (1 + xi) * (1 + eta), (1 - xi) * (1 + eta)])
    d = 0.25 * np.array([[-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)], [-(1 - xi), -(1 + xi), 1 + xi, 1 - xi]])
    return n, d


def at_points(corners, is_axisymmetric):
    """For each Gauss point of quads corners[..., 4, 2]: functions, derivatives, Jacobian, weighted area, weight."""
    for xi, eta, weight in GAUSS:
        n, d = shapes(xi, eta)
        jacobian = d @ corners
        radius = corners[..., 0] @ n if is_axisymmetric else np.ones(corners.shape[:-2])
        yield n, d, jacobian, weight * np.linalg.det(jacobian), radius


def volume(corners, is_axisymmetric):
    """Area of the section, or the integral of r over it."""
    return sum(area * radius for _, _, _, area, radius in at_points(corners, is_axisymmetric))


def mean_gradient(corners, values, is_axisymmetric):
    """Volume mean of d(values)_i/dx_j over the shapes `corners`; round: with the mean of values_r/r as the 33 part."""
    gradient = np.zeros(np.broadcast_shapes(corners.shape[:-2], values.shape[:-2]) + (3, 3))
    for n, d, jacobian, area, radius in at_points(corners, is_axisymmetric):
        local = np.linalg.solve(jacobian, np.broadcast_to(d, jacobian.shape[:-1] + (4,))) @ values
        gradient[..., :2, :2] += (area * radius)[..., None, None] * np.swapaxes(local, -1, -2)
        if is_axisymmetric:
            gradient[..., 2, 2] += area * (values[..., 0] @ n)
    return gradient / volume(corners, is_axisymmetric)[..., None, None]


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class Step:
    """What a law may know of one step.

    rotation: Hughes-Winget Q of the step; strain: dt D of the mid-step, turned by half of Q; rate: sqrt(D:D);
    trace: that of D; before, after, middle: volume ratios; gradient and length: F and the root of the area at the end.
    """

    def __init__(self, dt, velocity_gradient, ratios, gradient, length):
        self.dt, self.gradient, self.length = dt, gradient, length
        self.trace = np.trace(velocity_gradient)
        self.before, self.middle, self.after = ratios
        stretching = 0.5 * (velocity_gradient + velocity_gradient.T)
        spin = 0.5 * (velocity_gradient - velocity_gradient.T)
        self.rotation = np.linalg.solve(ONE - 0.5 * dt * spin, ONE + 0.5 * dt * spin)
        half = turn(0.5 * np.arctan2(self.rotation[1, 0], self.rotation[0, 0]))
        self.strain = half @ (dt * stretching) @ half.T
        self.rate = np.sqrt(dot(stretching, stretching))
        self.deviatoric_rate = np.sqrt(dot(deviator(stretching), deviator(stretching)))

    def turned(self, tensor):
        return self.rotation @ tensor @ self.rotation.T


def steps(history, dt, is_axisymmetric):
    """The steps along corner positions history[step, corner, 2]."""
    middle = 0.5 * (history[1:] + history[:-1])
    velocity_gradients = mean_gradient(middle, np.diff(history, axis=0) / dt, is_axisymmetric)
    first = volume(history[0], is_axisymmetric)
    ratio, middle_ratio = volume(history, is_axisymmetric) / first, volume(middle, is_axisymmetric) / first
    gradients = mean_gradient(history[0], history, is_axisymmetric)
    # the 33 part of F is what makes det F the volume ratio
    gradients[:, 2, 2] = ratio / np.linalg.det(gradients[:, :2, :2])
    lengths = np.sqrt(volume(history, False))
    for k, velocity_gradient in enumerate(velocity_gradients):
        yield Step(dt, velocity_gradient, (ratio[k], middle_ratio[k], ratio[k + 1]), gradients[k + 1],
                   lengths[k + 1])


def follow(law, path):
    """Stress (step, 3, 3), plastic strain, temperature, damage and internal energy per initial volume along the
    steps of a path; the first row is the state at the start."""
    state = law.at_rest()
    rows = [law.result(state)]
    for step in path:
        state = law.advance(state, step)
        rows.append(law.result(state))
    names = ("stress", "plastic_strain", "temperature", "damage", "energy")
    return {name: np.array([row[name] for row in rows]) for name in names}


def drive(law, history, dt, is_axisymmetric=False):
    """Follow corner positions history[step, corner, 2] with a constant step."""
    return follow(law, steps(history, dt, is_axisymmetric))
