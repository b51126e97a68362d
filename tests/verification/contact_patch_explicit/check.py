# SPDX-License-Identifier: MIT
"""Two blocks with matching meshes pressed together, damped to rest: types 1, 2, 3."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, PRESSURE = 1.0, 1.0, 1.0e-4
N = 4
TYPES = {1: "NTS", 2: "NTS-AR", 3: "two-pass NTS-AR"}


def pressed_blocks(kind, penalty, unit=0):
    """Two unit squares of N x N quads; penalty per contact node unless unit = 1."""
    end_time = 40.0
    deck = Deck(f"pressed blocks, type {kind}")
    deck.control(end_time, dt=0.01)
    for part in (1, 2):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
    upper = deck.mesh(*grid(N, N, origin=(0.0, 0.0)), part=1)
    lower = deck.mesh(*grid(N, N, origin=(0.0, -1.0)), part=2)
    deck.node_set(1, upper[:N + 1]).node_set(2, lower[-N - 1:][::-1])
    deck.fix(lower[:N + 1], y=1).fix([lower[N // 2], upper[-N // 2 - 1]], x=1)
    deck.curve(1, [(0.0, PRESSURE), (1.0e3, PRESSURE)])
    top = upper[-N - 1:][::-1]  # counter-clockwise: leftwards
    for a, b in zip(top[:-1], top[1:]):
        deck.add("*LOAD_SEGMENT", (1, 1.0, 0.0, a, b, b, b))
    deck.add("*DAMPING_GLOBAL", (0, 2.0 * np.pi / 4.0))  # critical for the first axial mode
    deck.contact(1, 2, kind, penalty, unit)
    return deck.output(plot=end_time / 4, glstat=end_time / 40, rcforc=end_time / 40)


def check_type(run, kind, penalty, tolerance):
    name = TYPES[kind]
    result = run.program(pressed_blocks(kind, penalty), name=f"type{kind}")
    last = result.table("contact")
    last = last.where(time=last["time"][-1])
    run.check(f"{name}: rows of slave nodes", len(last["node"]), N + 1, 0, "abs")
    run.check(f"{name}: competence lengths", last["length"],
              np.array([0.5, 1, 1, 1, 0.5]) / N, 1e-3, source="half of the neighbouring segments")
    run.check(f"{name}: arc length", last["s"], np.arange(N + 1) / N, 1e-3)
    run.check(f"{name}: pressure along the surface, inner nodes", last["pressure"][1:-1], PRESSURE,
              tolerance, source="the load")
    run.check(f"{name}: pressure is force over length", last["pressure"],
              last["fy"] / last["length"], 1e-12, source="definition")
    stress = result.cells("stress")[-1, :, 1].reshape(2, N, N)
    run.check(f"{name}: stress in both blocks, inner columns", stress[:, :, 1:-1], -PRESSURE,
              tolerance, source="the load, on both sides")
    if kind > 1:
        run.check(f"{name}: pressure at all nodes", last["pressure"], PRESSURE, tolerance,
                  source="matching meshes")
        run.check(f"{name}: stress in all elements", stress, -PRESSURE, tolerance)
    else:
        run.report(f"{name}: pressure at the end node / load", last["pressure"][0] / PRESSURE,
                   "unit weight: an end node is twice as stiff as its length asks")
    forces = result.table("rcforc")
    slave, master = forces.where(side="slave"), forces.where(side="master")
    run.check(f"{name}: resultant on the slave", slave["fy"][-1], PRESSURE, 1e-5,
              source="load times width")
    run.check(f"{name}: resultant on the master", master["fy"][-1], -PRESSURE, 1e-5)
    run.check(f"{name}: nodal forces add up to the resultant", last["fy"].sum(), slave["fy"][-1],
              1e-12)
    run.check(f"{name}: kinetic / internal energy at the end", result.table("glstat")["kinetic"][-1]
              / result.table("glstat")["internal"][-1], 0.0, 1e-9, "abs", "at rest")
    gap = {1: PRESSURE / N / penalty, 2: PRESSURE / N / penalty, 3: PRESSURE / N / penalty / 2.0}
    run.check(f"{name}: penetration of inner nodes", last["gap"][1:-1], -gap[kind],
              max(tolerance, 1e-4), source="pressure / eps_hat, half of it in two passes")
    return result


def check(run):
    check_type(run, 1, 50.0, 0.02)
    plain = check_type(run, 2, 1.0, 1e-5)
    check_type(run, 3, 1.0, 1e-5)
    distributed = run.program(pressed_blocks(2, float(N), unit=1), name="distributed")
    run.check("NTS-AR: PUNIT 1 with eps/l_sl gives the same force",
              distributed.table("rcforc")["fy"], plain.table("rcforc")["fy"], 1e-12,
              source="eps_hat = eps/l_sl")
