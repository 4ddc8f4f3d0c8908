"""References read without building their messages are those of the messages."""

from __future__ import annotations

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore
from std_msgs.msg import Header
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_core.errors import InvalidInputError
from robots_core.ros.joint_trajectories import single_point
from robots_core.ros.streams.serialized_readers import ReferenceReader

NAMES = ['a', 'b']
PADDING = 4 + 8 + 4 + 1  # behind the encapsulation, the stamp, the length of frame_id and its end


def reference(
    position: list[float], *, sec: int = 1, names: list[str] = NAMES, velocity: list[float] | None = None
) -> JointTrajectory:
    point = JointTrajectoryPoint(positions=position, velocities=velocity or [])
    return JointTrajectory(header=Header(stamp=Time(sec=sec, nanosec=5)), joint_names=names, points=[point])


def test_every_message_is_read_as_it_is() -> None:
    reader = ReferenceReader(NAMES, 'joint_reference')
    messages = [
        reference([1.0, 2.0]),
        reference([1.0, 2.0], sec=2),
        reference([1.0, 2.0], sec=3, velocity=[0.1, 0.2]),
        reference([1.0, 2.0], sec=4, names=['b', 'a']),
        reference([1.0, 2.0], sec=5),
        reference([1.0, 2.5], sec=6),
    ]
    for message in messages:
        rows, stamp = reader.read(serialize_message(message))
        np.testing.assert_array_equal(rows, single_point(message, NAMES, 'joint_reference'))
        assert stamp == message.header.stamp.sec + 5e-9


def test_the_array_is_the_same_as_long_as_only_the_stamp_changes() -> None:
    reader = ReferenceReader(NAMES, 'joint_reference')
    first = bytearray(serialize_message(reference([1.0, 2.0])))
    second = first.copy()
    second[PADDING] ^= 0xFF
    standing = [reader.read(bytes(raw))[0] for raw in (first, first, second)]
    moved, _ = reader.read(serialize_message(reference([1.0, 2.5], sec=4)))
    assert standing[0] is standing[1] is standing[2] is not moved


@pytest.mark.parametrize(
    ('message', 'complaint'),
    [
        (reference([1.0]), '1 positions for 2 joints'),
        (reference([1.0, float('nan')]), 'nan'),
        (reference([1.0, 2.0], names=['a', 'c']), 'lacks joint b'),
        (JointTrajectory(joint_names=NAMES), '0 points'),
    ],
)
def test_what_is_refused_is_refused_again(message: JointTrajectory, complaint: str) -> None:
    reader, good = ReferenceReader(NAMES, 'joint_reference'), serialize_message(reference([1.0, 2.0]))
    reader.read(good)
    for _ in range(2):
        with pytest.raises(InvalidInputError, match=complaint):
            reader.read(serialize_message(message))
    assert reader.read(good)[0][0].tolist() == [1.0, 2.0]


def test_reads_what_a_machine_of_the_other_byte_order_sends() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    types = {name.rsplit('/', 1)[-1]: kind for name, kind in store.types.items()}
    none = np.zeros(0)
    for little in (True, False, True, False):
        for sec in (1, 2):
            reader = ReferenceReader(NAMES, 'joint_reference')
            header = types['Header'](types['Time'](sec, 5), '')
            point = types['JointTrajectoryPoint'](
                np.array([1.0, 2.0]), none, none, none, types['Duration'](0, 0)
            )
            sent = types['JointTrajectory'](header, NAMES, [point])
            raw = bytes(store.serialize_cdr(sent, sent.__msgtype__, little_endian=little))
            for _ in range(2):
                rows, stamp = reader.read(raw)
                assert (rows[0].tolist(), stamp) == ([1.0, 2.0], sec + 5e-9)
