"""ForceWatch: forces on a tool that must stop its robot."""

from __future__ import annotations

import math
from collections.abc import Callable

from robots_core.blocks.force_control.force_control import ForceControlSettings
from robots_core.periodic.watchdog import Watchdog
from robots_core.validation import Array, finite_vector


class ForceWatch:
    """Detects a force beyond its limit, contact that was not planned, and a sensor that falls silent.

    A tool that is in contact when force control ends may stay so and be moved away; contact that begins while
    there is no force control is not planned. Silence counts under force control alone.

    Args:
        settings: Limits.
        share: See `Watchdog`.
    """

    def __init__(self, settings: ForceControlSettings, *, share: Callable[[], float] = lambda: 1.0) -> None:
        self._settings = settings
        self._watchdog = Watchdog(settings.timeout, share)
        self._alive = self._touching = False
        self.force: Array | None = None
        """The last one measured on the tool, (3,) N; None before."""

    def measured(self, force: Array) -> None:
        """Take a force on the tool, (3,) N.

        Raises:
            InvalidInputError: another shape, or NaN or infinity in it.
        """
        self.force = finite_vector(force, 3, 'force')
        self._alive = True

    def problem(self, now: float, *, controlled: bool) -> str:
        """What is wrong, with number and bound; '' for nothing. To be asked in every period.

        Args:
            now: s.
            controlled: Force control presses the tool.
        """
        settings = self._settings
        self._watchdog.check(now, alive=self._alive)
        self._alive = False
        if self.force is None:
            return 'no force was measured yet' if controlled else ''
        if controlled and self._watchdog.lost:
            return f'no force was measured for {settings.timeout:g} s'
        size = math.hypot(*self.force)  # of any finite force, without overflow
        touched, self._touching = self._touching, size >= settings.contact_force
        if size > settings.force_limit:
            return f'the force on the tool is {size:.1f} N; allowed are {settings.force_limit:g} N'
        if self._touching and not touched and not controlled:
            return (
                f'contact that was not planned: the force on the tool is {size:.1f} N; without force control '
                f'allowed is less than {settings.contact_force:g} N'
            )
        return ''
