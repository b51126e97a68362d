# SPDX-License-Identifier: MIT
"""The laws, one class each: at_rest() and advance(state, step) on a dictionary, result(state) for the driver.

Equations, sources and the choices where the literature leaves the discrete update open: README.md.
"""
import numpy as np

from driver import ONE, deviator, dot
from eos import pressure_step, sound_speed


def mises(tensor):
    return np.sqrt(1.5 * dot(tensor, tensor))


def falling_root(function, high):
    """Root of a falling function in [0, high], function(0) > 0 >= function(high): regula falsi (Illinois) with
    halvings, until the bracket or the last change is round-off."""
    low, f_low, f_high, kept = 0.0, function(0.0), function(high), 0
    if f_high >= 0.0:
        return high
    for turn in range(200):
        new = low - f_low * (high - low) / (f_high - f_low)
        if turn % 4 == 3 or not low < new < high:
            new = 0.5 * (low + high)
        value = function(new)
        if value == 0.0 or high - low <= 1.0e-15 * high:
            return new
        if value > 0.0:
            low, f_low, f_high, kept = new, value, f_high * (0.5 if kept == 1 else 1.0), 1
        else:
            high, f_high, f_low, kept = new, value, f_low * (0.5 if kept == -1 else 1.0), -1
    raise ArithmeticError("no root")


class Law:
    """The deviator is integrated, K ln J is added; energy: potential of the volume and trapezoidal work of s."""

    first_temperature = 0.0

    def __init__(self, bulk, shear):
        self.bulk, self.shear = bulk, shear

    def at_rest(self):
        return {"s": np.zeros((3, 3)), "p": 0.0, "plastic": 0.0, "temperature": self.first_temperature,
                "damage": 0.0, "energy": 0.0, "work": 0.0}

    def advance(self, state, step):
        new = dict(state)
        old = step.turned(state["s"])
        self.deviator(new, old + 2.0 * self.shear * deviator(step.strain), step)
        new["work"] += 0.5 * dot(old + new["s"], step.strain) * step.middle
        self.volume(new, step, new["work"] - state["work"])
        return new

    def deviator(self, new, trial, step):
        new["s"] = trial

    def volume(self, new, step, work):
        j = step.after
        new["p"] = -self.bulk * np.log(j)
        new["energy"] = new["work"] + self.bulk * (j * np.log(j) - j + 1.0)

    def result(self, state):
        return {"stress": state["s"] - state["p"] * ONE, "plastic_strain": state["plastic"],
                "temperature": state["temperature"], "damage": state["damage"], "energy": state["energy"]}


class Elastic(Law):
    """*MAT_ELASTIC."""

    def __init__(self, young, poisson):
        super().__init__(young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)))


def cowper(rate, c, p):
    return 1.0 + (rate / c) ** (1.0 / p) if c > 0.0 else 1.0


class PlasticKinematic(Elastic):
    """*MAT_PLASTIC_KINEMATIC without a rate effect."""

    def __init__(self, young, poisson, yield_stress, tangent=0.0, beta=0.0):
        super().__init__(young, poisson)
        self.yield_stress, self.beta = yield_stress, beta
        self.modulus = young * tangent / (young - tangent)

    def at_rest(self):
        return {**super().at_rest(), "back": np.zeros((3, 3))}

    def deviator(self, new, trial, step):
        back = step.turned(new["back"])
        xi = trial - back
        kinematic = (1.0 - self.beta) * self.modulus
        excess = mises(xi) - self.yield_stress - self.beta * self.modulus * new["plastic"]
        new["s"], new["back"] = trial, back
        if excess > 0.0:
            growth = excess / (3.0 * self.shear + self.modulus)
            direction = xi / mises(xi)
            new["s"] = trial - 3.0 * self.shear * growth * direction
            new["back"] = back + kinematic * growth * direction
            new["plastic"] += growth


