"""What happens in a simulated cell besides motion, each with its time in s since the start."""

from dataclasses import dataclass

from robots_controller.io.io_image import Kind


@dataclass(frozen=True)
class ProgramStateChanged:
    """The program was opened, runs, or has ended: a value of `RunState`."""

    time: float
    state: str


@dataclass(frozen=True)
class LineReached:
    """The program calls a robot function on another line than before."""

    time: float
    line: int


@dataclass(frozen=True)
class TextPrinted:
    """The program printed."""

    time: float
    line: int
    text: str


@dataclass(frozen=True)
class CommandStateChanged:
    """The robot is commanded to do something else: a value of `RobotCommandState`."""

    time: float
    state: str


@dataclass(frozen=True)
class OutputChanged:
    """An output has another value; the line is that of the program which asked for it."""

    time: float
    kind: Kind
    index: int
    value: float
    line: int


@dataclass(frozen=True)
class InputChanged:
    """An input has another value."""

    time: float
    kind: Kind
    index: int
    value: float


@dataclass(frozen=True)
class OverrideChanged:
    """The program scales the speed of all motions, 0..1."""

    time: float
    value: float


Event = (
    ProgramStateChanged
    | LineReached
    | TextPrinted
    | CommandStateChanged
    | OutputChanged
    | InputChanged
    | OverrideChanged
)
