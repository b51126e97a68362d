# SPDX-License-Identifier: MIT
"""A plate flies onto a plate of the same metal: plateau by the jump conditions, spall by the pull-back of the rear side."""
import numpy as np

from meshes import Deck, grid

RHO, G, SPEED, S1, GAMMA, CORRECTION = 8930.0, 46.0e9, 3940.0, 1.489, 1.99, 0.47
FLYER, TARGET, N = 0.5e-3, 3.0e-3, 150   # N elements a millimetre
VELOCITY = 400.0
# Flyer, target, speed and limit of the spalls: the break far from the flyer's rear side, and near it.
SPALLS = ((0.5e-3, 3.0e-3, 200.0, 3.0e9), (1.5e-3, 2.5e-3, 400.0, 4.0e9))


def plates(end, yield_stress, spall=0.0, law="015", cutoff=0.0, velocity=VELOCITY, thick=(FLYER, TARGET)):
    """One row of elements; the flyer's nodes come in at `velocity`, those between at half of it, as by symmetry they would go on."""
    flyer, length = thick[0], sum(thick)
    n = round(1e3 * N * length)
    deck = Deck("plate impact").control(end, scale=0.7).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.06))
    deck.add("*PART", "plates", (1, 1, 1, 1)).add("*SECTION_SHELL", (1, 13), (1.0,))
    deck.add("*EOS_GRUNEISEN", (1, SPEED, S1, 0.0, 0.0, GAMMA, CORRECTION), (1.0,))
    if law == "015":
        deck.add("*MAT_JOHNSON_COOK", (1, RHO, G), (yield_stress, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0),
                 (0.0, cutoff, spall), (0.0,))
    else:
        deck.add("*MAT_ELASTIC_PLASTIC_HYDRO", (1, RHO, G, yield_stress, 0.0, cutoff))
    nodes = deck.mesh(*grid(n, 1, length, length / n, (-flyer, 0.0))).reshape(2, n + 1)
    meeting = round(1e3 * N * flyer)
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
        run.check(f"{name}: stress of the plateau", -result.cells("stress")[-1][flat, 0],
                  np.full(flat.sum(), stress))
        run.check(f"{name}: volume of the plateau", found[flat], np.full(flat.sum(), volume))
        front = place[len(place) - 1 - np.argmax(-result.cells("stress")[-1][::-1, 0] > 0.55 * stress)]
        run.check(f"{name}: place of the shock", front, speed * end)
        if yield_stress < 2.0e6:
            run.check(f"{name}: Hugoniot's stress", stress, RHO * (SPEED + S1 * u) * u)
        table = result.table("glstat")
        run.check(f"{name}: energy ratio", table["energy_ratio"], np.ones_like(table["time"]))


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


class Impact:
    """One pair of plates without and with a limit."""

    def __init__(self, run, thick, velocity, limit):
        self.run, self.thick, self.velocity, self.limit = run, thick, velocity, limit
        self.name = f"{1e3 * thick[0]:g} on {1e3 * thick[1]:g} mm at {velocity:.0f} m/s"
        self.time, self.whole, self.result = self.rear(f"whole_{velocity:.0f}", 3, -200.0e9)
        self.arrival = self.time[np.argmax(self.whole > 0.5 * velocity)]

    def rear(self, name, spall, cutoff):
        """Time and velocity of the rear side, and the result; till the pulse of the spall has come to the rear side."""
        end = (1.25 * sum(self.thick) + self.thick[0]) / SPEED
        result = self.run.program(plates(end, 1.0e6, spall, "015", cutoff, self.velocity, self.thick), name=name)
        rear = result.table("nodout")
        return rear["time"], rear["vx"], result

    def check_whole(self):
        """Without spall: the jump to twice the velocity of the plateau."""
        self.run.check(f"{self.name}: a cut-off that is not reached: nothing breaks", self.result.cells("damage")[-1], 0.0)
        flat = (self.time > self.arrival + 0.05e-6) & (self.time < self.arrival + 0.15e-6)
        self.run.check(f"{self.name}: velocity of the rear side", self.whole[flat],
                       np.full(flat.sum(), self.velocity))

    def check_spall(self, spall):
        """Fall of the rear side until the pulse of the spall is half up, and the place of the break."""
        name = f"{self.name}, SPALL {spall}, {self.limit / 1e9:g} GPa"
        when, velocity, result = self.rear(f"spall_{spall}_{self.velocity:.0f}", spall, -self.limit)
        broken = np.flatnonzero(result.cells("damage")[-1].ravel() >= 1.0)
        self.run.true(f"{name}: it breaks", broken.size > 0)
        depth = sum(self.thick) - (broken.max() + 1) / N * 1e-3         # of the break below the rear side
        self.run.check(f"{name}: depth", depth, self.thick[0])
        start = int(np.argmax(when > self.arrival + 1.5 * self.thick[0] / SPEED))
        lowest = start + int(np.argmin(velocity[start:]))
        middle = 0.5 * (velocity[lowest] + self.velocity)
        after = lowest + int(np.argmax(velocity[lowest:] > middle))
        half = np.interp(middle, velocity[after - 1:after + 1], when[after - 1:after + 1])
        fall = self.velocity - np.interp(half, self.time, self.whole)
        left = np.sqrt(1.0 - depth / sum(self.thick))
        self.run.check(f"{name}: pull-back", fall, left * pull_back(self.limit))
        self.run.check(f"{name}: lowest velocity as written", velocity[lowest], self.velocity - pull_back(self.limit))
        self.run.check(f"{name}: what is left flies on", velocity[after + 40:].max(), self.velocity)
        self.run.true(f"{name}: the log tells of it",
                      "first failed point" in (result.folder / f"{result.job}.log").read_text())


def check_spall(run):
    """Two pairs of plates; largest stress and largest tension are nearly the same here, where the yield stress is 1 MPa."""
    for number, (flyer, target, velocity, limit) in enumerate(SPALLS):
        impact = Impact(run, (flyer, target), velocity, limit)
        impact.check_whole()
        for spall in (2, 3)[:2 - number]:
            impact.check_spall(spall)


def check(run):
    check_plateau(run)
    check_spall(run)
