# SPDX-License-Identifier: MIT
"""One element along random motions beside an independent driver in Python (README.md)."""
import functools
import json
import subprocess

import numpy as np

import cases
import driver
import eos
from meshes import Deck

N_STEP, SEEDS = 60, (1, 2, 3)
REFUSALS = ("this material is not available in slideline", "equations of state are not available in slideline")


def deck_of(case, histories, dt, is_axisymmetric):
    """A part of one element for each motion; every corner on curves with a point at each step."""
    deck = Deck(f"{case.name}, {'round' if is_axisymmetric else 'plane'}")
    deck.control(case.end, dt=dt)
    deck.add("*SECTION_SHELL", (1, 15 if is_axisymmetric else 13), (1.0,))
    case.cards(deck)
    times = dt * np.arange(N_STEP + 1)
    for part, history in enumerate(histories, 1):
        deck.add("*PART", "element", (part, 1, 1, 1 if case.has_eos else 0))
        nodes = deck.mesh(history[0], [(0, 1, 2, 3)], part)
        for k, (corner, axis) in enumerate(np.ndindex(4, 2)):
            number = 10000 + 10 * part + k
            deck.curve(number, list(zip(times, history[:, corner, axis] - history[0, corner, axis])))
            deck.prescribe(nodes[corner], axis + 1, 2, number)
    return deck.output(plot=dt, glstat=dt, matsum=dt)


def is_refused(run, deck):
    """Whether `slideline check` does not know the law or its equation of state yet; no other mistake counts."""
    path = run.work / "question.k"
    path.write_text(deck.text())
    answer = subprocess.run([str(run.program_path), "check", str(path), "--json"], capture_output=True, text=True,
                            timeout=60)
    return any(finding["message"] in REFUSALS for finding in json.loads(answer.stdout)["findings"])


def of_program(result, part, fields):
    """Histories of one part; the deviator apart from the pressure, so that each has its own scale."""
    tensor, pressure = result.cells("stress")[:, part - 1, :4], result.cells("pressure")[:, part - 1].ravel()
    found = {"pressure": pressure, "deviator": tensor + pressure[:, None] * np.array([1.0, 1.0, 1.0, 0.0]),
             "internal energy": result.table("matsum").where(part=part)["internal"]}
    return found | {field: result.cells(field)[:, part - 1].ravel() for field in fields}


def of_driver(expected, size, fields):
    """The same of the driver, whose energy is per initial volume."""
    mean = np.trace(expected["stress"], axis1=1, axis2=2) / 3.0
    deviator = expected["stress"] - mean[:, None, None] * np.eye(3)
    found = {"pressure": -mean, "deviator": deviator[:, [0, 1, 2, 0], [0, 1, 2, 1]],
             "internal energy": size * expected["energy"]}
    return found | {field: expected[field] for field in fields}


def scale_of(wanted, quantity):
    """The largest value; a deviator that is round-off of the mean is judged beside the pressure, other zeros must be
    zeros."""
    largest, pressure = (np.max(np.abs(wanted[name])) for name in (quantity, "pressure"))
    if quantity == "deviator" and largest < 1.0e-13 * pressure:
        return pressure
    return largest or 1.0


@functools.cache
def motion(path, seed, is_axisymmetric, dt, options):
    """Corner positions and the steps between them; most laws share them."""
    history = path(seed, N_STEP, is_axisymmetric, **dict(options))
    return history, list(driver.steps(history, dt, is_axisymmetric))


def go_through(run, case, seeds, is_axisymmetric):
    """All seeds in one run; whether a motion reaches what is to be compared."""
    dt, shape = case.end / N_STEP, "round" if is_axisymmetric else "plane"
    motions = [motion(case.path, seed, is_axisymmetric, dt, tuple(case.motion.items())) for seed in seeds]
    histories = [history for history, _ in motions]
    result = run.program(deck_of(case, histories, dt, is_axisymmetric),
                         name=f"{case.name} {shape} {seeds[0]}".replace(" ", "_").replace(",", ""))
    pairs, reached = [], False
    for part, (history, steps) in enumerate(motions, 1):
        expected = driver.follow(case.law(), steps)
        reached = case.reached(expected) or reached
        pairs.append((of_program(result, part, case.fields),
                      of_driver(expected, driver.volume(history[0], is_axisymmetric), case.fields)))
        if case.name.endswith("failure strain"):
            # An element that has left the mesh has taken its energy along.
            stays = result.cells("eroded")[:, part - 1].ravel() < 0.5
            for values in pairs[-1]:
                values["internal energy"] = np.where(stays, values["internal energy"], 0.0)
    for quantity in pairs[0][0]:
        scales = [scale_of(wanted, quantity) for _, wanted in pairs]
        run.check(f"{case.name}, {shape}: {quantity}",
                  [found[quantity] / scale for (found, _), scale in zip(pairs, scales)],
                  [wanted[quantity] / scale for (_, wanted), scale in zip(pairs, scales)])
    return reached


