"""Visualizer: a page is served, shows every shape, and places it where the robot is."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from urllib.request import urlopen

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, available_robot_models, load_robot_model
from robots_core.blocks import HalfSpace, PlacedBox, Scene, Zone
from robots_core.blocks.direct_kinematics import DirectKinematics
from robots_core.blocks.tool_trace import CHUNK, CHUNKS, JUMP, LONGEST_TRACE, SPACING
from robots_core.blocks.visualizer import Visualizer
from robots_core.errors import InvalidInputError
from robots_core.free_port import free_port
from robots_core.robot_model.shapes import Box
from robots_core.robot_model.stretched_length import stretched_length
from robots_core.validation import Array

LOCAL = '127.0.0.1'


@pytest.fixture(scope='module', params=available_robot_models())
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return load_robot_model(request.param)


@pytest.fixture(scope='module')
def visualizer(robot: BaseRobotModel) -> Iterator[Visualizer]:
    page = Visualizer(robot, port=0)
    yield page
    page.close()


def _pose(handle: object) -> Pose:
    w, x, y, z = handle.wxyz  # type: ignore[attr-defined]
    return Pose.from_quaternion(handle.position, [x, y, z, w])  # type: ignore[attr-defined]


def _assert_at(handle: object, r: Array, T: Array) -> None:
    distance, angle = _pose(handle).distance_to(Pose(r, T))
    assert distance < 1e-6  # the page may keep single precision
    assert angle < 1e-6


def test_page_is_served(visualizer: Visualizer):
    with urlopen(visualizer.url, timeout=240.0) as page:  # noqa: S310  # our own address
        assert page.status == 200
        assert b'<html' in page.read()


def test_frames_follow_the_robot(robot: BaseRobotModel, visualizer: Visualizer):
    tool = DirectKinematics(robot)
    for q in (robot.home, robot.home + 0.1, robot.home - 0.2):
        visualizer.update(q)
        r, T = robot.kinematic_model.frame_axes(q)
        for index, frame in enumerate(visualizer._frames[1:]):
            _assert_at(frame, r[index], T[index])
        pose = tool.forward(q)
        _assert_at(visualizer._tool_frame, pose.r, pose.T)
    _assert_at(visualizer._frames[0], np.zeros(3), np.eye(3))


def test_a_ghost_stands_elsewhere_until_it_is_gone(robot: BaseRobotModel, visualizer: Visualizer):
    q = np.array(robot.home) + 0.1
    for _ in range(2):
        visualizer.show_ghost(q)
        r, _T = robot.kinematic_model.frame_axes(q)
        np.testing.assert_allclose([frame.position for frame in visualizer._ghost[1:]], r, atol=1e-6)
        assert all(frame.visible for frame in visualizer._ghost)
        visualizer.show_ghost(None)
        assert not any(frame.visible for frame in visualizer._ghost)


def test_the_way_of_a_tool_that_nobody_watched_is_shown_to_the_next_browser(
    visualizer: Visualizer, robot: BaseRobotModel, monkeypatch: pytest.MonkeyPatch
):
    before = _pose(visualizer._tool_frame)
    way = [robot.home + angle for angle in np.linspace(0.0, 0.1, 20)]
    for q in way[:-1]:
        visualizer.follow(q)
    for _ in range(LONGEST_TRACE + 1):  # it stands for minutes
        visualizer.follow(way[-2])
    assert before.distance_to(_pose(visualizer._tool_frame)) == (0.0, 0.0)
    monkeypatch.setattr(Visualizer, 'watched', True)
    visualizer.follow(way[-1])
    pose = DirectKinematics(robot).forward(way[-1])
    _assert_at(visualizer._tool_frame, pose.r, pose.T)
    assert len(visualizer._trace._points) > 10


def test_every_shape_hangs_below_its_frame(robot: BaseRobotModel, visualizer: Visualizer):
    for shape in robot.visualization.shapes:
        frame = visualizer._frames[shape.frame].name
        handle = visualizer._server.scene.get_handle_by_name(f'{frame}/{shape.name}')
        assert handle is not None, shape.name
        _assert_at(handle, shape.pose.r, shape.pose.T)
    assert len(visualizer._collision) == len(robot.collision_model.shapes)


def test_zones_are_shown_where_they_are():
    pose = Pose.from_angles([0.5, 0.2, 0.4], [0.3, 0.2, 0.1])
    zones = (
        Zone('press', PlacedBox(Box((0.2, 0.3, 0.4)), pose), 'out', 'tool'),
        Zone('wall', HalfSpace([0.0, 0.8, 0.0], [0.0, 3.0, 4.0]), 'out', 'tool'),
    )
    page = Visualizer(load_robot_model('ur5e'), port=0)
    try:
        page.show_scene(Scene(zones=zones))
        press, wall = page._scene
        _assert_at(press, pose.r, pose.T)
        np.testing.assert_allclose(_pose(wall).T[:, 2], [0.0, 0.6, 0.8], atol=1e-6)
        page.show_scene(Scene())
        assert not page._scene
    finally:
        page.close()


@pytest.mark.parametrize('bad', ['nan', 'short'])
def test_bad_positions_are_refused_and_change_nothing(
    robot: BaseRobotModel, visualizer: Visualizer, bad: str
):
    q = np.full(robot.num_axes, np.nan) if bad == 'nan' else robot.home[1:]
    before = _pose(visualizer._tool_frame)
    with pytest.raises(InvalidInputError):
        visualizer.update(q)
    assert before.distance_to(_pose(visualizer._tool_frame)) == (0.0, 0.0)


def test_says_nothing_on_the_console(capfd: pytest.CaptureFixture[str]):
    Visualizer(load_robot_model('bello_bot'), port=0).close()
    assert capfd.readouterr() == ('', '')


def test_busy_port_gives_way_to_the_next_free_one():
    with socket.create_server((LOCAL, 0)) as busy:
        port = busy.getsockname()[1]
        page = Visualizer(load_robot_model('bello_bot'), port=port)
        try:
            assert page.url.startswith(f'http://{LOCAL}:')
            assert int(page.url.rpartition(':')[2]) > port
        finally:
            page.close()


def test_closed_page_gives_its_port_back():
    page = Visualizer(load_robot_model('bello_bot'), port=0)
    port = int(page.url.rpartition(':')[2])
    page.close()
    assert free_port(LOCAL, port) == port


@pytest.mark.parametrize('host', ['192.0.2.1', 'no such host'])  # 192.0.2.0/24 is reserved for documentation
def test_foreign_host_is_refused(host: str):
    with pytest.raises(InvalidInputError, match=r'cannot serve at host .* valid are 127\.0\.0\.1'):
        Visualizer(load_robot_model('bello_bot'), host=host)


@pytest.mark.parametrize('port', [-1, 65536])
def test_impossible_port_is_refused(port: int):
    with pytest.raises(InvalidInputError, match=r'must be in \[0, 65535\]'):
        free_port(LOCAL, port)


def test_the_stretched_length_is_the_height_of_a_robot_that_stands_straight():
    # Bello Bot stands straight up at zero: that is the height of its flange.
    robot = load_robot_model('bello_bot')
    assert stretched_length(robot) == pytest.approx(1.72, abs=1e-9)


@pytest.fixture
def trace() -> Iterator[Visualizer]:
    page = Visualizer(load_robot_model('bello_bot'), port=0)
    page.clear_trace()
    yield page
    page.close()


def _segments(page: Visualizer) -> np.ndarray:
    return np.concatenate([piece.points for piece in page._trace._pieces])


def test_trace_is_one_line_through_all_points(trace: Visualizer):
    points = [np.array([0.01 * i, 0.0, 1.0]) for i in range(CHUNK + 20)]
    for point in points:
        trace._trace.add(point)
    segments = _segments(trace)
    assert len(segments) == len(points) - 1
    np.testing.assert_allclose(segments[:, 0], points[:-1], atol=1e-6)  # single precision
    np.testing.assert_allclose(segments[:, 1], points[1:], atol=1e-6)


def test_trace_leaves_out_rest_and_jumps(trace: Visualizer):
    for x in (0.0, 0.4 * SPACING, 0.8 * SPACING, 2.0 * SPACING, 3.0 * JUMP, 3.0 * JUMP + 2.0 * SPACING):
        trace._trace.add(np.array([x, 0.0, 0.0]))
    np.testing.assert_allclose(
        _segments(trace)[:, :, 0],
        [[0.0, 2.0 * SPACING], [3.0 * JUMP, 3.0 * JUMP + 2.0 * SPACING]],
        atol=1e-6,  # single precision
    )


def test_trace_forgets_what_is_old(trace: Visualizer):
    for i in range(CHUNK * (CHUNKS + 3)):
        trace._trace.add(np.array([0.01 * i, 0.0, 0.0]))
    assert len(trace._trace._pieces) == CHUNKS
    trace.clear_trace()
    assert not trace._trace._pieces


def test_trace_can_be_hidden(trace: Visualizer):
    trace._trace.show(visible=False)
    for x in (0.0, 0.1):
        trace._trace.add(np.array([x, 0.0, 0.0]))
    assert not trace._trace._pieces[0].visible
    trace._trace.show(visible=True)
    assert trace._trace._pieces[0].visible
