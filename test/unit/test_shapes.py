"""Shapes: sizes that no cell has are refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from robots_core.errors import InvalidInputError
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere

FACE = np.array([[0, 1, 2]])


@pytest.mark.parametrize('size', [0.0, -1.0, 5e-324, 1e200, np.inf, np.nan])
@pytest.mark.parametrize(
    'make',
    [
        lambda size: Box((1.0, size, 1.0)),
        lambda size: Cylinder(1.0, size),
        lambda size: Cylinder(size, 1.0),
        lambda size: Capsule(1.0, size),
        Sphere,
    ],
)
def test_a_size_that_no_body_has_is_refused(make: Callable[[float], Geometry], size: float):
    with pytest.raises(InvalidInputError, match=r'must be'):
        make(size)


@pytest.mark.parametrize('place', [1e200, -np.inf, np.nan])
def test_a_mesh_stays_near_its_origin(place: float):
    with pytest.raises(InvalidInputError, match='vertex'):
        Mesh(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, place, 0.0]]), FACE)
