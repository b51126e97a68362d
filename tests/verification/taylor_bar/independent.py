# SPDX-License-Identifier: MIT
"""A small program of its own for the Taylor bar: the axisymmetric quad with gradients averaged over the volume, written
from its equations with numpy and nothing of the solver, with Coulomb friction under an impact end that stays on the wall.

`python independent.py COLUMNS ROWS MU [free]` prints radius, length and largest plastic strain; with `free` nodes of the impact end leave the wall
where they are pulled.
"""
import sys

import numpy as np

LENGTH, RADIUS, SPEED, END = 32.4e-3, 3.2e-3, 227.0, 80.0e-6
DENSITY, YOUNG, POISSON, YIELD, HARDENING = 8930.0, 117.0e9, 0.35, 400.0e6, 100.0e6
SHEAR, BULK = YOUNG / (2.0 * (1.0 + POISSON)), YOUNG / (3.0 * (1.0 - 2.0 * POISSON))


def geometry(r, z):
    """(n, 4) radii and heights of corners: areas weights M (n, 4), b_r, b_z (n, 4) and the volume per radian (n)."""
    rn, rp, zn, zp = (np.roll(one, shift, axis=1) for one in (r, z) for shift in (-1, 1))
    around = 0.5 * ((r[:, 2] - r[:, 0]) * (z[:, 3] - z[:, 1]) - (z[:, 2] - z[:, 0]) * (r[:, 3] - r[:, 1]))
    corner = 0.5 * ((rn - r) * (zp - z) - (zn - z) * (rp - r))
    m = (around[:, None] + corner) / 6.0
    b_r = ((2.0 * r + rn) * (zn - z) + (2.0 * r + rp) * (z - zp)) / 6.0 - m
    b_z = -((2.0 * r + rn) * (rn - r) + (2.0 * r + rp) * (r - rp)) / 6.0
    return m, b_r, b_z, np.sum(r * m, axis=1), around


def masses(r, z):
    """Integral of N_a r dA over each quad, 2 x 2 Gauss points."""
    total, g = np.zeros_like(r), 1.0 / np.sqrt(3.0)
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    for x in (-g, g):
        for y in (-g, g):
            n = 0.25 * (1 + corners[:, 0] * x) * (1 + corners[:, 1] * y)
            nx, ny = 0.25 * corners[:, 0] * (1 + corners[:, 1] * y), 0.25 * corners[:, 1] * (1 + corners[:, 0] * x)
            jacobian = (r @ nx) * (z @ ny) - (r @ ny) * (z @ nx)
            total += (r @ n * jacobian)[:, None] * n
    return total


