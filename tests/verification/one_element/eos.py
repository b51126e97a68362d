# SPDX-License-Identifier: MIT
"""Equations of state p = a(mu) + b(mu) E, mu = 1/V - 1, E per initial volume, and their energy equation."""


class LinearPolynomial:
    def __init__(self, c, energy=0.0):
        self.c, self.first_energy = tuple(c), energy

    def parts(self, v):
        c0, c1, c2, c3, c4, c5, c6 = self.c
        mu = 1.0 / v - 1.0
        square = mu * mu if mu.real > 0.0 else 0.0
        return c0 + c1 * mu + c2 * square + c3 * mu ** 3, c4 + c5 * mu + c6 * square


class Gruneisen:
    def __init__(self, rho, c, s1, s2, s3, gamma, a, energy=0.0):
        self.rho, self.c, self.s = rho, c, (s1, s2, s3)
        self.gamma, self.a, self.first_energy = gamma, a, energy

    def parts(self, v):
        mu = 1.0 / v - 1.0
        stiffness = self.rho * self.c ** 2
        if mu.real <= 0.0:
            return stiffness * mu, self.gamma + self.a * mu
        s1, s2, s3 = self.s
        top = stiffness * mu * (1.0 + (1.0 - 0.5 * self.gamma) * mu - 0.5 * self.a * mu * mu)
        low = 1.0 - (s1 - 1.0) * mu - s2 * mu ** 2 / (mu + 1.0) - s3 * mu ** 3 / (mu + 1.0) ** 2
        return top / low ** 2, self.gamma + self.a * mu


def sound_speed(eos, rho, shear, pressure, energy, v):
    """c^2 = (K + 4G/3)/density, K = -V dp/dV along dE = -p dV; derivatives by complex steps."""
    a, b = eos.parts(v + 1.0e-30j)
    slope = (a.imag + b.imag * energy) / 1.0e-30 - pressure * b.real
    return ((4.0 * shear / 3.0 - v * slope) * v / rho) ** 0.5


def pressure_step(eos, pressure, energy, before, after, work, least=None):
    """Pressure and energy at the end of a step, trapezoidal: E1 = E0 + work - (p0 + p1)/2 (V1 - V0), p1 not
    below `least`."""
    a, b = eos.parts(after)
    growth = after - before
    new_energy = (energy + work - 0.5 * (pressure + a) * growth) / (1.0 + 0.5 * b * growth)
    new_pressure = a + b * new_energy
    if least is not None and new_pressure < least:
        new_pressure = least
        new_energy = energy + work - 0.5 * (pressure + least) * growth
    return new_pressure, new_energy
