"""Solids are closed, as large as asked for, and where they should be."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from robots_core.robot_model.shapes import Mesh
from solids import block, hub, outline, pedestal, plate, stl, tapered_arm, tube

# An outline has 40 points on its circles: a polygon's half width is at least cos(pi / 40) of the radius.
ROUND = 1.0 - np.cos(np.pi / 40)

SOLIDS = {
    'hub': hub((0.1, 0.2, 0.3), 'y', 0.2, 0.3),
    'hub on a slant': hub((0.0, 0.0, 0.0), (1.0, 2.0, -0.5), 0.1, 0.4),
    'tube': tube((0.0, 0.0, 0.0), (1.0, 0.0, 1.0), 0.2, 0.1),
    'tapered arm': tapered_arm((0.0, 0.0, 0.0), (1.0, 0.0, 0.2), 0.2, 0.1, axis='y', width=0.2),
    'block': block((0.0, 0.0, 0.5), (0.2, 0.4, 0.6), axis='x'),
    'plate': plate(((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.0, 1.0)), axis='y', width=0.1, rounding=0.05),
    'pedestal': pedestal((0.0, 0.0, 0.0), (0.1, 0.0, 0.5), (0.8, 0.6), (0.4, 0.4)),
}


def _mesh(solid: Mesh) -> trimesh.Trimesh:
    return trimesh.Trimesh(solid.vertices, solid.faces)


@pytest.mark.parametrize('name', SOLIDS)
def test_surface_is_closed_and_faces_outwards(name: str):
    mesh = _mesh(SOLIDS[name])
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0.0


@pytest.mark.parametrize('name', SOLIDS)
def test_solid_is_convex(name: str):
    mesh = _mesh(SOLIDS[name])
    # Equal up to the flat facets that a twisted loft face is split into.
    assert mesh.volume == pytest.approx(mesh.convex_hull.volume, rel=1e-3)


def test_hub_has_its_radius_length_and_centre():
    mesh = _mesh(hub((0.1, 0.2, 0.3), 'y', 0.2, 0.3))
    np.testing.assert_allclose(mesh.extents, [0.4, 0.3, 0.4], rtol=ROUND)
    np.testing.assert_allclose(mesh.bounds.mean(axis=0), [0.1, 0.2, 0.3], atol=1e-12)


def test_tube_has_the_volume_of_a_truncated_cone():
    r, R, length = 0.1, 0.2, 0.8
    mesh = _mesh(tube((0.0, 0.0, 0.0), (length, 0.0, 0.0), r, R, chamfer=1e-4))
    volume = np.pi * length * (r * r + r * R + R * R) / 3.0
    assert mesh.volume == pytest.approx(volume, rel=2.0 * ROUND + 2e-3)  # area goes with the radius squared


def test_tapered_arm_reaches_around_both_ends():
    mesh = _mesh(tapered_arm((0.0, 0.1, 0.0), (1.0, 0.1, 0.0), 0.2, 0.1, axis='y', width=0.3))
    np.testing.assert_allclose(mesh.bounds[:, 0], [-0.2, 1.1], atol=0.2 * ROUND)
    np.testing.assert_allclose(mesh.bounds[:, 1], [-0.05, 0.25], atol=1e-12)


@pytest.mark.parametrize('axis', ['x', 'y', 'z'])
def test_block_has_its_size_whichever_edges_are_rounded(axis: str):
    size, centre = (0.2, 0.4, 0.6), (1.0, 2.0, 3.0)
    mesh = _mesh(block(centre, size, axis=axis))
    np.testing.assert_allclose(mesh.extents, size, rtol=ROUND)
    np.testing.assert_allclose(mesh.bounds.mean(axis=0), centre, atol=1e-12)


def test_outline_goes_counter_clockwise_around_all_circles():
    circles = [(0.0, 0.0, 0.3), (1.0, 0.5, 0.1), (0.2, 0.1, 0.05)]
    points = outline(circles)
    edges = np.roll(points, -1, axis=0) - points
    following = np.roll(edges, -1, axis=0)
    assert (edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0] >= -1e-12).all()
    for x, y, radius in circles:
        outward = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1)[:, None]
        distance = ((points - (x, y)) * outward).sum(axis=1)
        # An edge between two circles is tangent to both up to one step of direction.
        assert (distance >= radius * np.cos(2.0 * np.pi / len(points)) - 1e-12).all()


def test_stl_holds_every_solid():
    data = stl([SOLIDS['hub'], SOLIDS['block']])
    faces = len(SOLIDS['hub'].faces) + len(SOLIDS['block'].faces)
    assert len(data) == 84 + 50 * faces  # the format's header, and 50 bytes per triangle
