"""CellPort: what a robot program needs of the cell that it runs in."""

from typing import Protocol

from robots_controller.program.clock import Clock
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_controller.program.robot_kinematics import RobotKinematics
from robots_core.blocks.following.guide import Guide
from robots_core.errors import ProgramError


class MeasuredRobot(Protocol):
    """The robot as a program measures it; called from the program's thread."""

    def joint_feedback(self) -> JointFeedback:
        """What the robot measures now.

        Raises:
            RobotsError: no feedback.
        """


class ProgramController(Protocol):
    """What a program sets at the controller itself; called from the program's thread."""

    def set_override(self, value: float) -> None:
        """Scale the speed of all motions, 0..1."""


class CellPort(Protocol):
    """Requests of a program to its cell, and reports of what the program does.

    Every method but `hold` and `started` is called from the program's thread.
    """

    @property
    def clock(self) -> Clock:
        """The time that the program's waits take."""

    @property
    def payload(self) -> tuple[float, ...]:
        """What the robot carries where the program does not set it: mass and centre of mass, kg and m."""

    @property
    def simulated(self) -> bool:
        """Time is simulated: a held program continues at once, and no value is kept after the run."""

    @property
    def robot(self) -> MeasuredRobot:
        """What the robot measures."""

    @property
    def kinematics(self) -> RobotKinematics:
        """The robot's kinematics."""

    @property
    def controller(self) -> ProgramController:
        """The robot's controller."""

    # -- requests -------------------------------------------------------------------------------------

    def command(self, command: MotionCommand) -> None:
        """Start a motion; the cell ends it with `LuaProgram.finish_motion`.

        Raises:
            RobotsError: the motion is refused; the call in the program fails.
        """

    def flush(self) -> None:
        """No motion follows for now, although the last one would blend into it."""

    def abort(self) -> None:
        """End all commanded motions where the robot is; each still gets its `finish_motion`."""

    def guide(self, guide: Guide) -> None:
        """Let a sensor or a person guide the robot, or end that (NONE).

        Raises:
            RobotsError: the cell has no such guide; the call in the program fails.
        """

    def hold(self, *, held: bool) -> None:
        """Stop the robot on its path, or let it continue; from any thread."""

    def switch_at_target(self, change: OutputChange) -> None:
        """Switch an output when the robot is at the target of the last motion, or now if it stands."""

    # -- reports --------------------------------------------------------------------------------------

    def output_changed(self, change: OutputChange) -> None:
        """An output has changed; from any thread where an output is switched on the path."""

    def printed(self, text: str, line: int) -> None:
        """The program printed a text on a line."""

    def started(self) -> None:
        """The program begins to run; called by `LuaProgram.run`."""

    def line_reached(self, line: int) -> None:
        """The program calls a robot function on another line than before, or is held before a line."""

    def held_changed(self) -> None:
        """The program is held (`LuaProgram.call_stack` shows where), or continues."""

    def interrupted(self) -> None:
        """The program fails or is stopped: called before its run state changes."""

    def ended(self, error: ProgramError | None) -> None:
        """The program has ended: None, or why it failed. `LuaProgram.run_state` distinguishes a stop."""
