# SPDX-License-Identifier: MIT
"""A plate flies onto a plate of the same metal: plateau by the jump conditions, spall by the pull-back of the rear side."""
import numpy as np

from meshes import Deck, grid

RHO, G, SPEED, S1, GAMMA, CORRECTION = 8930.0, 46.0e9, 3940.0, 1.489, 1.99, 0.47
FLYER, TARGET, N = 0.5e-3, 3.0e-3, 150   # N elements a millimetre
VELOCITY = 400.0
SLOW, LIMIT = 200.0, 1.0e9


def plates(end, yield_stress, spall=0.0, law="015", cutoff=0.0, velocity=VELOCITY):
    """One row of elements; the flyer's nodes come in at `velocity`, those between at half of it, as by symmetry they would go on."""
    n, length = int(1e3 * N * (FLYER + TARGET)), FLYER + TARGET
    deck = Deck("plate impact").control(end, scale=0.7).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.add("*PART", "plates", (1, 1, 1, 1)).add("*SECTION_SHELL", (1, 13), (1.0,))
    deck.add("*EOS_GRUNEISEN", (1, SPEED, S1, 0.0, 0.0, GAMMA, CORRECTION), (1.0,))
    if law == "015":
        deck.add("*MAT_JOHNSON_COOK", (1, RHO, G), (yield_stress, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0),
                 (0.0, cutoff, spall), (0.0,))
    else:
        deck.add("*MAT_ELASTIC_PLASTIC_HYDRO", (1, RHO, G, yield_stress, 0.0, cutoff))
    nodes = deck.mesh(*grid(n, 1, length, length / n, (-FLYER, 0.0))).reshape(2, n + 1)
    meeting = int(1e3 * N * FLYER)
    deck.fix(nodes.ravel(), y=1)
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), velocity * (0.5 if k == meeting else 1.0))
                                         for row in nodes for k, node in enumerate(row[:meeting + 1])])
    return deck.output(plot=end, glstat=end / 20, nodout=end / 1000, nodes=[int(nodes[0, -1])])


def pressure(v, energy):
    """Gruneisen's equation."""
    mu = 1.0 / v - 1.0
    up = max(mu, 0.0)
    cold = RHO * SPEED ** 2 * mu * (1.0 + (1.0 - 0.5 * GAMMA) * up - 0.5 * CORRECTION * up ** 2) / (1.0 - (S1 - 1.0) * up) ** 2
    return cold + (GAMMA + CORRECTION * mu) * energy


def jump(u, yield_stress):
    """Stress, volume, energy behind the two waves of a half space that is brought to the velocity u: an elastic one, and a shock with
    what mass, momentum and energy ask for across it, where the deviator is 2/3 of the yield stress."""
    bulk = RHO * SPEED ** 2
    fast = np.sqrt((bulk + 4.0 * G / 3.0) / RHO)
    strain = yield_stress / (2.0 * G)                    # the uniaxial strain at which it yields
    s1, v1, u1 = RHO * fast ** 2 * strain, 1.0 - strain, fast * strain
    e1 = 0.5 * s1 * strain

    def excess(v2):
        """Momentum less mass: what v2 has to make 0."""
        # E2 by the energy jump, p linear in E2: two evaluations give it.
        p0, p1 = pressure(v2, 0.0), pressure(v2, 1.0)
        slope, fixed = p1 - p0, p0 + 2.0 * yield_stress / 3.0
        e2 = (e1 + 0.5 * (fixed + s1) * (v1 - v2)) / (1.0 - 0.5 * slope * (v1 - v2))
        s2 = fixed + slope * e2
        return (s2 - s1) * (v1 - v2) / RHO - (u - u1) ** 2, s2, e2

    low, high = 0.5, v1
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle)[0] > 0.0 else (low, middle)
    _, s2, e2 = excess(low)
    return s2, low, e2, (u - u1) / (v1 - low)     # the last: speed of the shock per initial length


