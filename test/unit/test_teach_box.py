"""TeachBox: axes, tool axes, dead-man, limits that stop it, refusals."""

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError, JointLimitError
from robots_planning import TeachBox, TeachStep
from robots_planning.guidance.jog_axes import JogAxes
from robots_planning.guidance.teach_box import OUT_OF_REACH

DT = 0.004


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


@pytest.fixture(scope='module')
def posture() -> np.ndarray:
    return np.array([0.2, -1.2, 1.4, 0.3, 0.8, -0.4])


def tool(robot: BaseRobotModel, q: np.ndarray) -> Pose:
    return Pose(*robot.direct_kinematics(q))


def test_axes_move_with_the_reduced_speed(robot: BaseRobotModel, posture: np.ndarray) -> None:
    box = TeachBox(robot, DT, posture, speed_fraction=0.05)
    command = np.array([0.02, 0.0, -9.0, 0.0, 0.0, 0.0])
    for k in range(300):
        box.jog_axes(command, k * DT)
        step = box.step(k * DT)
    np.testing.assert_allclose(step.q_dot, [0.02, 0.0, -0.05 * robot.axes_data.velocity[2], 0.0, 0.0, 0.0])
    assert step.jogging
    assert not step.limits


def test_the_tool_is_slow_also_when_axes_are_jogged(robot: BaseRobotModel, posture: np.ndarray) -> None:
    box = TeachBox(robot, DT, posture, speed_fraction=1.0, tool_speed=0.1)
    before = tool(robot, posture).r
    fastest = 0.0
    for k in range(250):
        box.jog_axes(robot.axes_data.velocity, k * DT)
        after = tool(robot, box.step(k * DT).q).r
        fastest, before = max(fastest, float(np.linalg.norm(after - before)) / DT), after
    assert 0.08 < fastest <= 0.1


@pytest.mark.parametrize('axes', ['base', 'tool', 'world'])
@pytest.mark.parametrize('direction', range(6))
def test_the_tool_moves_along_or_about_one_axis(
    robot: BaseRobotModel, posture: np.ndarray, axes: JogAxes, direction: int
) -> None:
    world = Pose.from_angles([1.0, 2.0, 0.0], [0.7, 0.2, 0.1])
    held = Pose.from_angles([0.1, 0.0, 0.2], [0.0, 0.3, 0.0])
    box = TeachBox(robot, DT, posture, tool=held, world=world)
    start = tool(robot, posture) @ held
    frame = {'base': np.eye(3), 'tool': start.T, 'world': world.T.T}[axes]
    twist = np.zeros(6)
    twist[direction] = 0.05
    for k in range(200):
        box.jog_tool(twist, k * DT, axes)
        step = box.step(k * DT)
    error = start.error_to(tool(robot, step.q) @ held).reshape(2, 3) @ frame
    moved = error.ravel()[direction]
    # Started over a ramp and a little behind, on its way by a hundredth of it.
    assert 0.02 < moved < 0.05 * 200 * DT
    rest = np.delete(error.ravel(), direction)
    assert np.abs(rest).max() < 0.01 * moved


def test_the_axes_of_base_link_are_those_of_its_maker() -> None:
    robot = load_robot_model('ur5e')
    T = robot.base_link.T
    assert not np.allclose(T, np.eye(3))
    posture = np.array([0.3, -1.2, 1.4, -0.6, -1.5, 0.2])
    box = TeachBox(robot, DT, posture)
    for k in range(100):
        box.jog_tool([0.05, 0.0, 0.0, 0.0, 0.0, 0.0], k * DT, 'base_link')
        step = box.step(k * DT)
    along = T.T @ (tool(robot, step.q).r - tool(robot, posture).r)
    assert along[0] > 0.005
    assert np.abs(along[1:]).max() < 0.01 * along[0]


def test_an_old_command_stops_the_robot(robot: BaseRobotModel, posture: np.ndarray) -> None:
    box = TeachBox(robot, DT, posture)
    steps: list[TeachStep] = []
    for k in range(500):
        if k <= 100:
            box.jog_tool([0.0, 0.1, 0.0, 0.0, 0.0, 0.0], k * DT)
        steps.append(box.step(k * DT))
    jogging = [step.jogging for step in steps]
    assert all(jogging[:126])  # the last command holds for 0.1 s
    assert not any(jogging[127:])
    assert steps[-1].standing
    # Braking with 0.3 of the acceleration from 0.1 of the speed, at the worst.
    axes = robot.axes_data
    longest = 0.1 * axes.velocity / (0.3 * 0.3 * axes.acceleration)  # 0.3: smallest part the torques leave
    stood = next(index for index, step in enumerate(steps) if index > 130 and step.standing)
    assert (stood - 126) * DT <= float(longest.max()) + DT


