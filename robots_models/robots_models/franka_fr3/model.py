"""Franka Research 3, with seven axes."""

from dataclasses import dataclass
from math import pi
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from robots_core import StructuralData
from robots_core.robot_model.urdf_robot_model import EARTH_GRAVITY
from robots_core.validation import Array, finite_vector, one_of
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class FrankaFr3Data(StructuralData):
    """Lengths in metres, limits in SI units.

    Attributes:
        shoulder_height: Base plane to axis 2.
        upper_arm: Axis 2 to the elbow, along axis 3.
        elbow_offset: Distance of axis 4 from axes 3 and 5.
        forearm: Elbow to axis 6, along axis 5.
        wrist_offset: Distance of axes 6 and 7.
        flange: Axis 6's height above the flange.
        rated_payload_kg: kg, an unconfirmed data-sheet figure.
        reach: An unconfirmed data-sheet figure.
        torque_rate: N m/s, of every axis.
        translation: Highest Cartesian velocity, acceleration and jerk, m/s, m/s^2, m/s^3.
        rotation: The same of turning, rad/s, rad/s^2, rad/s^3.
        velocity_offset: rad/s, see `velocity_limits`.
        velocity_gain: rad/s^2, see `velocity_limits`.
        velocity_zero_upper: rad, see `velocity_limits`.
        velocity_zero_lower: rad, see `velocity_limits`.
        velocity_cap: rad/s, see `velocity_limits`.
    """

    source: str = (
        'github.com/frankarobotics/franka_description @566ba44 (Franka Robotics, Apache-2.0): robots/fr3; '
        'github.com/frankaemika/docs @1da6bd3: source/control_parameters.rst; velocity limits by position: '
        'libfranka, rate_limiting.h. Published: kinematics, limits of position, velocity, acceleration, jerk '
        'and effort, masses and inertias. Unconfirmed data-sheet figures: payload, reach. Estimated: '
        'nothing. Not published: gear ratios, rotor inertias. AxesData.velocity holds the constant caps: '
        'true velocity limits fall to zero towards the ends of the range, see velocity_limits; '
        'limits="rectangular" loads the '
        "maker's narrower range, inside which constant limits are true"
    )
    shoulder_height: float = 0.333
    upper_arm: float = 0.316
    elbow_offset: float = 0.0825
    forearm: float = 0.384
    wrist_offset: float = 0.088
    flange: float = 0.107
    rated_payload_kg: float = 3.0
    reach: float = 0.855
    torque_rate: float = 1000.0
    translation: tuple[float, float, float] = (3.0, 9.0, 4500.0)
    rotation: tuple[float, float, float] = (2.5, 17.0, 8500.0)
    velocity_offset: tuple[float, ...] = (0.3, 0.2, 0.2, 0.3, 0.35, 0.35, 0.35)
    velocity_gain: tuple[float, ...] = (12.0, 5.17, 7.0, 8.0, 34.0, 11.0, 34.0)
    velocity_zero_upper: tuple[float, ...] = (2.7501, 1.7918, 2.9065, -0.1458, 2.8101, 4.5205, 3.0196)
    velocity_zero_lower: tuple[float, ...] = (-2.7501, -1.7918, -2.9065, -3.0481, -2.8101, 0.54092, -3.0196)
    velocity_cap: tuple[float, ...] = (2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26)

    def velocity_limits(self, q: ArrayLike) -> tuple[Array, Array]:
        """Lowest and highest velocity of every axis at a position, as the arm itself watches them.

        The highest is min(cap, max(0, -offset + sqrt(gain (zero_upper - q)))), the lowest its mirror image.

        Args:
            q: (7,) rad.

        Returns:
            Lowest and highest velocity, (7,) rad/s each.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        q = finite_vector(q, 7, 'q')
        offset, gain, cap = (
            np.asarray(column) for column in (self.velocity_offset, self.velocity_gain, self.velocity_cap)
        )

        def limit(room: Array) -> Array:
            return np.asarray(np.clip(np.sqrt(gain * np.maximum(room, 0.0)) - offset, 0.0, cap))

        return -limit(q - self.velocity_zero_lower), limit(self.velocity_zero_upper - q)


class FrankaFr3(PackagedRobot):
    """Franka's research arm for 3 kg; home is the maker's posture `ready`.

    Args:
        gravity: Acceleration of free fall in the base frame, (3,) m/s^2.
        limits: 'published', or 'rectangular': the maker's narrower ranges and velocities, inside which the
            velocity limits hold at every position.
    """

    DATA = FrankaFr3Data()
    HOME = (0.0, -pi / 4, 0.0, -3.0 * pi / 4, 0.0, pi / 2, pi / 4)
    ORIENTATION_CONVENTION = 'zyx'

    def __init__(
        self,
        *,
        gravity: ArrayLike = EARTH_GRAVITY,
        limits: Literal['published', 'rectangular'] = 'published',
    ) -> None:
        files = {'published': 'joint_limits.yaml', 'rectangular': 'rectangular_limits.yaml'}
        super().__init__(gravity=gravity, joint_limits=files[one_of('limits', files)(limits)])
