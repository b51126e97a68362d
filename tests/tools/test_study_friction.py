# SPDX-License-Identifier: MIT
"""Scenes with friction that studies and tests share: predicted flutter, roughness of ironing."""
import numpy as np
import pytest

from slideline_tools.contact_types import ALL_TYPES
from slideline_tools.studies import ironing
from slideline_tools.studies.stability_friction import scene


@pytest.mark.parametrize("ctype", ALL_TYPES)
def test_nothing_grows_without_friction(ctype):
    model, stiffness = scene.flutter(ctype), scene.penalty(1.0)
    rate, _ = model.growth(0.0, stiffness, model.step(stiffness))
    assert abs(rate) < 1.0e-4  # 1/s; 440 with mu 0.5


def test_growth_is_that_of_leap_frog_step_by_step():
    """The same matrices, stepped in time from noise."""
    model, stiffness, friction, mass = scene.flutter(5), scene.penalty(1.0), 0.5, 300.0
    step = model.step(stiffness)
    matrix = model.model.stiffness.copy()
    pressed = stiffness * model.springs
    matrix[1::2, 1::2] += pressed
    matrix[0::2, 1::2] -= friction * pressed
    free = model.model.free
    matrix = (matrix / np.repeat(model.model.mass, 2)[:, None])[np.ix_(free, free)]
    damp = 0.5 * mass * step
    before = np.random.default_rng(1).standard_normal(free.sum()) * 1.0e-9
    now, sizes = before.copy(), []
    for number in range(2400):
        before, now = now, (2.0 * now - (1.0 - damp) * before - step ** 2 * (matrix @ now)) / (1.0 + damp)
        if number >= 1200:
            sizes.append(np.sum(now ** 2))
    third = len(sizes) // 3
    measured = 0.5 * np.log(np.sum(sizes[-third:]) / np.sum(sizes[:third])) / (2 * third * step)
    assert measured == pytest.approx(model.growth(friction, stiffness, step, mass)[0], rel=0.03)


def test_roughness_is_that_of_the_wave_of_an_element():
    """A wave with the period of an element of the slab, on a slow trend."""
    share = np.linspace(0.0, 1.0, ironing.PLACES)
    cells = ironing.ALONG * (ironing.JUDGED[1] - ironing.JUDGED[0]) * ironing.CELLS / ironing.SLAB
    force = 100.0 + 5.0 * share + 2.0 * np.sin(2.0 * np.pi * cells * share)
    rough, largest = ironing.roughness(force, 1)
    assert rough == pytest.approx(2.0 / np.sqrt(2.0) / force.mean(), rel=0.03)
    assert largest == pytest.approx(2.0 / force.mean(), rel=0.05)
