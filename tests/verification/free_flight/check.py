# SPDX-License-Identifier: MIT
"""A spinning body without loads: momentum, angular momentum and energy are constant."""
import numpy as np

from meshes import Deck, angular_momentum, grid, lumped_mass

RHO, YOUNG, POISSON = 1000.0, 1.0e6, 0.3
VELOCITY, SPIN, CENTRE = (3.0, -2.0), 4.0, (0.8, 0.4)


def body(form, coefficient):
    """Sheared and waved block of 8 x 4 quads, spun about a point beside its centre."""
    coordinates, quads = grid(8, 4, 2.0, 1.0)
    x, y = coordinates.T
    coordinates = np.stack([x + 0.2 * y + 0.03 * np.sin(7.0 * y), y + 0.05 * np.sin(5.0 * x)], -1)
    deck = Deck("free flight")
    deck.control(1.0, scale=0.5).hourglass(form, coefficient).part().elastic(RHO, YOUNG, POISSON)
    deck.mesh(coordinates, quads)
    deck.add("*INITIAL_VELOCITY_GENERATION", (1, 2, SPIN, *VELOCITY, 0.0),
             (*CENTRE, 0.0, 0.0, 0.0, 1.0))
    return deck.output(plot=0.02, glstat=0.01, matsum=0.01), coordinates, quads


def check_form(run, name, form, coefficient):
    deck, coordinates, quads = body(form, coefficient)
    result = run.program(deck, name=name)
    mass = lumped_mass(coordinates, quads, RHO)
    arm = coordinates - CENTRE
    velocity = np.stack([VELOCITY[0] - SPIN * arm[:, 1], VELOCITY[1] + SPIN * arm[:, 0]], -1)
    momentum = mass @ velocity
    size = np.linalg.norm(momentum)
    run.check(f"{name}: initial velocity", result.points("velocity")[0, :, :2], velocity)
    part = result.table("matsum")
    run.check(f"{name}: mass", part["mass"], mass.sum())
    for name_, found, wanted in (("x", part["momentum_x"], momentum[0]),
                                 ("y", part["momentum_y"], momentum[1])):
        run.check(f"{name}: momentum {name_}, drift / |p|", (found - wanted) / size, 0.0)
    position = result.points("Points")[..., :2]
    found = angular_momentum(mass, position, result.points("velocity")[..., :2])
    run.check(f"{name}: angular momentum", found, angular_momentum(mass, coordinates, velocity))
    centre = np.tensordot(position, mass, axes=(1, 0)) / mass.sum()
    run.check(f"{name}: path of the centre of mass", centre,
              mass @ coordinates / mass.sum() + np.outer(result.times, momentum) / mass.sum())
    energy = result.table("glstat")
    kinetic = 0.5 * np.sum(mass * np.sum(velocity ** 2, axis=1))
    run.check(f"{name}: kinetic energy at the start", energy["kinetic"][0], kinetic)
    run.check(f"{name}: energy ratio", energy["energy_ratio"], 1.0)
    run.check(f"{name}: external work / energy", energy["external_work"] / kinetic, 0.0)
    run.report(f"{name}: internal energy at its peak / kinetic", energy["internal"].max() / kinetic,
               "the body stretches under its spin")


def check(run):
    check_form(run, "viscous", 1, 0.1)
    check_form(run, "stiffness", 4, 0.05)