def taylor(columns, rows, friction, leaves=False):
    x = np.array([(RADIUS * i / columns, LENGTH * j / rows) for j in range(rows + 1) for i in range(columns + 1)])
    w = columns + 1
    quads = np.array([(j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i)
                      for j in range(rows) for i in range(columns)])
    v = np.zeros_like(x)
    v[:, 1] = -SPEED
    axis = x[:, 0] == 0.0
    wall = x[:, 1] == 0.0
    share = DENSITY * masses(x[quads, 0], x[quads, 1])
    mass = np.bincount(quads.ravel(), share.ravel(), len(x))
    deviator, plastic = np.zeros((len(quads), 4)), np.zeros(len(quads))   # rr, zz, tt, rz
    first = geometry(x[quads, 0], x[quads, 1])[3]
    sound, time = np.sqrt((BULK + 4.0 / 3.0 * SHEAR) / DENSITY), 0.0
    gamma0 = np.array([1.0, -1.0, 1.0, -1.0])
    while time < END:
        r, z, u, s = x[quads, 0], x[quads, 1], v[quads, 0], v[quads, 1]
        m, b_r, b_z, volume, area = geometry(r, z)
        long = np.max(np.hypot(r - np.roll(r, 1, 1), z - np.roll(z, 1, 1)), axis=1)
        dt = 0.5 * np.min(area / long) / sound
        l_rr, l_zr = np.sum(b_r * u, 1) / volume, np.sum(b_r * s, 1) / volume
        l_rz, l_zz, l_tt = np.sum(b_z * u, 1) / volume, np.sum(b_z * s, 1) / volume, np.sum(m * u, 1) / volume
        trace, spin = l_rr + l_zz + l_tt, 0.5 * (l_zr - l_rz)
        # Hughes and Winget: the deviator turns with the body.
        half = 0.5 * dt * spin
        c, q = (1.0 - half ** 2) / (1.0 + half ** 2), 2.0 * half / (1.0 + half ** 2)
        d_rr, d_zz, d_tt, d_rz = deviator.T
        turned = np.stack([c * c * d_rr - 2.0 * c * q * d_rz + q * q * d_zz, q * q * d_rr + 2.0 * c * q * d_rz + c * c * d_zz,
                           d_tt, c * q * (d_rr - d_zz) + (c * c - q * q) * d_rz], axis=1)
        rate = np.stack([l_rr - trace / 3.0, l_zz - trace / 3.0, l_tt - trace / 3.0, 0.5 * (l_rz + l_zr)], axis=1)
        deviator = turned + 2.0 * SHEAR * dt * rate
        size = np.sqrt(1.5 * (np.sum(deviator[:, :3] ** 2, 1) + 2.0 * deviator[:, 3] ** 2))
        more = np.maximum(0.0, size - YIELD - HARDENING * plastic) / (3.0 * SHEAR + HARDENING)
        plastic += more
        deviator *= (1.0 - 3.0 * SHEAR * more / np.maximum(size, 1.0))[:, None]
        mean = BULK * np.log(volume / first)
        # Bulk viscosity, 1.5 and 0.06.
        h = np.sqrt(area)
        mean = mean - np.where(trace < 0.0, DENSITY * h * (2.25 * h * trace ** 2 - 0.06 * sound * trace), 0.0)
        rr, zz, tt, rz = deviator[:, 0] + mean, deviator[:, 1] + mean, deviator[:, 2] + mean, deviator[:, 3]
        # Viscous hourglass control, 0.1, on the plane pattern.
        plane_r = 0.5 * np.stack([z[:, 1] - z[:, 3], z[:, 2] - z[:, 0], z[:, 3] - z[:, 1], z[:, 0] - z[:, 2]], 1) / area[:, None]
        plane_z = 0.5 * np.stack([r[:, 3] - r[:, 1], r[:, 0] - r[:, 2], r[:, 1] - r[:, 3], r[:, 2] - r[:, 0]], 1) / area[:, None]
        gamma = gamma0 - np.sum(gamma0 * r, 1)[:, None] * plane_r - np.sum(gamma0 * z, 1)[:, None] * plane_z
        drag = (0.1 / 4.0 * DENSITY * sound * np.sqrt(area) * volume / area)[:, None] * gamma
        f_r = b_r * rr[:, None] + b_z * rz[:, None] + m * tt[:, None] + drag * np.sum(gamma * u, 1)[:, None]
        f_z = b_r * rz[:, None] + b_z * zz[:, None] + drag * np.sum(gamma * s, 1)[:, None]
        force = -np.stack([np.bincount(quads.ravel(), f.ravel(), len(x)) for f in (f_r, f_z)], 1)
        v += dt * force / mass[:, None]
        v[axis, 0] = 0.0
        # The wall takes what would go through it; friction takes of the rest at most mu times as much.
        touching = (x[:, 1] + dt * v[:, 1] <= 0.0) if leaves else wall
        push = np.where(touching, -v[:, 1] - x[:, 1] / dt, 0.0)
        v[:, 1] += push
        slip = np.abs(v[:, 0])
        v[:, 0] -= np.sign(v[:, 0]) * np.minimum(slip, friction * np.maximum(push, 0.0))
        x = x + dt * v
        time += dt
    top = x[-1, 1] - x[:, 1].min()
    return 1e3 * x[:, 0].max(), 1e3 * top, plastic.max(), 1e3 * x[:w, 0].max()


if __name__ == "__main__":
    print(*taylor(int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]), "free" in sys.argv))