class J2(Law):
    """Isotropic radial return to flow_stress(plastic, rate, state), the rate of the plastic strain solved with it."""

    def flow_stress(self, plastic, rate, new, step):
        raise NotImplementedError

    def deviator(self, new, trial, step):
        size, old = mises(trial), new["plastic"]
        new["s"], new["growth"] = trial, 0.0

        def excess(growth):
            return size - 3.0 * self.shear * growth - self.flow_stress(old + growth, growth / step.dt, new, step)

        if size > 0.0 and excess(0.0) > 0.0:
            growth = falling_root(excess, size / (3.0 * self.shear))
            new["s"] = trial * (1.0 - 3.0 * self.shear * growth / size)
            new["plastic"], new["growth"] = old + growth, growth


class PiecewiseLinear(J2):
    """*MAT_PIECEWISE_LINEAR_PLASTICITY with VP 0: points, or rows of points at rates; factors by the total rate."""

    def __init__(self, young, poisson, rows, rates=(0.0,), cowper_symonds=(0.0, 1.0), factors=None):
        Law.__init__(self, young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)))
        self.rows, self.rates, self.factors = rows, rates, factors
        self.cowper_symonds = cowper_symonds

    @staticmethod
    def polygon(row, plastic):
        """Behind the last point the last slope goes on, unless it falls."""
        x, y = row
        if len(x) == 1 or plastic <= x[-1]:
            return np.interp(plastic, x, y)
        return y[-1] + max(0.0, (y[-1] - y[-2]) / (x[-1] - x[-2])) * (plastic - x[-1])

    def flow_stress(self, plastic, rate, new, step):
        values = [self.polygon(row, plastic) for row in self.rows]
        factor = cowper(step.rate, *self.cowper_symonds)
        if self.factors is not None:
            factor *= np.interp(step.rate, *self.factors)
        return factor * np.interp(step.rate, self.rates, values)


class SimplifiedJohnsonCook(J2):
    """*MAT_SIMPLIFIED_JOHNSON_COOK: min(min(A + B e^n, SIGMAX) (1 + C ln r), SIGSAT).

    VP 0: r by the total rate; VP 1: r by the plastic rate of the step. r is never below 1."""

    def __init__(self, young, poisson, a, b, n, c, reference, vp=0, sigmax=1.0e28, sigsat=1.0e28):
        Law.__init__(self, young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)))
        self.a, self.b, self.n, self.c = a, b, n, c
        self.reference, self.vp, self.sigmax, self.sigsat = reference, vp, sigmax, sigsat

    def total_rate(self, step):
        return np.sqrt(2.0 / 3.0) * step.deviatoric_rate

    def flow_stress(self, plastic, rate, new, step):
        r = rate if self.vp == 1 else self.total_rate(step)
        stress = min(self.a + self.b * plastic ** self.n, self.sigmax)
        return min(stress * (1.0 + self.c * np.log(max(1.0, r / self.reference))), self.sigsat)


class WithPressure(J2):
    """Laws whose pressure comes from an equation of state; PC and failure judged at the end of the step.

    bulk_viscosity: its density, Q1 and Q2; the work of its forces goes into E."""

    bulk_viscosity = None

    def __init__(self, shear, eos, cutoff=0.0):
        super().__init__(0.0, shear)
        self.eos, self.cutoff = eos, cutoff

    def at_rest(self):
        a, b = self.eos.parts(1.0)
        energy = self.eos.first_energy
        return {**super().at_rest(), "p": a + b * energy, "energy": energy, "failed": False, "q": 0.0}

    def least_pressure(self, new):
        if new["failed"]:
            return 0.0
        return self.cutoff if self.cutoff < 0.0 else None

    def deviator(self, new, trial, step):
        if new["failed"]:
            new["s"], new["growth"] = np.zeros((3, 3)), 0.0
        else:
            super().deviator(new, trial, step)

    def volume(self, new, step, work):
        work += self.viscous_work(new, step)
        new["p"], new["energy"] = pressure_step(self.eos, new["p"], new["energy"], step.before, step.after, work,
                                                self.least_pressure(new))
        self.end_of_step(new, step)

    def viscous_work(self, new, step):
        """By the pressures q of the two ends; q with the sound speed of the state at the start of the step."""
        old, new["q"] = new["q"], 0.0
        if self.bulk_viscosity is not None and step.trace < 0.0:
            new["q"] = self.viscous_pressure(new, step)
        return -0.5 * (old + new["q"]) * (step.after - step.before)

    def viscous_pressure(self, new, step):
        rho, quadratic, linear = self.bulk_viscosity
        speed = sound_speed(self.eos, rho, self.shear, new["p"], new["energy"], step.before)
        rate = -step.trace * step.length
        return rho / step.after * rate * (quadratic * rate + linear * speed)

    def end_of_step(self, new, step):
        pass



