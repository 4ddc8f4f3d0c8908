"""ForceWatch: forces on a tool that must stop its robot."""

from __future__ import annotations

import math

import numpy as np

from robots_core.blocks.force_control.force_control import ForceControlSettings
from robots_core.validation import Array, finite_vector


class ForceWatch:
    """Looks for a force beyond its limit, contact that nobody planned, and a sensor that falls silent.

    A tool that is in contact when force control ends may stay so and be moved away; contact that begins while
    there is no force control is not planned.

    Args:
        settings: Limits.
    """

    def __init__(self, settings: ForceControlSettings) -> None:
        self._settings = settings
        self._time = -math.inf
        self.force: Array | None = None
        """The last one measured on the tool, (3,) N; None before."""
        self._touching = False

    def measured(self, force: Array, time: float) -> None:
        """Take a force on the tool, (3,) N, at a time, s.

        Raises:
            InvalidInputError: another shape, or NaN or infinity in it.
        """
        self.force, self._time = finite_vector(force, 3, 'force'), time

    def problem(self, now: float, *, controlled: bool) -> str:
        """What is wrong, with number and bound; '' for nothing.

        Args:
            now: s.
            controlled: Force control presses the tool.
        """
        settings = self._settings
        if self.force is None:
            return 'no force was measured yet' if controlled else ''
        size = float(np.linalg.norm(self.force))
        touched, self._touching = self._touching, size >= settings.contact_force
        silence = now - self._time
        if silence > settings.timeout:
            return f'no force was measured for {silence:.3g} s; allowed are {settings.timeout:g} s'
        if size > settings.force_limit:
            return f'the force on the tool is {size:.1f} N; allowed are {settings.force_limit:g} N'
        if self._touching and not touched and not controlled:
            return (
                f'contact that was not planned: the force on the tool is {size:.1f} N; without force control '
                f'allowed is less than {settings.contact_force:g} N'
            )
        return ''
