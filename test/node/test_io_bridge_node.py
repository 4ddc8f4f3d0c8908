"""io_bridge_node: maps between real topics."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseArray, Wrench
from rcl_interfaces.srv import DescribeParameters
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import (
    Bool,
    Float32,
    Float64,
    Float64MultiArray,
    UInt8,
    UInt8MultiArray,
    UInt16MultiArray,
    UInt64,
)

from bench import EVERY_STATE, MANY, Bench
from plant_partners import ModbusPartner
from robots_controller.io.stopping_inputs import unknown_inputs
from robots_controller.nodes.io_bridge_node import WATCH_PERIOD, IoBridgeNode
from robots_core.errors import InvalidInputError
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.peers.heartbeat import HEARTBEAT, Heartbeat
from robots_core.ros.qos import COMMAND, STATE, make_publisher
from robots_core.ros.timed_node import TimedNode

CONFIG = Path(__file__).parents[2] / 'robots_controller' / 'config'


class Plc(Bench):
    """The test plays both the PLC and the robot."""

    def __init__(self, runner: Any, path: Path) -> None:
        super().__init__(runner, 'plc')
        for topic, kind in (('digital_inputs', UInt8MultiArray), ('analog_inputs', Float64MultiArray)):
            self.collect(topic, kind, EVERY_STATE, lambda m: list(m.data))
        self.bridge = self.start_node(IoBridgeNode, io_map=str(path))

    def subscribed(self, kind: Any, topic: str, qos: QoSProfile = MANY) -> list[Any]:
        """Messages of a topic of the bridge, from when it was found on."""
        found: list[Any] = []
        subscription = self.peer.create_subscription(kind, topic, found.append, qos)
        self.wait(subscription.get_publisher_count, f'the bridge on {topic}')
        return found

    def repeat(self, topic: str, message: Any, qos: QoSProfile = COMMAND) -> None:
        """Publish a message again and again."""
        publisher = self.publisher(topic, type(message), qos)
        self.peer.create_timer(0.02, lambda: publisher.publish(message))

    def wait_for_input(self, image: str, values: list[float]) -> None:
        found = self.collected(f'{image}_inputs')
        self.wait(lambda: found and found[-1] == pytest.approx(values), f'{values} {image}')

    def wait_for_health(self, level: bytes, text: str) -> None:
        """Until this is the newest health."""

        def newest() -> bool:
            own = [one for one in self.health if one.name == '/io_bridge_node']
            return bool(own) and own[-1].level == level and text in own[-1].message

        self.wait(newest, text)


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
    (silent,) = (one for one in plc.health[-1:] if one.name == '/io_bridge_node')
    assert diagnostic_values(silent)['was_ready'] == 'True'  # a cell does not wait for its PLC
    message = UInt16MultiArray(data=[0b0000_0001_0000_0101])
    plc.repeat('plc/input_words', message)
    plc.repeat('plc/analog_words', UInt16MultiArray(data=[2048]))
    plc.wait_for_input('digital', [1, 0, 1, 0, 0])
    plc.wait_for_input('analog', [2048 * 0.002442])
    message.data[0] = 0b1010
    plc.wait_for_input('digital', [0, 1, 0, 1, 1])

    words = plc.subscribed(UInt16MultiArray, 'plc/output_words')
    plc.repeat('digital_outputs', UInt8MultiArray(data=[1, 0, 1, 0]), STATE)
    plc.repeat('analog_outputs', Float64MultiArray(data=[5.0]), STATE)
    # 0..10 V is 0..4095: 5 V is 2047.5, rounded to the even neighbour.
    expected = [0b101, 2048]
    plc.wait(lambda: [list(m.data) for m in words[-3:]] == 3 * [expected], 'the words and their repetitions')


def test_emergency_stops_without_a_value_are_named_in_the_label_of_their_image(bridge: Any):
    rows = [
        f'  - {{channel: digital_input.{k}, topic: plc/{name}, type: Bool}}\n'
        for k, name in enumerate('abc', 1)
    ]
    stops = 'emergency_stop: {digital_input.1: off, digital_input.2: off}\n'
    plc = bridge(stops + 'inputs:\n' + ''.join(rows))
    images = plc.collect('digital_inputs', UInt8MultiArray, EVERY_STATE)

    def unknown() -> dict[int, str]:
        return unknown_inputs(one.label for one in images[-1].layout.dim)

    silent = {k: f'plc/{name} has sent no value yet' for k, name in enumerate('ab', 1)}
    plc.wait(lambda: images and unknown() == silent, 'the start')
    plc.repeat('plc/a', Bool(data=False))  # the value that it has already
    plc.wait(lambda: unknown() == {2: silent[2]}, 'a value of one')
    plc.repeat('plc/b', Bool(data=True))
    plc.wait(lambda: list(images[-1].data) == [0, 1, 0] and not unknown(), 'values of both')
    assert not images[-1].layout.dim


class RobotInLockstep(TimedNode):
    """Publishes images of its outputs until a time, and is subscribed to what the bridge makes of them."""

    END = 3.0  # s

    def __init__(self, **options: Any) -> None:
        super().__init__('robot', **options)
        self.words: list[tuple[float, list[int]]] = []
        self._digital = self.create_publisher(UInt8MultiArray, 'digital_outputs', STATE)
        self._analog = self.create_publisher(Float64MultiArray, 'analog_outputs', STATE)
        self.create_subscription(UInt16MultiArray, 'plc/output_words', self._on_words, COMMAND)
        self.start_loop(self._work, period=0.1, name='robot', phase=Phase.ENVIRONMENT)

    def _work(self, now: float) -> None:
        if now <= self.END:
            self._digital.publish(UInt8MultiArray(data=[1, 0, 1]))
        self._analog.publish(Float64MultiArray(data=[5.0]))

    def _on_words(self, message: UInt16MultiArray) -> None:
        self.words.append((self.now(), list(message.data)))


def test_outputs_are_fail_safe_when_their_images_are_old(ros_nodes: Any):
    """By the time of the last one: its publisher is there all the time."""
    path = str(CONFIG / 'io_map_words.yaml')
    robot = ros_nodes.add(RobotInLockstep(**ros_nodes.options(lockstep=True)))
    bench = Bench(ros_nodes)
    bench.start_node(IoBridgeNode, io_map=path, lockstep=True)
    run = ros_nodes.coordinate('robot', 'io_bridge_node')
    bench.wait(lambda: robot.words and robot.words[-1][0] > robot.END + 1.0, 'the end')
    ros_nodes.call(run.end)
    on = [time for time, words in robot.words if words == [0b101, 2048]]
    off = [time for time, words in robot.words if words == [0, 2048]]
    lost = robot.END + 0.5
    assert on[-1] <= off[0] == pytest.approx(lost, abs=WATCH_PERIOD)
    bench.until_health(DiagnosticStatus.WARN, 'digital_outputs was not published for 0.5 s')


def test_outputs_are_fail_safe_when_the_programs_node_is_lost_whoever_publishes_images(ros_nodes: Any):
    heartbeat = Heartbeat(ros_nodes.add(TimedNode('lua_program_node', context=ros_nodes.context)))
    bench = Bench(ros_nodes)
    words = bench.collect('plc/output_words', UInt16MultiArray, read=lambda m: list(m.data))
    bridge = bench.start_node(IoBridgeNode, io_map=str(CONFIG / 'io_map_words.yaml'), watchdog=1.0)
    digital = bench.publisher('digital_outputs', UInt8MultiArray, STATE)
    analog = bench.publisher('analog_outputs', Float64MultiArray, STATE)

    def publish() -> None:
        digital.publish(UInt8MultiArray(data=[1, 0, 1]))
        analog.publish(Float64MultiArray(data=[5.0]))

    bench.peer.create_timer(0.02, publish)
    bench.wait(lambda: words and words[-1] == [0b101, 2048], 'the outputs')
    watched = bridge._watch._watched['lua_program_node'][1]
    bench.wait(lambda: watched._silence is not None, 'its heartbeat')
    heartbeat.stop()
    bench.wait(lambda: words[-1] == [0, 0], 'fail-safe values')
    bench.until_health(DiagnosticStatus.WARN, 'lua_program_node gives no sign of life; digital_output.1 is')


def test_outputs_are_fail_safe_when_the_programs_node_dies_before_its_first_sign_of_life(ros_nodes: Any):
    node = ros_nodes.add(TimedNode('lua_program_node', context=ros_nodes.context))
    make_publisher(node, UInt64, f'~/{HEARTBEAT}')
    bench = Bench(ros_nodes)
    words = bench.collect('plc/output_words', UInt16MultiArray, read=lambda m: m.data[0])
    bench.start_node(IoBridgeNode, io_map=str(CONFIG / 'io_map_words.yaml'))
    bench.publish('analog_outputs', Float64MultiArray(data=[5.0]), STATE)
    digital = bench.publisher('digital_outputs', UInt8MultiArray, STATE)
    bench.peer.create_timer(0.02, lambda: digital.publish(UInt8MultiArray(data=[1, 0, 1])))
    bench.until_health(DiagnosticStatus.WARN, 'lua_program_node gives no sign of life; digital_output.1 is')
    bench.wait(lambda: words and words[-1] == 0, 'fail-safe values')


def test_outputs_of_a_node_that_froze_stay_fail_safe_until_it_has_switched_them_itself(ros_nodes: Any):
    node = ros_nodes.add(TimedNode('lua_program_node', context=ros_nodes.context))
    heartbeat = Heartbeat(node)
    bench = Bench(ros_nodes)
    words = bench.collect('plc/output_words', UInt16MultiArray, read=lambda m: m.data[0])
    bridge = bench.start_node(IoBridgeNode, io_map=str(CONFIG / 'io_map_words.yaml'), watchdog=1.0)
    digital = bench.publisher('digital_outputs', UInt8MultiArray, STATE)
    bench.publish('analog_outputs', Float64MultiArray(data=[5.0]), STATE)
    image = [1, 0, 1]
    bench.peer.create_timer(0.02, lambda: digital.publish(UInt8MultiArray(data=image)))
    bench.wait(lambda: words and words[-1] == 0b101, 'the outputs')
    watched = bridge._watch._watched['lua_program_node'][1]
    bench.wait(lambda: watched._silence is not None, 'its heartbeat')
    heartbeat.stop()
    bench.wait(lambda: words[-1] == 0, 'fail-safe values')
    heartbeat = Heartbeat(node)
    bench.wait(lambda: not bridge._watch.lost, 'its heartbeat again')
    image[:] = [1, 1, 1]
    bench.wait(lambda: words[-1], 'an output that was off')
    assert words[-1] == 0b010
    bench.until_health(
        DiagnosticStatus.WARN, 'has not switched it since; digital_output.1 is at its fail-safe'
    )
    image[:] = [0, 1, 1]
    bench.wait(lambda: 'digital_output.1' not in bridge.bridge.left, 'the output switched off')
    image[:] = [1, 1, 1]
    bench.wait(lambda: words[-1] == 0b011, 'what the node has switched off and on')
    heartbeat.stop()


def test_a_bridge_that_ends_leaves_fail_safe_values(bridge: Any):
    plc = bridge("""