def check_plateau(run):
    """At half the way of the shock through the target; the plateau reaches from the flyer's rear side, in part released, to the shock."""
    u = 0.5 * VELOCITY
    for law, yield_stress in (("015", 1.0e6), ("015", 300.0e6), ("010", 300.0e6)):
        name = f"{law}, yield stress {yield_stress / 1e6:.0f} MPa"
        stress, volume, energy, speed = jump(u, yield_stress)
        end = 0.6 * FLYER / speed
        result = run.program(plates(end, yield_stress, law=law), name=f"plateau_{law}_{yield_stress / 1e6:.0f}")
        n = int(1e3 * N * (FLYER + TARGET))
        place = -FLYER + (np.arange(n) + 0.5) * (FLYER + TARGET) / n     # in the undeformed body
        flat = np.abs(place) < 0.8 * speed * end
        flat &= np.abs(place) > 0.05e-3                                  # wall heating beside the plane of impact
        x = result.points("Points")[-1][:n + 1, 0]
        found = np.diff(x) * n / (FLYER + TARGET)
        run.true(f"{name}: a plateau of elements", flat.sum() > 40)
        run.check(f"{name}: stress of the plateau", -result.cells("stress")[-1][flat, 0], np.full(flat.sum(), stress), 0.01,
                  source="jumps of mass, momentum, energy")
        run.check(f"{name}: volume of the plateau", found[flat], np.full(flat.sum(), volume), 0.002)
        front = place[len(place) - 1 - np.argmax(-result.cells("stress")[-1][::-1, 0] > 0.55 * stress)]
        run.check(f"{name}: place of the shock", front, speed * end, 0.03)
        if yield_stress < 2.0e6:
            run.check(f"{name}: Hugoniot's stress", stress, RHO * (SPEED + S1 * u) * u, 1e-3, source="rho0 (C + S1 u) u")
        table = result.table("glstat")
        run.check(f"{name}: energy ratio", table["energy_ratio"], np.ones_like(table["time"]), 2e-3)


def pull_back(limit):
    """2 integral of dp/(rho c) from -limit to 0 along the isentrope: the two families of waves that meet at the place of the spall."""
    v, energy, total = 1.0, 0.0, 0.0
    dv = 1.0e-5
    while True:
        p0 = pressure(v, energy)
        p1 = pressure(v + dv, energy - p0 * dv)
        if p1 < -limit:
            return 2.0 * (total + np.sqrt((p0 + limit) * dv * (p0 + limit) / (p0 - p1) / RHO))
        total += np.sqrt((p0 - p1) * dv / RHO)
        v, energy = v + dv, energy - 0.5 * (p0 + p1) * dv


def rear_of(run, name, *arguments):
    """Time and velocity of the rear side, and the result."""
    result = run.program(plates(1.5 * TARGET / SPEED, 1.0e6, *arguments, velocity=SLOW), name=name)
    rear = result.table("nodout")
    return rear["time"], rear["vx"], result


def check_spall(run):
    """The rear side jumps to twice the velocity of the plateau and falls until the wave of the spall comes; that is taken as it is
    half up, where the velocity without spall has come to, since the mesh rounds the tip between fall and rise."""
    time, whole, result = rear_of(run, "no_spall", 3, "015", -20.0e9)
    run.check("a cut-off that is not reached: nothing breaks", result.cells("damage")[-1], 0.0, 0.0, "abs")
    run.check("without spall the rear side comes to rest", whole[-1], 0.0, 0.02 * SLOW, "abs")
    arrival = time[np.argmax(whole > 0.5 * SLOW)]
    flat = (time > arrival + 0.05e-6) & (time < arrival + 0.15e-6)
    run.check("velocity of the rear side", whole[flat], np.full(flat.sum(), SLOW), 0.01, source="twice that of the plateau")
    for spall in (2, 3):
        name = f"SPALL {spall}"
        when, velocity, result = rear_of(run, f"spall_{spall}", spall, "015", -LIMIT)
        first = int(np.argmax(when > arrival + 0.05e-6))
        lowest = first + int(np.argmin(velocity[first:]))
        half = lowest + int(np.argmax(velocity[lowest:] > 0.5 * (velocity[lowest] + SLOW)))
        run.check(f"{name}: pull-back", SLOW - np.interp(when[half], time, whole), pull_back(LIMIT), 0.05,
                  source="2 integral of dp/(rho c) along the isentrope")
        run.check(f"{name}: lowest velocity as written", velocity[lowest], SLOW - pull_back(LIMIT), 0.0, "min")
        run.check(f"{name}: what is left flies on", velocity[half + 40:].max(), SLOW, 0.02)
        broken = np.flatnonzero(result.cells("damage")[-1].ravel() >= 1.0)
        run.true(f"{name}: it breaks", broken.size > 0)
        # Rarefactions from both free sides run equally far.
        place = (broken + 0.5) / N * 1e-3 - FLYER
        run.check(f"{name}: place", place.max(), TARGET - FLYER, 0.1e-3, "abs", source="as far from the rear side as the flyer is thick")
        run.true(f"{name}: the log tells of it", "points fail: the first" in (result.folder / f"{result.job}.log").read_text())


def check(run):
    check_plateau(run)
    check_spall(run)
