# SPDX-License-Identifier: MIT
"""Second, independent solution of the symmetric plate: a small explicit finite element program.

  second_opinion.py NX NY LAW OUT.csv [--yield 1e7] [--steps-per-ms N]

Total-Lagrangian 8-node quads with 2 x 2 Gauss points, lumped mass (diagonal scaling), central
differences, plane strain. LAW is one of
  svk      St. Venant-Kirchhoff (linear between Green strain and second Piola-Kirchhoff stress);
  hencky   logarithmic elastic strain and Kirchhoff stress, J2 by exponential return mapping;
  neohooke Simo's compressible neo-Hooke law, tau = G dev(J^-2/3 b) + K/2 (J^2 - 1) I;
  jaumann  Jaumann rate of the Cauchy deviator, volumetric Cauchy stress K ln J, J2 radial return.
Needs numpy and numba.
"""
import argparse

import numpy as np
from numba import njit

LENGTH, HEIGHT, LOAD = 8.0, 1.0, 80.0e3
YOUNG, POISSON, DENSITY = 1.0e9, 0.3, 1000.0
ELASTIC_FROM = 7.0
SHEAR = YOUNG / (2 * (1 + POISSON))
BULK = YOUNG / (3 * (1 - 2 * POISSON))
LAWS = {"svk": 0, "hencky": 1, "jaumann": 2, "neohooke": 3}
CORNER = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)], float)


def shapes(xi, eta):
    """Values (8) and parametric gradients (8,2) of the serendipity functions."""
    value, slope = np.zeros(8), np.zeros((8, 2))
    for n, (a, b) in enumerate(CORNER):
        if a and b:
            value[n] = (1 + a * xi) * (1 + b * eta) * (a * xi + b * eta - 1) / 4
            slope[n] = (a * (1 + b * eta) * (2 * a * xi + b * eta) / 4,
                        b * (1 + a * xi) * (2 * b * eta + a * xi) / 4)
        elif a == 0:
            value[n] = (1 - xi**2) * (1 + b * eta) / 2
            slope[n] = (-xi * (1 + b * eta), b * (1 - xi**2) / 2)
        else:
            value[n] = (1 + a * xi) * (1 - eta**2) / 2
            slope[n] = (a * (1 - eta**2) / 2, -eta * (1 + a * xi))
    return value, slope


def build(nx, ny):
    """Nodes of rectangles, connectivity, lumped mass, nodal load, boundary sets."""
    dx, dy = LENGTH / nx, HEIGHT / ny
    ids, table = {}, np.zeros((nx * ny, 8), np.int64)
    for i in range(nx):
        for j in range(ny):
            for n, (a, b) in enumerate(CORNER):
                table[i * ny + j, n] = ids.setdefault((2 * i + 1 + int(a), 2 * j + 1 + int(b)), len(ids))
    third, weight = np.sqrt(0.6), (5 / 9, 8 / 9, 5 / 9)
    diagonal = sum(wx * wy * shapes(x, y)[0] ** 2 for x, wx in zip((-third, 0, third), weight)
                   for y, wy in zip((-third, 0, third), weight))
    mass, load = np.zeros(len(ids)), np.zeros(len(ids))
    for row in table:
        mass[row] += DENSITY * dx * dy * diagonal / diagonal.sum()
    for i in range(nx):
        for a, w in ((0, 1 / 6), (1, 2 / 3), (2, 1 / 6)):
            load[ids[(2 * i + a, 2 * ny)]] += w * LOAD * dx
    left = np.array([n for (i, j), n in ids.items() if i == 0])
    return ids, table, mass, load, left, ids[(2 * nx, ny)], ids[(0, ny)]


@njit(cache=True, fastmath=False)
def stress_svk(f):
    lam = BULK - 2 * SHEAR / 3
    e11 = (f[0, 0]**2 + f[1, 0]**2 - 1) / 2
    e22 = (f[0, 1]**2 + f[1, 1]**2 - 1) / 2
    e12 = (f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1]) / 2
    s11 = lam * (e11 + e22) + 2 * SHEAR * e11
    s22 = lam * (e11 + e22) + 2 * SHEAR * e22
    s12 = 2 * SHEAR * e12
    p = np.empty((2, 2))
    for i in range(2):
        p[i, 0] = f[i, 0] * s11 + f[i, 1] * s12
        p[i, 1] = f[i, 0] * s12 + f[i, 1] * s22
    return p


