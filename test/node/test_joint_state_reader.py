"""Positions read in their place are those of the message, whatever comes before and after them."""

from __future__ import annotations

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import serialize_message
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState
from std_msgs.msg import Header

from robots_core.errors import InvalidInputError
from robots_core.ros.streams.serialized_readers import JointStateReader

names_of_joints = st.lists(
    st.text(st.characters(exclude_characters='\0', codec='utf-8'), min_size=1, max_size=9),
    min_size=1,
    max_size=8,
    unique=True,
)
numbers = st.floats(-1e6, 1e6)


def message(
    names: list[str], position: list[float], frame: str = '', velocity: list[float] | None = None
) -> JointState:
    header = Header(frame_id=frame, stamp=Time(sec=7, nanosec=8))
    return JointState(header=header, name=names, position=position, velocity=velocity or [])


@given(st.data())
def test_positions_are_matched_by_name_in_every_message(data: st.DataObject) -> None:
    names = data.draw(names_of_joints)
    wanted = data.draw(st.permutations(names))[: data.draw(st.integers(1, len(names)))]
    frame = data.draw(st.text(st.characters(exclude_characters='\0', codec='utf-8'), max_size=5))
    reader = JointStateReader(wanted)
    # The first is built, the others are read in their place.
    for velocity in ([], [0.5] * len(names), []):
        values = data.draw(st.lists(numbers, min_size=len(names), max_size=len(names)))
        raw = serialize_message(message(names, values, frame, velocity))
        assert reader.position(raw).tolist() == [values[names.index(name)] for name in wanted]


@given(st.lists(names_of_joints.filter(lambda names: 'wanted' not in names), min_size=2, max_size=5))
def test_messages_of_several_kinds_may_take_turns(others: list[list[str]]) -> None:
    reader = JointStateReader(['wanted'])
    for _ in range(2):
        for number, other in enumerate(others):
            raw = serialize_message(message([*other, 'wanted'], [0.0] * len(other) + [float(number)]))
            assert reader.position(raw).tolist() == [float(number)]


def test_reads_what_a_machine_of_the_other_byte_order_sends() -> None:
    reader, store = JointStateReader(['a', 'bc']), get_typestore(Stores.ROS2_JAZZY)
    time, header, state = (
        store.types[name]
        for name in ('builtin_interfaces/msg/Time', 'std_msgs/msg/Header', 'sensor_msgs/msg/JointState')
    )
    for value, little in ((0.1, True), (0.3, False), (0.5, True)):
        position, none = np.array([value, -value]), np.zeros(0)
        sent = state(header(time(7, 8), 'frame'), ['a', 'bc'], position, none, none)
        raw = bytes(store.serialize_cdr(sent, state.__msgtype__, little_endian=little))
        assert reader.position(raw).tolist() == [value, -value]


@pytest.mark.parametrize('before', [0, 1], ids=['first', 'later'])
@pytest.mark.parametrize(
    ('names', 'position', 'complaint'),
    [
        (['a'], [1.0], 'lacks joint b'),
        (['a', 'a'], [1.0, 2.0], 'twice'),
        (['a', 'b'], [1.0], '1 values for 2 joints'),
        (['a', 'b'], [1.0, 2.0, 3.0], '3 values for 2 joints'),
        (['a', 'b'], [], '0 values for 2 joints'),
        (['a', 'b'], [1.0, float('nan')], r'joint_states\[1\] is nan'),
        (['a', 'b'], [float('inf'), 0.0], r'joint_states\[0\] is inf'),
    ],
)
def test_refuses_messages_that_do_not_say_where_the_robot_is(
    before: int, names: list[str], position: list[float], complaint: str
) -> None:
    reader = JointStateReader(['a', 'b'])
    good = serialize_message(message(['a', 'b'], [1.0, 2.0]))
    for _ in range(before):
        reader.position(good)
    with pytest.raises(InvalidInputError, match=complaint):
        reader.position(serialize_message(message(names, position)))
    assert reader.position(good).tolist() == [1.0, 2.0]
