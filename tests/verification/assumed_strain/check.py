# SPDX-License-Identifier: MIT
"""Assumed strain (IHQ 6): beams and a tube of one element in height, distorted patches, a plastic hinge."""
import re

import numpy as np

from meshes import Deck, distorted_patch, grid

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3


def implicit_deck(title, step, end=1.0, quality=1.0, form=6, elform=13, points=None):
    """Statics; NIP stays blank unless given."""
    deck = Deck(title).add("*CONTROL_TERMINATION", (end,)).add("*CONTROL_IMPLICIT_GENERAL", (1, step))
    return deck.hourglass(form, quality).part(section=1).add("*SECTION_SHELL", (1, elform, None, points), (1.0,))


def loaded(deck, loads, end=1.0):
    """Nodal loads (node, direction, size) that grow from zero."""
    deck.curve(1, [(0.0, 0.0), (end, 1.0)])
    return deck.add("*LOAD_NODE_POINT", *[(int(node), direction, 1, size) for node, direction, size in loads])


def beam(n, length, height, poisson, load, **options):
    """Cantilever of n by 1 quads; load "couple" or "shear" at its end."""
    coordinates, quads = grid(n, 1, length, height, (0.0, -0.5 * height))
    deck = implicit_deck(f"beam under a {load}", 1.0, **options).elastic(RHO, YOUNG, poisson)
    nodes = deck.mesh(coordinates, quads)
    root, tip = nodes[coordinates[:, 0] == 0.0], nodes[coordinates[:, 0] == length]
    size = 1.0e-7 * YOUNG / (1.0 - poisson ** 2) * height ** 3 / 12.0 / length
    if load == "couple":
        loaded(deck.fix(root, x=1, y=1), [(tip[0], 1, size / height), (tip[1], 1, -size / height)])
    else:
        loaded(deck.fix(root, x=1, y=1), [(node, 2, 0.5 * size / length) for node in tip])
    return deck.output(plot=1.0, glstat=1.0), size


def check_beams(run):
    """Exact bending: of a couple at once, of a force to the rule of the middle of each element."""
    for n, length, height, poisson in ((1, 1.0, 1.0, 0.3), (2, 10.0, 0.5, 0.0), (7, 3.0, 0.5, 0.499)):
        rigidity = YOUNG / (1.0 - poisson ** 2) * height ** 3 / 12.0
        name = f"{n} quads {length / n:.3g} x {height:g}, nu {poisson}"
        deck, couple = beam(n, length, height, poisson, "couple")
        result = run.program(deck, name=f"couple_{n}")
        moved = result.points("displacement")[-1]
        run.check(f"couple, {name}: turn of the end", (moved[n, 0] - moved[-1, 0]) / height,
                  couple * length / rigidity)
        run.check(f"couple, {name}: deflection", moved[-1, 1],
                  0.5 * couple * length ** 2 / rigidity)
        energies = result.table("glstat")
        run.check(f"couple, {name}: energy is that of hourglass control", energies["hourglass"][-1],
                  0.5 * couple ** 2 * length / rigidity)
        deck, moment = beam(n, length, height, poisson, "shear")
        force = moment / length
        moved = run.program(deck, name=f"shear_{n}").points("displacement")[-1]
        expected = force * length ** 3 / (3.0 * rigidity) * (1.0 - 0.25 / n ** 2) \
            + 2.0 * (1.0 + poisson) * force * length / (YOUNG * height)
        run.check(f"shear, {name}: deflection", 0.5 * (moved[n, 1] + moved[-1, 1]), expected)


def check_cook(run):
    """Cook's membrane, plane stress E = 1, nu = 1/3 as plane strain: 23.96 (Cook 1974 and later ones)."""
    found = []
    for n in (4, 8, 16):
        xi, eta = (axis.ravel() for axis in np.meshgrid(np.arange(n + 1) / n, np.arange(n + 1) / n))
        coordinates = np.column_stack([48.0 * xi, (1.0 - xi) * 44.0 * eta + xi * (44.0 + 16.0 * eta)])
        deck = implicit_deck("Cook's membrane", 1.0).elastic(RHO, 0.9375, 0.25)
        nodes = deck.mesh(coordinates, grid(n, n)[1])
        deck.fix(nodes[xi == 0.0], x=1, y=1)
        share = np.where((eta[xi == 1.0] % 1.0) == 0.0, 0.5, 1.0) / n
        loaded(deck, [(node, 2, 1.0e-7 * part) for node, part in zip(nodes[xi == 1.0], share)])
        moved = run.program(deck.output(plot=1.0), name=f"cook_{n}").points("displacement")[-1]
        found.append(1.0e7 * float(moved[(xi == 1.0) & (eta == 0.5), 1][0]))
    run.report("Cook's membrane, 4 x 4: deflection", found[0], "full integration 18.3")
    run.check("Cook's membrane, 8 x 8 and 16 x 16: deflection to second order",
              found[2] + (found[2] - found[1]) / 3.0, 23.96)
    run.check("Cook's membrane, 16 x 16: deflection", found[2], 23.96)


