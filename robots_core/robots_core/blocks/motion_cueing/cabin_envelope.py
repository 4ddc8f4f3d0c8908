"""CabinEnvelope: how far and how fast a cabin may move from its middle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import positive

Six = tuple[float, float, float, float, float, float]

DIRECTIONS: Final = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
UNITS: Final = ('m', 'm', 'm', 'rad', 'rad', 'rad')
# Roll, pitch and yaw are no coordinates of an orientation near a pitch of 90 degrees.
STEEPEST_PITCH: Final = 1.2  # rad
UNLIMITED: Final = 1e9  # a jerk and an effort that nothing reaches
_PITCH: Final = DIRECTIONS.index('pitch')


@dataclass(frozen=True, kw_only=True)
class CabinEnvelope:
    """Bounds to both sides of the middle, by surge, sway, heave (m) and roll, pitch, yaw (rad).

    Attributes:
        reach: Largest distance, m and rad.
        velocity: Highest speed, m/s and rad/s.
        acceleration: Highest acceleration, m/s^2 and rad/s^2.

    Raises:
        InvalidInputError: a bound that is not a finite number above 0, or a pitch beyond `STEEPEST_PITCH`.
    """

    reach: Six
    velocity: Six
    acceleration: Six

    def __post_init__(self) -> None:
        for name, per_time in (('reach', ''), ('velocity', '/s'), ('acceleration', '/s^2')):
            bounds = getattr(self, name)
            if len(bounds) != 6:
                raise InvalidInputError(
                    f'{name} must have 6 bounds ({", ".join(DIRECTIONS)}), got {len(bounds)}'
                )
            for direction, unit, bound in zip(DIRECTIONS, UNITS, bounds, strict=True):
                positive(bound, f'{name} of {direction}', unit + per_time)
        if self.reach[_PITCH] > STEEPEST_PITCH:
            raise InvalidInputError(
                f'reach of pitch = {self.reach[_PITCH]:g} rad must be at most {STEEPEST_PITCH} rad'
            )

    @property
    def axes_data(self) -> AxesData:
        """The bounds as limits of six axes; jerk and effort are not limited."""
        reach = np.array(self.reach)
        return AxesData(
            names=DIRECTIONS,
            lower=-reach,
            upper=reach,
            velocity=np.array(self.velocity),
            acceleration=np.array(self.acceleration),
            jerk=np.full(6, UNLIMITED),
            effort=np.full(6, UNLIMITED),
            prismatic=(True,) * 3 + (False,) * 3,
        )
