"""How long a value of a plant takes through a robot program's handler and back, next to a bare client.

Run by `make benchmark-plant`. The plant is in this process: a Modbus TCP server, an MQTT broker, an OPC UA
server and a PLC on topics. A cell answers through its I/O bridge and the handlers of its program; beside it a
bare client of the same library answers by itself. Both take turns, so that a busy machine hits both.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from asyncua.common.callback import CallbackType
from benchmark_controller import node_command, process
from builtin_interfaces.msg import Time
from contest import Row, show
from diagnostic_msgs.msg import DiagnosticStatus
from plant_echoes import ECHOES, PERIOD
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rich.progress import track
from sensor_msgs.msg import JointState
from std_msgs.msg import UInt8
from trajectory_msgs.msg import JointTrajectory

from opcua_partners import OpcuaPartner, certificate
from plant_partners import ModbusPartner, MqttPartner
from robots_controller.live_cell.cell_graph import NodeDescription
from robots_core import load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.ros.messages import motion_result_from_message
from robots_core.ros.qos import COMMAND, SENSOR, STREAM
from robots_core.ros.running.middleware import choose_transports

PATIENCE = 60.0  # s
START_PATIENCE = 240.0  # s, of a cell that starts on a busy machine
PAUSE = 0.05  # s between two changes, in which everything comes to rest
OURS, BARE = 'ours', 'bare'
SIDES = (OURS, BARE)
CONTROLLER_PERIOD = 4.0  # ms, at 250 Hz
# ms over the bare client's round trip; on topics and for motions the whole time.
OVER_BARE = CONTROLLER_PERIOD + 5.0
ON_TOPICS = 4.0
TO_REFERENCE = 12.0
ECHO = Path(__file__).with_name('plant_echoes.py')
NAMES = ('topic', 'modbus', 'mqtt', 'opcua')
PROGRAM = ''.join(
    f'onDigitalInput({n}, {value}, function() setDigitalOutput({n}, {int(value == "true")}) end)\n'
    for n in range(1, len(NAMES) + 1)
    for value in ('true', 'false')
)
IO_MAP = """
modbus: {{press: {{host: 127.0.0.1, port: {modbus}, period: {period}}}}}
mqtt: {{broker: {{host: 127.0.0.1, port: {mqtt}}}}}
opcua: {{line: {{endpoint: 'opc.tcp://127.0.0.1:{opcua}', period: {period}}}}}
inputs:
  - {{channel: digital_input.1, topic: /plc/ours, type: UInt8, bit: 0}}
  - {{channel: digital_input.2, modbus: {{coil: 0}}}}
  - {{channel: digital_input.3, mqtt: {{topic: plant/ours}}}}
  - {{channel: digital_input.4, opcua: {{node: ns=2;s=to_ours}}}}
outputs:
  - {{channel: digital_output.1, topic: /plc/ours_answer, type: UInt8, bit: 0}}
  - {{channel: digital_output.2, modbus: {{coil: 2}}}}
  - {{channel: digital_output.3, mqtt: {{topic: robot/ours}}}}
  - {{channel: digital_output.4, opcua: {{node: ns=2;s=from_ours}}}}
"""


class Answers:
    """What the sides have answered last, and when."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._last: dict[str, tuple[bool, int]] = {}

    def arrived(self, side: str, value: object) -> None:
        with self._changed:
            self._last[side] = bool(value), time.perf_counter_ns()
            self._changed.notify_all()

    def until(self, side: str, *, value: bool, patience: float = PATIENCE) -> int | None:
        """When an answer came, ns; None if it has not."""
        with self._changed:
            came = self._changed.wait_for(lambda: self._last.get(side, (None,))[0] == value, patience)
            return self._last[side][1] if came else None


class ModbusPlant(ModbusPartner):
    """Coils 0 and 1 are what it says to the sides, 2 and 3 what they answer."""

    def __init__(self, answers: Answers) -> None:
        super().__init__()
        self._answers = answers

    def switch(self, side: str, *, on: bool) -> None:
        self.set('coil', SIDES.index(side), [on])

    async def _on_request(self, code: int, *rest: Any) -> Any:
        answer = await super()._on_request(code, *rest)
        for table, address, values in self.written:
            assert table == 'coil'
            self._answers.arrived(SIDES[address - len(SIDES)], values[0])
        self.written.clear()
        return answer


class MqttPlant(MqttPartner):
    """Topics plant/<side> and robot/<side>."""

    def __init__(self, answers: Answers) -> None:
        super().__init__()
        self._answers = answers

    def start(self) -> None:
        super().start()
        self._device.on_message = lambda _client, _data, message: self._answers.arrived(
            message.topic.partition('/')[2], message.payload == b'true'
        )

    def switch(self, side: str, *, on: bool) -> None:
        self.publish(f'plant/{side}', str(on).lower())


