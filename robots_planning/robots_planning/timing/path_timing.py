"""PathTiming: the interface of algorithms that time a motion along a path, and limits of the tool."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robots_core.validation import positive
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.trajectory import Trajectory


class TooSlowError(Exception):
    """A motion takes longer than the caller accepts."""


class PathTiming(Protocol):
    """Times a motion along a path, from rest to rest; one class per algorithm."""

    def trajectory(
        self, joint_path: JointPath, tool_path: CartesianPath, longest: float = np.inf
    ) -> Trajectory:
        """The timed motion along a path.

        Args:
            joint_path: Joint positions over s.
            tool_path: Poses of the tool over the same s.
            longest: Longest duration that the caller accepts, s; planning stops once it is exceeded.

        Raises:
            TooSlowError: the motion takes longer than `longest`.
        """


@dataclass(frozen=True)
class ToolLimits:
    """Limits of the tool centre point, each on the norm of a vector.

    Attributes:
        speed: m/s.
        acceleration: m/s^2; on a curve including the centripetal part.
        rotation_speed: rad/s.
        rotation_acceleration: rad/s^2.
        jerk: m/s^3, kept where jerk is limited; None for no limit.

    Raises:
        InvalidInputError: a limit that is not above 0.
    """

    speed: float
    acceleration: float
    rotation_speed: float
    rotation_acceleration: float
    jerk: float | None = None

    def __post_init__(self) -> None:
        positive(self.speed, 'cartesian_speed', 'm/s')
        positive(self.acceleration, 'cartesian_acceleration', 'm/s^2')
        positive(self.rotation_speed, 'rotation_speed', 'rad/s')
        positive(self.rotation_acceleration, 'rotation_acceleration', 'rad/s^2')
        if self.jerk is not None:
            positive(self.jerk, 'cartesian_jerk', 'm/s^3')
