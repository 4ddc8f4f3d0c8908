"""DeadlockDetection: finds a program that will never end."""

from typing import Final

from robots_controller.simulation.record.recording import Recording

# A robot that stands for this long in the middle of a motion, with nothing left that could change that.
STUCK_TIME: Final = 10.0  # s
# A program that computes or calls so long while nothing can change: 4e8 instructions or 1.5e6 calls.
BUSY_TIME = 30.0  # s


class DeadlockDetection:
    """Looked at once in each period that is not passed over.

    Args:
        longest: Longest time of the program, s.
        recording: Of the robot.
    """

    def __init__(self, longest: float, recording: Recording) -> None:
        self._longest, self._recording = longest, recording
        self._stands_since = self._rests_since = 0.0

    def reason(self, now: float, *, expected: bool, at_rest: bool, waiting: bool, busy: bool) -> str:
        """Why the program does not end, '' as long as it may.

        Args:
            now: Since its start, s.
            expected: Something will happen by itself: a wait ends, somebody else does something.
            at_rest: The robot stands, and no motion is under way.
            waiting: The program waits.
            busy: It computes or asks again and again, without waiting for anything.
        """
        if now >= self._longest:
            return f'it has not ended after {self._longest:g} s'
        if not at_rest or expected:
            self._rests_since = now
        elif busy:
            forever = now - self._rests_since > BUSY_TIME
            return 'it computes for ever: nothing is left that could change' if forever else ''
        else:
            return 'it waits for ever: nothing is left that could change' if waiting else ''
        if expected or not self._recording.standing(2):
            self._stands_since = now
        elif now - self._stands_since > STUCK_TIME:
            return 'the robot stands in the middle of a motion, and nothing lets it go on'
        return ''