class OpcuaPlant(OpcuaPartner):
    """Variables to_<side> and from_<side>."""

    def __init__(self, answers: Answers, certificate: tuple[str, str]) -> None:
        names = [f'{way}_{side}' for way in ('to', 'from') for side in SIDES]
        super().__init__(dict.fromkeys(names, False), certificate, {})
        self._answers = answers
        self._server.subscribe_server_callback(CallbackType.PostWrite, self._on_write)

    def switch(self, side: str, *, on: bool) -> None:
        self.set(f'to_{side}', value=on)

    def _on_write(self, event: Any, _dispatcher: Any) -> None:
        for item in event.request_params.NodesToWrite:
            way, _, side = str(item.NodeId.Identifier).partition('_')
            if way == 'from':
                self._answers.arrived(side, item.Value.Value.Value)


class TopicPlant(Node):
    """Topics /plc/<side> and /plc/<side>_answer; a PLC that also commands motions."""

    def __init__(self, answers: Answers) -> None:
        super().__init__('plc')
        self._words = {side: self.create_publisher(UInt8, f'/plc/{side}', STREAM) for side in SIDES}
        for side in SIDES:
            self.create_subscription(
                UInt8,
                f'/plc/{side}_answer',
                lambda message, side=side: answers.arrived(side, message.data),
                STREAM,
            )

    def switch(self, side: str, *, on: bool) -> None:
        self._words[side].publish(UInt8(data=on))


def wait_for_side(plant: Any, answers: Answers, side: str, name: str) -> None:
    """Switch until it answers both values: before it is connected, changes are lost."""
    end = time.monotonic() + START_PATIENCE
    while True:
        answered = []
        for on in (True, False):
            plant.switch(side, on=on)
            answered.append(answers.until(side, value=on, patience=1.0) is not None)
        if all(answered):
            return
        if time.monotonic() > end:
            raise SystemExit(f'{name}: no answer of {side}')


def round_trips(plant: Any, answers: Answers, count: int, name: str) -> dict[str, np.ndarray]:
    """Times of each side from a change to its answer, ms."""
    for side in SIDES:
        wait_for_side(plant, answers, side, name)
    times: dict[str, list[float]] = {side: [] for side in SIDES}
    for number in track(range(count), description=name, transient=True):
        for side in SIDES:
            time.sleep(PAUSE)
            start = time.perf_counter_ns()
            plant.switch(side, on=number % 2 == 0)
            answered = answers.until(side, value=number % 2 == 0)
            if answered is None:
                raise SystemExit(f'{name}: no answer of {side}')
            times[side].append(1e-6 * (answered - start))
    return {side: np.array(values) for side, values in times.items()}


@contextmanager
def spinning(node: Node) -> Iterator[None]:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    yield
    executor.shutdown()
    thread.join()


def run_plant(robot: str, count: int, folder: Path) -> dict[str, dict[str, np.ndarray]]:
    """Round trips by the name of the protocol."""
    program, io_map = folder / 'program.lua', folder / 'io_map.yaml'
    program.write_text(PROGRAM + 'wait(1e6)\n')
    answers = {name: Answers() for name in NAMES}
    topics = TopicPlant(answers['topic'])
    plants: dict[str, Any] = {
        'modbus': ModbusPlant(answers['modbus']),
        'mqtt': MqttPlant(answers['mqtt']),
        'opcua': OpcuaPlant(answers['opcua'], certificate(folder, 'plant')),
    }
    ports = {name: plant.port for name, plant in plants.items()}
    io_map.write_text(IO_MAP.format(period=PERIOD, **ports))
    common = {'robot_model': robot}
    program_node = {'program': str(program), 'autostart': True, 'digital_size': len(NAMES)}
    parts = [
        NodeDescription('robots_core', 'drive_node', common),
        NodeDescription('robots_controller', 'controller_node', common),
        NodeDescription('robots_planning', 'planning_node', common),
        NodeDescription('robots_controller', 'io_bridge_node', common | {'io_map': str(io_map)}),
        NodeDescription('robots_controller', 'lua_program_node', common | program_node),
    ]
    with ExitStack() as stack:
        for plant in plants.values():
            stack.callback(plant.end)
            plant.start()
        stack.callback(topics.destroy_node)
        stack.enter_context(spinning(topics))
        for name in ECHOES:
            stack.enter_context(process(sys.executable, str(ECHO), name, str(ports.get(name, 0))))
        for part in parts:
            stack.enter_context(process(*node_command(part)))
        return {
            name: round_trips({**plants, 'topic': topics}[name], answers[name], count, name) for name in NAMES
        }


