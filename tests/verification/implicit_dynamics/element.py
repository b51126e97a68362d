# SPDX-License-Identifier: MIT
"""One element against a recursion of its own, its spectral radius, and its end on curves."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, LENGTH = 1000.0, 1.0e6, 1.0
OMEGA = np.sqrt(3.0 * YOUNG / RHO) / LENGTH     # one linear element, one end held, consistent mass
PERIOD = 2.0 * np.pi / OMEGA
VELOCITY, ACCELERATION, DISPLACEMENT = 0, 1, 2
SPEED_1 = {"displacement": (DISPLACEMENT, [(0.0, 0.0), (1e3, 1e3)]), "velocity": (VELOCITY, [(0.0, 1.0), (1e3, 1.0)])}
SMALL = 1e-7


def generalised(radius):
    """alpha_m, alpha_f, gamma, beta of Chung & Hulbert (1993), eqs. 17, 20, 25."""
    alpha_m, alpha_f = (2.0 * radius - 1.0) / (radius + 1.0), radius / (radius + 1.0)
    return alpha_m, alpha_f, 0.5 - alpha_m + alpha_f, 0.25 * (1.0 - alpha_m + alpha_f) ** 2


def hilber(alpha):
    """The same of Hilber, Hughes and Taylor, alpha below 0."""
    return 0.0, -alpha, 0.5 - alpha, 0.25 * (1.0 - alpha) ** 2


#: name -> parameters, GAMMA, BETA and ALPHA of the deck, spectral radius of the deck
SCHEMES = {
    **{f"spectral radius {radius}": (generalised(radius), (None, None, None), radius) for radius in (1.0, 0.8, 0.5, 0.0)},
    "default": (generalised(0.8), (None, None, None), None),
    "Newmark, trapezoidal": ((0.0, 0.0, 0.5, 0.25), (0.5, 0.25, None), None),
    "Newmark, damped": ((0.0, 0.0, 0.6, 0.3025), (0.6, 0.3025, None), None),
    "HHT -0.1": (hilber(-0.1), (None, None, -0.1), None),
    "HHT -0.3": (hilber(-0.3), (None, None, -0.3), None),
}


def implicit(title, dt, end_time, newmark=(None, None, None), radius=None):
    gamma, beta, alpha = newmark
    deck = Deck(title).add("*CONTROL_TERMINATION", (end_time,)).add("*CONTROL_IMPLICIT_GENERAL", (1, dt))
    deck.add("*CONTROL_IMPLICIT_DYNAMICS", (1, gamma, beta, None, None, None, None, alpha))
    if radius is not None:
        deck.add("*CONTROL_IMPLICIT_SPECTRAL_RADIUS", (radius,))
    return deck


def element(title, dt, steps, newmark=(None, None, None), radius=None):
    """One element, held in y; the deck and its nodes."""
    deck = implicit(title, dt, steps * dt, newmark, radius)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    nodes = deck.mesh(*grid(1, 1, LENGTH, LENGTH))
    return deck.fix(nodes, y=1).output(glstat=dt, nodout=dt, nodes=[int(node) for node in nodes[:2]]), nodes


def led(deck, nodes, kind, factor, birth=0.0, death=0.0):
    """The right end on curve 1."""
    return deck.add("*BOUNDARY_PRESCRIBED_MOTION_NODE", *[(int(node), 1, kind, 1, factor, 0, death, birth)
                                                          for node in nodes[[1, 3]]])


def recursion(parameters, dt, steps, speed):
    """u, v, a of the right end: m = rho L/3, force = stress of the element (K = E/3, G = E/2)."""
    alpha_m, alpha_f, gamma, beta = parameters
    mass = RHO * LENGTH / 3.0
    u = a = strain = force = 0.0
    v = speed
    rows = [(u, v, a)]
    for _ in range(steps):
        new = u + dt * v
        for _ in range(30):
            middle = LENGTH + 0.5 * (u + new)
            new_strain = strain + (new - u) / middle
            new_force = YOUNG / 3.0 * np.log1p(new / LENGTH) + 2.0 / 3.0 * YOUNG * new_strain
            slope = YOUNG / 3.0 / (LENGTH + new) + 2.0 / 3.0 * YOUNG * (LENGTH + u) / middle ** 2
            new_a = (new - u - dt * v) / (beta * dt ** 2) - (0.5 / beta - 1.0) * a
            residual = mass * ((1.0 - alpha_m) * new_a + alpha_m * a) + (1.0 - alpha_f) * new_force + alpha_f * force
            change = -residual / ((1.0 - alpha_m) * mass / (beta * dt ** 2) + (1.0 - alpha_f) * slope)
            new += change
            if abs(change) <= 1e-16 * LENGTH:
                break
        middle = LENGTH + 0.5 * (u + new)
        strain += (new - u) / middle
        force = YOUNG / 3.0 * np.log1p(new / LENGTH) + 2.0 / 3.0 * YOUNG * strain
        new_a = (new - u - dt * v) / (beta * dt ** 2) - (0.5 / beta - 1.0) * a
        v += dt * ((1.0 - gamma) * a + gamma * new_a)
        u, a = new, new_a
        rows.append((u, v, a))
    return np.array(rows).T


def check_recursion(run):
    """Each scheme step by step, strains of 5 %."""
    dt, steps, speed = PERIOD / 20.0, 60, 0.05 * OMEGA
    for name, (parameters, newmark, radius) in SCHEMES.items():
        deck, nodes = element(name, dt, steps, newmark, radius)
        deck.fix(nodes[[0, 2]], x=1).add("*INITIAL_VELOCITY_NODE", *[(int(node), speed, 0.0) for node in nodes[[1, 3]]])
        history = run.program(deck).node(int(nodes[1]))
        for quantity, column, values in zip(("displacement", "velocity", "acceleration"), ("ux", "vx", "ax"),
                                            recursion(parameters, dt, steps, speed)):
            run.check(f"{name}: {quantity} of 60 steps", history[column], values)


def check_radius(run):
    """Steps of 1600 periods: a displaced end that is let go changes by -rho a step."""
    dt, held = 1.0e4 / OMEGA, 1e-6
    for radius in (1.0, 0.8, 0.5, 0.2):
        deck, nodes = element(f"spectral radius {radius}", dt, 8, radius=radius)
        deck.fix(nodes[[0, 2]], x=1).curve(1, [(0.0, 0.0), (dt, held), (1.0e3 * dt, held)])
        moved = run.program(led(deck, nodes, DISPLACEMENT, 1.0, death=2.5 * dt)).node(int(nodes[1]))["ux"]
        run.check(f"spectral radius {radius}: held displacement", moved[2], held)
        run.check(f"spectral radius {radius}: steps after the release / held displacement", moved[2:] / held,
                  (-radius) ** np.arange(7.0))


def driven(run, kind, points, dt, steps, birth=0.0, death=0.0, plot=None):
    """Free at the left end, the right one on a curve of speeds or places of 1e-7 m: result, rows of left and right end."""
    deck, nodes = element("driven element", dt, steps, radius=1.0)
    result = run.program(led(deck.curve(1, points), nodes, kind, SMALL, birth, death).output(plot=plot))
    return result, *(Rows(result.node(int(node))) for node in nodes[:2])


class Rows:
    """Histories of a node over the size of what drives it."""

    def __init__(self, table):
        self.time, self.u, self.v, self.a = table["time"], *(table[key] / SMALL for key in ("ux", "vx", "ax"))


def check_driven(run):
    """The driven end moves with speed 1 from the start: w = u_free - u_driven is a free oscillation from w' = -1."""
    dt, steps = PERIOD / 20.0, 200
    angle = 2.0 * np.arctan(0.5 * OMEGA * dt)
    for name, curve in SPEED_1.items():
        result, other, end = driven(run, *curve, dt, steps)
        name = f"{name} curve of speed 1"
        run.check(f"{name}: displacement", end.u, end.time)
        run.check(f"{name}: velocity of its end", end.v, 1.0)
        run.check(f"{name}: acceleration of its end", end.a, 0.0)
        run.check(f"{name}: swinging of the free end", other.u - end.u, -np.sin(angle * np.arange(steps + 1)) / OMEGA)
        run.check(f"{name}: energy", result.table("glstat")["energy_ratio"], 1.0)
    # An acceleration that rises to 1 and stays: the curve integrated twice, whatever the step.
    rise = 3.0 * PERIOD
    for dt in (PERIOD / 20.0, PERIOD / 1.7):
        _, _, end = driven(run, ACCELERATION, [(0.0, 0.0), (rise, 1.0), (1e3, 1.0)], dt, 20)
        late, early = np.maximum(end.time - rise, 0.0), np.minimum(end.time, rise)
        name = f"acceleration curve, step {dt / PERIOD:.2f} periods"
        run.check(f"{name}: displacement", end.u, early ** 3 / (6.0 * rise) + 0.5 * rise * late + 0.5 * late ** 2)
        run.check(f"{name}: velocity", end.v, 0.5 * early ** 2 / rise + late)


