"""ProgramEvents: what a program tells the host that runs it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from robots_controller.program.motion_command import MotionCommand, OutputChange
from robots_planning.robot_command_state import RobotCommandState


@dataclass(frozen=True)
class ProgramEvents:
    """What the host wants to hear; everything is called from the program's thread.

    Attributes:
        command: A motion is commanded; the host ends it with `finish_motion`.
        flush: No motion follows the commanded ones for now, although the last would blend.
        abort: The commanded motions shall end where the robot is.
        guided: Others shall guide the robot, in state TRAJECTORY or TEACH; or no longer: IDLE.
        output: An output changed.
        override: The speed scale changed.
        printed: A line of text, and the program's line.
    """

    command: Callable[[MotionCommand], None]
    flush: Callable[[], None]
    abort: Callable[[], None]
    guided: Callable[[RobotCommandState], None]
    output: Callable[[OutputChange], None]
    override: Callable[[float], None]
    printed: Callable[[str, int], None]
