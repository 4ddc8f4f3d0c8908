"""Markers to scenes and back."""

from __future__ import annotations

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from visualization_msgs.msg import Marker, MarkerArray

from robots_core import Pose
from robots_core.blocks import AttachedObject, Scene, SceneObject
from robots_core.blocks.collision.scene import OBJECT_COLOUR
from robots_core.errors import InvalidInputError
from robots_core.nodes.watched_scene import updated_scene
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Geometry, Mesh, Sphere
from robots_core.robot_model.urdf.triangle_mesh import triangle_mesh
from scene_markers import markers

POSE = Pose.from_angles([0.1, 0.2, 0.3], [0.4, 0.5, 0.6])


@pytest.mark.parametrize(
    'geometry', [Box((0.1, 0.2, 0.3)), Sphere(0.2), Cylinder(0.1, 0.5), Capsule(0.1, 0.5)]
)
def test_objects_survive_a_message(geometry: Geometry):
    scene = Scene((SceneObject('a', geometry, POSE),), (AttachedObject('b', geometry, POSE),))
    found = updated_scene(Scene(), markers(scene, Time()))
    for item in (*found.objects, *found.attached):
        if isinstance(geometry, Capsule):  # there is no such marker: it travels as triangles
            assert isinstance(item.geometry, Mesh)
            corners = item.geometry.vertices[item.geometry.faces]
            np.testing.assert_allclose(corners, triangle_mesh(geometry).triangles, atol=1e-12)
        else:
            assert item.geometry == geometry
        np.testing.assert_allclose(item.pose.r, POSE.r, atol=1e-12)
        np.testing.assert_allclose(item.pose.T, POSE.T, atol=1e-12)
    assert ([item.name for item in found.objects], [item.name for item in found.attached]) == (['a'], ['b'])


@pytest.mark.parametrize(
    ('channels', 'colour'),
    [
        ((0.25, 0.5, 0.75, 1.0), (0.25, 0.5, 0.75, 1.0)),
        ((-3.0, 255.0, np.inf, 0.5), (0.0, 1.0, 1.0, 0.5)),
        ((0.5, np.nan, 0.5, 1.0), OBJECT_COLOUR),
    ],
)
def test_an_obstacle_counts_whatever_its_colour_is(channels: tuple[float, ...], colour: tuple[float, ...]):
    message = markers(Scene((SceneObject('a', Sphere(0.1), POSE),)), Time())
    c = message.markers[0].color
    c.r, c.g, c.b, c.a = channels
    assert [item.colour for item in updated_scene(Scene(), message).objects] == [colour]


def test_objects_are_replaced_and_deleted_by_name():
    scene = Scene((SceneObject('a', Sphere(0.1), POSE), SceneObject('b', Sphere(0.1), POSE)))
    marker = markers(Scene((SceneObject('b', Sphere(0.4), POSE),)), Time()).markers[0]
    marker.header.frame_id = 'base_link'  # the other name of the robot's base in REP-199
    found = updated_scene(scene, MarkerArray(markers=[Marker(ns='a', action=Marker.DELETE), marker]))
    assert [(item.name, item.geometry) for item in found.objects] == [('b', Sphere(0.4))]
    turned = Pose(np.zeros(3), np.diag([-1.0, -1.0, 1.0]))  # of robots whose maker has it elsewhere
    found = updated_scene(scene, MarkerArray(markers=[marker]), turned)
    assert found.objects[-1].pose.distance_to(turned @ POSE) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert updated_scene(found, MarkerArray(markers=[Marker(action=Marker.DELETEALL)])).objects == ()


@pytest.mark.parametrize(
    ('kind', 'scale', 'frame', 'reason'),
    [
        (Marker.ARROW, (1.0, 1.0, 1.0), '', 'marker of type 0'),
        (Marker.SPHERE, (1.0, 2.0, 1.0), '', 'elliptic'),
        (Marker.CUBE, (1.0, 0.0, 1.0), '', 'above 0'),
        (Marker.CUBE, (1.0, float('nan'), 1.0), '', 'nan'),
        (Marker.CUBE, (1.0, 1.0, 1.0), 'camera', "frame 'camera'; known are base, base_link and tool0"),
        (Marker.TRIANGLE_LIST, (1.0, 1.0, 1.0), '', 'has 0 points'),
        (Marker.MESH_RESOURCE, (1.0, 1.0, 1.0), '', 'not found'),
    ],
)
def test_what_is_no_solid_is_refused(kind: int, scale: tuple[float, float, float], frame: str, reason: str):
    marker = Marker(ns='thing', type=kind, mesh_resource='file:///missing.stl')
    marker.header.frame_id = frame
    marker.pose.orientation.w = 1.0
    marker.scale.x, marker.scale.y, marker.scale.z = scale
    with pytest.raises((InvalidInputError, LookupError), match=reason):
        updated_scene(Scene(), MarkerArray(markers=[marker]))
