# SPDX-License-Identifier: MIT
"""Piecewise linear hardening and its rate effects, one element."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, YOUNG, POISSON, YIELD, TANGENT = 1.0e5, 2.0e8, 0.3, 1.0e6, 2.0e7
BULK, SHEAR, _ = moduli(YOUNG, POISSON)
MODULUS = YOUNG * TANGENT / (YOUNG - TANGENT)
#: plastic strain and yield stress: rising, rising steeper, level, then on with the last slope
STRAINS = np.array([0.0, 0.003, 0.006, 0.011, 0.02])
STRESSES = np.array([1.0e6, 1.06e6, 1.3e6, 1.3e6, 1.42e6])
CYCLE = (0.0, 0.025, 0.012, -0.02, 0.03)
#: displacements at times 0, 1, 2 ... of a pull that gets faster; strain rates about 1e-4 to 2e-2
PULL = (0.0, 0.02, 0.0202, 0.022, 0.03, 0.05, 0.052)
RATES = (1.0e-3, 5.0e-3, 1.5e-2)
ROWS = ((1.0e6, 1.2e6), (1.1e6, 1.5e6), (1.5e6, 1.6e6))


def material(deck, sigy=0.0, etan=0.0, rate=(0.0, 0.0), curve=0, factor=0, points=None, **_):
    deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY",
             (1, RHO, YOUNG, POISSON, sigy, etan, 1.0e21, 0.0),
             (*rate, curve, factor, 0.0))
    if points is not None:
        filled = [list(column) + [0.0] * (8 - len(column)) for column in points]
        deck.lines.extend(",".join(repr(float(value)) for value in row) for row in filled)
    return deck


def element(displacements, moved, law, nip=None, n_step=200, implicit=False, every=1):
    """One unit square; `moved` nodes follow the curve of `displacements` at times 0, 1, 2 ... along x. Of an
    implicit run the square is a row of four elements, whose inner nodes are free along x. Every so many steps are stored."""
    deck = Deck("piecewise linear element")
    end = float(len(displacements) - 1)
    if implicit:
        deck.add("*CONTROL_TERMINATION", (end,))
        deck.add("*CONTROL_IMPLICIT_GENERAL", (1, 1.0 / n_step))
    else:
        deck.control(end, dt=1.0 / n_step)
    deck.part(points=nip)
    if law is None:
        deck.plastic(RHO, YOUNG, POISSON, YIELD, TANGENT, 1.0)
    else:
        material(deck, **law)
        for number, points in law.get("curves", {}).items():
            deck.curve(number, points)
        if "table" in law:
            deck.add("*DEFINE_TABLE", (500,), *[(rate,) for rate in RATES])
            for number, row in enumerate(ROWS):
                deck.curve(501 + number, [(0.0, row[0]), (0.01 * (number + 1), row[1])])
    n_x = 4 if implicit else 1
    nodes = deck.mesh(*grid(n_x, 1))
    deck.curve(1, list(enumerate(map(float, displacements))))
    deck.fix(nodes, y=1)
    for k, node in enumerate(nodes[[0, n_x, n_x + 1, 2 * n_x + 1]]):
        if k in moved:
            deck.prescribe(node, 1, 2, 1)
        else:
            deck.fix([node], x=1)
    return deck.output(plot=every / n_step)


def yield_stress(plastic, strains=STRAINS, stresses=STRESSES):
    """The curve, continued by its last slope."""
    slope = (stresses[-1] - stresses[-2]) / (strains[-1] - strains[-2])
    return np.interp(plastic, strains, stresses) + slope * np.maximum(0.0, plastic - strains[-1])


def leg(start, plastic, strain):
    """Signed stress q and plastic strain after `strain` from (start, plastic) in one direction: with
    the elastic stress t = |.| the plastic strain solves sigma(p) + 3G p = t + 3G p0."""
    sign = np.where(strain >= 0.0, 1.0, -1.0)
    elastic = sign * start + 2.0 * SHEAR * np.abs(strain)
    far = np.append(STRAINS, STRAINS[-1] + 1.0)
    goal = elastic + 3.0 * SHEAR * plastic
    found = np.maximum(plastic, np.interp(goal, yield_stress(far) + 3.0 * SHEAR * far, far))
    return sign * (elastic - 3.0 * SHEAR * (found - plastic)), found


def closed_cycle(time, displacements):
    strain = np.log1p(np.interp(time, np.arange(len(displacements)), displacements))
    corners = np.log1p(np.array(displacements))
    q, p = np.zeros_like(time), np.zeros_like(time)
    start = plastic = 0.0
    for k in range(len(displacements) - 1):
        here = (time >= k - 1e-9) & (time <= k + 1 + 1e-9)
        q[here], p[here] = leg(start, plastic, strain[here] - corners[k])
        end_q, end_p = leg(start, plastic, np.array([corners[k + 1] - corners[k]]))
        start, plastic = end_q[0], end_p[0]
    return strain, q, p


def check_cycle(run, name, law, nip=None, implicit=False):
    result = run.program(element(CYCLE, (1, 3), law, nip, 200, implicit, 4),
                         name=f"cycle_{name}_{nip or 1}{'_implicit' if implicit else ''}")
    name += ", 2x2 points" if nip else ""
    name += ", implicit" if implicit else ""
    strain, q, p = closed_cycle(result.times, CYCLE)
    stress = result.cells("stress")[:, 1 if implicit else 0, :]
    run.check(f"{name}: deviator over the cycle", stress[:, 0] - stress[:, 1], q)
    run.check(f"{name}: mean stress over the cycle", stress[:, :3].sum(axis=1) / 3.0, BULK * strain)
    run.check(f"{name}: plastic strain over the cycle",
              result.cells("plastic_strain")[:, 1 if implicit else 0].ravel(), p)
    run.true(f"{name}: every segment was walked", p[-1] > STRAINS[-1])
    return result


def check_shear(run):
    result = run.program(element((0.0, 0.08), (2, 3), {"curve": 7, "curves": {
        7: list(zip(STRAINS, STRESSES))}}, n_step=400), name="shear")
    gamma = 0.08 * result.times
    far = np.append(STRAINS, 1.0)
    p = np.maximum(0.0, np.interp(np.sqrt(3.0) * SHEAR * gamma, yield_stress(far) + 3.0 * SHEAR * far, far))
    tau = SHEAR * (gamma - np.sqrt(3.0) * p)
    run.check("shear stress through the segments", result.cells("stress")[:, 0, 3], tau)
    run.check("plastic strain in shear", result.cells("plastic_strain")[:, 0].ravel(), p)


def check_bilinear(run):
    """The law of one line is that of MAT_PLASTIC_KINEMATIC."""
    known = run.program(element(CYCLE, (1, 3), None, every=4), name="bilinear_003")
    sheared = run.program(element((0.0, 0.04, -0.02), (2, 3), None, 4, every=4), name="bilinear_shear_003")
    forms = {"SIGY, ETAN": {"sigy": YIELD, "etan": TANGENT},
             "two points": {"points": ((0.0, 0.5), (YIELD, YIELD + 0.5 * MODULUS))},
             "five points": {"points": ([0.0, 0.004, 0.01, 0.02, 0.03],
                                        [YIELD + MODULUS * p for p in (0.0, 0.004, 0.01, 0.02, 0.03)])},
             "curve": {"curve": 7, "curves": {7: [(p, YIELD + MODULUS * p) for p in (0.0, 0.001, 0.013)]}}}
    for name, law in forms.items():
        for other, moved, path, nip in ((known, (1, 3), CYCLE, None),
                                        (sheared, (2, 3), (0.0, 0.04, -0.02), 4)):
            kind = "uniaxial strain" if nip is None else "shear, 2x2 points"
            job = f"bilinear_{kind.split()[0].strip(',')}_{name.split()[0].strip(',')}"
            found = run.program(element(path, moved, law, nip, every=4), name=job)
            for field in ("stress", "plastic_strain"):
                run.check(f"{field} of {name} beside MAT_PLASTIC_KINEMATIC, {kind}",
                          found.cells(field), other.cells(field))


def check_rate(run, name, law, expected, moved=(1, 3), n_step=100):
    """While plastic strain grows, the von Mises stress is expected(rate, p), rate = sqrt(D:D) of the step."""
    result = run.program(element(PULL, moved, law, n_step=n_step), name=name.replace(" ", "_"))
    u = np.interp(np.arange(len(result.times)) / n_step, np.arange(len(PULL)), PULL)
    speed = np.abs(np.diff(u)) * n_step
    rate = speed / np.sqrt(2.0) if 2 in moved else speed / (1.0 + 0.5 * (u[1:] + u[:-1]))
    xx, yy, zz, xy = result.cells("stress")[:, 0, :4].T
    mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy ** 2)
    p = result.cells("plastic_strain")[:, 0].ravel()
    flows = np.diff(p) > 1e-9
    run.true(f"{name}: flow in most steps", flows.sum() > 0.5 * len(flows))
    run.check(f"{name}: yield stress over rates {rate[flows].min():.2g} to {rate[flows].max():.2g}",
              mises[1:][flows], expected(rate[flows], p[1:][flows]))


def by_table(rate, p):
    """Between the rows, and outside them the outermost."""
    rows = [yield_stress(p, np.array([0.0, 0.01 * (k + 1)]), np.array(row)) for k, row in enumerate(ROWS)]
    low = np.clip(np.searchsorted(RATES, rate) - 1, 0, len(RATES) - 2)
    bounds = np.array(RATES)
    share = np.clip((rate - bounds[low]) / (bounds[low + 1] - bounds[low]), 0.0, 1.0)
    rows = np.array(rows)
    index = np.arange(len(rate))
    return (1.0 - share) * rows[low, index] + share * rows[low + 1, index]


def check(run):
    law = {"curve": 7, "curves": {7: list(zip(STRAINS, STRESSES))}}
    check_cycle(run, "curve", law)
    check_cycle(run, "points", {"points": (STRAINS, STRESSES)})
    check_cycle(run, "curve", law, 4)
    check_cycle(run, "curve", law, 4, implicit=True)
    check_shear(run)
    check_bilinear(run)

    def cowper(rate, p):
        return yield_stress(p) * (1.0 + (rate / 0.02) ** (1.0 / 3.0))

    points = {"points": (STRAINS, STRESSES)}
    check_rate(run, "Cowper-Symonds", {**points, "rate": (0.02, 3.0)}, cowper)
    check_rate(run, "Cowper-Symonds in shear", {**points, "rate": (0.02, 3.0)}, cowper, (2, 3))
    factor = ([0.0, 4.0e-3, 1.5e-2], [1.0, 1.3, 1.5])
    check_rate(run, "factor by curve", {**points, "factor": 8, "curves": {8: list(zip(*factor))}},
               lambda rate, p: yield_stress(p) * np.interp(rate, *factor))
    check_rate(run, "table", {"curve": 500, "table": True}, by_table)
