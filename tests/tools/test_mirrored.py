# SPDX-License-Identifier: MIT
"""Pictures of both halves of a model."""
import types

import numpy as np

from slideline_tools.mirrored import Mirrored


def one_quad_and_triangle():
    """A quad and a triangle right of x = 0, with a vector and a stress."""
    points = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.5, 2.0, 0.0]]])
    return types.SimpleNamespace(
        points=points, cells=np.array([[0, 1, 2, 3], [3, 2, 4, 4]]), n_node=5, n_cell=2, times=np.array([0.0]),
        point_field=lambda name: points + [1.0, 2.0, 0.0], cell_field=lambda name: np.arange(12.0).reshape(1, 2, 6))


def area(points, cells):
    corner = points[cells][:, :, :2]
    p, q = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    return 0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])


def test_image_has_the_same_areas_on_the_other_side():
    results = Mirrored(one_quad_and_triangle())
    areas = area(results.points[0], results.cells)
    assert np.allclose(areas, [1.0, 0.5, 1.0, 0.5])
    assert np.array_equal(results.points[0, 5:], results.points[0, :5] * [-1.0, 1.0, 1.0])
    assert results.n_node == 10 and results.n_cell == 4 and results.times[0] == 0.0


def test_vectors_and_shear_turn_round():
    results = Mirrored(one_quad_and_triangle())
    moved = results.point_field("displacement")[0]
    assert np.array_equal(moved[5:], moved[:5] * [-1.0, 1.0, 1.0])
    stress = results.cell_field("stress")[0]
    assert np.array_equal(stress[2:], stress[:2] * [1.0, 1.0, 1.0, -1.0, 1.0, -1.0])
