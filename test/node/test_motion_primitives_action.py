"""ExecuteMotionPrimitiveSequence by the real protocol; its interfaces are built here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import PoseStamped

from control_interfaces import control_msgs
from robots_core import Pose
from robots_core.ros.messages import BUILD, doubles

from .served_robot import ServedRobot

__all__ = ['control_msgs']

PTP, LIN, CIRC = 0, 50, 51
STEP = 0.1  # m
RADIUS = 0.02  # m


@pytest.fixture(scope='module')
def robot(module_ros_nodes: Any, control_msgs: None) -> ServedRobot:
    del control_msgs
    from control_msgs.action import ExecuteMotionPrimitiveSequence  # noqa: PLC0415  # built by the fixture

    return ServedRobot(module_ros_nodes, ExecuteMotionPrimitiveSequence, 'execute_motion_primitive_sequence')


def primitive(
    kind: int,
    *poses: Pose,
    joints: Sequence[float] = (),
    radius: float = 0.0,
    frame: str = '',
    **arguments: float,
) -> Any:
    from control_msgs.msg import MotionArgument, MotionPrimitive  # noqa: PLC0415  # built by the fixture

    message = MotionPrimitive(type=kind, blend_radius=radius, joint_positions=doubles(np.array(joints)))
    message.poses = [PoseStamped(pose=BUILD.pose(pose.r, pose.quaternion())) for pose in poses]
    for pose in message.poses:
        pose.header.frame_id = frame
    message.additional_arguments = [MotionArgument(name=name, value=one) for name, one in arguments.items()]
    return message


def sequence(*motions: Any) -> Any:
    from control_msgs.msg import MotionPrimitiveSequence  # noqa: PLC0415  # built by the fixture

    return MotionPrimitiveSequence(motions=motions)


def tool(robot: ServedRobot) -> Pose:
    return Pose(*robot.robot.direct_kinematics(robot.q))


def moved(pose: Pose, *by: float) -> Pose:
    return Pose(pose.r + np.array(by), pose.T)


def test_joint_line_and_arc_run_through_with_blends(robot: ServedRobot) -> None:
    robot.feedback.clear()
    up = robot.q + np.eye(6)[1] * 0.1
    over = Pose(*robot.robot.direct_kinematics(up))
    down = moved(over, 0.0, 0.0, -STEP)
    aside = moved(down, STEP, 0.0, 0.0)
    via, end = moved(aside, STEP, STEP, 0.0), moved(aside, 2 * STEP, 0.0, 0.0)
    goal = sequence(
        primitive(PTP, joints=up, radius=RADIUS, velocity=0.5, acceleration=1.0),
        primitive(LIN, down, radius=RADIUS, velocity=0.1),
        primitive(LIN, aside, velocity=0.1, acceleration=0.5, move_time=0.0),
        primitive(CIRC, end, via, velocity=0.1),
    )
    seen = len(robot.references)
    status, result = robot.result(robot.send(goal))
    assert (status, result.error_code, result.error_string) == (GoalStatus.STATUS_SUCCEEDED, 0, 'reached')
    robot.wait(lambda: np.linalg.norm(tool(robot).r - end.r) < 1e-4, 'the end')
    ways = np.array(
        [robot.robot.direct_kinematics(np.array(point.positions))[0] for point in robot.references[seen:]]
    )
    # It passes blended ends inside their radius, not through them.
    for pose, blended in ((over, True), (down, True), (aside, False), (via, False)):
        nearest = float(np.linalg.norm(ways - pose.r, axis=1).min())
        assert (1e-4 < nearest < RADIUS) if blended else nearest < 5e-3
    indices = [one.current_primitive_index for one in robot.feedback]
    assert indices == sorted(indices)
    assert set(indices) <= set(range(4))
    assert indices


def test_a_sequence_is_canceled_on_its_path(robot: ServedRobot) -> None:
    here = robot.q
    goal = robot.send(
        sequence(
            primitive(PTP, joints=here + np.eye(6)[0], velocity=0.01),
            primitive(PTP, joints=here),
        )
    )
    robot.until_moving()
    assert robot.asked(goal.cancel_goal_async).goals_canceling
    assert robot.result(goal)[0] == GoalStatus.STATUS_CANCELED
    robot.until_standing(robot.references)
    assert np.abs(robot.q - here).max() < 0.5


def test_a_newer_sequence_preempts_the_one_that_runs(robot: ServedRobot) -> None:
    here = robot.q
    first = robot.send(sequence(primitive(PTP, joints=here + np.eye(6)[0], velocity=0.01)))
    robot.until_moving()
    second = robot.send(sequence(primitive(PTP, joints=here)))
    status, result = robot.result(first)
    assert (status, result.error_string) == (GoalStatus.STATUS_ABORTED, 'preempted by a newer goal')
    assert robot.result(second)[0] == GoalStatus.STATUS_SUCCEEDED
    robot.until_at(here)


@pytest.mark.parametrize(
    ('motions', 'complaint'),
    [
        (list, 'a sequence needs 1 to 255 primitives, got 0'),
        (lambda: [primitive(7)], 'primitive 0: type 7 is not known; valid are LINEAR_JOINT (0)'),
        (lambda: [primitive(LIN, joints=[0.0] * 6)], 'LINEAR_CARTESIAN needs 1 pose, got 0 poses and 6'),
        (lambda: [primitive(CIRC, Pose.identity())], 'CIRCULAR_CARTESIAN needs 2 poses, the end and a point'),
        (lambda: [primitive(PTP, joints=[9.0] * 6, radius=0.1)] * 2, 'primitive 0: '),
        (lambda: [primitive(PTP, joints=[9.0] * 6)], 'primitive 0: '),
        (lambda: [primitive(PTP, joints=[0.0] * 6, move_time=2.0)], "argument 'move_time' is not known"),
        (lambda: [primitive(PTP, joints=[0.0] * 6, velocity=-1.0)], 'velocity = -1 must be a number above 0'),
        (lambda: [primitive(LIN, Pose.identity(), velocity=1e3)], 'cartesian_speed = 1000 m/s must be in'),
        (lambda: [primitive(LIN, Pose.identity(), radius=-1.0)], 'blend_radius = -1 m must be in [0, 1] m'),
        (lambda: [primitive(LIN, Pose.identity(), frame='moon')], "frame 'moon' is unknown"),
        (
            lambda: [primitive(PTP, joints=[0.0, -1.0, 1.0, 0.0, 0.0, 0.0]), primitive(LIN)],
            'primitive 1: LINEAR_CARTESIAN needs 1 pose',
        ),
    ],
)
def test_what_is_not_valid_is_refused_before_anything_moves(
    robot: ServedRobot, motions: Any, complaint: str
) -> None:
    here = robot.q
    status, result = robot.result(robot.send(sequence(*motions())))
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, robot.action.Result.INVALID_GOAL)
    assert complaint in result.error_string
    np.testing.assert_array_equal(robot.q, here)


def test_a_motion_that_is_impossible_ends_the_sequence_there(robot: ServedRobot) -> None:
    here = robot.q
    far = moved(tool(robot), 9.0, 0.0, 0.0)
    near = here + np.eye(6)[5] * 0.1
    status, result = robot.result(
        robot.send(sequence(primitive(PTP, joints=near), primitive(LIN, far), primitive(PTP, joints=here)))
    )
    assert (status, result.error_code) == (GoalStatus.STATUS_ABORTED, robot.action.Result.INVALID_GOAL)
    assert result.error_string.startswith('primitive 1: ')
