"""AxesData: the paper's record of limits and drive data per axis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from robots_core.errors import InvalidInputError, JointLimitError
from robots_core.validation import Array, finite_vector, read_only

# Limits are inclusive; a value computed to lie on a limit may exceed it by rounding.
LIMIT_TOLERANCE = 1e-9
_PER_TIME: Final[Mapping[str, str]] = {
    'position': '',
    'velocity': '/s',
    'acceleration': '/s^2',
    'jerk': '/s^3',
}


@dataclass(frozen=True, eq=False)
class AxesData:
    """Limits and drive data of the axes, each array of shape (n,) and read-only.

    Attributes:
        names: Joint names, base to tip.
        lower: Lowest position, rad (prismatic: m); -inf for a continuous axis.
        upper: Highest position, rad (m); inf for a continuous axis.
        velocity: Highest speed, rad/s (m/s).
        acceleration: Highest acceleration, rad/s^2 (m/s^2).
        jerk: Highest jerk, rad/s^3 (m/s^3).
        effort: Highest torque, N m (force, N), at the joint.
        gear_ratio: Motor revolutions per joint revolution; NaN where not published.
        rotor_inertia: Motor inertia at the motor side, kg m^2; 0 where not published.
        coulomb_friction: Friction of a sliding axis, N m (N), at the joint; 0 where not published.
        viscous_friction: Increase of friction with speed, N m s/rad (N s/m), at the joint; likewise.
        prismatic: True for an axis that slides.

    Raises:
        InvalidInputError: arrays of different lengths, limits that are not positive, friction below zero, or
            lower >= upper.
    """

    names: tuple[str, ...]
    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    effort: Array
    gear_ratio: Array = field(default_factory=lambda: np.empty(0))
    rotor_inertia: Array = field(default_factory=lambda: np.empty(0))
    coulomb_friction: Array = field(default_factory=lambda: np.empty(0))
    viscous_friction: Array = field(default_factory=lambda: np.empty(0))
    prismatic: tuple[bool, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.names)
        if n == 0:
            raise InvalidInputError('a robot needs at least one axis')
        defaults = {'gear_ratio': np.full(n, np.nan)}
        defaults |= dict.fromkeys(('rotor_inertia', 'coulomb_friction', 'viscous_friction'), np.zeros(n))
        for item in fields(self):
            if item.name in ('names', 'prismatic'):
                continue
            values = np.asarray(getattr(self, item.name), dtype=np.float64)
            if values.size == 0 and item.name in defaults:
                values = defaults[item.name]
            if values.shape != (n,):
                raise InvalidInputError(f'AxesData.{item.name} must have shape ({n},), got {values.shape}')
            object.__setattr__(self, item.name, read_only(values))
        object.__setattr__(self, 'prismatic', tuple(self.prismatic) or (False,) * n)
        self._check_limits()

    def _check_limits(self) -> None:
        for index, name in enumerate(self.names):
            if problem := self._problem(index):
                raise InvalidInputError(f'axis {name}: {problem}', joint=name)

    def _problem(self, index: int) -> str:
        """Which figure of an axis is wrong; '' for none."""
        low, high = self.lower[index], self.upper[index]
        if not low < high:
            return f'lower limit {low:g} must be below upper limit {high:g}'
        if np.isinf(low) != np.isinf(high):
            return f'limits [{low:g}, {high:g}] must both be finite or both infinite (a continuous axis)'
        for quantity in ('velocity', 'acceleration', 'jerk', 'effort'):
            if not 0.0 < (value := getattr(self, quantity)[index]) < np.inf:
                return f'{quantity} limit {value:g} must be a finite number above 0'
        for quantity in ('rotor_inertia', 'coulomb_friction', 'viscous_friction'):
            if not 0.0 <= (value := getattr(self, quantity)[index]) < np.inf:
                return f'{quantity} {value:g} must be a finite number, 0 or above'
        return ''

    @property
    def num_axes(self) -> int:
        """Number of axes n."""
        return len(self.names)

    @property
    def continuous(self) -> NDArray[np.bool_]:
        """(n,) bool: the axis turns without limits."""
        return np.isinf(self.lower) & np.isinf(self.upper)

    @property
    def one_turn(self) -> tuple[Array, Array]:
        """Lowest and highest positions, (n,) each, rad (m); a continuous axis has a turn about 0."""
        return np.where(self.continuous, -np.pi, self.lower), np.where(self.continuous, np.pi, self.upper)

    @property
    def middle_and_half(self) -> tuple[Array, Array]:
        """Middle and half of each range, (n,) each, rad (m); 0 and infinity of a continuous axis."""
        low, high = self.one_turn
        middle, half = np.where(self.continuous, 0.0, 0.5 * (low + high)), 0.5 * (high - low)
        return middle, np.where(self.continuous, np.inf, half)

    @property
    def reflected_inertia(self) -> Array:
        """Rotor inertia reflected to the joint, (n,), kg m^2 (kg): gear ratio squared times rotor inertia."""
        ratio = np.where(np.isnan(self.gear_ratio), 0.0, self.gear_ratio)
        return np.asarray(ratio**2 * self.rotor_inertia)

    def unit(self, index: int, quantity: str = 'position') -> str:
        """Unit of axis `index`: 'rad' or 'm' of its position, and so on.

        Args:
            index: Which axis.
            quantity: 'position', 'velocity', 'acceleration', 'jerk' or 'torque'.
        """
        slides = self.prismatic[index]
        if quantity == 'torque':
            return 'N' if slides else 'N m'
        return ('m' if slides else 'rad') + _PER_TIME[quantity]

    def check_position(self, q: ArrayLike, name: str = 'q', *, tolerance: float = LIMIT_TOLERANCE) -> Array:
        """`q` as (n,) array, if it lies inside the limits, or beyond them by a tolerance, rad (m).

        Raises:
            JointLimitError: an axis is outside; names axis, value and limits.
            InvalidInputError: wrong shape, NaN or infinity.
        """
        values = finite_vector(q, self.num_axes, name)
        # On a few values numpy's own comparisons take several times longer.
        ranges = zip(values.tolist(), self.lower.tolist(), self.upper.tolist(), strict=True)
        for index, (value, low, high) in enumerate(ranges):
            if not low - tolerance <= value <= high + tolerance:
                raise JointLimitError(self.names[index], value, low, high, unit=self.unit(index))
        return values
