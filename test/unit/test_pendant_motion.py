"""Steps and motions to typed targets of the operator's page; without a browser and without ROS."""

from __future__ import annotations

import numpy as np
import pytest

from robots_controller.pendant.jog.jog_command import JogCommand
from robots_controller.pendant.jog.jog_prediction import HORIZON, JogPrediction
from robots_controller.pendant.jog.pendant_motion import (
    motion_preview,
    step_command,
    target_command,
)
from robots_controller.pendant.pendant_state import PendantState
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import CollisionDetection, Scene, SceneObject
from robots_core.errors import InvalidInputError, JointLimitError
from robots_core.orientation import rotation_from_vector
from robots_core.robot_model.shapes import Capsule
from robots_planning.guidance.teach_box import TeachBox
from robots_planning.motion_settings import MotionSettings, frame_numbers
from robots_planning.pathplanning import PathPlanning

TOOL = Pose.from_angles((0.0, 0.1, 0.2), (0.3, -0.2, 0.1))
BASE = Pose.from_angles((0.5, -0.3, 0.1), (0.4, 0.2, -0.1))
BASIS = PendantState(settings=MotionSettings(tool=frame_numbers(TOOL), base=frame_numbers(BASE)))
PLAIN = PendantState()
ROBOTS = ('cello_bot', 'kuka_kr210_r2700', 'kuka_lbr_iiwa14')  # the first axis of the first slides


@pytest.mark.parametrize('name', ROBOTS)
def test_a_step_of_an_axis_moves_it_alone_and_by_just_that(name: str) -> None:
    robot = load_robot_model(name)
    q = np.array(robot.home)
    for index in range(robot.num_axes):
        sign = '+' if q[index] + 0.01 < robot.axes_data.upper[index] else '-'
        command = step_command(
            robot, JogCommand.from_key(f'axes {index} {sign}', 1.0, q.size), 0.01, q, BASIS
        )
        assert command.q is not None
        way = np.array(command.q) - q
        assert np.flatnonzero(way).tolist() == [index]
        assert abs(way[index]) == pytest.approx(0.01)


@pytest.mark.parametrize('frame', ['tool', 'base', 'taught'])
@pytest.mark.parametrize('index', range(6))
def test_a_step_of_the_tool_is_one_in_its_direction_alone(frame: str, index: int) -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    q = np.array(robot.home)
    start = Pose(*robot.direct_kinematics(q)) @ TOOL
    taught = rotation_from_vector(np.array([0.3, -0.5, 0.9])) if frame == 'taught' else None
    jog = JogCommand.from_key(f'{frame} {index} -', 1.0, 6, taught)
    command = step_command(robot, jog, 0.02, q, BASIS)
    assert command.pose is not None
    error = start.error_to(BASE @ command.pose)  # in the robot's base
    turn = {'tool': start.T, 'base': np.eye(3), 'taught': taught}[frame]
    assert turn is not None
    seen = np.concatenate([turn.T @ error[:3], turn.T @ error[3:]])
    expected = np.zeros(6)
    expected[index] = -0.02
    np.testing.assert_allclose(seen, expected, atol=1e-9)


def test_a_step_out_of_the_limits_is_refused() -> None:
    robot = load_robot_model('cello_bot')
    with pytest.raises(JointLimitError, match=robot.axes_data.names[0]):
        step_command(
            robot, JogCommand.from_key('axes 0 +', 1.0, robot.num_axes), 0.01, robot.axes_data.upper, BASIS
        )


@pytest.mark.parametrize(
    ('way', 'values', 'error'),
    [
        ('joints', [0.0], 'q must have shape'),
        ('pose', [0.0] * 5, 'pose must have shape'),
        ('line', [0.0, 0.0, float('nan'), 0.0, 0.0, 0.0], 'pose'),
        ('joints', [99.0, 0.0, 0.0, 0.0, 0.0, 0.0], 'A1'),
    ],
)
def test_odd_targets_are_refused(way: str, values: list[float], error: str) -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    with pytest.raises(InvalidInputError, match=error):
        target_command(robot, way, values, 1.0, BASIS)  # type: ignore[arg-type]


