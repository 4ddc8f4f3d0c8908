"""IoPort: what the rows of an I/O map exchange values with, a topic or the server of a protocol."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from robots_controller.io.bridge.place import Place

Number = bool | int | float


@dataclass(frozen=True)
class Arrival:
    """A value that has arrived from a place, or a problem there.

    Attributes:
        place: The place.
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


class IoPort:
    """One partner of rows. None of the methods blocks, except `finish` for as long as it may."""

    def kind(self, place: Any) -> str:
        """Type of the number there: 'boolean', 'float', 'double' or one of `INTEGERS`."""
        raise NotImplementedError

    def arrivals(self) -> Sequence[Arrival]:
        """What came since the last call, in order."""
        return ()

    def lost(self) -> int:
        """Values since the last call that came faster than they could be sent or taken, at least."""
        return 0

    def send(self, values: Mapping[Any, Number]) -> None:
        """Write values, in this order and after those of earlier calls.

        What cannot be written now is written as soon as it can be, with the newest value of each place.
        """

    def problems(self) -> Mapping[str, str]:
        """What is wrong with this port now, each with a key that stays while the problem does."""
        return {}

    def news(self) -> Sequence[str]:
        """What is to be logged once: connected again, values lost, since the last call."""
        return ()

    def finish(self, end: float) -> None:
        """Wait until the partner has what was sent, at most until a time of `time.monotonic`, s."""

    def close(self) -> None:
        """End the connection."""
