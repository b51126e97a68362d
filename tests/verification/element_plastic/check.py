# SPDX-License-Identifier: MIT
"""J2 plasticity of one element: cyclic uniaxial strain and monotonic shear."""
import numpy as np

from meshes import Deck, grid, moduli

RHO, YOUNG, POISSON, YIELD = 1.0e5, 2.0e8, 0.3, 1.0e6
BULK, SHEAR, _ = moduli(YOUNG, POISSON)
TANGENT = 2.0e7
CYCLE = (0.0, 0.02, -0.02, 0.012)
LAWS = {"perfect": (0.0, 1.0), "isotropic": (TANGENT, 1.0), "kinematic": (TANGENT, 0.0),
        "mixed": (TANGENT, 0.5)}


def element(displacements, dof_nodes, tangent, beta, points=None, n_step=200):
    """One unit square; the curve's ordinates at times 0, 1, 2 ... are `displacements`."""
    deck = Deck("plastic element")
    deck.control(float(len(displacements) - 1), dt=1.0 / n_step)
    deck.part(points=points).plastic(RHO, YOUNG, POISSON, YIELD, tangent, beta)
    nodes = deck.mesh(*grid(1, 1))
    deck.curve(1, list(enumerate(map(float, displacements))))
    deck.fix(nodes, y=1)
    for k in range(4):
        if k in dof_nodes:
            deck.prescribe(nodes[k], 1, 2, 1)
        else:
            deck.fix([nodes[k]], x=1)
    return deck.output(plot=1.0 / n_step, glstat=1.0 / n_step)


def cyclic_uniaxial(strain, hardening, beta):
    """Closed form piece by piece of q = 3/2 s_xx and of the plastic strain.

    Elastic: dq = 2 G d(strain). Plastic: |q - back| = sigma_Y + beta H p,
    d(back) = (1 - beta) H dp sign, so dp = 2 G |d(strain)| / (3 G + H).
    """
    q = p = back = 0.0
    path = [(0.0, 0.0)]
    for step in np.diff(strain):
        sign = 1.0 if step >= 0.0 else -1.0
        limit = back + sign * (YIELD + beta * hardening * p)
        elastic = min(abs(step), max(0.0, sign * (limit - q)) / (2.0 * SHEAR))
        increment = 2.0 * SHEAR * (abs(step) - elastic) / (3.0 * SHEAR + hardening)
        p += increment
        back += sign * (1.0 - beta) * hardening * increment
        if increment > 0.0:
            q = back + sign * (YIELD + beta * hardening * p)
        else:
            q += 2.0 * SHEAR * step
        path.append((q, p))
    return np.array(path)


def check_cycle(run, name, points=None):
    tangent, beta = LAWS[name]
    hardening = YOUNG * tangent / (YOUNG - tangent)
    result = run.program(element(CYCLE, (1, 3), tangent, beta, points),
                         name=f"cycle_{name}_{points or 1}")
    name += ", full integration" if points else ""
    time = result.times
    strain = np.log1p(np.interp(time, np.arange(len(CYCLE)), CYCLE))
    q, p = cyclic_uniaxial(strain, hardening, beta).T
    stress = result.cells("stress")[:, 0, :]
    mean = BULK * strain
    expected = np.stack([mean + 2.0 * q / 3.0, mean - q / 3.0, mean - q / 3.0], -1)
    run.check(f"{name}: deviator over the cycle", stress[:, 0] - stress[:, 1], q)
    run.check(f"{name}: stress over the cycle", stress[:, :3], expected)
    run.check(f"{name}: plastic strain over the cycle",
              result.cells("plastic_strain")[:, 0].ravel(), p)
    check_reversal(run, name, time, stress, result.cells("plastic_strain")[:, 0].ravel(),
                   2.0 * YIELD + 2.0 * beta * hardening * np.interp(1.0, time, p), beta)
    dissipated = YIELD * p[-1]
    if tangent == 0.0:
        stored = 0.5 * BULK * strain[-1] ** 2 + q[-1] ** 2 / (6.0 * SHEAR)
        run.check(f"{name}: internal energy", result.table("glstat")["internal"][-1],
                  dissipated + stored)


def check_reversal(run, name, time, stress, plastic, elastic_range, beta):
    """Stress range from the first turning point to the first new plastic flow."""
    turn = int(np.argmin(np.abs(time - 1.0)))
    flow = turn + int(np.argmax(plastic[turn:] > plastic[turn] * (1.0 + 1e-9)))
    q = stress[:, 0] - stress[:, 1]
    one_step = abs(q[turn + 1] - q[turn])
    run.check(f"{name}: elastic range after reversal / yield stress",
              (q[turn] - q[flow - 1] + 0.5 * one_step) / YIELD, elastic_range / YIELD,
              tol=0.55 * one_step / YIELD)
    if beta == 0.0:
        run.true(f"{name}: reverse yield below the stress reached",
                 abs(q[flow - 1]) < q[turn] - one_step)


def check_shear(run, name):
    tangent, beta = LAWS[name]
    hardening = YOUNG * tangent / (YOUNG - tangent)
    deck = element((0.0, 0.04), (2, 3), tangent, beta)
    result = run.program(deck, name=f"shear_{name}")
    gamma = 0.04 * result.times
    limit = YIELD / np.sqrt(3.0)
    plastic = np.maximum(0.0, gamma - limit / SHEAR)
    tau = np.minimum(SHEAR * gamma, limit) + plastic * SHEAR * hardening / (hardening + 3.0 * SHEAR)
    stress = result.cells("stress")[:, 0, :]
    run.check(f"{name}: shear stress", stress[:, 3], tau)
    run.check(f"{name}: plastic strain in shear", result.cells("plastic_strain")[-1, 0].item(),
              plastic[-1] * np.sqrt(3.0) * SHEAR / (hardening + 3.0 * SHEAR))
    if tangent == 0.0:
        run.check(f"{name}: shear yield stress", stress[-1, 3], limit)


def check(run):
    for name in LAWS:
        check_cycle(run, name)
    check_shear(run, "perfect")
    check_shear(run, "isotropic")
    check_shear(run, "kinematic")
    check_cycle(run, "mixed", 4)
