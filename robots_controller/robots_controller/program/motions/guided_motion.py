"""GuidedMotion: motion that a sensor or a person guides while a program waits."""

from collections.abc import Callable, Generator

import numpy as np

from robots_controller.program.program_state import ProgramState
from robots_core.blocks.following.guide import Guide
from robots_core.errors import ProgramError
from robots_core.validation import Array
from robots_planning.robot_command_state import STATE_OF_GUIDE

# The robot stands when nothing has changed in so many checks; a stream of references has ended by then too.
CHECKS = 3
CHECK_PERIOD = 0.1  # s
STILL = 1e-5  # rad (m); what drives settle on
LONGEST_BRAKING = 10.0  # s


class GuidedMotion:
    """Hands the robot over, and takes it back.

    A motion of an input's handler takes the robot back too, until the handler has ended.
    """

    def __init__(
        self, state: ProgramState, position: Callable[[], Array], hand_over: Callable[[Guide], None]
    ) -> None:
        self._state, self._position, self._hand_over = state, position, hand_over
        self._wanted = self._guide = Guide.NONE

    def run(self, guide: Guide, ended: Callable[[], bool], duration: float) -> Generator[None, None, bool]:
        """Hand the robot over until the program shall continue, and wait until it stands again.

        Args:
            guide: SENSOR or PERSON.
            ended: The program shall continue.
            duration: Longest time of it, s; braking comes after that.

        Returns:
            True if it ended before `duration`.

        Raises:
            RobotsError: nothing can guide the robot.
            ProgramError: the robot still moves long after it was taken back.
            ProgramStopped: the program shall stop.
        """
        self._wanted = guide
        try:
            self._set(guide)
            early = yield from self._state.waiting(lambda: self._wanted is Guide.NONE or ended(), duration)
        finally:
            self._wanted = Guide.NONE
            self._set(Guide.NONE)
        yield from self._standstill(guide)
        return early

    def interrupt(self) -> Generator[None, None, None]:
        """Take the robot back for a motion of an input's handler.

        Raises:
            ProgramError: the robot still moves long after that.
            ProgramStopped: the program shall stop.
        """
        guide = self._guide
        if guide is not Guide.NONE:
            self._set(Guide.NONE)
            yield from self._standstill(guide)

    def handled(self, *, abort: bool) -> None:
        """The handler of an input has ended: guidance continues, or ends."""
        if abort:
            self._wanted = Guide.NONE
        elif self._wanted is not self._guide:
            self._set(self._wanted)

    def _set(self, guide: Guide) -> None:
        self._guide = guide
        self._state.command_state = STATE_OF_GUIDE[guide]
        self._hand_over(guide)

    def _standstill(self, guide: Guide) -> Generator[None, None, None]:
        last, still, checks = self._position(), 0, 0
        while still < CHECKS:
            yield from self._state.waiting(lambda: False, CHECK_PERIOD)
            now = self._position()
            still = still + 1 if float(np.abs(now - last).max()) <= STILL else 0
            last, checks = now, checks + 1
            if checks * CHECK_PERIOD > LONGEST_BRAKING:
                raise ProgramError(
                    f'the robot still moves {LONGEST_BRAKING:g} s after the end of '
                    f'{STATE_OF_GUIDE[guide]}; something else than the program moves it'
                )
