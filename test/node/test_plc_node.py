"""plc_node: a script against outputs that the test publishes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import Float64MultiArray, UInt8MultiArray

from robots_controller.nodes.plc_node import PlcNode
from robots_core.errors import InvalidInputError
from robots_core.ros.qos import STATE

EVERY_STATE = QoSProfile(depth=100, durability=STATE.durability, reliability=STATE.reliability)

SCRIPT = """
initial: {digital_input.2: true}
rules:
  - {when: digital_output.1 rises, after: 0.1, set: {digital_input.1: true, analog_input.1: 2.5}}
  - {when: digital_output.1 falls, set: {digital_input.1: false}}
"""


class Robot:
    """Publishes outputs and hears inputs, each with the time of sending in s."""

    def __init__(self, runner: Any, folder: Path, script: str) -> None:
        self.digital: list[tuple[float, list[int]]] = []
        self.analog: list[tuple[float, list[float]]] = []
        self.health: list[tuple[bytes, str]] = []
        node = runner.create_node('robot')
        for topic, kind, seen in (
            ('digital_inputs', UInt8MultiArray, self.digital),
            ('analog_inputs', Float64MultiArray, self.analog),
        ):
            node.create_subscription(
                kind, topic, lambda m, info, s=seen: s.append((sent(info), list(m.data))), EVERY_STATE
            )
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, 10)
        self.outputs = node.create_publisher(UInt8MultiArray, 'digital_outputs', STATE)
        path = folder / 'plc.yaml'
        path.write_text(script)
        self.plc = runner.add(
            PlcNode(context=runner.context, parameter_overrides=[Parameter('script', value=str(path))])
        )

    def _on_health(self, message: DiagnosticArray) -> None:
        self.health += [(s.level, s.message) for s in message.status if s.name == '/plc_node']


def sent(info: dict[str, int]) -> float:
    return 1e-9 * info['source_timestamp']


def test_inputs_follow_outputs_after_their_time(ros_nodes: Any, tmp_path: Path):
    robot = Robot(ros_nodes, tmp_path, SCRIPT)
    ros_nodes.wait_for(lambda: robot.digital and robot.analog, what='the first images')
    assert robot.digital[0][1] == [0, 1]
    assert robot.analog[0][1] == [0.0]
    started = ros_nodes.context and robot.plc.get_clock().now().nanoseconds * 1e-9
    robot.outputs.publish(UInt8MultiArray(data=[1]))
    ros_nodes.wait_for(lambda: len(robot.digital) == 2 and len(robot.analog) == 2, what='the inputs')
    assert robot.digital[1][1] == [1, 1]
    assert robot.analog[1][1] == [2.5]
    # Never early; how late depends on the machine.
    assert robot.digital[1][0] - started >= 0.1
    robot.outputs.publish(UInt8MultiArray(data=[0, 1, 1]))
    ros_nodes.wait_for(lambda: len(robot.digital) == 3, what='the fall')
    assert robot.digital[2][1] == [0, 1]


def test_rules_without_end_are_reported(ros_nodes: Any, tmp_path: Path):
    robot = Robot(
        ros_nodes,
        tmp_path,
        'rules:\n'
        '  - {when: digital_input.1 rises, set: {digital_input.1: 0}}\n'
        '  - {when: digital_input.1 falls, set: {digital_input.1: 1}}\n'
        '  - {when: digital_output.1 rises, set: {digital_input.1: 1}}\n',
    )
    robot.outputs.publish(UInt8MultiArray(data=[1]))
    ros_nodes.wait_for(
        lambda: any(
            level == DiagnosticStatus.ERROR and 'without end' in text for level, text in robot.health
        ),
        what='the report',
    )


def test_a_wrong_script_is_refused_at_start(ros_nodes: Any, tmp_path: Path):
    with pytest.raises(InvalidInputError, match=r'plc\.yaml:2: when is missing'):
        Robot(ros_nodes, tmp_path, 'rules:\n  - {set: {digital_input.1: 1}}\n')