def known(run):
    """Today's laws and, of the new ones, those that the program no longer refuses."""
    refused = []
    for case in cases.NEW:
        history = case.path(SEEDS[0], N_STEP, False, **case.motion)
        if is_refused(run, deck_of(case, [history], case.end / N_STEP, False)):
            refused.append(case)
    run.report("laws that the program refuses by name", len(refused), ", ".join(case.name for case in refused))
    return cases.EXISTING + [case for case in cases.NEW if case not in refused]


def check_rubber(run, name, law):
    """Kirchhoff's stress of the driver is dW/dF F^T, here by differences."""
    gradient = np.array([[1.2, 0.3, 0.0], [-0.1, 0.9, 0.0], [0.0, 0.0, 1.1]])
    energy = np.zeros((3, 3))
    for i, j in np.ndindex(3, 3):
        change = np.zeros((3, 3))
        change[i, j] = 1.0e-5
        ends = [law.energy(f @ f.T, np.linalg.det(f)) for f in (gradient + change, gradient - change)]
        energy[i, j] = (ends[0] - ends[1]) / 2.0e-5
    ratio = np.linalg.det(gradient)
    run.check(f"driver, {name}: stress is the derivative of the energy",
              ratio * law.stress(gradient @ gradient.T, ratio), energy @ gradient.T)
    run.check(f"driver, {name}: no stress at rest",
              law.stress(np.eye(3), 1.0) / law.stress(np.eye(3), 0.9)[0, 0], 0.0)


def check_eos(run):
    """Closed forms of the driver's equations of state."""
    metal = eos.Gruneisen(8930.0, 3940.0, 1.49, 0.0, 0.0, 2.0, 0.47)
    v = np.linspace(0.7, 0.99, 10)
    mu = 1.0 / v - 1.0
    wanted = 8930.0 * 3940.0 ** 2 * mu * (1.0 + mu) / (1.0 - 0.49 * mu) ** 2
    found = [a + b * 0.5 * p * (1.0 - x) for x, p in zip(v, wanted) for a, b in [metal.parts(x)]]
    run.check("driver, Gruneisen: pressure with the energy of the Hugoniot", found, wanted)
    gas, errors = eos.LinearPolynomial((0.0, 0.0, 0.0, 0.0, 0.4, 0.4, 0.0)), []
    for n in (50, 100):
        energy, v = 2.5e5, np.linspace(1.0, 0.5, n + 1)
        pressure = 1.0e5
        for before, after in zip(v[:-1], v[1:]):
            pressure, energy = eos.pressure_step(gas, pressure, energy, before, after, 0.0)
        errors.append(abs(pressure / (1.0e5 * 0.5 ** -1.4) - 1.0))
    run.check("driver, polynomial: adiabatic compression of a gas", errors[-1], 0.0)
    run.check("driver, sound speed of a gas", eos.sound_speed(gas, 1.2, 0.0, 1.3e5, 2.6e5, 0.8),
              (1.4 * 1.3e5 * 0.8 / 1.2) ** 0.5)
    run.check("driver, energy equation: order", run.order(np.array([2.0, 1.0]), errors), 2.0)


def sweep(run, seed, count):
    """`count` new motions of each law."""
    for case in known(run):
        for is_axisymmetric in (False, True):
            go_through(run, case, range(seed, seed + count), is_axisymmetric)


def check(run):
    check_rubber(run, "Mooney-Rivlin", cases.laws.MooneyRivlin(0.49, 4.0e5, 1.0e5))
    check_rubber(run, "Blatz-Ko", cases.laws.BlatzKo(1.0e6))
    check_eos(run)
    for case in known(run):
        reached = [go_through(run, case, SEEDS, is_axisymmetric) for is_axisymmetric in (False, True)]
        run.true(f"{case.name}: plane and round motions reach what is to be compared", all(reached))
