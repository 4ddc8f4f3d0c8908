"""Messages to plain values: what they may not hold."""

from __future__ import annotations

import math

import numpy as np
import pytest
from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import TwistStamped

from robots_core import Pose, load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, JointLimitError, RobotsError, UnreachablePoseError
from robots_core.ros.messages import (
    diagnostic_status,
    diagnostic_values,
    motion_result_from_message,
    motion_result_message,
    number_in,
    pose_from_message,
    pose_in_base,
    twist_in_base,
)


def test_a_number_of_a_status_is_finite_or_its_default() -> None:
    assert number_in({'end': '0.25'}, 'end', 1.0) == 0.25
    assert number_in({}, 'end', 1.0) == 1.0
    for text in ('soon', '', 'nan', '-inf', '1e999'):
        with pytest.raises(InvalidInputError, match=f"end = '{text}' must be a finite number"):
            number_in({'end': text}, 'end', 1.0)


@pytest.mark.parametrize('key', ['ended', 'progress'])
def test_a_result_whose_numbers_are_none_is_refused(key: str) -> None:
    with pytest.raises(InvalidInputError, match=key):
        motion_result_from_message(diagnostic_status('motion', '', id='1.0', **{key: 'soon'}))


@pytest.mark.parametrize('value', [1e4, -1e200, float('inf'), float('nan')])
def test_a_pose_is_near_its_frame(value: float) -> None:
    message = PoseMessage()
    message.position.y = value
    with pytest.raises(InvalidInputError, match=r'position\[1\]'):
        pose_from_message(message)


@pytest.mark.parametrize('error', [UnreachablePoseError('too far'), JointLimitError('a1', 4.0, -3.0, 3.0)])
def test_a_result_keeps_the_code_of_its_error(error: RobotsError) -> None:
    result = MotionResult.refused('5.000000000', error)
    sent = motion_result_message(result, 'robot')
    assert diagnostic_values(sent)['code'] == error.code
    received = motion_result_from_message(sent).error
    assert received is not None
    assert (received.code, received.message) == (error.code, error.message)
    reached = motion_result_message(MotionResult('5.0', ok=True, message='reached'), 'robot')
    assert 'code' not in diagnostic_values(reached)


def test_poses_and_twists_in_base_link_come_into_the_base() -> None:
    pose, twist = PoseMessage(), TwistStamped()
    pose.position.x, pose.orientation.w = 0.5, 1.0
    twist.twist.linear.x, twist.twist.angular.y = 0.1, 0.2
    turned = np.diag([-1.0, -1.0, 1.0])
    for robot, frame, turn in (
        ('ur5e', 'base_link', turned),
        ('ur10e', 'base_link', turned),
        ('ur5e', 'base', np.eye(3)),
        ('ur5e', '', np.eye(3)),
        ('bello_bot', 'base_link', np.eye(3)),
    ):
        base_link = load_robot_model(robot).base_link
        found = pose_in_base(frame, pose, base_link)
        assert found.distance_to(Pose(turn @ [0.5, 0.0, 0.0], turn)) == pytest.approx((0.0, 0.0), abs=1e-9)
        twist.header.frame_id = frame
        wanted = [*(turn @ [0.1, 0.0, 0.0]), *(turn @ [0.0, 0.2, 0.0])]
        assert twist_in_base(twist, base_link) == pytest.approx(wanted, abs=1e-12)
    twist.header.frame_id = 'camera'
    with pytest.raises(InvalidInputError, match="frame 'camera' is unknown"):
        twist_in_base(twist, base_link)
    twist.header.frame_id = 'base_link'
    for value in (math.nan, math.inf, 1e308):
        twist.twist.angular.z = value
        with pytest.raises(InvalidInputError, match='twist'):
            twist_in_base(twist, base_link)
