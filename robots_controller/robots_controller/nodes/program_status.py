"""ProgramStatus: tells on `program_status` where a program is and how it fares."""

from __future__ import annotations

import threading
import time
from typing import Final

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node

from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.program.program_position import TellingPace, told_place
from robots_core.ros.messages import diagnostic_status
from robots_core.ros.qos import STATE

STATUS_PERIOD: Final = 0.02  # s, after which a change that could not be told at once is told


class ProgramStatus:
    """Publishes a program's state, line and error, and the motion that was sent last; from any thread.

    Args:
        node: The node to speak through.
        program: The program.
        robot_name: The robot it is for.
    """

    def __init__(self, node: Node, program: LuaProgram, robot_name: str) -> None:
        self.open_error = ''
        """Why the program could not be opened, or ''."""
        self._program, self._robot_name = program, robot_name
        self._lock = threading.Lock()
        self._pace = TellingPace()
        self._due = False
        self._motion: dict[str, object] = {}
        self._publisher = node.create_publisher(DiagnosticStatus, 'program_status', STATE)
        node.create_timer(STATUS_PERIOD, self.publish_if_due)

    def line_changed(self) -> None:
        """The program is on another line: told now, or with others that follow soon."""
        self._due = True
        if self._pace.passes(time.monotonic()):
            self.publish_if_due()

    def motion_sent(self, id_: str, file: str, line: int) -> None:
        """A motion was sent.

        The program may be far ahead of the motions that it blends: who reads along is told their lines.
        """
        self._motion = {'motion': id_, 'motion_file': file, 'motion_line': line}
        self.publish()

    def publish_if_due(self) -> None:
        """Tell a change that has not been told."""
        if self._due:
            self.publish()

    def publish(self) -> None:
        """Tell everything now."""
        with self._lock:
            self._due = False
            program = self._program
            state = program.run_state
            error = str(program.error or self.open_error)
            held = {'hold': program.hold_reason, 'stack': program.call_stack} if program.hold_reason else {}
            self._publisher.publish(
                diagnostic_status(
                    'program',
                    error or f'{program.file or "no program"}: {state}',
                    level=DiagnosticStatus.ERROR if error else DiagnosticStatus.OK,
                    hardware_id=self._robot_name,
                    **told_place(program, state, error),
                    **held,
                    **self._motion,
                )
            )
