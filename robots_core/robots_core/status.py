"""Status: what a diagnostic_msgs/DiagnosticStatus says, whichever transport carries it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum


class Level(IntEnum):
    """Levels of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True)
class Status:
    """One status.

    Attributes:
        name: Of what it is the status.
        text: For people.
        level: How bad it is.
        values: Further facts; they travel as text.
    """

    name: str
    text: str = ''
    level: Level = Level.OK
    values: Mapping[str, object] = field(default_factory=dict)

    @classmethod
    def of_problem(cls, name: str, problem: str) -> 'Status':
        """Of what has a problem, an error, or none: ''."""
        return cls(name, problem or 'none', Level.ERROR if problem else Level.OK)