def check_patch(run):
    """Linear displacement of the outer nodes of a distorted patch, plane and round."""
    coordinates, quads = distorted_patch()
    for elform, shift, gradient in ((13, 0.0, [[2.0, 3.0], [-1.0, 1.5]]), (15, 0.7, [[2.0, 0.0], [0.0, -1.5]])):
        place = coordinates + (shift, 0.0)
        deck = implicit_deck("distorted patch", 1.0, elform=elform).elastic(RHO, YOUNG, POISSON)
        nodes = deck.mesh(place, quads).tolist()
        moved = 1.0e-8 * place @ np.transpose(gradient)
        deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
        for node, u in zip(nodes[:4] + nodes[5:], np.delete(moved, 4, axis=0)):
            deck.prescribe(node, 1, 2, 1, float(u[0])).prescribe(node, 2, 2, 1, float(u[1]))
        result = run.program(deck.output(plot=1.0, glstat=1.0), name=f"patch_{elform}")
        name = "round patch" if elform == 15 else "plane patch"
        run.check(f"{name}: inner node / largest displacement",
                  np.abs(result.points("displacement")[-1][4, :2] - moved[4]).max()
                  / np.abs(moved).max(), 0.0)
        energies = result.table("glstat")
        run.check(f"{name}: hourglass / internal energy",
                  energies["hourglass"][-1] / energies["internal"][-1], 0.0)


def energy_ratios(result):
    """Energy ratios of the iterations of the last step, from the log."""
    log = (result.folder / f"{result.job}.log").read_text()
    rows = re.findall(r"iteration (\d+): energy ratio (\S+),", log)
    start = max(k for k, row in enumerate(rows) if row[0] == "1")
    return np.array([float(row[1]) for row in rows[start:]])


def check_newton(run):
    """A beam bent far: quadratic convergence; work of the load is stored."""
    coordinates, quads = grid(10, 1, 10.0, 0.5)
    deck = implicit_deck("beam bent far", 0.1).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    deck.fix(nodes[[0, 11]], x=1, y=1)
    loaded(deck, [(nodes[10], 2, 200.0), (nodes[21], 2, 200.0)])
    result = run.program(deck.output(plot=0.1, glstat=0.1))
    run.check("bent far: deflection / length", result.points("displacement")[-1][10, 1] / 10.0, 0.6)
    ratios = energy_ratios(result)
    orders = np.log(ratios[2:]) / np.log(ratios[1:-1])
    fast = [k for k in range(len(orders)) if 1e-26 < ratios[k + 2] and ratios[k + 1] < 1e-3]
    run.check("bent far: order of the last iterations",
              max(orders[k] for k in fast) if fast else 0.0, 1.7)
    run.check("bent far: energy ratio", result.table("glstat")["energy_ratio"][-1], 1.0)


def check_hinge(run):
    """Four perfectly plastic layers under a growing curvature: their plastic moment, and of their
    own bending the elastic sixteenth times QM that assumed strain keeps."""
    yield_stress, length, height = 1.0e3, 0.25, 1.0
    curvature = 0.02
    quality = 0.5
    coordinates, quads = grid(1, 4, length, height, (0.0, -0.5 * height))
    deck = implicit_deck("plastic hinge", 0.02, quality=quality).plastic(RHO, YOUNG, POISSON, yield_stress)
    nodes = deck.mesh(coordinates, quads)
    deck.fix(nodes[0::2], x=1).fix([nodes[4]], y=1)
    deck.curve(1, [(0.0, 0.0), (1.0, 1.0)])
    for node, y in zip(nodes[1::2], coordinates[1::2, 1]):
        deck.prescribe(int(node), 1, 2, 1, float(-curvature * length * y))
    result = run.program(deck.output(glstat=0.02))
    energies = result.table("glstat")
    work = energies["external_work"]
    moment = (work[-1] - work[-6]) / (curvature * length * (energies["time"][-1] - energies["time"][-6]))
    middle = 0.5 * (energies["time"][-1] + energies["time"][-6]) * curvature
    hinge = 2.0 / np.sqrt(3.0) * yield_stress * height ** 2 / 4.0
    own = quality * YOUNG / (1.0 - POISSON ** 2) * height ** 3 / 12.0 / 16.0 * middle
    run.check("plastic hinge: moment", moment, hinge + own)
    run.report("plastic hinge: share of the layers' own bending", own / hinge)
    run.check("plastic hinge: work of hourglass control", energies["hourglass"][-1],
              0.5 * own / middle * curvature ** 2 * length)