def blow(dt, steps):
    """The free end after the other was set to speed 1 in the first step: trapezoidal rule by hand."""
    own, shared, spring = RHO * LENGTH / 3.0, RHO * LENGTH / 6.0, YOUNG / LENGTH
    u = v = 0.0
    rows = [u]
    for i in range(steps):
        # own (v1 - v) + shared (1 or 0) + dt spring (mean of u - driven) = 0, u1 - u = dt (v + v1)/2
        kick = shared if i == 0 else 0.0
        stretch = u + 0.25 * dt * v - (i + 0.5) * dt
        v1 = (own * v - kick - dt * spring * stretch) / (own + 0.25 * dt ** 2 * spring)
        u, v = u + 0.5 * dt * (v + v1), v1
        rows.append(u)
    return np.array(rows)


def check_life(run):
    """Births and deaths inside a step."""
    dt, late, steps = PERIOD / 20.0, 7.3, 100
    result, _, end = driven(run, *SPEED_1["velocity"], dt, steps, birth=late * dt)
    alive = end.time > late * dt
    run.check("birth inside a step: displacement", end.u, np.maximum(end.time - late * dt, 0.0))
    run.check("birth inside a step: velocity from then on", end.v[alive], 1.0)
    run.check("birth inside a step: acceleration from then on", end.a[alive], 0.0)
    run.check("birth inside a step: energy", result.table("glstat")["energy_ratio"], 1.0)
    _, other, _ = driven(run, *SPEED_1["velocity"], dt, steps, birth=7.0 * dt)
    run.check("birth between two steps: free end", other.u[7:], blow(dt, steps - 7))
    for name, curve in SPEED_1.items():
        result, _, _ = driven(run, *curve, dt, 8, death=2.6 * dt, plot=1e-3 * dt)
        name, at_death = f"death inside a step, {name}", np.argmin(np.abs(result.times / dt - 2.6))
        run.check(f"{name}: a state at the death", np.abs(result.times[at_death] / dt - 2.6), 0.0)
        run.check(f"{name}: displacement there", result.points("displacement")[at_death, :, 0].max() / SMALL, 2.6 * dt)
        speed = result.points("velocity")[at_death:, :, 0].mean(axis=1)
        run.check(f"{name}: momentum after it", speed, speed[0])


def check(run):
    check_recursion(run)
    check_radius(run)
    check_driven(run)
    check_life(run)
