"""Topics as ports of an I/O map: a field each of a message."""

import math
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks

from robots_controller.io.bridge.io_port import Arrival, IoPort, Number
from robots_controller.io.bridge.topic_field import FieldPath, TopicField
from robots_controller.io.io_map import IoRow, check_bit
from robots_controller.io.number_kinds import INTEGERS
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import message_class
from robots_core.ros.qos import rclpy_profile
from robots_core.ros.robot_node import RobotNode

_ARRAY: Final = re.compile(r'sequence<(?P<listed>[^,]+)(, \d+)?>|(?P<fixed>[^\[]+)\[\d+\]')
NUMBERS: Final = ('boolean', 'float', 'double', *INTEGERS)
_ZEROS: Final[dict[str, Any]] = {'boolean': False, 'float': 0.0, 'double': 0.0, 'string': ''}


class _Topic(IoPort):
    """One topic.

    Raises:
        InvalidInputError: a row's type or field does not exist, or cannot hold its channel.
    """

    def __init__(self, rows: Sequence[tuple[IoRow, TopicField]]) -> None:
        self._kinds = {place: _kind(row, place) for row, place in rows}

    def kind(self, place: Any) -> str:
        """See `IoPort`; the node ends what it has opened."""
        return self._kinds[place]


class InputTopic(_Topic):
    """Inputs from a topic."""

    def __init__(self, node: RobotNode, rows: Sequence[tuple[IoRow, TopicField]], on_arrival: Any) -> None:
        super().__init__(rows)
        self._on_arrival = on_arrival
        self._arrivals: list[Arrival] = []
        place = rows[0][1]
        node.create_subscription(
            message_class(place.type), place.port, self._on_message, rclpy_profile(place.qos)
        )

    def arrivals(self) -> Sequence[Arrival]:
        """What came since the last call."""
        arrivals, self._arrivals = self._arrivals, []
        return arrivals

    def _on_message(self, message: Any) -> None:
        self._arrivals += self._read(message)
        self._on_arrival()

    def _read(self, message: Any) -> Iterator[Arrival]:
        stamp = stamp_of(message)
        for place in self._kinds:
            try:
                yield Arrival(place, place.path.get(message), stamp=stamp)
            except InvalidInputError as error:
                yield Arrival(place, problem=error.message)


class OutputTopic(_Topic):
    """Outputs to a topic, sent once all of its fields are known."""

    def __init__(self, node: RobotNode, rows: Sequence[tuple[IoRow, TopicField]]) -> None:
        super().__init__(rows)
        place = rows[0][1]
        self._clock = node.get_clock()
        self._message = message_class(place.type)()
        for one in self._kinds:
            make_room(self._message, one.path)
        self._unknown = set(self._kinds)
        self._publisher = node.create_publisher(
            type(self._message),
            place.port,
            rclpy_profile(place.qos),
            event_callbacks=PublisherEventCallbacks(matched=self._on_matched),
        )

    def send(self, values: Mapping[Any, Number]) -> None:
        """Send the message with these values."""
        for place, value in values.items():
            place.path.set(self._message, value)
        self._unknown -= values.keys()
        self._publish()

    def finish(self, end: float) -> None:
        """See `IoPort.finish`: wait until all subscribers have what was sent."""
        self._publisher.wait_for_all_acked(Duration(seconds=max(0.0, end - time.monotonic())))

    def _on_matched(self, change: Any) -> None:
        """Send the newest values to a PLC that starts later, or again."""
        if change.current_count_change > 0:
            self._publish()

    def _publish(self) -> None:
        if self._unknown:
            return
        if hasattr(self._message, 'header'):
            self._message.header.stamp = self._clock.now().to_msg()
        self._publisher.publish(self._message)


def stamp_of(message: Any) -> float:
    """The stamp of a message's header, s since 1970; NaN where it has none."""
    stamp = getattr(getattr(message, 'header', None), 'stamp', None)
    if stamp is None or not (stamp.sec or stamp.nanosec):
        return math.nan
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def _kind(row: IoRow, place: TopicField) -> str:
    try:
        message = message_class(place.type)
        found = number_type(message, place.path)
        check_bit(place, row.bit, found)
        if row.channel.direction == 'output':
            make_room(message(), place.path)
    except InvalidInputError as error:
        raise row.error(error.message) from None
    return found


def number_type(kind: Any, path: FieldPath) -> str:
    """Type of the number at a path, one of `NUMBERS`.

    Raises:
        InvalidInputError: the message has no such field, or it is no number.
    """
    current = ''
    for depth, step in enumerate(path.steps):
        where = path.up_to(depth) or 'the message'
        if isinstance(step, int):
            element = _element(current)
            if not element:
                raise InvalidInputError(f'{where} is {current!r} and no array, which {path.text} needs')
            current = element
        else:
            fields = {} if depth and '/' not in current else _fields(current, kind)
            if step not in fields:
                names = f'; its fields are {", ".join(fields)}' if fields else ''
                raise InvalidInputError(f'{where} has no field {step!r}, which {path.text} needs{names}')
            current = fields[step]
    if current not in NUMBERS:
        hint = f'; an element of it is {path.text}[0]' if _element(current) else ''
        raise InvalidInputError(f'{path.text} is {current!r}; needed is a number or a bool{hint}')
    return current


def make_room(message: Any, path: FieldPath) -> None:
    """Lengthen the arrays of a message until a path leads somewhere; its type was checked.

    Raises:
        InvalidInputError: an array of fixed length is too short.
    """
    holder, current = message, ''
    for depth, step in enumerate(path.steps):
        if isinstance(step, int):
            element = _element(current)
            while len(holder) <= step:
                if not current.startswith('sequence<'):
                    raise InvalidInputError(
                        f'{path.up_to(depth)} has {len(holder)} elements; {path.text} needs {step + 1}'
                    )
                zero = message_class(_full(element))() if '/' in element else _ZEROS.get(element, 0)
                holder.append(zero)
            holder, current = holder[step], element
        else:
            current = _fields(current, type(message))[step]
            holder = getattr(holder, step)


def _element(kind: str) -> str:
    match = _ARRAY.fullmatch(kind)
    return (match['listed'] or match['fixed']) if match else ''


def _full(kind: str) -> str:
    package, _, name = kind.rpartition('/')
    return f'{package.removesuffix("/msg")}/msg/{name}'


def _fields(kind: str, outermost: Any) -> dict[str, str]:
    found = message_class(_full(kind)) if kind else outermost
    fields: dict[str, str] = found.get_fields_and_field_types()
    return fields
