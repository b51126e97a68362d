# SPDX-License-Identifier: MIT
"""Laws with their cards, the Python class that answers to them, and the motions that each goes through."""
import dataclasses
import typing

import numpy as np

import eos
import laws
import paths

RHO = 7800.0
YOUNG, POISSON, SHEAR = 2.0e11, 0.3, 8.0e10
POINTS = ([0.0, 0.01, 0.03, 0.08, 0.2], [3.0e8, 4.0e8, 4.5e8, 4.5e8, 5.0e8])
COPPER = (9.0e7, 2.9e8, 0.31, 0.025, 1.09, 1.0)  # A B n C m reference rate


@dataclasses.dataclass
class Case:
    """cards: keywords with their cards; end: time of the motion; motion: keywords of paths.general."""

    name: str
    cards: typing.Callable
    law: typing.Callable
    end: float = 3.0e-3
    motion: dict = dataclasses.field(default_factory=dict)
    path: typing.Callable = paths.general
    has_eos: bool = False
    fields: tuple = ("plastic_strain",)
    reached: typing.Callable = lambda found: True


def flows(found):
    return found["plastic_strain"][-1] > 0.02


def elastic(deck):
    return deck.elastic(RHO, YOUNG, POISSON)


def plastic(beta, tangent):
    def cards(deck):
        return deck.add("*MAT_PLASTIC_KINEMATIC", (1, RHO, YOUNG, POISSON, 4.0e8, tangent, beta), (0.0, 0.0, 0.0, 0.0))
    return cards


def piecewise(rate=(0.0, 0.0), curve=0, factor=0, points=POINTS):
    def cards(deck):
        deck.add("*MAT_PIECEWISE_LINEAR_PLASTICITY", (1, RHO, YOUNG, POISSON, 0.0, 0.0, 1.0e21, 0.0),
                 (*rate, curve, factor, 0.0))
        if points is not None:
            deck.add("", *[tuple(list(column) + [0.0] * (8 - len(column))) for column in points])
            deck.lines.remove("")
        if factor:
            deck.curve(factor, [(50.0, 1.0), (150.0, 1.2), (400.0, 1.5)])
        if curve:
            deck.add("*DEFINE_TABLE", (curve,), *[(rate,) for rate in RATES])
            for k, row in enumerate(ROWS):
                deck.curve(curve + 1 + k, list(zip(*row)))
        return deck
    return cards


RATES = (50.0, 150.0, 400.0)
ROWS = (([0.0, 0.1], [3.0e8, 4.0e8]), ([0.0, 0.02, 0.1], [3.5e8, 4.2e8, 4.5e8]), ([0.0, 0.05], [5.0e8, 5.2e8]))
FALLING = ([0.0, 0.05, 0.1, 0.2], [3.0e8, 4.0e8, 3.0e8, 2.5e8])

EXISTING = [
    Case("001 elastic", elastic, lambda: laws.Elastic(YOUNG, POISSON), fields=()),
    Case("003 isotropic", plastic(1.0, 2.0e10), lambda: laws.PlasticKinematic(YOUNG, POISSON, 4.0e8, 2.0e10, 1.0),
         reached=flows),
    Case("003 mixed", plastic(0.3, 2.0e10), lambda: laws.PlasticKinematic(YOUNG, POISSON, 4.0e8, 2.0e10, 0.3),
         reached=flows),
    Case("003 kinematic", plastic(0.0, 2.0e10), lambda: laws.PlasticKinematic(YOUNG, POISSON, 4.0e8, 2.0e10, 0.0),
         reached=flows),
    Case("003 perfect", plastic(1.0, 0.0), lambda: laws.PlasticKinematic(YOUNG, POISSON, 4.0e8, 0.0, 1.0),
         reached=flows),
    Case("024 points", piecewise(), lambda: laws.PiecewiseLinear(YOUNG, POISSON, [POINTS]), reached=flows),
    Case("024 falling", piecewise(points=FALLING), lambda: laws.PiecewiseLinear(YOUNG, POISSON, [FALLING]),
         reached=flows),
    Case("024 Cowper-Symonds", piecewise((300.0, 4.0)),
         lambda: laws.PiecewiseLinear(YOUNG, POISSON, [POINTS], cowper_symonds=(300.0, 4.0)), reached=flows),
    Case("024 factor", piecewise(factor=80),
         lambda: laws.PiecewiseLinear(YOUNG, POISSON, [POINTS],
                                      factors=([50.0, 150.0, 400.0], [1.0, 1.2, 1.5])), reached=flows),
    Case("024 table", piecewise(curve=500, points=None),
         lambda: laws.PiecewiseLinear(YOUNG, POISSON, ROWS, RATES), reached=flows),
]


