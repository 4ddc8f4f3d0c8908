"""WashoutSettings: the parameters of the classical washout filter."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import radians
from typing import Final

from robots_core.blocks.motion_cueing.vehicle_motion import GRAVITY
from robots_core.errors import InvalidInputError
from robots_core.validation import positive

Two = tuple[float, float]
Three = tuple[float, float, float]

_UNITS: Final = {
    'force_scale': '',
    'force_limit': 'm/s^2',
    'rate_scale': '',
    'rate_limit': 'rad/s',
    'translation_frequency': 'rad/s',
    'translation_damping': '',
    'return_frequency': 'rad/s',
    'rotation_frequency': 'rad/s',
    'rotation_damping': '',
    'tilt_frequency': 'rad/s',
    'tilt_damping': '',
    'tilt_rate': 'rad/s',
    'largest_tilt': 'rad',
    'timeout': 's',
    'fade_time': 's',
}


@dataclass(frozen=True, kw_only=True)
class WashoutSettings:
    """Parameters by axis x, y, z of the cabin (forward, left, up), all above zero; of tilting by x and y.

    The numbers are of the usual order for the classical algorithm, chosen for a robot that carries a cabin;
    they are no standard set, and each simulator and each kind of vehicle has its own. A tilt rate of 3 deg/s
    is the customary bound below which a person hardly feels the cabin tilt.

    Attributes:
        force_scale: Part of the vehicle's specific force (without gravity at rest) that the cabin aims at.
        force_limit: Largest specific force that is taken in, m/s^2, before scaling.
        rate_scale: Part of the vehicle's angular velocity.
        rate_limit: Largest angular velocity that is taken in, rad/s, before scaling.
        translation_frequency: Natural frequency of the translational high-pass, rad/s.
        translation_damping: Its damping ratio.
        return_frequency: Its third pole, rad/s, by which the cabin returns under sustained force.
        rotation_frequency: Natural frequency of the rotational high-pass, rad/s.
        rotation_damping: Its damping ratio.
        tilt_frequency: Natural frequency of the low-pass of the tilt coordination, rad/s: by pitch for x,
            by roll for y.
        tilt_damping: Its damping ratio.
        tilt_rate: Highest speed of tilting, rad/s.
        largest_tilt: Largest angle of tilting, rad.
        timeout: The last sample holds for this long, s.
        fade_time: Then the input fades to that of a vehicle at rest within this time, s.

    Raises:
        InvalidInputError: a parameter that is not a finite number above 0, a tilt of 1 rad and more.
    """

    force_scale: Three = (0.5, 0.5, 0.5)
    force_limit: Three = (10.0, 10.0, 10.0)
    rate_scale: Three = (0.5, 0.5, 0.5)
    rate_limit: Three = (1.0, 1.0, 1.0)
    translation_frequency: Three = (2.5, 2.5, 4.0)
    translation_damping: Three = (1.0, 1.0, 1.0)
    return_frequency: Three = (0.3, 0.3, 0.5)
    rotation_frequency: Three = (0.7, 0.7, 0.7)
    rotation_damping: Three = (1.0, 1.0, 1.0)
    tilt_frequency: Two = (2.0, 2.0)
    tilt_damping: Two = (1.0, 1.0)
    tilt_rate: float = radians(3.0)
    largest_tilt: float = 0.25
    timeout: float = 0.2
    fade_time: float = 1.0

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not isinstance(item.default, tuple):
                positive(value, item.name, _UNITS[item.name])
                continue
            axes = 'xyz'[: len(item.default)]
            if not isinstance(value, tuple) or len(value) != len(axes):
                raise InvalidInputError(f'{item.name} = {value!r} must have a number for each of {axes}')
            for axis, number in zip(axes, value, strict=True):
                positive(number, f'{item.name}.{axis}', _UNITS[item.name])
        if self.largest_tilt >= 1.0:
            raise InvalidInputError(
                f'largest_tilt = {self.largest_tilt:g} rad must be below 1 rad: by {GRAVITY:.2f} m/s^2 times '
                f'its sine, a cabin hardly gives more force with a larger tilt'
            )
