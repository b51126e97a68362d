# SPDX-License-Identifier: MIT
"""A free block that spins: hourglass control neither feeds it nor, with stiffness, eats it; plastic strain in it."""
import numpy as np

from meshes import Deck, grid
from scene import (FULL, N_X, OMEGA, POISSON, RHO, SHEAR, SOUND, TURN, YOUNG, HEIGHT, N_Y, Motion,
                   block_mesh, spin, spin_deck)

PLASTIC = (1.0e5, 1.0e6, 1.0)  # yield stress, tangent modulus, isotropic: the bending yields in its first quarter


def check_stiffness(run):
    """The stiffness form keeps the energy, by the program's account and by the motion alone."""
    turns = 15.0
    for form, coefficient, scale, distorted in ((4, 0.1, 0.9, False), (5, 0.3, 0.5, False),
                                                (4, 0.3, 0.9, True)):
        label = f"IHQ {form}, QM {coefficient:g}, TSSFAC {scale:g}, {'distorted' if distorted else 'regular'}"
        result = run.program(spin_deck(form, coefficient, scale, turns, distorted, states=0.25))
        energy, motion = result.table("glstat"), Motion(result, distorted)
        run.check(f"{label}: energy ratio over {turns:g} turns", energy["energy_ratio"], 1.0)
        stored = motion.pattern_energy(coefficient)
        total = motion.kinetic() + motion.strain_energy() + stored
        run.check(f"{label}: energy of the motion / at the start", total / energy["total"][0], 1.0)
        third = len(stored) // 3
        run.check(f"{label}: energy in the pattern, last third / first third",
                  stored[-third:].mean() / stored[:third].mean(), 3.0)


def check_held_step(run):
    """A long spin, and one that has yielded: the step is held, so that the balance has no trend."""
    for label, deck, turns in (("elastic, QM 0.05, TSSFAC 0.7", spin_deck(4, 0.05, 0.7, 40.0), 40.0),
                               ("elastic, QM 0.05, TSSFAC 0.7, LCTM 1 s",
                                spin_deck(4, 0.05, 0.7, 40.0, constant=1.0), 40.0),
                               ("yielded, QM 0.05, TSSFAC 0.9", spin_deck(4, 0.05, 0.9, 30.0, plastic=PLASTIC), 30.0)):
        ratio = run.program(deck).table("glstat")["energy_ratio"]
        run.check(f"{label}: energy ratio over {turns:g} turns", ratio, 1.0)
        run.check(f"{label}: last ten turns - first ten", ratio[-500:].mean() - ratio[:500].mean(),
                  0.0)
    free = run.program(spin_deck(4, 0.05, 0.7, 5.0)).table("glstat")
    for label, last in (("constant", 1.0), ("variable", 2.0)):
        deck = spin_deck(4, 0.05, 0.7, 5.0, constant=1.0)
        place = deck.lines.index("*DEFINE_CURVE") + 3
        deck.lines[place] = f"1000000.0,{last!r}"
        capped = run.program(deck, name=f"cap_{label}").table("glstat")
        run.true(f"LCTM that lies above L/c, {label}: the energy ratio has the same bits as without",
                 np.array_equal(capped["energy_ratio"], free["energy_ratio"]))


