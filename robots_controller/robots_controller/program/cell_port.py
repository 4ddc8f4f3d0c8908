"""CellPort: what a robot program needs of the cell that it runs in."""

from collections.abc import Mapping

from robots_controller.program.clock import Clock
from robots_controller.program.motions.motion_command import MotionCommand, OutputChange
from robots_core.blocks.following.guide import Guide
from robots_core.errors import ProgramError
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.motion_settings import NOTHING


class ProgramRobot:
    """What the robot measures, and its kinematics; called from the program's thread.

    This one measures nothing.
    """

    def joint_position(self) -> Array:
        """Measured joint positions, (n,), rad (m).

        Raises:
            RobotsError: no feedback.
        """
        raise ProgramError('the position of the robot is not known here')

    def joint_speeds(self) -> Array:
        """Measured joint velocities, (n,), rad/s (m/s).

        Raises:
            RobotsError: none are measured.
        """
        raise ProgramError('the speeds of the joints are not known here')

    def joint_torques(self) -> Array:
        """Measured torques of the motors, at the joints, (n,), N m (N).

        Raises:
            RobotsError: none are measured.
        """
        raise ProgramError('the torques of the joints are not known here')

    def direct_kinematics(self, q: Array) -> Pose:  # noqa: ARG002
        """Pose of tool0 in the base frame for joint positions (n,).

        Raises:
            RobotsError: the kinematics are unknown.
        """
        raise ProgramError("the robot's kinematics are not known here")

    def inverse_kinematics(self, pose: Pose, near: Array, settings: Mapping[str, object]) -> Array:  # noqa: ARG002
        """Joint positions (n,) that a joint motion to a pose would lead to, rad (m).

        Args:
            pose: Of the tool, seen from the base that was set.
            near: Joint positions (n,) to search from, rad (m).
            settings: Modal settings that the program has changed.

        Raises:
            UnreachablePoseError: there are none inside the limits.
            RobotsError: the kinematics are unknown.
        """
        raise ProgramError("the robot's kinematics are not known here")


class CellPort:
    """Requests of a program to its cell, and reports of what the program does.

    This cell has no robot, and is in the machine's time: requests and reports have no effect. Others override
    what they take. Every method but `hold` and `started` is called from the program's thread.
    """

    clock = Clock()
    """The time that the program's waits take."""
    payload: tuple[float, ...] = NOTHING
    """What the robot carries where the program does not set it: mass and centre of mass, kg and m."""
    simulated = False
    """Time is simulated: a held program continues at once, and no value is kept after the run."""

    def __init__(self) -> None:
        self.robot = ProgramRobot()
        """What the robot measures, and its kinematics."""

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

    def set_override(self, value: float) -> None:
        """Scale the speed of all motions, 0..1."""

    def output_changed(self, change: OutputChange) -> None:
        """An output has changed; from any thread where an output is switched on the path."""

    def switch_at_target(self, change: OutputChange) -> None:
        """Switch an output when the robot is at the target of the last motion, or now if it stands."""

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
