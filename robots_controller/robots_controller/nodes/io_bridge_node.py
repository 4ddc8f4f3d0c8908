"""io_bridge_node: connects inputs and outputs with any topics of a PLC, by a YAML file."""

import time
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from robots_controller.io.fail_safe import FailSafe, parse_fail_safe, safe_value
from robots_controller.io.io_conversion import INTEGERS, InputValue, to_field
from robots_controller.io.io_map import IoMap, IoRow, TopicQos, read_io_map
from robots_controller.nodes.io_images import InputImages, OutputImages
from robots_controller.nodes.message_types import make_room, number_type
from robots_core.errors import InvalidInputError
from robots_core.ros.heartbeat import HeartbeatWatch, watchdog_parameter
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.message_class import message_class
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.run import run

# A small part of the shortest timeout.
WATCH_PERIOD: Final = 0.02  # s
WRITER: Final = 'lua_program_node'
LOST: Final = f'{WRITER} gives no sign of life'
LEFT: Final = f'{WRITER} gave no sign of life for some time, and has not switched it since'
FINISH_TIMEOUT: Final = 0.5  # s, for the last message to arrive


class IoBridgeNode(RobotNode):
    """Inputs from topics, outputs to topics."""

    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('io_bridge_node', **options)
        path = self.parameter('io_map', '', 'YAML file that maps channels to topics')
        self._map = read_io_map(path) if path else IoMap()
        declared = self.parameter(
            'fail_safe',
            [''],
            "fail-safe values of outputs that the map does not declare, as 'digital_output.3=hold'",
            read=parse_fail_safe,
        )
        safe = {**declared, **self._map.fail_safe}
        for row in self._map.inputs:
            _field_type(row)
        self._problems: dict[str, str] = {}
        now = self.now()
        self._inputs = [InputValue(row, now) for row in self._map.inputs]
        self._images = InputImages(self, [row.channel for row in self._map.inputs])
        self._timer = self.create_timer(WATCH_PERIOD, self._update_inputs)
        for topic, rows in _by_topic(self._map.inputs).items():
            members = [value for value in self._inputs if value.row.topic == topic]
            self.create_subscription(
                message_class(rows[0].type), topic, partial(self._on_message, members), _qos(rows[0].qos)
            )
        self._topics = [_OutputTopic(self, rows, safe) for rows in _by_topic(self._map.outputs).values()]
        self._outputs = OutputImages(self, [row.channel for row in self._map.outputs], self._on_outputs)
        self.ready()  # also without a PLC
        self._update_inputs()
        self._watch = HeartbeatWatch(self, [WRITER], watchdog_parameter(self), lambda *_: self._on_outputs())
        if self._map.outputs:
            self.create_timer(WATCH_PERIOD, self._on_outputs)
        self._report()

    def _report(self) -> None:
        problems = '; '.join(self._problems.values())
        if problems:
            self.report_health(DiagnosticStatus.WARN, problems)
        elif not (self._map.inputs or self._map.outputs):
            self.ready('ready; parameter io_map is empty, nothing is connected')
        else:
            self.ready(inputs=len(self._map.inputs), outputs=len(self._map.outputs))

    def _set_problem(self, key: str, problem: str) -> None:
        if not problem:
            self._problems.pop(key, None)
            return
        if key not in self._problems:
            self.journal.warning(problem)
        self._problems[key] = problem

    # -- inputs ---------------------------------------------------------------------------------------

    def _on_message(self, members: list[InputValue], message: Any) -> None:
        now = self.now()
        for value in members:
            name = value.row.channel.name
            problem = ''
            try:
                value.receive(message, now)
            except InvalidInputError as error:
                problem = f'{value.row.topic}: {error}; {name} keeps its value'
            self._set_problem(f'value {name}', problem)
        self._update_inputs()

    def _update_inputs(self) -> None:
        now = self.now()
        for value in self._inputs:
            row = value.row
            self._images.set(row.channel, value.update(now))
            silent = value.silent(now)
            self._set_problem(
                f'silence {row.channel.name}',
                f'{row.topic} has been silent for {row.timeout:g} s; {row.channel.name} is at its '
                f'fail-safe value {row.fail_safe:g}'
                if silent
                else '',
            )
        self._images.publish()
        self._report()
        due = min((value.next_time(now) for value in self._inputs), default=float('inf')) - now
        if due == float('inf'):
            self._timer.cancel()
        else:
            self._timer.timer_period_ns = max(1_000_000, int(1e9 * due))
            self._timer.reset()

    # -- outputs --------------------------------------------------------------------------------------

    def _on_outputs(self) -> None:
        now = self.now()
        for topic in self._topics:
            for row, problem in topic.update(self._outputs, now, lost=bool(self._watch.lost)):
                self._set_problem(f'output {row.file}:{row.line}', problem)
        self._report()

    def destroy_node(self) -> None:
        """Leave the PLC with fail-safe values."""
        if self.context.ok():
            for topic in self._topics:
                topic.make_safe(self._outputs)
            end = time.monotonic() + FINISH_TIMEOUT
            for topic in self._topics:
                topic.wait_until_received(end)
        super().destroy_node()