def simplified_johnson_cook(vp, sigmax=0.0, sigsat=0.0):
    def cards(deck):
        a, b, n, c, _, reference = COPPER
        return deck.add("*MAT_SIMPLIFIED_JOHNSON_COOK", (1, RHO, YOUNG, POISSON, float(vp)),
                        (a, b, n, c, 0.0, sigmax or None, sigsat or None, reference))

    def law():
        a, b, n, c, _, reference = COPPER
        return laws.SimplifiedJohnsonCook(YOUNG, POISSON, a, b, n, c, reference, vp, sigmax or 1.0e28,
                                          sigsat or 1.0e28)
    return cards, law


POLYNOMIAL = (0.0, 1.4e11, 2.0e11, 1.5e11, 2.0, 1.5, 0.0)
GRUNEISEN = (3940.0, 1.49, 0.1, 0.05, 2.0, 0.47)


def polynomial(deck, c=POLYNOMIAL, energy=0.0):
    return deck.add("*EOS_LINEAR_POLYNOMIAL", (1, *c), (energy, 1.0))


def gruneisen(deck, energy=0.0):
    return deck.add("*EOS_GRUNEISEN", (1, *GRUNEISEN, energy), (1.0,))


def gruneisen_law(energy=0.0):
    return eos.Gruneisen(RHO, *GRUNEISEN, energy)


def johnson_cook(state, state_law, cutoff=0.0, spall=2, damage=None):
    def cards(deck):
        a, b, n, c, m, reference = COPPER
        d = damage or (0.0,) * 5
        deck.add("*MAT_JOHNSON_COOK", (1, RHO, SHEAR, 0.0, 0.0, 0.0, 1.0, 0.0),
                 (a, b, n, c, m, 1356.0, 293.0, reference), (383.0, cutoff, float(spall), 1.0, *d[:4]),
                 (d[4], 0.0, 1.0, 1.0e-6))
        return state(deck)

    def law():
        a, b, n, c, m, reference = COPPER
        return laws.JohnsonCook(RHO, SHEAR, COPPER, (1356.0, 293.0), 383.0, state_law(), cutoff, spall, damage)
    return cards, law


def with_viscosity(cards, law, quadratic=1.5, linear=0.06):
    def both(deck):
        return cards(deck.add("*CONTROL_BULK_VISCOSITY", (quadratic, linear)))

    def viscous():
        made = law()
        made.bulk_viscosity = (RHO, quadratic, linear)
        return made
    return both, viscous


def hydro(state, state_law, cutoff=0.0, failure=0.0, points=None):
    def cards(deck):
        columns = [[0.0] * 8] * 4
        if points is not None:
            padded = [list(column) + [0.0] * (16 - len(column)) for column in points]
            columns = [padded[0][:8], padded[0][8:], padded[1][:8], padded[1][8:]]
        deck.add("*MAT_ELASTIC_PLASTIC_HYDRO", (1, RHO, SHEAR, 3.0e8, 1.0e9, cutoff, failure), *columns)
        return state(deck)
    return cards, lambda: laws.ElasticPlasticHydro(SHEAR, 3.0e8, 1.0e9, state_law(), cutoff, failure, points)


def null(viscosity, cutoff):
    def cards(deck):
        return polynomial(deck.add("*MAT_NULL", (1, 1000.0, cutoff, viscosity)), WATER, 1.0e6)
    return cards, lambda: laws.Null(viscosity, eos.LinearPolynomial(WATER, 1.0e6), cutoff)


WATER = (0.0, 2.2e9, 8.0e9, 1.0e10, 0.3, 0.2, 0.0)


def mooney_rivlin(deck):
    return deck.add("*MAT_MOONEY-RIVLIN_RUBBER", (1, 1000.0, 0.49, 4.0e5, 1.0e5, 0.0), (0.0, 0.0, 0.0, 0))


def blatz_ko(deck):
    return deck.add("*MAT_BLATZ-KO_RUBBER", (1, 1000.0, 1.0e6, 0.0))


FOAM = ([0.0, 0.05, 0.4, 0.7], [2.0e5, 2.5e5, 4.0e5, 2.0e6])


