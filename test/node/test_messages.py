"""Messages to plain values: what they may not hold."""

from __future__ import annotations

import pytest
from geometry_msgs.msg import Pose as PoseMessage

from robots_core.errors import InvalidInputError, JointLimitError, RobotsError, UnreachablePoseError
from robots_core.motion_result import MotionResult
from robots_core.ros.messages import (
    diagnostic_status,
    diagnostic_values,
    motion_result_from_message,
    motion_result_message,
    number_in,
    pose_from_message,
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
