"""RobotNode: what callbacks refuse is reported, and the node continues."""

from __future__ import annotations

from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64

from bench import Bench
from robots_core.errors import InvalidInputError
from robots_core.ros.qos import COMMAND, STREAM
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import fraction


@pytest.mark.parametrize(('qos', 'lines'), [(COMMAND, 3), (STREAM, 1)])
def test_what_a_callback_refuses_is_reported_with_its_topic(ros_nodes: Any, qos: Any, lines: int) -> None:
    bench = Bench(ros_nodes)
    node, taken = bench.start_node(lambda **options: RobotNode('taker', **options)), []
    node.create_subscription(
        Float64, 'part', lambda message: taken.append(fraction(message.data, 'part')), qos
    )
    logged: list[str] = []
    node.journal = type('Journal', (), {'error': staticmethod(logged.append)})
    for count in range(1, 4):
        bench.publish('part', Float64(data=1.0 + count))
        bench.until_health(DiagnosticStatus.WARN, f'part: part = {1.0 + count}')
    assert len(logged) == lines
    bench.publish('part', Float64(data=0.5))
    bench.wait(lambda: taken == [0.5], 'a valid message')


def test_of_messages_in_which_only_the_stamp_is_new_the_callback_gets_the_first_that_it_accepts(
    ros_nodes: Any,
) -> None:
    bench = Bench(ros_nodes)
    node = bench.start_node(lambda **options: RobotNode('taker', **options))
    taken: list[tuple[int, float]] = []
    repeated: list[int] = []
    refused = True

    def take(message: JointState) -> None:
        taken.append((message.header.stamp.sec, message.position[0]))
        if refused:
            raise InvalidInputError('not now')

    def again(stamp: bytes) -> bool:
        repeated.append(int.from_bytes(stamp[:4], 'little'))
        return repeated[-1] != 6

    node.poll(JointState, 'joint_states', take, rate=200.0, again=again)

    def send(second: int, position: float) -> None:
        message = JointState(position=[position])
        message.header.stamp.sec = second
        bench.publish('joint_states', message)
        bench.wait(lambda: second in (*(sec for sec, _ in taken), *repeated), f'message {second}')

    for second in (1, 2):
        send(second, 0.5)
    assert taken == [(1, 0.5), (2, 0.5)]  # what was refused is refused again
    refused = False
    for second, position in ((3, 0.5), (4, 0.5), (5, 0.7), (6, 0.7), (7, 0.7)):
        send(second, position)
    bench.wait(lambda: len(taken) == 5, 'the message that was not taken by its stamp')
    assert taken[2:] == [(3, 0.5), (5, 0.7), (6, 0.7)]
    assert repeated == [4, 6, 7]
