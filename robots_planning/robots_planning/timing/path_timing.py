"""PathTiming: what tells when to be where on a path."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robots_core.validation import positive
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath
from robots_planning.trajectory import Trajectory


class TooSlowError(Exception):
    """A motion takes longer than it is of use."""


class PathTiming(Protocol):
    """From a path to a motion along it, from rest to rest; one class per algorithm."""

    def trajectory(
        self, joint_path: JointPath, tool_path: CartesianPath, longest: float = np.inf
    ) -> Trajectory:
        """The timed motion along a path.

        Args:
            joint_path: What the axes do over s.
            tool_path: What the tool does over the same s.
            longest: Time that is of use, s: nobody need plan a motion that takes more to its end.

        Raises:
            TooSlowError: it takes longer.
        """


@dataclass(frozen=True)
class ToolLimits:
    """Limits of the tool centre point, each the length of a vector.

    Attributes:
        speed: m/s.
        acceleration: m/s^2; on a curve the centripetal part is in it.
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