def pattern(motion):
    """Amplitude of the pattern that alternates from node to node, weighted with the mass: no linear motion has one."""
    nodes = np.arange(len(motion.start))
    signs = (-1.0) ** (nodes % (N_X + 1) + nodes // (N_X + 1))
    return np.linalg.norm(np.sum((signs * motion.mass)[:, None] * motion.position, axis=1), axis=1)


def check_viscous(run):
    """Without stiffness the pattern creeps outwards: the centrifugal force against the viscous one."""
    coefficient = 0.05
    rate = 4.0 * coefficient * SOUND / np.sqrt(HEIGHT / N_Y * 1.0 / N_X)
    growth = 0.5 * (np.sqrt((rate + 2.0j * OMEGA) ** 2 + 4.0 * OMEGA ** 2) - (rate + 2.0j * OMEGA)).real
    coordinates, quads = block_mesh(False)
    deck = Deck("pattern in a spin").control(12.0 * TURN).hourglass(1, coefficient).part()
    nodes = deck.elastic(RHO, YOUNG, POISSON).mesh(coordinates, quads)
    signs = (-1.0) ** (np.arange(len(nodes)) % (N_X + 1) + np.arange(len(nodes)) // (N_X + 1))
    spin(deck, nodes, coordinates, 1.0e-4 * signs, 0.0)
    result = run.program(deck.output(plot=0.25 * TURN, glstat=TURN))
    amplitude, times = pattern(Motion(result, False)), result.times
    late = times > 2.0 * TURN
    run.check("viscous form: growth rate of the pattern",
              np.polyfit(times[late], np.log(amplitude[late]), 1)[0], growth)

    result = run.program(spin_deck(1, coefficient, 0.9, 50.0, True, states=0.5))
    energy, motion = result.table("glstat"), Motion(result, True)
    start, momentum = energy["total"][0], motion.angular_momentum()
    run.check("viscous form, distorted, 50 turns: energy ratio", energy["energy_ratio"], 1.0)
    run.check("same: angular momentum", momentum, momentum[0])
    run.report("same: energy of the motion at the end / at the start",
               (motion.kinetic() + motion.strain_energy())[-1] / start, "hourglass control has eaten the rest")
    run.check("same: hourglass energy / what the motion has lost", energy["hourglass"][-1],
              start - (motion.kinetic() + motion.strain_energy())[-1])
    run.check("same: kinetic energy at the end", motion.kinetic()[-1],
              0.5 * momentum[-1] ** 2 / motion.inertia()[-1])


def check_plastic(run):
    """Plastic strain goes on only while something vibrates, and as much at a quarter of the step."""
    for form, name in ((FULL, "NIP 4"), (4, "one point")):
        late = {}
        for scale, viscosity in ((0.8, None), (0.2, None), (0.8, (0.0, 1.0))):
            result = run.program(spin_deck(form, 0.05, scale, 20.0, states=0.25, plastic=PLASTIC,
                                           bulk_viscosity=viscosity))
            strain = result.cells("plastic_strain").mean(axis=1)
            late[scale, viscosity] = strain[-1] - strain[4]
            run.report(f"{name}, TSSFAC {scale:g}{', bulk viscosity' if viscosity else ''}: growth of the mean "
                       "plastic strain from turn 1 to 20", strain[-1] / strain[4] - 1.0,
                       "vibration goes on" if not viscosity else "")
        run.check(f"{name}: growth after turn 1 where bulk viscosity has ended the vibration",
                  late[0.8, (0.0, 1.0)], 0.0)
        if form == FULL:
            run.check(f"{name}: growth at TSSFAC 0.2 / at 0.8", late[0.2, None] / late[0.8, None],
                      0.4)


def check_law(run):
    """Work of the hypoelastic deviator around a closed cycle: strain gamma sin, volume 1 + a sin of twice the phase."""
    gamma, volume, steps, dt = 0.05, 0.02, 1000, 1.0e-3
    phase = 2.0 * np.pi * np.arange(steps + 1) / steps
    root = np.sqrt(1.0 + volume * np.sin(2.0 * phase))
    stretch = np.stack([root * np.exp(gamma * np.sin(phase)), root * np.exp(-gamma * np.sin(phase))], 1)
    coordinates, quads = grid(1, 1)
    deck = Deck("closed cycle").control(steps * dt, dt=dt).part().elastic(RHO, YOUNG, POISSON)
    nodes = deck.mesh(coordinates, quads)
    for dof in (0, 1):
        deck.curve(10 + dof, list(zip((dt * np.arange(steps + 1)).tolist(), (stretch[:, dof] - 1.0).tolist())))
    for node, place in zip(nodes, coordinates):
        for dof in (0, 1):
            if place[dof] > 0.5:
                deck.prescribe(node, dof + 1, 2, 10 + dof)
            else:
                deck.fix([node], x=int(dof == 0), y=int(dof == 1))
    work = run.program(deck.output(glstat=dt)).table("glstat")["internal"][-1]
    run.check("work around a closed cycle of strain", work,
              2.0 * np.pi * SHEAR * gamma ** 2 * volume)


def check(run):
    check_law(run)
    check_stiffness(run)
    check_held_step(run)
    check_viscous(run)
    check_plastic(run)
