"""Place: where the number of an I/O map's row stands, at whatever partner."""

from dataclasses import dataclass


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
