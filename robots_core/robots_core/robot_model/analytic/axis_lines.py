"""The axes of a robot as lines in space at q = 0, from which a closed form is built."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module

import numpy as np

from robots_core.errors import NoAnalyticInverseKinematicsError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only

# Robot descriptions print right angles with few digits (1.5708), which turns axes by 4e-6 rad and moves them
# by as many metres per metre. Beyond, the robot is meant to be different, or is a calibrated arm.
STRUCTURE_TOLERANCE = 1e-5
# A closed form divides by the sine of the angle between two axes; real arms have right angles, or 50 and more
# degrees in hollow wrists.
SMALLEST_SINE = 0.1
SHORTEST_LINK = 1e-3  # m


@dataclass(frozen=True, eq=False)
class AxisLines:
    """Axes and tool of a six-axis robot at q = 0, base frame.

    Attributes:
        name: The robot's name.
        directions: Unit vectors of the axes, (6, 3); positive rotations are right-handed about them.
        points: A point on each axis, (6, 3), m.
        r: Position of tool0, (3,), m.
        T: Orientation of tool0, (3, 3).
    """

    name: str
    directions: Array
    points: Array
    r: Array
    T: Array

    def __post_init__(self) -> None:
        for field in ('directions', 'points', 'r', 'T'):
            object.__setattr__(self, field, read_only(getattr(self, field)))

    @classmethod
    def of(cls, robot: BaseRobotModel) -> AxisLines:
        """The lines of a robot.

        Raises:
            NoAnalyticInverseKinematicsError: not six axes, or one that slides.
        """
        if robot.num_axes != 6:
            raise no_closed_form(
                robot.name, f'it has {robot.num_axes} axes, closed forms are known here for 6'
            )
        axes = robot.axes_data
        for index, name in enumerate(axes.names):
            if axes.prismatic[index]:
                raise no_closed_form(robot.name, f'axis {index + 1} ({name}) slides, all six must turn')
        # Loads compiled code, which a robot without closed form does not need.
        chain = import_module('robots_core.kernels.serial_chain').SerialChain.of(robot)
        return cls(robot.name, chain.directions, chain.points, chain.r, chain.T)

    def common_direction(self, *axes: int) -> tuple[Array, Array, float]:
        """The direction that parallel axes share, which are counted from 1.

        Returns:
            Unit vector (3,) in the sense of the first axis; the sign of each axis along it; the largest
            angle of an axis from it, rad.

        Raises:
            NoAnalyticInverseKinematicsError: axes that are not parallel.
        """
        chosen = self.directions[np.array(axes) - 1]
        signs = np.where(chosen @ chosen[0] < 0.0, -1.0, 1.0)
        mean = (signs[:, None] * chosen).sum(axis=0)
        mean /= np.linalg.norm(mean)
        angles = np.arcsin(np.clip(np.linalg.norm(np.cross(chosen, mean), axis=1), 0.0, 1.0))
        deviation = float(angles.max())
        if deviation > STRUCTURE_TOLERANCE:
            raise no_closed_form(
                self.name, f'axes {_listed(axes)} are not parallel (they differ by {2.0 * deviation:.3g} rad)'
            )
        return mean, signs, deviation

    def common_point(self, *axes: int) -> tuple[Array, float]:
        """The point where axes meet, which are counted from 1.

        Returns:
            The point (3,) m; the largest distance of an axis from it, m.

        Raises:
            NoAnalyticInverseKinematicsError: axes that do not meet in one point.
        """
        chosen = np.array(axes) - 1
        # Projectors onto the planes across the axes: the distance of x from axis i is |P_i (x - p_i)|.
        projectors = np.eye(3) - self.directions[chosen, :, None] * self.directions[chosen, None, :]
        targets = np.einsum('kij,kj->ki', projectors, self.points[chosen])
        point, *_ = np.linalg.lstsq(projectors.reshape(-1, 3), targets.reshape(-1), rcond=None)
        deviation = float(np.linalg.norm(projectors @ point - targets, axis=1).max())
        if deviation > STRUCTURE_TOLERANCE:
            raise no_closed_form(
                self.name,
                f'axes {_listed(axes)} do not meet in one point (they pass it by {deviation:.3g} m)',
            )
        return point, deviation

    def sine_between(self, first: int, second: int) -> float:
        """Sine of the angle between two axes (counted from 1), which must not be close to parallel.

        Raises:
            NoAnalyticInverseKinematicsError: nearly parallel axes.
        """
        sine = float(np.linalg.norm(np.cross(self.directions[first - 1], self.directions[second - 1])))
        if sine < SMALLEST_SINE:
            raise no_closed_form(self.name, f'axes {first} and {second} are parallel or nearly so')
        return sine


def no_closed_form(robot: str, reason: str) -> NoAnalyticInverseKinematicsError:
    """The error with the reason why a robot has no closed form here."""
    return NoAnalyticInverseKinematicsError(
        f'robot {robot!r} has no analytic inverse kinematics: {reason}; use DampedLeastSquares', reason=reason
    )


def _listed(axes: tuple[int, ...]) -> str:
    return f'{", ".join(str(axis) for axis in axes[:-1])} and {axes[-1]}'
