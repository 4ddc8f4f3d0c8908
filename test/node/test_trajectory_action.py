"""FollowJointTrajectory by the real protocol; its interfaces are built here, cut down to those of an arm."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Duration, Time
from rclpy.action.client import ActionClient
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from built_messages import build_messages
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import doubles, nanoseconds
from robots_planning.nodes.planning_node import PlanningNode

from .bench import Bench

ROBOT = 'ur5e'
DEFINITIONS = Path(__file__).parents[1] / 'support' / 'interfaces' / 'control_msgs'
USES = (
    *('trajectory_msgs', 'std_msgs', 'builtin_interfaces'),
    *('action_msgs', 'unique_identifier_msgs', 'service_msgs'),
)
STEP = 0.2  # rad
PATIENT = 20.0  # s, with drives that a busy machine delays


@pytest.fixture(scope='module')
def action(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    messages, actions = (
        {path.stem: path.read_text() for path in DEFINITIONS.glob(f'*.{kind}')} for kind in ('msg', 'action')
    )
    folder = tmp_path_factory.mktemp('control')
    sys.path.insert(0, str(build_messages(folder, 'control_msgs', messages, USES, actions)))
    from control_msgs.action import FollowJointTrajectory  # noqa: PLC0415  # built above

    yield FollowJointTrajectory
    sys.path.pop(0)
    for name in [name for name in sys.modules if name.partition('.')[0] == 'control_msgs']:
        del sys.modules[name]


class ServedRobot(Bench):
    """Planner, controller and drives, and a client of the action."""

    def __init__(self, runner: Any, action: Any) -> None:
        super().__init__(runner)
        self.action = action
        self.robot = load_robot_model(ROBOT)
        self.names = list(self.robot.axes_data.names)
        self.start_node(DriveNode, robot_model=ROBOT)
        self.start_node(ControllerNode, robot_model=ROBOT, feedback_timeout=PATIENT)
        planner = self.start_node(PlanningNode, robot_model=ROBOT)
        self.references = self.collect(
            'joint_reference', JointTrajectory, read=lambda message: message.points[0]
        )
        self.client = ActionClient(self.peer, action, 'follow_joint_trajectory')
        self.feedback: list[Any] = []
        self.wait(
            lambda: self.references and planner._reference is not None and self.client.server_is_ready(),
            'the action',
        )

    @property
    def q(self) -> np.ndarray:
        """The newest reference."""
        return np.array(self.references[-1].positions)

    def points(self, *rows: np.ndarray, period: int = 2) -> JointTrajectory:
        points = [
            JointTrajectoryPoint(positions=doubles(q), time_from_start=Duration(sec=period * number))
            for number, q in enumerate(rows, 1)
        ]
        return JointTrajectory(joint_names=self.names, points=points)

    def send(self, trajectory: JointTrajectory, **goal: Any) -> Any:
        """A goal that is accepted."""
        sent = self.asked(
            lambda: self.client.send_goal_async(
                self.action.Goal(trajectory=trajectory, **goal),
                feedback_callback=lambda message: self.feedback.append(message.feedback),
            )
        )
        assert sent.accepted
        return sent

    def asked(self, ask: Any) -> Any:
        """The answer to a request, sent in the thread that takes answers: the client expects that."""
        futures: list[Any] = []
        once = self.peer.create_guard_condition(lambda: futures.append(ask()))
        once.trigger()
        self.runner.wait_for(lambda: futures and futures[0].done(), 30.0, 'the answer')
        self.peer.destroy_guard_condition(once)
        return futures[0].result()

    def result(self, goal: Any) -> tuple[int, Any]:
        answer = self.asked(goal.get_result_async)
        return answer.status, answer.result

    @property
    def moving(self) -> bool:
        return any(self.references[-1].velocities)

    def until_moving(self) -> None:
        self.wait(lambda: self.moving, 'it moves')


@pytest.fixture(scope='module')
def robot(module_ros_nodes: Any, action: Any) -> ServedRobot:
    return ServedRobot(module_ros_nodes, action)


def shifted(robot: ServedRobot, by: float) -> np.ndarray:
    return robot.q + np.eye(6)[0] * by


def test_a_goal_is_reached_with_feedback_on_the_way(robot: ServedRobot) -> None:
    target = shifted(robot, STEP)
    robot.feedback.clear()
    status, result = robot.result(robot.send(robot.points(target)))
    assert (status, result.error_code) == (GoalStatus.STATUS_SUCCEEDED, robot.action.Result.SUCCESSFUL)
    np.testing.assert_allclose(robot.q, target, atol=1e-4)
    assert robot.feedback
    for feedback in robot.feedback:
        assert list(feedback.joint_names) == robot.names
        wanted, actual, error = (
            np.array(point.positions) for point in (feedback.desired, feedback.actual, feedback.error)
        )
        np.testing.assert_allclose(error, wanted - actual, atol=1e-12)


def test_a_goal_is_canceled_on_its_path(robot: ServedRobot) -> None:
    goal = robot.send(robot.points(shifted(robot, -STEP), period=60))
    robot.until_moving()
    assert robot.asked(goal.cancel_goal_async).goals_canceling
    status, _ = robot.result(goal)
    assert status == GoalStatus.STATUS_CANCELED
    robot.wait(lambda: not robot.moving, 'it stands')


def test_a_newer_goal_preempts_the_one_that_runs(robot: ServedRobot) -> None:
    first = robot.send(robot.points(shifted(robot, STEP), period=60))
    robot.until_moving()
    target = shifted(robot, -0.5 * STEP)
    second = robot.send(robot.points(target))
    status, result = robot.result(first)
    assert (status, result.error_string) == (GoalStatus.STATUS_ABORTED, 'preempted by a newer goal')
    status, _ = robot.result(second)
    assert status == GoalStatus.STATUS_SUCCEEDED
    np.testing.assert_allclose(robot.q, target, atol=1e-4)


def test_a_goal_with_a_stamp_in_the_future_waits_and_can_be_canceled_before(robot: ServedRobot) -> None:
    before, trajectory = robot.q, robot.points(shifted(robot, STEP))
    trajectory.header.stamp = Time(sec=int(robot.peer.get_clock().now().nanoseconds * 1e-9) + 3600)
    goal = robot.send(trajectory)
    assert robot.asked(goal.cancel_goal_async).goals_canceling
    assert robot.result(goal)[0] == GoalStatus.STATUS_CANCELED
    np.testing.assert_array_equal(robot.q, before)

    trajectory = robot.points(shifted(robot, STEP))
    stamp = robot.peer.get_clock().now().nanoseconds + 500_000_000
    trajectory.header.stamp = Time(sec=stamp // 10**9, nanosec=stamp % 10**9)
    robot.feedback.clear()
    assert robot.result(robot.send(trajectory))[0] == GoalStatus.STATUS_SUCCEEDED
    assert nanoseconds(robot.feedback[0].header.stamp) >= stamp


def test_a_trajectory_that_is_past_is_refused(robot: ServedRobot) -> None:
    trajectory = robot.points(shifted(robot, STEP))
    trajectory.header.stamp = Time(sec=1)
    status, result = robot.result(robot.send(trajectory))
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, robot.action.Result.INVALID_GOAL)
    assert 'the trajectory has ended' in result.error_string


def tolerance(robot: ServedRobot, value: float) -> list[Any]:
    from control_msgs.msg import JointTolerance  # noqa: PLC0415  # built above

    return [JointTolerance(name=robot.names[0], position=value)]


def test_an_error_beyond_the_path_tolerance_ends_the_goal(robot: ServedRobot) -> None:
    goal = robot.send(
        robot.points(shifted(robot, STEP), period=1), path_tolerance=tolerance(robot, 1e-9)
    )  # drives follow, but not as well
    status, result = robot.result(goal)
    assert status == GoalStatus.STATUS_ABORTED
    assert result.error_code == robot.action.Result.PATH_TOLERANCE_VIOLATED
    assert 'allowed is 1e-09' in result.error_string


def test_goal_tolerances_decide_on_the_end(robot: ServedRobot) -> None:
    far = robot.send(robot.points(shifted(robot, 0.1)), goal_tolerance=tolerance(robot, 0.1))
    assert robot.result(far)[0] == GoalStatus.STATUS_SUCCEEDED
    near = robot.send(robot.points(shifted(robot, -0.1)), goal_tolerance=tolerance(robot, 1e-300))
    status, result = robot.result(near)
    assert status == GoalStatus.STATUS_ABORTED
    assert result.error_code == robot.action.Result.GOAL_TOLERANCE_VIOLATED


@pytest.mark.parametrize('value', [-2.0, float('nan')])
def test_tolerances_that_are_none_are_refused(robot: ServedRobot, value: float) -> None:
    goal = robot.send(robot.points(shifted(robot, STEP)), path_tolerance=tolerance(robot, value))
    status, result = robot.result(goal)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, robot.action.Result.INVALID_GOAL)
    assert 'valid are numbers from 0 on, and -1 for none' in result.error_string
