"""The camera of the robot's page: everything is in the picture, and the tool is not hidden."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks import Scene, SceneObject
from robots_core.blocks.page_camera import (
    FIELD_OF_VIEW,
    UP,
    VIEWS,
    CameraView,
    PlacedBounds,
    View,
    camera_view,
)
from robots_core.blocks.visualizer import Visualizer
from robots_core.robot_model.shapes import Box
from robots_core.validation import Array

JOINTS = np.array([[0.0, 0.0, 0.3], [0.0, 0.0, 0.9]])
TOOL = np.array([0.6, 0.1, 0.5])


def box(centre: tuple[float, ...], size: tuple[float, ...], turn: float = 0.0) -> PlacedBounds:
    half = 0.5 * np.array(size)
    return PlacedBounds(np.array([-half, half]), Pose.from_angles(centre, [turn, 0.0, 0.0]))


def view_of(view: View, *scene: PlacedBounds) -> CameraView:
    return camera_view(view, reach=1.2, joints=JOINTS, tool=TOOL, scene=scene)


def off_axis(view: CameraView, point: Array) -> float:
    """Angle between the middle of the picture and a point, rad."""
    forward, ray = view.look_at - view.position, point - view.position
    return float(np.arccos(forward @ ray / np.linalg.norm(forward) / np.linalg.norm(ray)))


@pytest.mark.parametrize('view', [view for view in VIEWS if view != 'tool'])
def test_robot_and_scene_are_in_the_picture(view: View):
    table = box((0.9, -1.4, 0.2), (0.8, 0.6, 0.7), turn=0.4)
    found = view_of(view, table)
    for point in (*JOINTS, TOOL, *table.corners):
        # Up to the corner of a picture that is 1.2 times as wide as high.
        assert off_axis(found, point) <= np.arctan(np.hypot(1.0, 1.2) * np.tan(0.5 * FIELD_OF_VIEW)) + 1e-9
    assert abs(np.cross(found.up, found.look_at - found.position)).max() > 0.0


@pytest.mark.parametrize('view', ['all', 'tool'])
def test_a_roof_does_not_hide_the_tool(view: View):
    roof = box((0.4, 0.0, 0.75), (1.6, 1.6, 0.02))
    wall = box((0.6, -0.8, 0.5), (3.0, 0.02, 2.0))
    for scene in ((roof,), (wall,), (roof, wall)):
        found = view_of(view, *scene)
        assert not any(item.crossed(TOOL, found.position) for item in scene)


def test_a_line_crosses_a_box_that_is_between_its_ends():
    item = box((1.0, 0.0, 0.0), (0.2, 0.2, 0.2), turn=0.5)
    start = np.zeros(3)
    assert item.crossed(start, np.array([2.0, 0.0, 0.0]))
    assert not item.crossed(start, np.array([0.8, 0.0, 0.0]))
    assert not item.crossed(start, np.array([2.0, 1.0, 0.0]))
    assert not item.crossed(start, np.array([-2.0, 0.0, 0.0]))


def test_a_large_floor_does_not_make_the_robot_small():
    near, far = (view_of('all', box((0.0, 0.0, -0.1), (size, size, 0.1))) for size in (4.0, 400.0))
    distance = [np.linalg.norm(view.position - view.look_at) for view in (near, far)]
    assert distance[1] < 1.5 * distance[0]


def test_browsers_begin_with_a_view_of_the_scene():
    page = Visualizer(load_robot_model('ur5e'), port=0)
    try:
        camera = page._server.initial_camera
        before = np.array(camera.position)
        assert camera.fov == FIELD_OF_VIEW
        table = SceneObject('table', Box((3.0, 3.0, 0.1)), Pose([0.0, 1.0, -0.3], np.eye(3)))
        page.show_scene(Scene((table,)))
        assert np.linalg.norm(camera.position) > np.linalg.norm(before)
        assert UP @ (np.array(camera.position) - camera.look_at) > 0.0
    finally:
        page.close()
