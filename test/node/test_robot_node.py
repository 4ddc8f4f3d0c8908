"""RobotNode: what callbacks refuse is reported, and the node continues."""

from __future__ import annotations

from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Float64

from robots_core.ros.qos import COMMAND, STREAM
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import fraction

from .bench import Bench


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
