"""ProgramRobot: what a robot program reads of the robot."""

from collections.abc import Mapping
from typing import Protocol

from robots_core.errors import ProgramError
from robots_core.pose import Pose
from robots_core.validation import Array


class ProgramRobot(Protocol):
    """What the robot measures, and its kinematics; called from the program's thread."""

    def joint_position(self) -> Array:
        """Measured joint positions, (n,), rad (m).

        Raises:
            RobotsError: no feedback.
        """

    def joint_speeds(self) -> Array:
        """Measured joint velocities, (n,), rad/s (m/s).

        Raises:
            RobotsError: none are measured.
        """

    def joint_torques(self) -> Array:
        """Measured torques of the motors, at the joints, (n,), N m (N).

        Raises:
            RobotsError: none are measured.
        """

    def direct_kinematics(self, q: Array) -> Pose:
        """Pose of tool0 in the base frame for joint positions (n,).

        Raises:
            RobotsError: the kinematics are unknown.
        """

    def inverse_kinematics(self, pose: Pose, near: Array, settings: Mapping[str, object]) -> Array:
        """Joint positions (n,) that a joint motion to a pose would lead to, rad (m).

        Args:
            pose: Of the tool, seen from the base that was set.
            near: Joint positions (n,) to search from, rad (m).
            settings: Modal settings that the program has changed.

        Raises:
            UnreachablePoseError: there are none inside the limits.
            RobotsError: the kinematics are unknown.
        """


class UnknownRobot(ProgramRobot):
    """No robot: for cells that have none."""

    def joint_position(self) -> Array:
        """Raises a ProgramError: nothing is measured."""
        raise ProgramError('the position of the robot is not known here')

    def joint_speeds(self) -> Array:
        """Raises a ProgramError: nothing is measured."""
        raise ProgramError('the speeds of the joints are not known here')

    def joint_torques(self) -> Array:
        """Raises a ProgramError: nothing is measured."""
        raise ProgramError('the torques of the joints are not known here')

    def direct_kinematics(self, q: Array) -> Pose:  # noqa: ARG002
        """Raises a ProgramError: there is no robot."""
        raise ProgramError("the robot's kinematics are not known here")

    def inverse_kinematics(self, pose: Pose, near: Array, settings: Mapping[str, object]) -> Array:  # noqa: ARG002
        """Raises a ProgramError: there is no robot."""
        raise ProgramError("the robot's kinematics are not known here")