fail_safe: {digital_output.2: hold, analog_output.1: 2.5}
outputs:
  - {bits: {0: digital_output.1, 1: digital_output.2}, topic: word, type: UInt8}
  - {channel: analog_output.1, topic: current, type: Float64}
""")
    words, currents = plc.subscribed(UInt8, 'word'), plc.subscribed(Float64, 'current')
    plc.repeat('digital_outputs', UInt8MultiArray(data=[1, 1]), STATE)
    plc.repeat('analog_outputs', Float64MultiArray(data=[7.0]), STATE)
    plc.wait(lambda: words and words[-1].data == 0b11 and currents and currents[-1].data == 7.0, 'all on')
    plc.runner.destroy(plc.bridge)
    plc.wait(lambda: words[-1].data == 0b10 and currents[-1].data == 2.5, 'fail-safe values')


def test_a_plc_that_publishes_one_topic_per_tag(ros_nodes: Any):
    plc = Plc(ros_nodes, CONFIG / 'io_map_tags.yaml')
    plc.wait_for_input('digital', [0, 1, 0])  # closed is the fail-safe value
    plc.repeat('plc/press/ready', Bool(data=True))
    plc.repeat('plc/press/closed', Bool(data=False))
    plc.wait_for_input('digital', [1, 0, 0])
    sensor = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    plc.repeat('plc/press/force', Float32(data=2500.0), sensor)
    plc.wait_for_input('analog', [2.5])
    current = plc.subscribed(Float64, 'plc/torch/current')
    plc.repeat('digital_outputs', UInt8MultiArray(data=[1]), STATE)
    plc.repeat('analog_outputs', Float64MultiArray(data=[0.5]), STATE)
    plc.wait(lambda: current and current[-1].data == 0.5, 'the current')
    # Latched: also for a PLC that comes late.
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    start = plc.subscribed(Bool, 'plc/press/start', latched)
    plc.wait(lambda: start and start[-1].data, 'the start signal')


def test_a_plc_that_starts_later_is_sent_what_has_not_changed_since(bridge: Any):
    plc = bridge('outputs:\n  - {channel: digital_output.1, topic: plc/start, type: Bool}\n')
    first = plc.subscribed(Bool, 'plc/start')
    plc.repeat('digital_outputs', UInt8MultiArray(data=[1]), STATE)
    plc.wait(lambda: first and first[-1].data, 'the start signal')
    late = plc.subscribed(Bool, 'plc/start')
    plc.wait(lambda: late and late[-1].data, 'the start signal, sent again')


def test_any_field_of_any_message(bridge: Any):
    plc = bridge("""
