"""Partners of the rows of an I/O map, topics and servers of protocols, and the places of values there."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

Number = bool | int | float


@dataclass(frozen=True)
class Place:
    """A field of a topic, a register, a variable of an OPC UA server.

    Attributes:
        port: The partner: a topic, or a protocol and its server. Places of one port share an `IoPort`.
    """

    port: str

    @property
    def source(self) -> str:
        """What falls silent together with this place, for messages: the topic or the partner."""
        return self.port

    @property
    def text(self) -> str:
        """The place at its partner, for messages."""
        raise NotImplementedError

    @property
    def cells(self) -> tuple[str, ...]:
        """What it takes of its partner, by any names; two outputs must not take the same."""
        return (self.text,)


@dataclass(frozen=True)
class PlantPlace(Place):
    """A place at a server of a protocol.

    Attributes:
        kind: Type of the number: 'boolean', 'float', 'double' or one of `INTEGERS`.
    """

    kind: str


@dataclass(frozen=True)
class Arrival:
    """A value that has arrived from a place, or a problem there.

    Attributes:
        value: The value as it came; None where there is a problem instead.
        problem: Why there is no value, '' for none.
        stamp: When the source measured the value, s since 1970; NaN where it is not stated.
        lost: Earlier values of the place that the partner says it could not send.
    """

    place: Place
    value: object = None
    problem: str = ''
    stamp: float = math.nan
    lost: int = 0


class IoPort(Protocol):
    """One partner of rows; the methods' defaults are those of one that is only read, and has no problems.

    None of the methods blocks, except `finish` for as long as it may.
    """

    def kind(self, place: Any) -> str:
        """Type of the number there: 'boolean', 'float', 'double' or one of `INTEGERS`."""

    def arrivals(self) -> Sequence[Arrival]:
        """What came since the last call, in order."""
        return ()

    def lost(self) -> int:
        """Values since the last call that came faster than they could be sent or taken, at least."""
        return 0

    def send(self, values: Mapping[Any, Number]) -> None:  # noqa: ARG002  # to inputs nothing is written
        """Write values, in this order and after those of earlier calls.

        What cannot be written now is written as soon as it can be, with the newest value of each place.
        """
        return

    def problems(self) -> Mapping[str, str]:
        """What is wrong with this port now, each with a key that stays while the problem does."""
        return {}

    def news(self) -> Sequence[str]:
        """What is to be logged once: connected again, values lost, since the last call."""
        return ()

    def finish(self, end: float) -> None:  # noqa: ARG002
        """Wait until the partner has what was sent, at most until a time of `time.monotonic`, s."""
        return

    def close(self) -> None:
        """End the connection."""
        return
