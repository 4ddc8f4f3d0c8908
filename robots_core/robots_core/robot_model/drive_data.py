"""DriveData: motors, gears and the controllers of the axes' drives."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, read_only

# The rule for drives without published figures: a speed control of this bandwidth on the inertia that the
# effort accelerates at the acceleration limit; the position control and the integrator five times slower.
DEFAULT_SPEED_BANDWIDTH: Final = 2.0 * np.pi * 20.0  # rad/s
DEFAULT_SLOWER: Final = 5.0

ABOVE_ZERO: Final = ('integral_time', 'torque_limit', 'stiffness', 'current_frequency')
AT_LEAST: Final = {'stiction': 1.0}  # the others 0


@dataclass(frozen=True, eq=False)
class DriveData:
    """Drives of the axes, each array of shape (n,) and read-only. All figures are those at the joint.

    A motor whose gear turns it i times as fast has i^2 times its inertia, stiffness and damping at the
    joint and i times its torque, see `from_motors`. The order of the attributes is that of the rows of
    `array`.

    Attributes:
        position_gain: Commanded speed per position error, 1/s.
        velocity_gain: Commanded torque per speed error, N m s/rad.
        integral_time: Time constant of the speed control's integrator, s; inf: none.
        torque_limit: Highest commanded torque, N m; inf: none.
        inertia: Of the rotor, kg m^2.
        coulomb_friction: Friction while sliding, N m: of the motor's shaft where the gear is elastic.
        viscous_friction: Increase of friction with speed, N m s/rad.
        stiction: Highest friction at standstill per friction while sliding, at least 1.
        stiffness: Of the gear, N m/rad; inf: rigid.
        damping: Of an elastic gear, N m s/rad.
        current_frequency: Natural frequency of the current control, rad/s; inf: ideal.
        current_damping: Its damping ratio.
        back_emf: Rate of the torque per speed due to the voltage induced in the motor, N m/rad.

    Raises:
        InvalidInputError: arrays of different lengths, or values outside their range.
    """

    position_gain: Array
    velocity_gain: Array
    integral_time: Array
    torque_limit: Array
    inertia: Array
    coulomb_friction: Array
    viscous_friction: Array
    stiction: Array
    stiffness: Array
    damping: Array
    current_frequency: Array
    current_damping: Array
    back_emf: Array

    def __post_init__(self) -> None:
        n = np.asarray(self.position_gain).shape
        for item in fields(self):
            values = np.asarray(getattr(self, item.name), dtype=np.float64)
            if values.ndim != 1 or values.shape != n:
                raise InvalidInputError(f'DriveData.{item.name} must have shape {n}, got {values.shape}')
            least = AT_LEAST.get(item.name, 0.0)
            for value in values:
                if item.name in ABOVE_ZERO:
                    if not value > 0.0:
                        raise InvalidInputError(
                            f'{item.name} {value:g} of a drive must be above 0, or infinite'
                        )
                elif not least <= value < np.inf:
                    raise InvalidInputError(
                        f'{item.name} {value:g} of a drive must be finite, {least:g} or above'
                    )
            object.__setattr__(self, item.name, read_only(values))

    @property
    def array(self) -> Array:
        """The attributes as (13, n), one row each."""
        return np.array([getattr(self, item.name) for item in fields(self)])

    @classmethod
    def from_limits(cls, axes: AxesData) -> DriveData:
        """Rigid, ideal drives for axes whose motors are not published.

        The torque limit is the effort, the inertia and the friction are those of `axes`. The speed control
        has a bandwidth of 20 Hz on an inertia of effort / acceleration limit, the load for which such a
        drive would be chosen; position control and integrator are five times slower.
        """
        n = axes.num_axes
        load = axes.effort / axes.acceleration
        return cls(
            position_gain=np.full(n, DEFAULT_SPEED_BANDWIDTH / DEFAULT_SLOWER),
            velocity_gain=DEFAULT_SPEED_BANDWIDTH * load,
            integral_time=np.full(n, DEFAULT_SLOWER / DEFAULT_SPEED_BANDWIDTH),
            torque_limit=axes.effort,
            inertia=axes.reflected_inertia,
            coulomb_friction=axes.coulomb_friction,
            viscous_friction=axes.viscous_friction,
            stiction=np.ones(n),
            stiffness=np.full(n, np.inf),
            damping=np.zeros(n),
            current_frequency=np.full(n, np.inf),
            current_damping=np.ones(n),
            back_emf=np.zeros(n),
        )

    @classmethod
    def from_motors(
        cls,
        axes: AxesData,
        *,
        torque_constant: ArrayLike,
        position_gain: ArrayLike,
        speed_gain: ArrayLike,
        integral_time: ArrayLike,
        current_limit: ArrayLike,
        stiction: ArrayLike = 1.0,
        stiffness: ArrayLike = np.inf,
        damping: ArrayLike = 0.0,
        current_frequency: ArrayLike = np.inf,
        current_damping: ArrayLike = 1.0,
        resistance: ArrayLike = np.inf,
    ) -> DriveData:
        """Drives from figures at the motor's side, each one number or (n,), as in data sheets.

        Gear ratio, rotor inertia and friction are those of `axes`. The current control is that of the
        Modelica Standard Library's `RobotR3.Utilities.Motor`: 1 / (1 + 2 D s / w + s^2 / w^2), with an
        armature inductance of resistance / (2 D w).

        Args:
            axes: The robot's axes, with all gear ratios.
            torque_constant: N m/A.
            position_gain: 1/s.
            speed_gain: A s/rad, commanded current per error of the motor's speed.
            integral_time: s.
            current_limit: A; inf: none.
            stiction: Ratio to the friction while sliding.
            stiffness: Of the gear, N m/rad.
            damping: Of the gear, N m s/rad.
            current_frequency: w, rad/s.
            current_damping: D.
            resistance: Of the armature, ohm; inf: no induced voltage.

        Raises:
            InvalidInputError: an axis without gear ratio, or values outside their range.
        """
        n = axes.num_axes
        ratio = np.abs(axes.gear_ratio)
        if np.isnan(ratio).any():
            raise InvalidInputError(
                f'axis {axes.names[int(np.isnan(ratio).argmax())]} has no gear ratio; motors need one'
            )

        def per_axis(values: ArrayLike) -> Array:
            return np.broadcast_to(np.asarray(values, dtype=np.float64), (n,))

        constant = per_axis(torque_constant) * ratio
        frequency, lag = per_axis(current_frequency), per_axis(current_damping)
        inductance = np.divide(
            per_axis(resistance),
            2.0 * lag * frequency,
            out=np.full(n, np.inf),
            where=np.isfinite(frequency) & (lag > 0.0),
        )
        return cls(
            position_gain=per_axis(position_gain),
            velocity_gain=constant * ratio * per_axis(speed_gain),
            integral_time=per_axis(integral_time),
            torque_limit=constant * per_axis(current_limit),
            inertia=axes.reflected_inertia,
            coulomb_friction=axes.coulomb_friction,
            viscous_friction=axes.viscous_friction,
            stiction=per_axis(stiction),
            stiffness=ratio**2 * per_axis(stiffness),
            damping=ratio**2 * per_axis(damping),
            current_frequency=frequency,
            current_damping=lag,
            back_emf=constant**2 / inductance,
        )
