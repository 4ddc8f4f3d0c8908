"""DrivenVehicle: a car that a person drives by steering and pedals."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import exp
from typing import Final

import numpy as np

from robots_core.blocks.motion_cueing.vehicle_motion import GRAVITY, VehicleMotion
from robots_core.errors import InvalidInputError
from robots_core.validation import positive

_UNITS: Final = {
    'wheelbase': 'm',
    'largest_steering': 'rad',
    'characteristic_speed': 'm/s',
    'acceleration': 'm/s^2',
    'braking': 'm/s^2',
    'highest_speed': 'm/s',
    'grip': 'm/s^2',
    'response': 's',
}


@dataclass(frozen=True)
class DriverInputs:
    """What a driver does.

    Attributes:
        steering: -1 (full right) to 1 (full left).
        pedal: -1 (full braking) to 1 (full acceleration).

    Raises:
        InvalidInputError: a value outside, NaN or infinite.
    """

    steering: float
    pedal: float

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not -1.0 <= value <= 1.0:
                raise InvalidInputError(f'{item.name} = {value!r}; valid is -1 to 1')


@dataclass(frozen=True, kw_only=True)
class VehicleData:
    """Figures of a car, all above zero; the defaults are those of no particular one.

    Attributes:
        wheelbase: m.
        largest_steering: Angle of the front wheels at full steering, rad.
        characteristic_speed: At which it yaws half as much as a car without slip, m/s.
        acceleration: At full pedal from rest, m/s^2; it falls linearly to zero at the highest speed.
        braking: At full pedal, m/s^2.
        highest_speed: m/s.
        grip: Largest acceleration to the side, m/s^2.
        response: Time constant of steering and pedals, s.

    Raises:
        InvalidInputError: a figure that is not a finite number above 0.
    """

    wheelbase: float = 2.7
    largest_steering: float = 0.5
    characteristic_speed: float = 22.0
    acceleration: float = 3.5
    braking: float = 7.0
    highest_speed: float = 40.0
    grip: float = 7.0
    response: float = 0.15

    def __post_init__(self) -> None:
        for item in fields(self):
            positive(getattr(self, item.name), item.name, _UNITS[item.name])


class DrivenVehicle:
    """A car in steady cornering, with a lag of its steering and pedals.

    The yaw rate is that of the single-track model in steady state, r = v delta / (l (1 + (v / v_ch)^2))
    (P. Riekert and T. E. Schunck, Zur Fahrmechanik des gummibereiften Kraftfahrzeugs, Ingenieur-Archiv 11,
    1940; v_ch as in M. Mitschke and H. Wallentowitz, Dynamik der Kraftfahrzeuge), bounded by the grip. The
    body does not lean; the driver's head is above the centre of mass. The car does not drive backwards.

    Args:
        data: The car's figures.
        dt: Period, s.

    Raises:
        InvalidInputError: a period that is not positive.
    """

    def __init__(self, data: VehicleData, dt: float) -> None:
        self.data, self._dt = data, positive(dt, 'dt', 's')
        self._share = 1.0 - exp(-dt / data.response)
        self.stop()

    def stop(self) -> None:
        """Stand from now on."""
        self.speed = 0.0
        """m/s."""
        self._steering = self._pull = 0.0

    def step(self, inputs: DriverInputs) -> VehicleMotion:
        """Motion at the end of the next period."""
        data = self.data
        strength = data.acceleration * (1.0 - self.speed / data.highest_speed)
        wanted = inputs.pedal * (data.braking if inputs.pedal < 0.0 else strength)
        self._pull += self._share * (wanted - self._pull)
        self._steering += self._share * (inputs.steering * data.largest_steering - self._steering)
        before, self.speed = self.speed, max(0.0, self.speed + self._dt * self._pull)
        if self.speed == 0.0:
            self._pull = max(0.0, self._pull)
        v = self.speed
        yaw = v * self._steering / (data.wheelbase * (1.0 + (v / data.characteristic_speed) ** 2))
        across = min(max(v * yaw, -data.grip), data.grip)
        forward = (v - before) / self._dt
        rate = across / v if v > 0.0 else 0.0
        return VehicleMotion(np.array([forward, across, GRAVITY]), np.array([0.0, 0.0, rate]))
