"""What coordinator and participants of a lock-step run send each other."""

from __future__ import annotations

import json
import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from robots_core.ros.lockstep.phases import NANOSECONDS

PARTICIPANTS: Final = '/lockstep/participants'
"""std_msgs/String, an `Announcement` as JSON; latched by each participant."""
ROSTER: Final = '/lockstep/roster'
"""std_msgs/String, a `Roster` as JSON; latched by the coordinator."""
TIME: Final = '/lockstep/time'
"""std_msgs/Int64MultiArray: sequence, time (ns), messages sent so far on each polled topic.

For those whose turn it is not. It is sent when time has advanced, and in each turn from `OBSERVE` on: before,
there is nothing to poll that is newer."""
REPORT: Final = '/lockstep/report'
"""std_msgs/Int64MultiArray: reports, each behind the count of its numbers: participant, sequence answered,
busy, next due time (ns) per phase, then pairs of an endpoint and its new count."""
GO: Final = 'lockstep_go'
"""std_msgs/Int64MultiArray below a participant's name: sequence to answer, time (ns), phase, and the messages
sent so far on each polled topic."""

LED: Final = -1
"""In the place of a participant, in a report: a process gives the lead back; behind it time (ns), next phase,
whether the run cannot continue, and for how many instants it has sent the clock."""


def is_of_protocol(topic: str) -> bool:
    """The topic is one of the above, or the clock."""
    return topic in {PARTICIPANTS, ROSTER, TIME, REPORT, '/clock'} or topic.endswith('/' + GO)


RELEASE: Final = -1
"""The phase of the first turn, in which the participants send what they have held back so far."""
OVER: Final = -2
"""The phase of a turn at the end of an instant, in which participants report again what they have to do: what
became due in a phase that was over is due later."""

LEAD: Final = -3
"""The phase of a turn in which the participants of a process go on by themselves for a slice of time; behind
it the next one."""

# CDR of an Int64MultiArray without layout: encapsulation (little endian), no dimensions, no offset, the
# length, padding to 8 bytes, the numbers.
_HEAD: Final = struct.Struct('<4sIII4x')
LITTLE_ENDIAN: Final = b'\x00\x01\x00\x00'
_CLOCK: Final = struct.Struct('<4siI')  # CDR of a Clock

Kind = Literal['publisher', 'subscription', 'polled', 'recorded', 'service', 'requests', 'replies']


@dataclass(frozen=True)
class Endpoint:
    """Where a participant counts messages.

    Attributes:
        kind: What it counts; a client has two, its requests and behind them the replies to them. What is
            'recorded' is not counted: time does not wait for the recorder.
        name: Of the topic or service, with its namespace.
        latched: It is transient-local; such a subscription does not match other publishers.
    """

    kind: Kind
    name: str
    latched: bool = False


@dataclass(frozen=True)
class Announcement:
    """A node takes part.

    Attributes:
        name: The node's name, with its namespace.
        endpoints: In the order of their numbers; more may follow, none goes.
        matched: Version of the roster whose endpoints have all found each other, as this node finds.
        leader: The participant of its process to which the lead can be given; '' if it cannot.
    """

    name: str
    endpoints: tuple[Endpoint, ...]
    matched: int = 0
    leader: str = ''

    @classmethod
    def from_json(cls, text: str) -> Announcement:
        """Of its text."""
        fields = json.loads(text)
        return cls(fields['name'], _endpoints(fields['endpoints']), fields['matched'], fields['leader'])


@dataclass(frozen=True)
class Roster:
    """The participants.

    Attributes:
        version: Grows with each change, and from run to run.
        participants: Endpoints by the participant's name; their order gives their numbers.
        polled: Topics in the order in which messages count them; more may follow.
    """

    version: int
    participants: dict[str, tuple[Endpoint, ...]]
    polled: tuple[str, ...]

    @classmethod
    def from_json(cls, text: str) -> Roster:
        """Of its text."""
        fields = json.loads(text)
        participants = {name: _endpoints(items) for name, items in fields['participants'].items()}
        return cls(fields['version'], participants, tuple(fields['polled']))


def as_json(record: Announcement | Roster) -> str:
    """As the text of a message; inverse of `from_json`."""
    return json.dumps(vars(record), default=vars)


def _endpoints(items: Iterable[dict[str, object]]) -> tuple[Endpoint, ...]:
    return tuple(Endpoint(**item) for item in items)  # type: ignore[arg-type]


def encode(numbers: list[int]) -> bytes:
    """A serialized Int64MultiArray, at a fraction of what building and converting a message takes."""
    count = len(numbers)
    return _HEAD.pack(LITTLE_ENDIAN, 0, 0, count) + struct.pack(f'<{count}q', *numbers)


def encode_clock(time: int) -> bytes:
    """A serialized Clock, of a time in ns."""
    return _CLOCK.pack(LITTLE_ENDIAN, *divmod(time, NANOSECONDS))


def decode(data: bytes) -> tuple[int, ...]:
    """The numbers of a serialized Int64MultiArray.

    Raises:
        ValueError: not little endian, or with a layout.
    """
    encapsulation, dimensions, _, count = _HEAD.unpack_from(data)
    if encapsulation[:2] != LITTLE_ENDIAN[:2] or dimensions:
        raise ValueError('an Int64MultiArray of lock-step is little endian and has no layout')
    return struct.unpack_from(f'<{count}q', data, _HEAD.size)


def encode_reports(reports: Iterable[Sequence[int]]) -> bytes:
    """Several reports as one message."""
    return encode([number for report in reports for number in (len(report), *report)])


def decode_reports(data: bytes) -> Iterator[tuple[int, ...]]:
    """The reports of a message."""
    numbers, place = decode(data), 0
    while place < len(numbers):
        behind = place + 1 + numbers[place]
        yield numbers[place + 1 : behind]
        place = behind
