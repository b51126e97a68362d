# SPDX-License-Identifier: MIT
"""The collision scene with all contact types: balances, and the plastic strain."""
import numpy as np

from contact_types import TYPES
from meshes import trapezoid

MASS = 7850.0 * 0.020 * 0.005
SPEED = -80.0


def episodes(active):
    """Number of stretches of time in which the bodies touch."""
    on = active > 0
    return int(on[0]) + int(np.sum(on[1:] & ~on[:-1]))


def check_type(run, kind):
    name = TYPES[kind]
    # every step in rcforc: the trapezoid of the central difference is exact
    result = run.program(run.root / "input" / "collision" / "collision.k", f"ctype={kind}",
                         "p:dtforc=1.0e-7", name=f"type{kind}")
    energy = result.table("glstat")
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"{name}: kinetic energy at the start", energy["kinetic"][0], 0.5 * MASS * SPEED ** 2)
    run.check(f"{name}: hourglass / internal energy at the end",
              energy["hourglass"][-1] / energy["internal"][-1], 0.0)
    forces = result.table("rcforc")
    slave, master = forces.where(side="slave"), forces.where(side="master")
    peak = np.max(np.abs(slave["fy"]))
    for axis in ("fx", "fy"):
        run.check(f"{name}: (slave + master {axis}) / peak force",
                  (slave[axis] + master[axis]) / peak, 0.0)
    projectile = result.table("matsum").where(part=2)
    run.check(f"{name}: mass of the projectile", projectile["mass"], MASS)
    run.check(f"{name}: momentum change of the projectile", trapezoid(slave["fy"], slave["time"]),
              projectile["momentum_y"][-1] - projectile["momentum_y"][0])
    run.check(f"{name}: it rebounds: change of momentum / initial momentum",
              (projectile["momentum_y"][-1] - projectile["momentum_y"][0]) / (MASS * abs(SPEED)),
              1.0)
    state = int(np.argmin(np.abs(result.times - 0.7e-3)))
    plate = result.cells("part_id")[state].ravel() == 1
    strain = result.cells("plastic_strain")[state].ravel()
    run.check(f"{name}: largest plastic strain at 0.7 ms", strain[plate].max(), 0.24)
    run.check(f"{name}: plastic strain in the elastic projectile", strain[~plate].max(), 0.0)
    inside = result.points("contact_force")[..., :2].sum(axis=1)
    run.check(f"{name}: nodal contact forces add up to nothing / peak", inside / peak, 0.0)
    run.report(f"{name}: energy ratio furthest from 1",
               1.0 + max(energy["energy_ratio"] - 1.0, key=abs))
    run.report(f"{name}: mean velocity of the projectile at 1 ms",
               projectile["momentum_y"][-1] / MASS, "m/s")
    run.report(f"{name}: largest contact force", peak, "N/m")
    run.report(f"{name}: contact episodes", episodes(slave["n_active"]))


def check(run):
    for kind in TYPES:
        check_type(run, kind)