class ElasticPlasticHydro(WithPressure):
    """*MAT_ELASTIC_PLASTIC_HYDRO: SIGY + EH e, or points."""

    def __init__(self, shear, yield_stress, modulus, eos, cutoff=0.0, failure=0.0, points=None):
        super().__init__(shear, eos, cutoff)
        self.yield_stress, self.modulus = yield_stress, modulus
        self.failure, self.points = failure, points

    def flow_stress(self, plastic, rate, new, step):
        if self.points is not None:
            return PiecewiseLinear.polygon(self.points, plastic)
        return self.yield_stress + self.modulus * plastic

    def deviator(self, new, trial, step):
        super().deviator(new, trial, step)
        if self.failure > 0.0 and new["plastic"] >= self.failure:
            new["failed"], new["s"] = True, np.zeros((3, 3))

    def volume(self, new, step, work):
        if not new["failed"]:
            super().volume(new, step, work)
        else:
            # no pressure at the end of the step
            new["energy"] += work - 0.5 * new["p"] * (step.after - step.before)
            new["p"] = 0.0


class JohnsonCook(WithPressure):
    """*MAT_JOHNSON_COOK with the temperature of the start of the step, spall 1 to 3 and damage D1 to D5."""

    def __init__(self, rho, shear, constants, temperatures, heat, eos, cutoff=0.0, spall=2, damage=None, efmin=1.0e-6, vp=1):
        super().__init__(shear, eos, cutoff)
        self.rho, self.heat = rho, heat
        self.a, self.b, self.n, self.c, self.m, self.reference = constants
        self.melt, self.room = temperatures
        self.first_temperature = self.room
        self.spall, self.damage, self.efmin, self.vp = spall, damage, efmin, vp

    def homologous(self, temperature):
        return min(1.0, max(0.0, (temperature - self.room) / (self.melt - self.room)))

    def logarithm(self, rate):
        return np.log(max(1.0, rate / self.reference))

    def flow_stress(self, plastic, rate, new, step):
        return ((self.a + self.b * plastic ** self.n) * (1.0 + self.c * self.logarithm(self.rate(rate, step)))
                * (1.0 - self.homologous(new["temperature"]) ** self.m))

    def least_pressure(self, new):
        if new["failed"]:
            return 0.0
        return self.cutoff if self.spall == 1 and self.cutoff < 0.0 else None

    def rate(self, plastic_rate, step):
        return plastic_rate if self.vp == 1 else np.sqrt(2.0 / 3.0) * step.deviatoric_rate

    def deviator(self, new, trial, step):
        super().deviator(new, trial, step)
        growth, stress = new["growth"], mises(new["s"])
        if growth > 0.0 and self.damage is not None:
            # the mean stress of the start of the step: the pressure waits for the work of the deviator
            more = growth / self.failure_strain(new, self.rate(growth / step.dt, step), stress)
            new["damage"] = min(1.0, new["damage"] + more)
        if growth > 0.0:
            new["temperature"] += stress * growth * step.middle / (self.rho * self.heat)
        if new["damage"] >= 1.0:
            new["failed"], new["s"] = True, np.zeros((3, 3))

    def end_of_step(self, new, step):
        if self.is_spalled(new):
            new["failed"], new["damage"] = True, max(1.0, new["damage"])

    def failure_strain(self, new, rate, stress):
        d1, d2, d3, d4, d5 = self.damage
        triaxiality = -new["p"] / stress
        strain = ((d1 + d2 * np.exp(d3 * triaxiality)) * (1.0 + d4 * self.logarithm(rate))
                  * (1.0 + d5 * self.homologous(new["temperature"])))
        return max(strain, self.efmin)

    def is_spalled(self, new):
        if self.cutoff >= 0.0 or self.spall == 1:
            return False
        if self.spall == 3:
            return new["p"] < self.cutoff
        return np.max(np.linalg.eigvalsh(new["s"] - new["p"] * ONE)) >= -self.cutoff