def foam(poisson):
    def cards(deck):
        deck.add("*MAT_CRUSHABLE_FOAM", (1, 100.0, 1.0e7, poisson, 90, 1.0e5, 0.0, 0))
        return deck.curve(90, list(zip(*FOAM)))
    return cards, lambda: laws.CrushableFoam(1.0e7, poisson, FOAM, 1.0e5)


def pressure(found):
    return -np.trace(found["stress"], axis1=1, axis2=2) / 3.0


def reaches(cutoff):
    return lambda found: np.min(pressure(found)) <= cutoff * (1.0 - 1.0e-12)


def breaks(found):
    """No deviator at the end, but some before."""
    deviator = found["stress"] + pressure(found)[:, None, None] * np.eye(3)
    return np.max(np.abs(deviator[-1])) <= 1.0e-12 * np.max(np.abs(deviator))


def crushes(found):
    return np.max(pressure(found)) > 0.5e5


def heats(found):
    return flows(found) and found["temperature"][-1] > 300.0


def linear():
    return eos.LinearPolynomial(POLYNOMIAL)


METAL = ("plastic_strain", "temperature", "damage")
#: failure strain of some tenths
BRITTLE = (0.1, 0.4, -1.5, 0.01, 1.1)
SLOW = {"end": 3.0e-2}
NEW = [
    Case("098 VP 1", *simplified_johnson_cook(1), reached=flows),
    Case("098 VP 0", *simplified_johnson_cook(0), reached=flows),
    Case("098 SIGMAX, SIGSAT", *simplified_johnson_cook(1, 2.2e8, 2.4e8), reached=flows),
    Case("015 polynomial", *johnson_cook(polynomial, linear), has_eos=True, fields=METAL, reached=heats),
    Case("015 Gruneisen", *johnson_cook(gruneisen, gruneisen_law), has_eos=True, fields=METAL, reached=heats),
    Case("015 damage", *johnson_cook(gruneisen, gruneisen_law, damage=BRITTLE), has_eos=True, fields=METAL,
         reached=lambda found: np.max(found["damage"]) >= 1.0 and breaks(found)),
    Case("015 spall 1", *johnson_cook(gruneisen, gruneisen_law, -3.0e8, 1), has_eos=True, fields=METAL,
         reached=reaches(-3.0e8)),
    Case("015 spall 2", *johnson_cook(gruneisen, gruneisen_law, -2.0e9, 2), has_eos=True, fields=METAL,
         reached=breaks),
    Case("015 spall 3", *johnson_cook(gruneisen, gruneisen_law, -2.0e9, 3), has_eos=True, fields=METAL,
         reached=breaks),
    Case("015 bulk viscosity", *with_viscosity(*johnson_cook(gruneisen, gruneisen_law)), has_eos=True, fields=METAL,
         reached=heats),
    Case("010 polynomial", *hydro(polynomial, linear), has_eos=True, reached=flows),
    Case("010 failure strain", *hydro(polynomial, linear, 0.0, 0.15), has_eos=True, reached=breaks),
    Case("010 points, cut-off", *hydro(gruneisen, gruneisen_law, -3.0e8, 0.0, POINTS), has_eos=True, reached=reaches(-3.0e8)),
    Case("009 viscous", *null(10.0, 0.0), has_eos=True, fields=()),
    Case("009 cut-off", *null(0.0, -1.0e6), has_eos=True, fields=(), reached=reaches(-1.0e6)),
    Case("027 one F", mooney_rivlin, lambda: laws.MooneyRivlin(0.49, 4.0e5, 1.0e5), path=paths.homogeneous,
         fields=(), **SLOW),
    Case("007 one F", blatz_ko, lambda: laws.BlatzKo(1.0e6), path=paths.homogeneous, fields=(), **SLOW),
    Case("027 distorted", mooney_rivlin, lambda: laws.MooneyRivlin(0.49, 4.0e5, 1.0e5), fields=(), **SLOW),
    Case("007 distorted", blatz_ko, lambda: laws.BlatzKo(1.0e6), fields=(), **SLOW),
    Case("063 PR 0", *foam(0.0), fields=(), motion={"volume": 0.4}, reached=crushes, **SLOW),
    Case("063 PR 0.2", *foam(0.2), fields=(), motion={"volume": 0.4}, reached=crushes, **SLOW),
]
