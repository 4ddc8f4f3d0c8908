"""Events of a running cell: what the monitor receives and the view shows."""

from dataclasses import dataclass

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.pose import Pose
from robots_core.validation import Array


@dataclass(frozen=True)
class NodeHealth:
    """A node's own report: its process, what it says to a person, and its page, '' for none.

    Attributes:
        works: It was ready once: what it lacks since then, or warns of, does not keep it from its work.
    """

    node: str
    pid: int
    ok: bool
    message: str
    url: str
    works: bool = False


@dataclass(frozen=True)
class ProgramStatus:
    """Where the program is: state, line, that line's text, error."""

    state: str
    file: str
    line: int
    source: str
    error: str


@dataclass(frozen=True)
class ProgramPrint:
    """The program printed a text."""

    text: str


@dataclass(frozen=True)
class MotionCommanded:
    """A motion was commanded; the target is joint positions or a pose."""

    id: str
    kind: str
    target: Array | Pose


@dataclass(frozen=True)
class MotionPlanned:
    """A motion was planned, duration in s; or a point of a stream was sent."""

    id: str
    duration: float
    streamed: bool = False


@dataclass(frozen=True)
class MotionProgress:
    """Done part of the running motion, 0..1."""

    progress: float


@dataclass(frozen=True)
class OutputsChanged:
    """Outputs have other values; kind is 'digital' or 'analog', changes are (index from 1, value)."""

    kind: str
    changes: tuple[tuple[int, float], ...]


Event = (
    NodeHealth
    | ProgramStatus
    | ProgramPrint
    | MotionCommanded
    | MotionPlanned
    | MotionProgress
    | MotionResult
    | OutputsChanged
)
