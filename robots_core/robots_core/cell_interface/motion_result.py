"""MotionResult: how a motion command ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final

from robots_core.errors import MotionEndedError, RobotsError
from robots_core.status import Level, Status

PASSED: Final = 'passed'
"""The motion ran through to the next one."""
BLOCKED: Final = 'stopped before a collision'
"""An obstacle is ahead: the motion goes around it, or ends here."""


@dataclass(frozen=True)
class MotionResult:
    """End of a motion.

    Attributes:
        id: The command's id.
        ok: The robot stands at the target, or passed it where motions blend.
        message: 'reached', 'passed', or the reason why not.
        details: Further facts: duration (s), progress (0..1), ended (s), or the data of the error.
        blocked: The robot stands before an obstacle. The planner leads it around, or ends the motion with
            another result.
        code: That of the error (`docs/reference/errors.md`), where it is not at the target.
    """

    id: str
    ok: bool
    message: str
    details: Mapping[str, Any] = field(default_factory=dict)
    blocked: bool = False
    code: str = MotionEndedError.code

    @classmethod
    def refused(cls, id_: str, error: RobotsError) -> MotionResult:
        """The result of a command that an error ended."""
        return cls(id_, ok=False, message=error.message, details=dict(error.details), code=error.code)

    def ended_at(self, time: float) -> MotionResult:
        """The result with its time, s, among the details."""
        return replace(self, details={**self.details, 'ended': f'{time:.9f}'})

    @property
    def status(self) -> Status:
        """As it travels on `motion_result`."""
        level = Level.OK if self.ok else Level.WARN if self.blocked else Level.ERROR
        values = {'id': self.id, **self.details, **({} if self.ok else {'code': self.code})}
        return Status('motion', self.message, level, values)

    @property
    def error(self) -> RobotsError | None:
        """Why the robot is not at the target; None if it is."""
        if self.ok:
            return None
        error = MotionEndedError(self.message)
        error.code = self.code
        error.details.update({key: str(value) for key, value in self.details.items()})
        return error
