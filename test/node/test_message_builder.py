"""Nodes and simulations build the same messages from the same plain values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.serialization import serialize_message

from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.simulation.record import ros_messages
from robots_core.message_builder import MessageBuilder
from robots_core.pose import Pose
from robots_core.ros import messages
from robots_core.status import Level, Status
from robots_planning.motion_kinds import MOTION_KINDS, MotionKind

STAMP = 1_700_000_000_123_456_789
NAMES = ('A1', 'A22')
Q, V, W = np.array([0.25, -1.5]), np.array([1.0, 2.0]), np.arange(6.0)
POSE = Pose.from_quaternion([0.1, 0.2, 0.3], [0.0, 0.6, 0.0, 0.8])
BUILT: dict[str, Callable[[MessageBuilder], Any]] = {
    'bool': lambda build: build.value(True),
    'number': lambda build: build.value(0.1),
    'text': lambda build: build.value('IDLE'),
    'status': lambda build: build.status(Status('stop', 'hit', Level.WARN, {'n': 2}), 'ur5e'),
    'no problem': lambda build: build.status(Status.of_problem('contact', ''), 'ur5e'),
    'positions': lambda build: build.joint_state(STAMP, NAMES, Q),
    'states': lambda build: build.joint_state(STAMP, NAMES, Q, V, W[:2]),
    'trajectory': lambda build: build.joint_trajectory(STAMP, NAMES, [(4_000_000, Q, V, Q)], 'base'),
    'pose': lambda build: build.pose_stamped(STAMP, POSE, 'world'),
    'path': lambda build: build.path(STAMP, [POSE, Pose.identity()]),
    'twist': lambda build: build.twist_stamped(STAMP, W),
    'wrench': lambda build: build.wrench_stamped(STAMP, W),
    'matrix': lambda build: build.matrix(W.reshape(2, 3), 'part', 'momentum'),
    'digital image': lambda build: build.image('digital_outputs', np.array([1.0, 0.0, 1.0]), labelled=True),
    'analog image': lambda build: build.image('analog_inputs', Q, labelled=False),
}


def same(ros: Any, rosbags: Any) -> bool:
    store, kind, expected = ros_messages.typestore(), rosbags.__msgtype__, ros_messages.serialized(rosbags)
    found = serialize_message(ros)
    if len(found) - len(expected) not in range(9):  # it leaves padding behind the end
        return False
    again = store.deserialize_cdr(found[: len(expected)], kind)  # what is between the fields may differ
    return bytes(store.serialize_cdr(again, kind)) == bytes(expected)


@pytest.mark.parametrize('build', BUILT.values(), ids=BUILT)
def test_both_build_the_same_message(build: Callable[[MessageBuilder], Any]):
    assert same(build(messages.BUILD), build(ros_messages.BUILD))


@pytest.mark.parametrize('kind', MOTION_KINDS, ids=lambda kind: kind.topic)
def test_a_command_is_the_same_message_of_its_type(kind: MotionKind):
    targets: dict[str, dict[str, Any]] = {
        'joints': {'q': Q},
        'pose': {'pose': POSE},
        'poses': {'pose': POSE, 'path': (POSE, POSE)},
    }
    command = MotionCommand(kind, 1, kind.functions[0], **targets[kind.target])
    rosbags = command.message(ros_messages.BUILD, STAMP, NAMES)
    assert rosbags.__msgtype__ == kind.message_type
    assert same(command.message(messages.BUILD, messages.BUILD.time(STAMP), NAMES), rosbags)


@pytest.mark.parametrize('level', ['OK', 'WARN', 'ERROR', 'STALE'])
def test_levels_are_those_of_the_message(level: str) -> None:
    constant = getattr(DiagnosticStatus, level)
    assert messages.diagnostic_status('drive', 'moves', level=constant).level == constant
