"""farthest_vertices: no direction has its farthest vertex among those that are left out."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from robots_core.blocks.collision.distances.farthest_vertices import CELLS, farthest_vertices
from robots_core.blocks.collision.distances.nearest_points import cell_of
from robots_core.blocks.collision.solids import Solid
from robots_core.pose import Pose
from robots_core.robot_model.shapes import Box, Mesh

RNG = np.random.default_rng(2)
BALL = RNG.normal(size=(160, 3))
BALL /= np.linalg.norm(BALL, axis=1)[:, None]
TURNS = np.arange(40) * (2.0 * np.pi / 40.0)
# Of a drum, many vertices are equally far in many directions.
DRUM = np.array([[np.cos(turn), np.sin(turn), z] for turn in TURNS for z in (-0.3, 0.3)])
SHAPES = {'ball': BALL, 'drum': DRUM, 'sheet': BALL * [1.0, 1.0, 0.0], 'far_away': 0.01 * BALL + 5.0}
EDGES = np.array([d for d in product((-1.0, -0.5, 0.0, 0.5, 1.0), repeat=3) if any(d)])


@pytest.mark.parametrize('vertices', SHAPES.values(), ids=SHAPES)
def test_the_farthest_vertex_is_one_of_its_cell(vertices: np.ndarray):
    places, chosen = farthest_vertices(vertices)
    for direction in np.concatenate([EDGES, RNG.normal(size=(1000, 3)), DRUM, -BALL]):
        cell = cell_of(*direction)
        assert 0 <= cell < CELLS
        some = chosen[places[cell] : places[cell + 1]]
        along = vertices @ direction
        assert along[some].max() == along.max()
        assert (np.diff(some) > 0).all()


def test_few_of_many_vertices_are_looked_at():
    _, chosen = farthest_vertices(BALL)
    assert chosen.size / CELLS < 0.1 * len(BALL)


def test_a_solid_with_few_vertices_or_hollows_has_none():
    faces = np.array([[0, 1, 2]])
    here = Pose.identity()
    assert Solid('box', Box((1.0, 1.0, 1.0)), 0, here).farthest is None
    assert Solid('surface', Mesh(BALL, faces), 0, here, convex=False).farthest is None
    assert Solid('hull', Mesh(BALL, faces), 0, here).farthest is not None
