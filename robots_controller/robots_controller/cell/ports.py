"""Ports of the cell: what a transport provides to it."""

from collections.abc import Callable, Mapping
from typing import Protocol

from robots_controller.control.controller_request import ControllerRequest
from robots_controller.program.cell_port import MeasuredRobot, ProgramController
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.errors import PlanningError, ProgramError, RobotsError
from robots_core.status import Status
from robots_planning.robot_command_state import RobotCommandState

Configured = Callable[[PlanningError | None], None]


class PlannerPort(Protocol):
    """The planner as a program's motions reach it. Results come back to `ProgramMotions.result`."""

    @property
    def name(self) -> str:
        """The node or action that plans, for people."""

    def plans(self, command: MotionCommand) -> bool:  # noqa: ARG002
        """A planner takes motions of this kind."""
        return True

    def differs(self, settings: Mapping[str, object]) -> bool:
        """The planner has other modal settings than these."""

    @property
    def configurable(self) -> bool:
        """The planner takes settings now."""
        return True

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:
        """Set these modal settings and take back all others; returns at once.

        Args:
            settings: Values by parameter name, SI.
            done: Called with None, or why the planner refuses.
            moving: A motion was sent just now, which keeps the settings before these.
        """

    def flush(self, settings: Mapping[str, object]) -> None:
        """No motion follows the last one, which has these settings: a planner need not wait for one."""

    def next_id(self) -> str:
        """The id of the next command."""

    def command(self, id_: str, command: MotionCommand) -> None:
        """Send a motion."""

    def followers(self) -> Mapping[bytes, str]:
        """The nodes that can end a motion: an identity each, and the node's name."""


class ControllerPort(ProgramController, Protocol):
    """Requests to the controller."""

    def request(self, request: ControllerRequest) -> None:
        """Pause on the path, resume, or stop on the path and give up all motions."""

    def command(self, *, taken: bool) -> None:
        """Take the robot for the program, or give it back; a refusal goes to `ProgramHost.lose_robot`."""

    def wait_for_command(self) -> None:
        """Wait until the controller has answered `command`; in the program's thread.

        A motion sent before could be the first of a free robot, which cannot be taken while it moves.
        """
        return


class RobotPort(MeasuredRobot, Protocol):
    """The robot as a program measures it and hands it over."""

    def guide(self, guide: Guide) -> None:
        """Hand the robot over to a sensor or a person, or take it back (NONE).

        Raises:
            RobotsError: the cell has no such guide.
        """


class ProgramObserver(Protocol):
    """The observers of a program: operators, recorders, editors."""

    def command_state(self, state: RobotCommandState) -> None:
        """What the robot is commanded to do."""

    def motion_sent(self, id_: str, command: MotionCommand, file: str) -> None:
        """A motion of a program or subprogram was sent."""

    def motion_ended(self, id_: str, command: MotionCommand, error: RobotsError | None) -> None:
        """A motion has ended: None, or why the robot is not at the target. '' for one that was not sent."""

    def status(self, state: RunState, status: Status) -> None:
        """State, place and motion of the program."""

    def outputs_changed(self, change: OutputChange) -> None:
        """An output has changed."""

    def printed(self, text: str, line: int) -> None:
        """The program printed."""

    def line_reached(self, line: int) -> None:
        """The program is on another line."""

    def held_changed(self) -> None:
        """The program is held, or continues."""

    def ended(self, error: ProgramError | None) -> None:
        """The program has ended."""
