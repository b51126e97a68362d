# SPDX-License-Identifier: MIT
"""Roughness of the force of ironing."""
import numpy as np
import pytest

from slideline_tools.studies import ironing


def test_roughness_is_that_of_the_wave_of_an_element():
    """A wave with the period of an element of the slab, on a slow trend."""
    share = np.linspace(0.0, 1.0, ironing.PLACES)
    cells = ironing.ALONG * (ironing.JUDGED[1] - ironing.JUDGED[0]) * ironing.CELLS / ironing.SLAB
    force = 100.0 + 5.0 * share + 2.0 * np.sin(2.0 * np.pi * cells * share)
    rough, largest = ironing.roughness(force, 1)
    assert rough == pytest.approx(2.0 / np.sqrt(2.0) / force.mean(), rel=0.03)
    assert largest == pytest.approx(2.0 / force.mean(), rel=0.05)