@njit(cache=True)
def to_nominal(f, t11, t22, t12):
    """First Piola-Kirchhoff stress P = tau F^-T."""
    j = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
    p = np.empty((2, 2))
    p[0, 0] = (t11 * f[1, 1] - t12 * f[0, 1]) / j
    p[0, 1] = (-t11 * f[1, 0] + t12 * f[0, 0]) / j
    p[1, 0] = (t12 * f[1, 1] - t22 * f[0, 1]) / j
    p[1, 1] = (-t12 * f[1, 0] + t22 * f[0, 0]) / j
    return p


@njit(cache=True)
def stress_neohooke(f):
    j = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
    scale = j ** (-2 / 3)
    b11 = scale * (f[0, 0]**2 + f[0, 1]**2)
    b22 = scale * (f[1, 0]**2 + f[1, 1]**2)
    b12 = scale * (f[0, 0] * f[1, 0] + f[0, 1] * f[1, 1])
    mean = (b11 + b22 + scale) / 3
    pressure = BULK / 2 * (j * j - 1)
    return to_nominal(f, SHEAR * (b11 - mean) + pressure, SHEAR * (b22 - mean) + pressure, SHEAR * b12)


@njit(cache=True)
def stress_hencky(f, state, limit):
    """state = inverse plastic Cauchy-Green (11, 22, 12, 33) minus identity, plastic strain."""
    c11, c22, c12, c33 = 1 + state[0], 1 + state[1], state[2], 1 + state[3]
    a11 = f[0, 0] * c11 + f[0, 1] * c12
    a12 = f[0, 0] * c12 + f[0, 1] * c22
    a21 = f[1, 0] * c11 + f[1, 1] * c12
    a22 = f[1, 0] * c12 + f[1, 1] * c22
    b11 = a11 * f[0, 0] + a12 * f[0, 1]
    b22 = a21 * f[1, 0] + a22 * f[1, 1]
    b12 = a11 * f[1, 0] + a12 * f[1, 1]
    half, radius = (b11 + b22) / 2, np.hypot((b11 - b22) / 2, b12)
    angle = 0.5 * np.arctan2(2 * b12, b11 - b22)
    co, si = np.cos(angle), np.sin(angle)
    e1, e2, e3 = 0.5 * np.log(half + radius), 0.5 * np.log(half - radius), 0.5 * np.log(c33)
    trace = e1 + e2 + e3
    d1, d2, d3 = e1 - trace / 3, e2 - trace / 3, e3 - trace / 3
    mises = 2 * SHEAR * np.sqrt(1.5 * (d1 * d1 + d2 * d2 + d3 * d3))
    if mises > limit:
        scale = limit / mises
        state[4] += (mises - limit) / (3 * SHEAR)
        d1, d2, d3 = d1 * scale, d2 * scale, d3 * scale
        n1, n2 = np.exp(2 * (d1 + trace / 3)), np.exp(2 * (d2 + trace / 3))
        b11, b22 = n1 * co * co + n2 * si * si, n1 * si * si + n2 * co * co
        b12 = (n1 - n2) * co * si
        j = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
        g11, g12, g21, g22 = f[1, 1] / j, -f[0, 1] / j, -f[1, 0] / j, f[0, 0] / j
        a11, a12 = g11 * b11 + g12 * b12, g11 * b12 + g12 * b22
        a21, a22 = g21 * b11 + g22 * b12, g21 * b12 + g22 * b22
        state[0] = a11 * g11 + a12 * g12 - 1
        state[1] = a21 * g21 + a22 * g22 - 1
        state[2] = a11 * g21 + a12 * g22
        state[3] = np.exp(2 * (d3 + trace / 3)) - 1
    t1, t2 = BULK * trace + 2 * SHEAR * d1, BULK * trace + 2 * SHEAR * d2
    return to_nominal(f, t1 * co * co + t2 * si * si, t1 * si * si + t2 * co * co, (t1 - t2) * co * si)