inputs:
  - {channel: analog_input.1, topic: a, type: geometry_msgs/Wrench, field: force.z, scale: -1}
  - {channel: analog_input.2, topic: b, type: geometry_msgs/msg/PoseArray, field: 'poses[1].position.x'}
outputs:
  - {channel: analog_output.2, topic: c, type: geometry_msgs/PoseArray, field: 'poses[1].position.y'}
""")
    message = Wrench()
    message.force.z = -3.5
    plc.publish('a', message)
    plc.wait_for_input('analog', [3.5, 0.0])
    plc.publish('b', PoseArray())
    plc.wait_for_health(DiagnosticStatus.WARN, 'b: poses has 0 elements; poses[1].position.x needs 2')
    arrays = plc.subscribed(PoseArray, 'c')
    plc.repeat('analog_outputs', Float64MultiArray(data=[1.0, 2.0]), STATE)
    wanted = [0.0, 2.0]
    plc.wait(lambda: arrays and [pose.position.y for pose in arrays[-1].poses] == wanted, 'the array')
    assert arrays[-1].header.stamp.sec > 0
    plc.publish('b', arrays[-1])
    plc.wait_for_health(DiagnosticStatus.OK, 'ready')


def test_an_output_that_does_not_fit_is_reported(bridge: Any):
    plc = bridge('outputs:\n  - {channel: analog_output.1, topic: a, type: UInt8}\n')
    message = Float64MultiArray(data=[300.0])
    plc.repeat('analog_outputs', message, STATE)
    plc.wait_for_health(DiagnosticStatus.WARN, 'analog_output.1 would be 300; uint8 ends at 255')
    message.data[0] = 3.0
    plc.wait_for_health(DiagnosticStatus.OK, 'ready')


def test_rows_of_a_plant_beside_those_of_topics(bridge: Any):
    partner = ModbusPartner()
    plc = bridge(f"""
