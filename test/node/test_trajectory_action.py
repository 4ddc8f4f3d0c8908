"""FollowJointTrajectory by the real protocol; its interfaces are built here, cut down to those of an arm."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from builtin_interfaces.msg import Time

from control_interfaces import control_msgs
from robots_core.ros.messages import nanoseconds

from .served_robot import ServedRobot

__all__ = ['control_msgs']

STEP = 0.2  # rad


@pytest.fixture(scope='module')
def action(control_msgs: None) -> Any:
    del control_msgs
    from control_msgs.action import FollowJointTrajectory  # noqa: PLC0415  # built by the fixture

    return FollowJointTrajectory


@pytest.fixture(scope='module')
def robot(module_ros_nodes: Any, action: Any) -> ServedRobot:
    return ServedRobot(module_ros_nodes, action, 'follow_joint_trajectory')


def shifted(robot: ServedRobot, by: float) -> np.ndarray:
    return robot.q + np.eye(6)[0] * by


def test_a_goal_is_reached_with_feedback_on_the_way(robot: ServedRobot) -> None:
    target = shifted(robot, STEP)
    robot.feedback.clear()
    status, result = robot.result(robot.send(robot.points(target)))
    assert (status, result.error_code) == (GoalStatus.STATUS_SUCCEEDED, robot.action.Result.SUCCESSFUL)
    robot.until_at(target)
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
    robot.until_at(target)


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


def test_tolerances_that_are_none_are_refused(robot: ServedRobot) -> None:
    goal = robot.send(robot.points(shifted(robot, STEP)), path_tolerance=tolerance(robot, -2.0))
    status, result = robot.result(goal)
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, robot.action.Result.INVALID_GOAL)
    assert result.error_string.startswith('path_tolerance of shoulder_pan_joint is -2; valid are numbers')
