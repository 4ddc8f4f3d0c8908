"""DeadlockDetection: finds a program that will never end."""

from __future__ import annotations

from typing import Final

from robots_controller.simulation.record.recording import Recording

# A robot that stands for this long in the middle of a motion, with nothing left that could change that.
STUCK_TIME: Final = 10.0  # s


class DeadlockDetection:
    """Looked at once in each period that is not passed over.

    Args:
        longest: Longest time of the program, s.
        recording: Of the robot.
    """

    def __init__(self, longest: float, recording: Recording) -> None:
        self._longest, self._recording = longest, recording
        self._stands_since = 0.0

    def reason(self, now: float, *, expected: bool, at_rest: bool, waiting: bool) -> str:
        """Why the program does not end, '' as long as it may.

        Args:
            now: Since its start, s.
            expected: Something will happen by itself: a wait ends, somebody else does something.
            at_rest: The robot stands, and no motion is under way.
            waiting: The program waits.
        """
        if now >= self._longest:
            return f'it has not ended after {self._longest:g} s'
        if at_rest and not expected:
            return 'it waits for ever: nothing is left that could change' if waiting else ''
        if expected or not self._recording.standing(2):
            self._stands_since = now
        elif now - self._stands_since > STUCK_TIME:
            return 'the robot stands in the middle of a motion, and nothing lets it go on'
        return ''
