"""Place: where the number of an I/O map's row stands, at whatever partner."""

from typing import Protocol


class Place(Protocol):
    """A field of a topic, a register, a node of an OPC UA server; hashable, and equal for the same place."""

    @property
    def port(self) -> str:
        """The partner: a topic, or a protocol and its server. Places of one port share an `IoPort`."""

    @property
    def source(self) -> str:
        """What falls silent together with this place, for messages: the topic or the partner."""

    @property
    def text(self) -> str:
        """The place at its partner, for messages."""

    @property
    def cells(self) -> tuple[str, ...]:
        """What it takes of its partner, by any names; two outputs must not take the same."""