class Null(WithPressure):
    """*MAT_NULL: viscous deviator 2 mu D'."""

    def __init__(self, viscosity, eos, cutoff=0.0):
        super().__init__(0.0, eos, cutoff)
        self.viscosity = viscosity

    def deviator(self, new, trial, step):
        new["s"] = 2.0 * self.viscosity * deviator(step.strain) / step.dt


class Hyperelastic:
    """Stress and energy are functions of F alone."""

    def at_rest(self):
        return {"stress": np.zeros((3, 3)), "energy": 0.0}

    def advance(self, state, step):
        b, j = step.gradient @ step.gradient.T, step.after
        return {"stress": self.stress(b, j), "energy": self.energy(b, j)}

    def result(self, state):
        return {"stress": state["stress"], "plastic_strain": 0.0, "temperature": 0.0, "damage": 0.0,
                "energy": state["energy"]}


class MooneyRivlin(Hyperelastic):
    """*MAT_MOONEY-RIVLIN_RUBBER."""

    def __init__(self, poisson, a, b):
        self.a, self.b = a, b
        self.c = 0.5 * a + b
        self.d = (a * (5.0 * poisson - 2.0) + b * (11.0 * poisson - 5.0)) / (2.0 * (1.0 - 2.0 * poisson))

    def stress(self, left, j):
        third = j * j
        volumetric = -2.0 * self.c / third ** 2 + 2.0 * self.d * third * (third - 1.0)
        return 2.0 / j * ((self.a + self.b * np.trace(left)) * left - self.b * left @ left + volumetric * ONE)

    def energy(self, left, j):
        first, third = np.trace(left), j * j
        second = 0.5 * (first ** 2 - np.trace(left @ left))
        return (self.a * (first - 3.0) + self.b * (second - 3.0) + self.c * (third ** -2 - 1.0)
                + self.d * (third - 1.0) ** 2)


class BlatzKo(Hyperelastic):
    """*MAT_BLATZ-KO_RUBBER, Poisson's ratio 0.463."""

    poisson = 0.463

    def __init__(self, shear):
        self.shear = shear

    def stress(self, left, j):
        return self.shear * (left / j - j ** (-1.0 / (1.0 - 2.0 * self.poisson)) * ONE)

    def energy(self, left, j):
        beta = self.poisson / (1.0 - 2.0 * self.poisson)
        return 0.5 * self.shear * (np.trace(left) - 3.0 + (j ** (-2.0 * beta) - 1.0) / beta)


class CrushableFoam(Elastic):
    """*MAT_CRUSHABLE_FOAM, MODEL 0: principal values of the trial stress cut to the curve of 1 - V and to TSC."""

    def __init__(self, young, poisson, curve, tension):
        super().__init__(young, poisson)
        self.curve, self.tension = curve, tension

    def advance(self, state, step):
        new = dict(state)
        old = step.turned(state["s"] - state["p"] * ONE)
        trial = old + 2.0 * self.shear * deviator(step.strain) + self.bulk * np.log(step.after / step.before) * ONE
        values, axes = np.linalg.eigh(trial)
        crush = np.interp(1.0 - step.after, *self.curve)
        stress = axes @ np.diag(np.clip(values, -crush, self.tension)) @ axes.T
        new["s"], new["p"] = deviator(stress), -np.trace(stress) / 3.0
        # work of s by its own strain, of p by the change of volume
        new["energy"] += (0.5 * dot(deviator(old) + new["s"], step.strain) * step.middle
                          - 0.5 * (state["p"] + new["p"]) * (step.after - step.before))
        return new