@njit(cache=True)
def stress_jaumann(f, old, state, limit):
    """state = Cauchy deviator (11, 22, 12, 33), plastic strain; old = previous F."""
    m = 0.5 * (f + old)
    jm = m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
    d = f - old
    l11 = (d[0, 0] * m[1, 1] - d[0, 1] * m[1, 0]) / jm
    l12 = (-d[0, 0] * m[0, 1] + d[0, 1] * m[0, 0]) / jm
    l21 = (d[1, 0] * m[1, 1] - d[1, 1] * m[1, 0]) / jm
    l22 = (-d[1, 0] * m[0, 1] + d[1, 1] * m[0, 0]) / jm
    spin = 0.5 * (l21 - l12)                      # Hughes-Winget: rotation by 2 atan(spin/2)
    den = 1 + 0.25 * spin * spin
    co, si = (1 - 0.25 * spin * spin) / den, spin / den
    s11 = co * co * state[0] - 2 * co * si * state[2] + si * si * state[1]
    s22 = si * si * state[0] + 2 * co * si * state[2] + co * co * state[1]
    s12 = co * si * (state[0] - state[1]) + (co * co - si * si) * state[2]
    mean = (l11 + l22) / 3
    s11 += 2 * SHEAR * (l11 - mean)
    s22 += 2 * SHEAR * (l22 - mean)
    s12 += SHEAR * (l12 + l21)
    s33 = state[3] - 2 * SHEAR * mean
    mises = np.sqrt(1.5 * (s11 * s11 + s22 * s22 + s33 * s33 + 2 * s12 * s12))
    if mises > limit:
        state[4] += (mises - limit) / (3 * SHEAR)
        scale = limit / mises
        s11, s22, s12, s33 = s11 * scale, s22 * scale, s12 * scale, s33 * scale
    state[0], state[1], state[2], state[3] = s11, s22, s12, s33
    j = f[0, 0] * f[1, 1] - f[0, 1] * f[1, 0]
    pressure = BULK * np.log(j)
    return to_nominal(f, j * (s11 + pressure), j * (s22 + pressure), j * s12)


@njit(cache=True)
def nominal_stress(law, f, old, state, limit):
    if law == 0:
        return stress_svk(f)
    if law == 1:
        return stress_hencky(f, state, limit)
    if law == 2:
        return stress_jaumann(f, old, state, limit)
    return stress_neohooke(f)


@njit(cache=True)
def subtract_internal(law, table, slope, area, limit, u, state, last, nominal, force):
    """Subtract the internal nodal forces; return the stress work of this step."""
    work = 0.0
    f = np.empty((2, 2))
    for e in range(table.shape[0]):
        for q in range(4):
            f[0, 0], f[0, 1], f[1, 0], f[1, 1] = 1.0, 0.0, 0.0, 1.0
            for a in range(8):
                n = table[e, a]
                for i in range(2):
                    f[i, 0] += u[n, i] * slope[q, a, 0]
                    f[i, 1] += u[n, i] * slope[q, a, 1]
            p = nominal_stress(law, f, last[e, q], state[e, q], limit[e])
            for i in range(2):
                for k in range(2):
                    mean = 0.5 * (p[i, k] + nominal[e, q, i, k])
                    work += mean * (f[i, k] - last[e, q, i, k]) * area
                    nominal[e, q, i, k] = p[i, k]
                    last[e, q, i, k] = f[i, k]
            for a in range(8):
                n = table[e, a]
                for i in range(2):
                    force[n, i] -= (p[i, 0] * slope[q, a, 0] + p[i, 1] * slope[q, a, 1]) * area
    return work


@njit(cache=True)
def kinetic_energy(mass, v, force, dt, step):
    """Kinetic energy at the step, with the half-step velocities carried to it."""
    total = 0.0
    if step > 0:
        for n in range(mass.size):
            for i in range(2):
                total += 0.5 * mass[n] * (v[n, i] + 0.5 * dt * force[n, i] / mass[n]) ** 2
    return total