@pytest.mark.parametrize('speed_fraction', [0.1, 0.3])
@pytest.mark.parametrize('direction', range(3))
@pytest.mark.parametrize('sign', [-1.0, 1.0])
def test_a_released_tool_stops_on_its_line(
    robot: BaseRobotModel, posture: np.ndarray, direction: int, sign: float, speed_fraction: float
) -> None:
    box = TeachBox(robot, DT, posture, speed_fraction=speed_fraction)
    twist = np.zeros(6)
    twist[direction] = sign
    for k in range(250):
        box.jog_tool(twist, k * DT)
        step = box.step(k * DT)
    start = tool(robot, posture)
    for k in range(250, 500):
        step = box.step(k * DT)
        error = start.error_to(tool(robot, step.q))
        # How far limits of the axes that it meets while it is jogged keep it from its line.
        assert np.abs(np.delete(error[:3], direction)).max() < 5e-4
        assert np.linalg.norm(error[3:]) < 1e-3
        if step.standing:
            break
    assert step.standing


def test_a_command_from_the_future_is_none(robot: BaseRobotModel, posture: np.ndarray) -> None:
    box = TeachBox(robot, DT, posture)
    box.jog_axes(np.full(6, 0.1), 5.0)
    assert box.step(1.0).standing


def test_an_axis_stops_at_its_limit_and_is_named(robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    posture = np.array(robot.home)
    posture[0] = axes.upper[0] - 0.01
    box = TeachBox(robot, DT, posture)
    for k in range(400):
        box.jog_axes([0.5, 0.0, 0.0, 0.0, 0.0, 0.1], k * DT)
        step = box.step(k * DT)
        assert step.q[0] <= axes.upper[0]
    assert step.q[0] == pytest.approx(axes.upper[0], abs=1e-9)
    assert step.q_dot[0] == pytest.approx(0.0, abs=1e-6)
    assert step.q_dot[5] == pytest.approx(0.1)
    assert step.limits == (f'{axes.names[0]} position upper',)


def test_a_tool_that_cannot_go_on_stops_and_says_why(robot: BaseRobotModel) -> None:
    posture = np.array([0.0, -1.2, 1.4, 0.0, 0.8, 0.0])
    box = TeachBox(robot, DT, posture)
    for k in range(3000):
        box.jog_tool([0.25, 0.0, 0.0, 0.0, 0.0, 0.0], k * DT)
        step = box.step(k * DT)
    start, end = tool(robot, posture), tool(robot, step.q)
    assert np.abs(step.q_dot).max() < 1e-3
    assert step.limits == (OUT_OF_REACH,)  # stretched
    # It is still where it was to move along, within what it may be behind.
    assert np.abs(end.r - start.r)[1:].max() < 2e-3
    assert end.r[0] > start.r[0] + 0.1


def test_going_the_other_way_is_possible_at_a_limit(robot: BaseRobotModel) -> None:
    posture = np.array(robot.home)
    posture[0] = robot.axes_data.upper[0]
    box = TeachBox(robot, DT, posture)
    box.jog_axes([-0.1, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0)
    step = box.step(0.0)
    assert step.q_dot[0] < 0.0
    assert not step.limits


def test_bad_input_is_refused(robot: BaseRobotModel, posture: np.ndarray) -> None:
    box = TeachBox(robot, DT, posture)
    with pytest.raises(InvalidInputError, match='shape'):
        box.jog_axes([0.0], 0.0)
    with pytest.raises(InvalidInputError, match='nan'):
        box.jog_tool([np.nan] * 6, 0.0)
    with pytest.raises(InvalidInputError, match='valid are base, base_link, tool and world'):
        box.jog_tool([0.0] * 6, 0.0, 'flange')  # type: ignore[arg-type]
    with pytest.raises(JointLimitError):
        TeachBox(robot, DT, np.full(6, 9.0))
    for option in ('speed_fraction', 'acceleration_fraction', 'tool_speed', 'rotation_speed', 'timeout'):
        with pytest.raises(InvalidInputError, match=option):
            TeachBox(robot, DT, posture, **{option: 0.0})