modbus:
  press: {{host: 127.0.0.1, port: {partner.port}, period: 0.02, response_timeout: 60.0}}
inputs:
  - {{channel: digital_input.1, topic: ready, type: Bool}}
  - {{channel: digital_input.2, modbus: {{discrete_input: 3}}}}
outputs:
  - {{channel: digital_output.1, modbus: {{coil: 1}}}}
""")
    plc.wait_for_health(DiagnosticStatus.WARN, 'modbus press: 127.0.0.1:')
    plc.repeat('digital_outputs', UInt8MultiArray(data=[1]), STATE)
    partner.start()
    partner.set('discrete_input', 3, [True])
    plc.wait_for_health(DiagnosticStatus.OK, 'ready')
    plc.publish('ready', Bool(data=True))
    plc.wait_for_input('digital', [1, 1])
    plc.wait(lambda: partner.get('coil', 1) == [True], 'the output')
    names = ['digital_output.1', 'digital_input.9']
    described = plc.call(
        'io_bridge_node/describe_io', DescribeParameters.Request(names=names), DescribeParameters
    )
    assert [one.description for one in described.descriptors] == [
        'coil 1 of unit 1 of modbus press',
        'is not in the I/O map',
    ]
    plc.runner.destroy(plc.bridge)
    assert partner.written[-1] == ('coil', 1, [0])  # fail-safe, and confirmed before the end
    partner.end()


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
def test_what_does_not_exist_is_reported_with_its_line(ros_nodes: Any, bridge: Any, row: str, message: str):
    del ros_nodes
    with pytest.raises(InvalidInputError) as info:
        bridge(f'inputs:\n  - {{channel: digital_input.1, topic: a, {row}}}\n')
    assert str(info.value).startswith(f'map.yaml:2: {message}')


def test_an_array_of_fixed_length_is_not_lengthened(ros_nodes: Any, bridge: Any):
    del ros_nodes
    row = 'channel: analog_output.1, topic: a, type: sensor_msgs/Imu, field: "angular_velocity_covariance[9]"'
    with pytest.raises(InvalidInputError, match=r'map\.yaml:2: angular_velocity_covariance has 9 elements'):
        bridge(f'outputs:\n  - {{{row}}}\n')