@pytest.mark.parametrize('way', ['joints', 'pose', 'line'])
def test_a_preview_shows_where_and_how_long_and_no_tool_is_too_fast(way: str) -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    planning, q = PathPlanning(robot), np.array(robot.home) + np.radians([0, 0, 0, 20, 30, 0])
    goal = q + np.array([0.5, 0.1, -0.1, 0.2, -0.3, 0.2])
    pose = Pose(*robot.direct_kinematics(goal)) @ TOOL
    values = goal if way == 'joints' else [*pose.r, *pose.angles(robot.orientation_convention)]
    command = target_command(robot, way, list(values), 1.0, BASIS)  # type: ignore[arg-type]
    found = motion_preview(planning, command, q, BASIS.settings, 0.25)
    reached = Pose(*robot.direct_kinematics(found.q)) @ TOOL
    assert max(reached.distance_to(pose)) < 1e-6
    settings = MotionSettings(**{**vars(BASIS.settings), **found.command.settings})
    target = found.command.pose if found.command.q is None else found.command.q
    assert target is not None
    motion = planning.plan(found.command.kind, q, target, settings).trajectory
    assert motion.duration == pytest.approx(found.duration)
    times = np.arange(0.0, motion.duration, 0.01)
    places = np.array([(Pose(*robot.direct_kinematics(row)) @ TOOL).r for row in motion.sample(times)[0]])
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() / 0.01 <= 0.25


def test_a_preview_of_a_way_around_obstacles_has_all_of_it_and_its_smallest_distance() -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    post = SceneObject('post', Capsule(0.05, 1.6), Pose(np.array([1.7, 0.0, 1.0]), np.eye(3)))
    collision = CollisionDetection(robot, scene=Scene((post,)))
    planning = PathPlanning(robot, collision=collision, collision_margin=0.005)
    start, goal = np.radians([[side, -70.0, 90.0, 0.0, 70.0, 0.0] for side in (-30.0, 30.0)])
    command = target_command(robot, 'joints', goal.tolist(), 1.0, PLAIN)
    found = motion_preview(planning, command, start, MotionSettings(avoid=True), 0.25)
    assert found.around
    assert found.closest is not None
    assert found.closest.second == 'post'
    assert found.closest.distance >= 0.005
    np.testing.assert_allclose(
        [found.at(0.0), found.at(found.duration), found.q], [start, goal, goal], atol=1e-12
    )
    lowest = min(found.at(time).tolist()[1] for time in np.linspace(0.0, found.duration, 50))
    assert abs(lowest - start[1]) > 0.01  # a way that is not the line of axis 1
    command = target_command(robot, 'joints', (start + 0.1).tolist(), 1.0, PLAIN)
    straight = motion_preview(planning, command, start, MotionSettings(), 0.25)
    assert not straight.around


def _jog(robot: BaseRobotModel, box: TeachBox, jog: JogCommand, time: float) -> None:
    if jog.frame == 'axes':
        box.jog_axes(jog.velocity(robot.axes_data, PLAIN.jog_speeds), time)
    else:
        box.jog_tool(jog.twist(PLAIN.jog_speeds), time, jog.tool_frame)


@pytest.mark.parametrize(
    ('name', 'key', 'limit'),
    [
        ('cello_bot', 'axes 0 +', 'position upper'),
        ('kuka_kr210_r2700', 'axes 2 -', 'position lower'),
        ('kuka_kr210_r2700', 'base 0 +', ''),
        ('kuka_lbr_iiwa14', 'tool 2 +', ''),
    ],
)
def test_what_stops_a_jog_is_announced_before_it_does(name: str, key: str, limit: str) -> None:
    robot = load_robot_model(name)
    jog, outlook, period = JogCommand.from_key(key, 1.0, robot.num_axes), JogPrediction(robot), 0.02
    box = TeachBox(robot, period, robot.home, speed_fraction=PLAIN.jog_speeds.fraction)
    places = []
    for number in range(100_000):
        _jog(robot, box, jog, number * period)
        step = box.step(number * period)
        places.append(step.q)
        if step.limits:
            break
    assert limit in step.limits[0]
    soon, far = places[-int(0.5 / period) :][0], places[0]
    ahead = outlook.ahead(jog, soon, PLAIN.jog_speeds, PLAIN.settings)
    assert ahead is not None
    assert ahead.time < HORIZON
    assert {one.split()[0] for one in ahead.limits} & {one.split()[0] for one in step.limits}
    assert (
        len(places) * period < 2.0 * HORIZON
        or outlook.ahead(jog, far, PLAIN.jog_speeds, PLAIN.settings) is None
    )
