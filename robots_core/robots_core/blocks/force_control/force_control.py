"""ForceControl: presses a tool along a direction with a commanded force while it may move across."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.validation import Array, finite_vector, positive, read_only

SQUARE: Final = 1e-9  # largest cosine between two directions that are at right angles


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceControlSettings:
    """How a tool presses. Directions are in the base frame; their lengths do not matter.

    Attributes:
        press: Where to, (3,).
        drive: Where the tool moves to meanwhile, (3,), at right angles to `press`.
        gain: Speed per error of the force, (m/s)/N. The product with the stiffness of what is pressed, in
            1/s, is how fast the error decays; it must be small next to the inverse of all delays.
        press_speed: Highest speed of pressing, m/s, also towards what is pressed.
        drive_speed: Highest speed of driving, m/s.
        acceleration: Of driving, m/s^2.
        travel: Longest travel along `press` from where it begins, m.
        force_limit: Largest force on the tool, N.
        contact_force: Force from which the tool touches something, N.
        timeout: Without a measured force for this long there is none, s.

    Raises:
        InvalidInputError: a number that is not finite and above 0, directions without length or not at right
            angles, or a `contact_force` that is not below `force_limit`.
    """

    press: Array
    drive: Array
    gain: float
    press_speed: float
    drive_speed: float
    acceleration: float
    travel: float
    force_limit: float
    contact_force: float
    timeout: float

    def __post_init__(self) -> None:
        for name, unit in (
            ('gain', '(m/s)/N'),
            ('press_speed', 'm/s'),
            ('drive_speed', 'm/s'),
            ('acceleration', 'm/s^2'),
            ('travel', 'm'),
            ('force_limit', 'N'),
            ('contact_force', 'N'),
            ('timeout', 's'),
        ):
            positive(getattr(self, name), name, unit)
        for name in ('press', 'drive'):
            vector = finite_vector(getattr(self, name), 3, name)
            length = positive(float(np.linalg.norm(vector)), f'length of {name}')
            object.__setattr__(self, name, read_only(vector / length))
        if abs(self.press @ self.drive) > SQUARE:
            raise InvalidInputError(
                f'press and drive must be at right angles, the cosine between them is '
                f'{float(self.press @ self.drive):.3g}'
            )
        if self.contact_force >= self.force_limit:
            raise InvalidInputError(
                f'contact_force = {self.contact_force:g} N must be below force_limit = {self.force_limit:g} N'
            )


class ForceControl:
    """Admittance control of one direction: the speed of pressing is proportional to the error of the force.

    That is a damper in the place of the robot (N. Hogan, Impedance control: an approach to manipulation,
    Journal of Dynamic Systems, Measurement, and Control 107, 1985; accommodation control of D. E. Whitney,
    1977). Against anything that gives way elastically the force settles without an error.

    Args:
        settings: Its parameters.
        dt: Period, s.
    """

    def __init__(self, settings: ForceControlSettings, dt: float) -> None:
        self.settings = settings
        self._dt = positive(dt, 'dt', 's')
        self.begin()

    def begin(self) -> None:
        """Start from a tool that stands; the travel along `press` counts from here."""
        self.travel = 0.0
        """Way along `press` so far, m."""
        self._driven = 0.0

    def check(self, wanted: float, speed: float) -> None:
        """Check what is commanded.

        Raises:
            InvalidInputError: a force (N) or a speed (m/s) out of its range.
        """
        limit, fastest = self.settings.force_limit, self.settings.drive_speed
        if not 0.0 <= wanted < limit:
            raise InvalidInputError(f'a load of {wanted:g} N is commanded; valid is 0 to below {limit:g} N')
        if not abs(speed) <= fastest:
            raise InvalidInputError(
                f'a speed of {speed:g} m/s is commanded; valid is {-fastest:g} to {fastest:g} m/s'
            )

    def step(self, force: Array, wanted: float, speed: float) -> Array:
        """Twist of the tool for the next period, (6,), m/s and rad/s, base frame.

        Args:
            force: On the tool, (3,) N, base frame.
            wanted: To press with, N.
            speed: To drive with, m/s; approached with the acceleration.

        Raises:
            InvalidInputError: as `check`, a force that is not finite, or the travel along `press` has come to
                its end.
        """
        self.check(wanted, speed)
        settings = self.settings
        measured = 0.0 - float(finite_vector(force, 3, 'force') @ settings.press)
        most = settings.acceleration * self._dt
        self._driven += min(max(speed - self._driven, -most), most)
        pressing = settings.gain * (wanted - measured)
        pressing = min(max(pressing, -settings.press_speed), settings.press_speed)
        self.travel += pressing * self._dt
        if self.travel > settings.travel:
            raise InvalidInputError(
                f'pressed {settings.travel:g} m far, as far as allowed; the force is {measured:.1f} N, '
                f'wanted are {wanted:g} N'
            )
        return np.concatenate([pressing * settings.press + self._driven * settings.drive, np.zeros(3)])
