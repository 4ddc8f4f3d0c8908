"""Motion that others guide while a program waits: sensors in state TRAJECTORY, a person in state TEACH."""

from __future__ import annotations

from collections.abc import Callable, Generator

import numpy as np

from robots_controller.program.program_state import ProgramState
from robots_core.errors import ProgramError
from robots_core.validation import Array
from robots_planning.robot_command_state import RobotCommandState

# The robot stands when nothing has changed in so many looks; a stream of references has ended by then too.
LOOKS = 3
LOOK_PERIOD = 0.1  # s
STILL = 1e-5  # rad (m); what drives settle on
LONGEST_BRAKING = 10.0  # s


def guided(
    state: ProgramState,
    mode: RobotCommandState,
    ended: Callable[[], bool],
    duration: float,
    position: Callable[[], Array],
    *,
    hand_over: Callable[[RobotCommandState], None],
) -> Generator[None, None, bool]:
    """Hand the robot over, and take it back when it stands.

    Args:
        state: Of the program.
        mode: TRAJECTORY or TEACH.
        ended: The program shall go on.
        duration: Longest time of it, s; braking comes after that.
        position: Measured joint positions, (n,).
        hand_over: Hands the robot over (the mode) and takes it back (IDLE).

    Returns:
        True if it ended before `duration`.

    Raises:
        RobotsError: nothing can guide the robot.
        ProgramError: the robot still moves long after it was taken back.
        ProgramStopped: the program shall stop.
    """
    state.set_command_state(mode)
    try:
        hand_over(mode)
        early = yield from state.waiting(ended, duration)
    finally:
        state.set_command_state(RobotCommandState.IDLE)
        hand_over(RobotCommandState.IDLE)
    last, still, looks = position(), 0, 0
    while still < LOOKS:
        yield from state.waiting(lambda: False, LOOK_PERIOD)
        now = position()
        still = still + 1 if float(np.abs(now - last).max()) <= STILL else 0
        last, looks = now, looks + 1
        if looks * LOOK_PERIOD > LONGEST_BRAKING:
            raise ProgramError(
                f'the robot still moves {LONGEST_BRAKING:g} s after the end of {mode}: who guides it?'
            )
    return early