class _OutputTopic:
    """The message of one topic, made of all its rows."""

    def __init__(self, node: RobotNode, rows: list[IoRow], safe: FailSafe) -> None:
        self._safe = safe
        self._clock = node.get_clock()
        self._rows = [(row, _field_type(row)) for row in rows]
        self._message = message_class(rows[0].type)()
        for row in rows:
            make_room(self._message, row.path)
        self._publisher = node.create_publisher(
            type(self._message),
            rows[0].topic,
            _qos(rows[0].qos),
            event_callbacks=PublisherEventCallbacks(matched=self._on_matched),
        )
        self._sent: list[Any] | None = None
        self._left: set[str] = set()
        """Outputs that a lost program's node has not put to their fail-safe values itself."""
        period = min(row.period for row in rows)
        if period < float('inf'):
            node.create_timer(period, self._repeat)

    def update(self, images: OutputImages, now: float, *, lost: bool) -> list[tuple[IoRow, str]]:
        """Set the message and send it if it changed; the rows and their problems, '' for none."""
        problems = []
        for row, kind in self._rows:
            value, problem = images.value(row.channel), ''
            absent = images.absent_for(row.channel, now) >= row.timeout
            safe = safe_value(self._safe, row.channel, value)
            if lost and safe != value:
                self._left.add(row.channel.name)
            elif safe == value:
                # The node has put it there itself; one that froze must not switch it on again before.
                self._left.discard(row.channel.name)
            if lost or absent or row.channel.name in self._left:
                value = safe
                why = LOST if lost else LEFT
                if absent:
                    why = f'{row.channel.image} was not published for {row.timeout:g} s'
                problem = f'{why}; {row.channel.name} is at its fail-safe value'
            if value is None:
                return []  # a message with made-up values must not switch anything
            cut = self._put(row, kind, value)
            problems.append((row, problem or cut))
        self._send()
        return problems

    def make_safe(self, images: OutputImages) -> None:
        """Send the fail-safe values."""
        for row, kind in self._rows:
            value = safe_value(self._safe, row.channel, images.value(row.channel))
            if value is None:
                return
            self._put(row, kind, value)
        self._send()

    def wait_until_received(self, end: float) -> None:
        """Wait until all subscribers have what was sent, at most until a time of `time.monotonic`, s."""
        self._publisher.wait_for_all_acked(Duration(seconds=max(0.0, end - time.monotonic())))

    def _put(self, row: IoRow, kind: str, value: float) -> str:
        field, lost = to_field(row, value, kind, row.path.get(self._message))
        row.path.set(self._message, field)
        return lost

    def _send(self) -> None:
        fields = [row.path.get(self._message) for row, _ in self._rows]
        if fields != self._sent:
            self._sent = fields
            self._publish()

    def _on_matched(self, change: Any) -> None:
        """Send the newest values to a PLC that starts later, or again."""
        if change.current_count_change > 0:
            self._repeat()

    def _repeat(self) -> None:
        if self._sent is not None:
            self._publish()

    def _publish(self) -> None:
        if hasattr(self._message, 'header'):
            self._message.header.stamp = self._clock.now().to_msg()
        self._publisher.publish(self._message)


def _field_type(row: IoRow) -> str:
    """Type of the row's field.

    Raises:
        InvalidInputError: the type or the field does not exist, or cannot hold the channel.
    """
    try:
        kind = message_class(row.type)
        found = number_type(kind, row.path)
        _check_bit(row, found)
        if row.channel.direction == 'output':
            make_room(kind(), row.path)
    except InvalidInputError as error:
        raise row.error(error.message) from None
    return found


def _check_bit(row: IoRow, kind: str) -> None:
    if row.bit is None:
        return
    if kind not in INTEGERS:
        raise InvalidInputError(f'{row.path.text} is {kind!r}; a bit needs a whole number')
    bits = (INTEGERS[kind][1] - INTEGERS[kind][0]).bit_length()
    if row.bit >= bits:
        raise InvalidInputError(f'{row.path.text} is {kind!r} with bits 0..{bits - 1}, not {row.bit}')


def _by_topic(rows: tuple[IoRow, ...]) -> dict[str, list[IoRow]]:
    topics: dict[str, list[IoRow]] = {}
    for row in rows:
        topics.setdefault(row.topic, []).append(row)
    return topics


def _qos(qos: TopicQos) -> QoSProfile:
    return QoSProfile(
        depth=qos.depth,
        reliability=ReliabilityPolicy[qos.reliability.upper()],
        durability=DurabilityPolicy[qos.durability.upper()],
    )


main: Final = partial(run, IoBridgeNode)