@njit(cache=True)
def march(law, table, slope, area, mass, load, left, pin, watch, limit, dt, rows, every):
    """History (rows + 1, 6): time, u_y, kinetic, internal, external work, plastic strain."""
    nodes, count = mass.size, table.shape[0]
    u, v, force = np.zeros((nodes, 2)), np.zeros((nodes, 2)), np.zeros((nodes, 2))
    state, last = np.zeros((count, 4, 5)), np.zeros((count, 4, 2, 2))
    nominal = np.zeros((count, 4, 2, 2))
    last[:, :, 0, 0] = 1.0
    last[:, :, 1, 1] = 1.0
    history = np.zeros((rows + 1, 6))
    internal, external = 0.0, 0.0
    for step in range(rows * every + 1):
        force[:, 0] = 0.0
        force[:, 1] = load
        internal += subtract_internal(law, table, slope, area, limit, u, state, last, nominal, force)
        for n in left:
            force[n, 0] = 0.0
        force[pin, 0] = force[pin, 1] = 0.0
        if step % every == 0:
            row = step // every
            history[row, 0], history[row, 1] = step * dt, u[watch, 1]
            history[row, 2] = kinetic_energy(mass, v, force, dt, step)
            history[row, 3], history[row, 4] = internal, external
            history[row, 5] = state[:, :, 4].max() if law in (1, 2) else 0.0
        start = 0.5 if step == 0 else 1.0
        for n in range(nodes):
            for i in range(2):
                v[n, i] += start * dt * force[n, i] / mass[n]
                u[n, i] += dt * v[n, i]
            external += load[n] * dt * v[n, 1]
    return history


def report(args, mass, load, history, every):
    peak = history[:, 1].argmax()
    around = history[peak - 1:peak + 2]
    fit = np.polyfit(around[:, 0] - around[1, 0], around[:, 1], 2)
    shift = -fit[1] / (2 * fit[0])
    error = abs(history[:, 2] + history[:, 3] - history[:, 4]).max() / history[:, 4].max()
    print(f"{args.nx}x{args.ny} {args.law} yield {args.limit:.3g} dt {1e-3 / every:.3g}: "
          f"peak {np.polyval(fit, shift):.5f} m at {around[1, 0] + shift:.5f} s, "
          f"end {history[-1, 1]:.5f}, mass {mass.sum():.6g}, load {load.sum():.6g}, "
          f"energy error {error:.2e}, plastic strain {history[-1, 5]:.4f}")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("nx", type=int)
    parser.add_argument("ny", type=int)
    parser.add_argument("law", choices=sorted(LAWS))
    parser.add_argument("out")
    parser.add_argument("--yield", dest="limit", type=float, default=1.0e30)
    parser.add_argument("--steps-per-ms", type=int, default=0)
    parser.add_argument("--end", type=float, default=0.6)
    args = parser.parse_args()
    if args.law in ("svk", "neohooke") and args.limit < 1e29:
        parser.error(args.law + " is elastic only")
    ids, table, mass, load, left, pin, watch = build(args.nx, args.ny)
    dx, dy = LENGTH / args.nx, HEIGHT / args.ny
    gauss = 1 / np.sqrt(3)
    slope = np.array([shapes(x, y)[1] * (2 / dx, 2 / dy)
                      for x in (-gauss, gauss) for y in (-gauss, gauss)])
    limit = np.full(args.nx * args.ny, args.limit)
    limit[round(args.nx * ELASTIC_FROM / LENGTH) * args.ny:] = 1.0e30
    speed = np.sqrt((BULK + 4 * SHEAR / 3) / DENSITY)
    every = args.steps_per_ms or int(np.ceil(1e-3 / (0.18 * min(dx, dy) / speed)))
    history = march(LAWS[args.law], table, slope, dx * dy / 4, mass, load, left, pin, watch, limit,
                    1e-3 / every, round(args.end / 1e-3), every)
    with open(args.out, "w", encoding="ascii") as out:
        out.write("time,uy\n")
        out.writelines(f"{row[0]:.4f},{row[1]:.6e}\n" for row in history)
    report(args, mass, load, history, every)


if __name__ == "__main__":
    main()