class Commander(Node):
    """Commands motions and looks when the reference changes."""

    def __init__(self, names: tuple[str, ...]) -> None:
        super().__init__('commander')
        self._names = list(names)
        self._changed = threading.Condition()
        self._reference: list[float] = []
        self._moved = 0
        self._number = 0
        self._results: dict[str, MotionResult] = {}
        self._commands = self.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
        self.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, SENSOR)
        self.create_subscription(DiagnosticStatus, 'motion_result', self._on_result, COMMAND)

    def _on_reference(self, message: JointTrajectory) -> None:
        with self._changed:
            positions = message.points[0].positions.tolist()
            if self._reference and positions != self._reference and not self._moved:
                self._moved = time.perf_counter_ns()
            self._reference = positions
            self._changed.notify_all()

    def _on_result(self, message: DiagnosticStatus) -> None:
        with self._changed:
            result = motion_result_from_message(message)
            self._results[result.id] = result
            self._changed.notify_all()

    def until(self, condition: Any, what: str) -> None:
        with self._changed:
            if not self._changed.wait_for(condition, PATIENCE):
                raise SystemExit(f'no {what} arrives')

    def _move(self, target: np.ndarray) -> MotionResult:
        self._number += 1
        command = JointState(name=self._names, position=target.tolist())
        command.header.stamp = Time(sec=self._number)
        id_ = f'{self._number}.000000000'
        self._commands.publish(command)
        self.until(lambda: id_ in self._results, 'result')
        return self._results[id_]

    def ready(self, target: np.ndarray) -> None:
        """Command motions to `target` until one succeeds: planning_node refuses them before its reference."""
        self.until(lambda: self._reference and self._commands.get_subscription_count(), 'reference')
        end = time.monotonic() + PATIENCE
        while not (result := self._move(target)).ok:
            if time.monotonic() > end:
                raise SystemExit(f'the motion is refused: {result.message}')

    def delay(self, target: np.ndarray) -> float:
        """Time from a command to the first changed reference, ms."""
        with self._changed:
            self._moved = 0
        start = time.perf_counter_ns()
        result = self._move(target)
        if not (result.ok and self._moved):
            raise SystemExit(f'the robot has not moved: {result.message}')
        return 1e-6 * (self._moved - start)


def run_motions(robot: str, count: int) -> np.ndarray:
    """Times from `ptpjoint_joint` to the first changed reference, ms."""
    model = load_robot_model(robot)
    parts = [
        NodeDescription(package, name, {'robot_model': robot})
        for package, name in (
            ('robots_core', 'drive_node'),
            ('robots_controller', 'controller_node'),
            ('robots_planning', 'planning_node'),
        )
    ]
    commander = Commander(model.axes_data.names)
    with ExitStack() as stack:
        stack.callback(commander.destroy_node)
        stack.enter_context(spinning(commander))
        for part in parts:
            stack.enter_context(process(*node_command(part)))
        step = np.eye(model.num_axes)[0] * np.radians(2.0)
        commander.ready(model.home + step)  # the first motion loads code
        delays = []
        for number in track(range(count), description='motions', transient=True):
            time.sleep(PAUSE)
            delays.append(commander.delay(model.home + (number % 2) * step))
    return np.array(delays)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--robot', default='ur5e')
    parser.add_argument('--count', type=int, default=200, help='changes of each input, and motions')
    parser.add_argument('--markdown', action='store_true', help='for the documentation')
    options = parser.parse_args()
    choose_transports()
    rclpy.init()
    with tempfile.TemporaryDirectory() as folder:
        trips = run_plant(options.robot, options.count, Path(folder))
    delays = run_motions(options.robot, options.count)
    rclpy.shutdown()
    rows = []
    for name, sides in trips.items():
        bare = 1e3 * float(np.median(sides[BARE]))
        most = 1e3 * ON_TOPICS if name == 'topic' else bare + 1e3 * OVER_BARE
        rows.append(row(f'{name} through a handler and back', options.robot, sides[OURS], bare, most))
    bare = 1e3 * float(np.median(trips['topic'][BARE]))
    what = 'ptpjoint_joint to the first changed reference'
    rows.append(row(what, options.robot, delays, bare, 1e3 * TO_REFERENCE))
    show(rows, f'Medians of {options.count}', markdown=options.markdown)


def row(what: str, robot: str, ours: np.ndarray, bare: float, most: float) -> Row:
    """A line of the table; `ours` in ms, the others in us."""
    worst = f'p99 {np.percentile(ours, 99.0):.1f} ms; at most {1e-3 * most:.1f} ms wanted'
    return Row(what, robot, 1e3 * float(np.median(ours)), 'bare client', bare, most / bare, worst)


if __name__ == '__main__':
    main()
