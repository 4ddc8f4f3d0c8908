"""What happens in a simulated cell besides motion."""

from dataclasses import dataclass

from robots_controller.io.io_image import Kind


@dataclass(frozen=True)
class Event:
    """What has happened at a time, s since the start."""

    time: float


@dataclass(frozen=True)
class ProgramStateChanged(Event):
    """The program was opened, runs, or has ended: a value of `RunState`."""

    state: str


@dataclass(frozen=True)
class LineReached(Event):
    """The program calls a robot function on another line than before."""

    line: int


@dataclass(frozen=True)
class TextPrinted(Event):
    """The program printed."""

    line: int
    text: str


@dataclass(frozen=True)
class CommandStateChanged(Event):
    """The robot is commanded to do something else: a value of `RobotCommandState`."""

    state: str


@dataclass(frozen=True)
class OutputChanged(Event):
    """An output has another value; the line is that of the program which asked for it."""

    kind: Kind
    index: int
    value: float
    line: int


@dataclass(frozen=True)
class InputChanged(Event):
    """An input has another value."""

    kind: Kind
    index: int
    value: float


@dataclass(frozen=True)
class OverrideChanged(Event):
    """The program scales the speed of all motions, 0..1."""

    value: float
