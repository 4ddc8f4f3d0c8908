"""JointFeedback: what a robot measures at its joints."""

from dataclasses import dataclass

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
