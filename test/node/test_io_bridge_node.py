"""io_bridge_node: maps between real topics."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseArray, Wrench
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, Float32, Float64, Float64MultiArray, UInt8MultiArray, UInt16MultiArray

from robots_controller.nodes.io_bridge_node import IoBridgeNode
from robots_core.errors import InvalidInputError
from robots_core.ros.qos import STATE

CONFIG = Path(__file__).parents[2] / 'robots_controller' / 'config'
MANY = QoSProfile(depth=100)
EVERY_STATE = QoSProfile(depth=100, durability=STATE.durability, reliability=STATE.reliability)


class Plc:
    """The test plays both the PLC and the robot."""

    def __init__(self, runner: Any, path: Path) -> None:
        self.runner = runner
        self.node = runner.create_node('plc')
        self.robot = runner.create_node('robot')
        self.inputs: dict[str, list[list[float]]] = {'digital_inputs': [], 'analog_inputs': []}
        self.health: list[tuple[bytes, str]] = []
        for topic, kind in (('digital_inputs', UInt8MultiArray), ('analog_inputs', Float64MultiArray)):
            seen = self.inputs[topic]
            self.robot.create_subscription(kind, topic, lambda m, s=seen: s.append(list(m.data)), EVERY_STATE)
        self.robot.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, 10)
        self.bridge = runner.add(
            IoBridgeNode(context=runner.context, parameter_overrides=[Parameter('io_map', value=str(path))])
        )

    def _on_health(self, message: DiagnosticArray) -> None:
        self.health += [(s.level, s.message) for s in message.status if s.name == '/io_bridge_node']

    def publisher(self, kind: Any, topic: str, qos: QoSProfile = MANY) -> Any:
        publisher = self.node.create_publisher(kind, topic, qos)
        self.runner.wait_for(publisher.get_subscription_count, what=f'the bridge on {topic}')
        return publisher

    def heard(self, kind: Any, topic: str, qos: QoSProfile = MANY) -> list[Any]:
        seen: list[Any] = []
        subscription = self.node.create_subscription(kind, topic, seen.append, qos)
        self.runner.wait_for(subscription.get_publisher_count, what=f'the bridge on {topic}')
        return seen

    def wait_for_input(self, image: str, values: list[float]) -> None:
        seen = self.inputs[f'{image}_inputs']
        self.runner.wait_for(lambda: seen and seen[-1] == pytest.approx(values), what=f'{values} {image}')

    def wait_for_health(self, level: bytes, text: str) -> None:
        self.runner.wait_for(
            lambda: self.health and self.health[-1][0] == level and text in self.health[-1][1], what=text
        )


@pytest.fixture
def bridge(ros_nodes: Any, tmp_path: Path) -> Any:
    def start(text: str) -> Plc:
        path = tmp_path / 'map.yaml'
        path.write_text(text)
        return Plc(ros_nodes, path)

    return start


def test_a_plc_that_publishes_words(ros_nodes: Any):
    plc = Plc(ros_nodes, CONFIG / 'io_map_words.yaml')
    plc.wait_for_health(DiagnosticStatus.WARN, 'plc/input_words has been silent for 0.5 s')
    words = plc.publisher(UInt16MultiArray, 'plc/input_words')
    analog = plc.publisher(UInt16MultiArray, 'plc/analog_words')
    message, level = UInt16MultiArray(data=[0b0000_0001_0000_0101]), UInt16MultiArray(data=[2048])
    plc.node.create_timer(0.02, lambda: (words.publish(message), analog.publish(level)))
    plc.wait_for_input('digital', [1, 0, 1, 0, 0])
    plc.wait_for_input('analog', [2048 * 0.002442])
    plc.wait_for_health(DiagnosticStatus.OK, 'ready')
    message.data[0] = 0b1010
    plc.wait_for_input('digital', [0, 1, 0, 1, 1])

    sent = plc.heard(UInt16MultiArray, 'plc/output_words')
    digital = plc.robot.create_publisher(UInt8MultiArray, 'digital_outputs', STATE)
    outputs = plc.robot.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
    digital.publish(UInt8MultiArray(data=[1, 0, 1, 0]))
    outputs.publish(Float64MultiArray(data=[5.0]))
    # 0..10 V is 0..4095: 5 V is 2047.5, rounded to the even neighbour.
    ros_nodes.wait_for(lambda: sent and list(sent[-1].data) == [0b101, 2048], what='the words')
    count = len(sent)
    ros_nodes.wait_for(lambda: len(sent) >= count + 3, what='repetitions')
    assert all(list(m.data) == [0b101, 2048] for m in sent[count:])
    ros_nodes.call(lambda: plc.robot.destroy_publisher(digital))
    ros_nodes.wait_for(lambda: list(sent[-1].data) == [0, 2048], what='the fail-safe values')
    plc.wait_for_health(DiagnosticStatus.WARN, 'nobody has published digital_outputs for 0.5 s')


def test_a_plc_that_publishes_one_topic_per_tag(ros_nodes: Any):
    plc = Plc(ros_nodes, CONFIG / 'io_map_tags.yaml')
    plc.wait_for_input('digital', [0, 1, 0])  # closed is the fail-safe value
    ready = plc.publisher(Bool, 'plc/press/ready')
    closed = plc.publisher(Bool, 'plc/press/closed')
    sensor = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    force = plc.publisher(Float32, 'plc/press/force', sensor)
    ready.publish(Bool(data=True))
    closed.publish(Bool(data=False))
    plc.wait_for_input('digital', [1, 0, 0])
    plc.node.create_timer(0.02, lambda: force.publish(Float32(data=2500.0)))
    plc.wait_for_input('analog', [2.5])
    digital = plc.robot.create_publisher(UInt8MultiArray, 'digital_outputs', STATE)
    analog = plc.robot.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
    digital.publish(UInt8MultiArray(data=[1]))
    analog.publish(Float64MultiArray(data=[0.25]))
    current = plc.heard(Float64, 'plc/torch/current')
    analog.publish(Float64MultiArray(data=[0.5]))
    ros_nodes.wait_for(lambda: current and current[-1].data == 0.5, what='the current')
    # Latched: also for a PLC that comes late.
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    start = plc.heard(Bool, 'plc/press/start', latched)
    ros_nodes.wait_for(lambda: start and start[-1].data, what='the start signal')


def test_any_field_of_any_message(ros_nodes: Any, bridge: Any):
    plc = bridge("""
