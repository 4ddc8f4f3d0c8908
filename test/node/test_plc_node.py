"""plc_node: a script against outputs that the test publishes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Float64MultiArray, UInt8MultiArray

from bench import EVERY_STATE, Bench
from plant_partners import MqttPartner, free_port
from robots_controller.nodes.io_bridge_node import IoBridgeNode
from robots_controller.nodes.plc_node import PlcNode
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE

SCRIPT = """
initial: {digital_input.2: true}
rules:
  - {when: digital_output.1 rises, after: 0.1, set: {digital_input.1: true, analog_input.1: 2.5}}
  - {when: digital_output.1 falls, set: {digital_input.1: false}}
"""


class Robot(Bench):
    """Publishes outputs and collects inputs, each with the time of sending in s."""

    def __init__(self, runner: Any, folder: Path, script: str, **options: Any) -> None:
        super().__init__(runner, 'robot')
        self.digital = self.collect_sent('digital_inputs', UInt8MultiArray, EVERY_STATE)
        self.analog = self.collect_sent('analog_inputs', Float64MultiArray, EVERY_STATE)
        path = folder / 'plc.yaml'
        path.write_text(script)
        self.plc = self.start_node(PlcNode, script=str(path), **options)

    def switch(self, *outputs: int) -> None:
        self.publish('digital_outputs', UInt8MultiArray(data=outputs), STATE)


def test_inputs_follow_outputs_after_their_time(ros_nodes: Any, tmp_path: Path):
    robot = Robot(ros_nodes, tmp_path, SCRIPT)
    robot.wait(lambda: robot.digital and robot.analog, 'the first images')
    told = robot.collect('plc_status', DiagnosticStatus, EVERY_STATE, diagnostic_values)
    robot.wait(lambda: told, 'the state of the PLC')
    assert told[0]['script'] == 'plc.yaml'
    assert json.loads(told[0]['pending']) == []
    assert list(robot.digital[0][1]) == [0, 1]
    assert list(robot.analog[0][1]) == [0.0]
    started = robot.plc.get_clock().now().nanoseconds * 1e-9
    robot.switch(1)
    robot.wait(lambda: len(robot.digital) == 2 and len(robot.analog) == 2, 'the inputs')
    assert list(robot.digital[1][1]) == [1, 1]
    assert list(robot.analog[1][1]) == [2.5]
    robot.wait(lambda: len(told) == 3, 'what was due, and its end')
    ((time, line, inputs),) = json.loads(told[1]['pending'])
    assert (line, inputs) == (4, {'digital_input.1': 1.0, 'analog_input.1': 2.5})
    assert time - started >= 0.1
    assert json.loads(told[2]['pending']) == []
    # Never early; how late depends on the machine.
    assert robot.digital[1][0] - started >= 0.1
    robot.switch(0, 1, 1)
    robot.wait(lambda: len(robot.digital) == 3, 'the fall')
    assert list(robot.digital[2][1]) == [0, 1]


def test_rules_without_end_are_reported(ros_nodes: Any, tmp_path: Path):
    robot = Robot(
        ros_nodes,
        tmp_path,
        'rules:\n'
        '  - {when: digital_input.1 rises, set: {digital_input.1: 0}}\n'
        '  - {when: digital_input.1 falls, set: {digital_input.1: 1}}\n'
        '  - {when: digital_output.1 rises, set: {digital_input.1: 1}}\n',
    )
    robot.switch(1)
    robot.until_health(DiagnosticStatus.ERROR, 'without end')


def test_a_wrong_script_is_refused_at_start(ros_nodes: Any, tmp_path: Path):
    with pytest.raises(InvalidInputError, match=r'plc\.yaml:2: when is missing'):
        Robot(ros_nodes, tmp_path, 'rules:\n  - {set: {digital_input.1: 1}}\n')


@pytest.mark.parametrize('protocol', ['modbus', 'opcua', 'mqtt'])
def test_a_map_connects_a_robot_with_a_plc_that_is_a_server(
    ros_nodes: Any, tmp_path: Path, protocol: str
) -> None:
    broker = MqttPartner()
    port = broker.port
    if protocol == 'mqtt':
        broker.start()
    places = {
        'modbus': (
            f'{{host: 127.0.0.1, port: {port}, response_timeout: 60.0, period: 0.02}}',
            'discrete_input: 0',
            'coil: 0',
        ),
        'opcua': (
            f"{{endpoint: 'opc.tcp://127.0.0.1:{port}', response_timeout: 60.0}}",
            'node: nsu=urn:robots:plc;s=digital_input.1',
            'node: nsu=urn:robots:plc;s=digital_output.1',
        ),
        'mqtt': (
            f'{{host: 127.0.0.1, port: {port}, response_timeout: 60.0}}',
            'topic: plc/digital_input.1',
            'topic: plc/digital_output.1, retain: true',
        ),
    }
    server, read, written = places[protocol]
    io_map = tmp_path / 'map.yaml'
    io_map.write_text(f"""
{protocol}: {{plc: {server}}}
inputs: [{{channel: digital_input.1, {protocol}: {{{read}}}}}]
outputs: [{{channel: digital_output.1, {protocol}: {{{written}}}}}]
""")
    robot = Robot(ros_nodes, tmp_path, SCRIPT, **{f'{protocol}_port': port})
    robot.start_node(IoBridgeNode, io_map=str(io_map), watchdog=0.0)
    robot.switch(1)
    robot.wait(lambda: robot.digital and robot.digital[-1][1][0] == 1, 'the input that follows')
    broker.end()


def test_a_plc_in_simulated_time_is_no_server(ros_nodes: Any, tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match='a PLC in simulated time is no server and at no broker'):
        Robot(ros_nodes, tmp_path, SCRIPT, modbus_port=free_port(), use_sim_time=True)
