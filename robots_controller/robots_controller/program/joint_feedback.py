"""JointFeedback: what a robot measures at its joints."""

from dataclasses import dataclass

from robots_core.errors import ProgramError
from robots_core.validation import Array


@dataclass(frozen=True, eq=False)
class JointFeedback:
    """One measurement.

    Attributes:
        position: (n,), rad (m).
        velocity: (n,), rad/s (m/s); None if it is not measured.
        torque: Of the motors, at the joints, (n,), N m (N); None if it is not measured.
    """

    position: Array
    velocity: Array | None = None
    torque: Array | None = None

    @property
    def measured_velocity(self) -> Array:
        """The velocity.

        Raises:
            ProgramError: it is not measured.
        """
        if self.velocity is None:
            raise ProgramError('the robot measures no joint speeds: its joint_states have no velocity')
        return self.velocity

    @property
    def measured_torque(self) -> Array:
        """The torque.

        Raises:
            ProgramError: it is not measured.
        """
        if self.torque is None:
            raise ProgramError(
                'the robot measures no torques: its joint_states have no effort; those of drives of level '
                'rigid_body do'
            )
        return self.torque