inputs:
  - {channel: analog_input.1, topic: a, type: geometry_msgs/Wrench, field: force.z, scale: -1}
  - {channel: analog_input.2, topic: b, type: geometry_msgs/msg/PoseArray, field: 'poses[1].position.x'}
outputs:
  - {channel: analog_output.2, topic: c, type: geometry_msgs/PoseArray, field: 'poses[1].position.y'}
""")
    wrench, poses = plc.publisher(Wrench, 'a'), plc.publisher(PoseArray, 'b')
    message = Wrench()
    message.force.z = -3.5
    wrench.publish(message)
    plc.wait_for_input('analog', [3.5, 0.0])
    poses.publish(PoseArray())
    plc.wait_for_health(DiagnosticStatus.WARN, 'b: poses has 0 elements; poses[1].position.x needs 2')
    analog = plc.robot.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
    heard = plc.heard(PoseArray, 'c')
    analog.publish(Float64MultiArray(data=[1.0, 2.0]))
    ros_nodes.wait_for(lambda: heard, what='the array')
    assert [pose.position.y for pose in heard[-1].poses] == [0.0, 2.0]
    poses.publish(heard[-1])
    plc.wait_for_health(DiagnosticStatus.OK, 'ready')


def test_an_output_that_does_not_fit_is_told(bridge: Any):
    plc = bridge('outputs:\n  - {channel: analog_output.1, topic: a, type: UInt8}\n')
    analog = plc.robot.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
    analog.publish(Float64MultiArray(data=[300.0]))
    plc.wait_for_health(DiagnosticStatus.WARN, 'analog_output.1 would be 300; uint8 ends at 255')
    analog.publish(Float64MultiArray(data=[3.0]))
    plc.wait_for_health(DiagnosticStatus.OK, 'ready')


@pytest.mark.parametrize(
    ('row', 'message'),
    [
        ('type: no_such_msgs/A', "no_such_msgs/msg/A: the package 'no_such_msgs' cannot be imported"),
        ('type: std_msgs/NoSuch', "std_msgs/msg/NoSuch: 'std_msgs' has no message 'NoSuch'"),
        (
            'type: Bool, field: value',
            "the message has no field 'value', which value needs; its fields are data",
        ),
        (
            'type: UInt16MultiArray',
            r"data is 'sequence<uint16>'; needed is a number or a bool; an element of",
        ),
        ('type: UInt16MultiArray, field: "data[0].x"', r"data[0] has no field 'x', which data[0].x needs"),
        ('type: Bool, field: "data[0]"', "data is 'boolean' and no array, which data[0] needs"),
        ('type: String', "'String' is no message type"),
        ('type: std_msgs/String', "data is 'string'; needed is a number or a bool"),
        ('type: Float32, bit: 1', "data is 'float'; a bit needs a whole number"),
        ('type: UInt16, bit: 16', "data is 'uint16' with bits 0..15, not 16"),
    ],
)
def test_what_does_not_exist_is_told_with_its_line(ros_nodes: Any, bridge: Any, row: str, message: str):
    del ros_nodes
    with pytest.raises(InvalidInputError) as info:
        bridge(f'inputs:\n  - {{channel: digital_input.1, topic: a, {row}}}\n')
    assert str(info.value).startswith(f'map.yaml:2: {message}')


def test_an_array_of_fixed_length_is_not_lengthened(ros_nodes: Any, bridge: Any):
    del ros_nodes
    row = 'channel: analog_output.1, topic: a, type: sensor_msgs/Imu, field: "angular_velocity_covariance[9]"'
    with pytest.raises(InvalidInputError, match=r'map\.yaml:2: angular_velocity_covariance has 9 elements'):
        bridge(f'outputs:\n  - {{{row}}}\n')
