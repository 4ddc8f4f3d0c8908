"""Trajectories read and written without an object for each point are those of the messages."""

from __future__ import annotations

import numpy as np
import pytest
from builtin_interfaces.msg import Duration, Time
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from rosbags.typesys import Stores, get_typestore
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_core.errors import InvalidInputError
from robots_core.ros.joint_trajectories import FIELDS, SerializedTrajectory, serialize_points

WHAT = 'joint_trajectory'
TEXT = st.text(st.characters(codec='utf-8', exclude_characters='\0'), max_size=9)
NAMES = st.lists(TEXT, min_size=1, max_size=7, unique=True)


def message_of(names: list[str], frame: str, times: np.ndarray, rows: np.ndarray) -> JointTrajectory:
    points = [
        JointTrajectoryPoint(
            **{field: row.tolist() for field, row in zip(FIELDS, values, strict=True)},
            time_from_start=Duration(sec=int(time // 10**9), nanosec=int(time % 10**9)),
        )
        for time, values in zip(times, rows.transpose(1, 0, 2), strict=True)
    ]
    header = Header(stamp=Time(sec=7, nanosec=5), frame_id=frame)
    return JointTrajectory(header=header, joint_names=names, points=points)


def some(names: list[str], count: int) -> tuple[np.ndarray, np.ndarray]:
    times = np.arange(count) * 1_500_000_000 - 2_000_000_001
    return times, np.random.default_rng(count).normal(size=(3, count, len(names)))


@given(names=NAMES, frame=TEXT, count=st.integers(1, 5))
def test_what_is_read_and_written_is_the_message(names: list[str], frame: str, count: int) -> None:
    times, rows = some(names, count)
    message = message_of(names, frame, times, rows)
    raw = serialize_points(names, message.header.stamp, frame, times, rows)
    assert deserialize_message(raw, JointTrajectory) == message
    for serialized in (raw, serialize_message(message)):
        read = SerializedTrajectory(serialized)
        assert (read.id, read.num_points) == ('7.000000005', count)
        found, values = read.points(names[::-1], WHAT)
        np.testing.assert_array_equal(found, times)
        np.testing.assert_array_equal(values, rows[:, :, ::-1])
        assert 'message' not in vars(read)  # it was not deserialized


def test_points_of_another_layout_are_deserialized() -> None:
    names = ['a', 'b']
    times, rows = some(names, 3)
    message = message_of(names, '', times, rows)
    message.points[1].effort = [1.0, 2.0]
    read = SerializedTrajectory(serialize_message(message))
    np.testing.assert_array_equal(read.points(names, WHAT)[1], rows)
    assert read.message == message
    message.points[2].accelerations = []
    with pytest.raises(InvalidInputError, match='point 3 has 0 accelerations for 2 joints'):
        SerializedTrajectory(serialize_message(message)).points(names, WHAT)


@pytest.mark.parametrize('count', [1, 4])
def test_reads_what_a_machine_of_the_other_byte_order_sends(count: int) -> None:
    names = ['a', 'b']
    times, rows = some(names, count)
    store = get_typestore(Stores.ROS2_JAZZY)
    raw = serialize_points(names, Time(sec=7, nanosec=5), 'base', times, rows)
    message = store.deserialize_cdr(raw, 'trajectory_msgs/msg/JointTrajectory')
    read = SerializedTrajectory(bytes(store.serialize_cdr(message, message.__msgtype__, little_endian=False)))
    assert (read.id, read.num_points) == ('7.000000005', count)
    np.testing.assert_array_equal(read.points(names, WHAT)[1], rows)


@pytest.mark.parametrize(
    ('names', 'complaint'), [(['a', 'c'], 'lacks joint c'), (['a', 'b', 'c'], 'lacks joint c')]
)
def test_missing_joints_are_named(names: list[str], complaint: str) -> None:
    times, rows = some(['a', 'b'], 2)
    raw = serialize_points(['a', 'b'], Time(), '', times, rows)
    with pytest.raises(InvalidInputError, match=complaint):
        SerializedTrajectory(raw).points(names, WHAT)