def check_tube(run):
    """A long thin tube under a ring load at its end, one element thick."""
    radius, thickness = 1.0, 0.002
    rigidity = YOUNG * thickness ** 3 / (12.0 * (1.0 - POISSON ** 2))
    beta = (3.0 * (1.0 - POISSON ** 2) / (radius * thickness) ** 2) ** 0.25
    n, size = 100, 1.0e-9
    length = 5.0 / beta
    z = length * (np.arange(n + 1) / n) ** 1.5
    coordinates = np.array([(radius + side * thickness, height) for height in z for side in (-0.5, 0.5)])
    quads = [(2 * k, 2 * k + 1, 2 * k + 3, 2 * k + 2) for k in range(n)]
    deck = implicit_deck("edge of a tube", 1.0, elform=15).elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    deck.fix(nodes[-2:], y=1)
    loaded(deck, [(node, 1, 0.5 * size * radius) for node in nodes[:2]])
    result = run.program(deck.output(plot=1.0, glstat=1.0))
    moved = result.points("displacement")[-1]
    deflection = 0.5 * (moved[:-1:2, 0] + moved[1::2, 0])
    run.check("tube: radial displacement of the loaded end", deflection[0],
              size / (2.0 * beta ** 3 * rigidity))
    exact = size / (2.0 * beta ** 3 * rigidity) * np.exp(-beta * z) * np.cos(beta * z)
    run.check("tube: largest error of the wave", np.abs(deflection - exact).max() / exact[0], 0.0)
    energies = result.table("glstat")
    run.check("tube: internal and hourglass energy",
              energies["internal"][-1] + energies["hourglass"][-1], energies["external_work"][-1])


def check_vibration(run):
    """The explicit beam of one element in height: frequency of the first bending mode of the mesh."""
    length, height, n = 10.0, 0.5, 20
    coordinates, quads = grid(n, 1, length, height, (0.0, -0.5 * height))
    modulus = YOUNG / (1.0 - POISSON ** 2)
    k = 1.8751040687 / length
    frequency = k ** 2 * np.sqrt(modulus * height ** 2 / 12.0 / RHO) / (2.0 * np.pi)
    end = 1.5 / frequency
    deck = Deck("bending wave").control(end).hourglass(6, 1.0).part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    s = (np.cosh(k * length) + np.cos(k * length)) / (np.sinh(k * length) + np.sin(k * length))
    kx = k * coordinates[:, 0]
    shape = 0.5 * (np.cosh(kx) - np.cos(kx) - s * (np.sinh(kx) - np.sin(kx)))
    slope = 0.5 * k * (np.sinh(kx) + np.sin(kx) - s * (np.cosh(kx) - np.cos(kx)))
    deck.fix(nodes[[0, n + 1]], x=1, y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[
        (int(node), -1.0e-4 * y * turn, 1.0e-4 * w) for node, y, turn, w
        in zip(nodes, coordinates[:, 1], slope, shape) if w > 0.0])
    result = run.program(deck.output(nodout=end / 1000, glstat=end / 100, nodes=[nodes[n]]))
    history = result.node(int(nodes[n]))
    time, moved = history["time"], history["uy"]
    zero = np.flatnonzero(moved[:-1] * moved[1:] < 0.0)
    crossing = time[zero] - moved[zero] * (time[zero + 1] - time[zero]) / (moved[zero + 1] - moved[zero])
    rotary = height ** 2 / 4.0 / length ** 2 * 4.648  # lumped masses lie at the faces
    shear = height ** 2 / 12.0 / length ** 2 * 4.648 * 2.0 * (1.0 + POISSON) / (1.0 - POISSON ** 2)
    run.check("explicit beam: frequency of the first bending mode", 0.5 / np.diff(crossing).mean(),
              frequency / np.sqrt(1.0 + rotary + shear))
    energies = result.table("glstat")
    run.check("explicit beam: energy ratio", energies["energy_ratio"], 1.0)


def check_full(run):
    """NIP blank, or 2 (the default of shells), and another form: NIP 4 with one warning, and its bits."""
    results = {}
    for points in (4, None, 2):
        deck, _ = beam(3, 3.0, 0.5, POISSON, "shear", form=1, quality=0.1, points=points)
        results[points] = run.program(deck, name=f"points_{points}")
    moved = {points: result.points("displacement")[-1] for points, result in results.items()}
    for points, name in ((None, "NIP blank"), (2, "NIP 2")):
        run.check(f"{name} without IHQ 6: displacement", moved[points], moved[4])
        log = (results[points].folder / f"{results[points].job}.log").read_text()
        run.check(f"{name} without IHQ 6: warnings", log.count("the implicit method integrates these parts fully, as with NIP 4 (one-point elements need IHQ 6 and no rubber):"), 1)


def check(run):
    check_beams(run)
    check_cook(run)
    check_patch(run)
    check_newton(run)
    check_hinge(run)
    check_tube(run)
    check_vibration(run)
    check_full(run)
