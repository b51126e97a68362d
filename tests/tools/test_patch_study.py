# SPDX-License-Identifier: MIT
"""The patch test study: relaxation numbers, meshes, texts."""
import numpy as np
import pytest

from slideline_tools.scenes.patch import even_lines, patch_grids, relaxation, uneven_lines
from slideline_tools.studies import patch


def test_default_blocks_are_five_above_four():
    lower, upper = patch_grids()
    assert (len(lower.upper), len(upper.lower)) == (5, 6)
    assert lower.points[0, -1, 1] == upper.points[0, 0, 1] == 0.0


def test_relaxation_grows_with_a_softer_interface_and_a_stiffer_one_needs_smaller_steps():
    grids = patch_grids()
    soft, middle, stiff = (relaxation(*grids, penalty) for penalty in (1e3, 1e6, 1e10))
    assert soft[0] < middle[0] <= stiff[0] < 18.01
    assert soft[2] > middle[2] >= stiff[2]
    assert stiff[1] < 0.02 * middle[1]
    # A step of L/c of the smaller quads (0.2 m, 31.6 m/s) is an upper bound.
    assert soft[1] < 0.2 / np.sqrt(1000.0)


@pytest.mark.parametrize("layout", patch.LAYOUTS)
def test_meshes_cover_the_metre_and_do_not_match(layout):
    lower, upper = patch.layout_grids(layout)
    for grid in (lower, upper):
        x = grid.points[:, 0, 0]
        assert x[0] == 0.0 and x[-1] == 1.0 and np.all(np.diff(x) > 0.0)
    assert not set(lower.points[1:-1, 0, 0]) == set(upper.points[1:-1, 0, 0])


def test_uneven_lines_keep_the_ends():
    assert np.array_equal(uneven_lines(5, 0.0), even_lines(5))
    assert np.ptp(np.diff(uneven_lines(5, 0.3))) > 0.1
