"""FeedbackWatch: feedback that is lost, frozen, jumps or is too far from the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np

from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.stops.faults import Fault
from robots_core.periodic.watchdog import CHECKS, Watchdog
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

Finding = tuple[Fault, str]

# Drives with stiction may hold an axis for a thousandth; encoders resolve far finer than this.
FROZEN_DISTANCE: Final = 0.02  # rad, m
# Part of the timeout of the feedback: a drive that gets its references late begins to move within it.
FROZEN_TIME: Final = 0.5
# For a loss, within the timeout.
MOST_CHECKS: Final = 4.0 * CHECKS
# What a standing robot gives way to a push, or settles by after a stop.
JUMP: Final = 0.05  # rad, m
# Feedback of a busy machine is late by this.
LATENESS: Final = 0.1  # s
SETTLED: Final = 1.0  # s from the end of a reference until the robot stands, whatever its drives


class FeedbackWatch:
    """Judges the feedback of each period, all axes at once."""

    def __init__(self, axes: AxesData, settings: ControllerSettings, share: Callable[[], float]) -> None:
        self._axes, self._settings = axes, settings
        self._watchdog, self._share = Watchdog(settings.feedback_timeout, share), share
        self.position: Array | None = None
        """Newest feedback, (n,), rad (m)."""
        self.time = -np.inf
        """When it came, s."""
        self._looked = -np.inf
        self._interval = settings.feedback_timeout / MOST_CHECKS
        self._moved = -np.inf
        self._anchor: Array | None = None
        self._unchanged = np.zeros(axes.num_axes)  # s, each with its reference away

    @property
    def lost(self) -> bool:
        """There is no feedback, or none any more."""
        return self.position is None or self._watchdog.lost

    def restart(self) -> None:
        """The reference was set again."""
        self._anchor = None

    def check(self, now: float, feedback: Array | None, reference: Array | None) -> Finding | None:
        """Judge what came in this period.

        Args:
            now: Time, s.
            feedback: Joint positions, (n,), or None if none came.
            reference: The last one that was sent, (3, n).

        Returns:
            What is wrong, and its text for a person; a loss is found once.
        """
        if feedback is None and now - self._looked < self._interval:
            return None
        self._looked, timeout = now, self._settings.feedback_timeout
        lost = self._watchdog.check(now, alive=feedback is not None)
        if feedback is None:
            reason = f'no feedback for {timeout:g} s: is the drive still running?'
            return (Fault.FEEDBACK_LOST, reason) if lost else None
        finding = None
        if reference is not None and self.position is not None:
            if np.count_nonzero(reference[1]):  # of a few values in less time than any()
                self._moved = now
            change = np.abs(feedback - self.position)
            finding = (
                self._jumped(now, change)
                or self._frozen(change, reference[0], min(now - self.time, timeout / CHECKS))
                or self._behind(np.abs(feedback - reference[0]))
            )
        self.position, self.time = feedback, now
        return finding

    def _jumped(self, now: float, change: Array) -> Finding | None:
        if np.maximum.reduce(change) <= JUMP:
            return None
        allowed = np.full_like(change, JUMP)
        if now - self._moved < SETTLED:
            allowed += self._axes.velocity * (now - self.time + LATENESS)
        worst = int((change - allowed).argmax())
        if change[worst] <= allowed[worst]:
            return None
        return Fault.FEEDBACK_JUMPED, (
            f'the feedback of {self._axes.names[worst]} has jumped by {change[worst]:.4g} '
            f'{self._axes.unit(worst)}, allowed is {allowed[worst]:.4g} {self._axes.unit(worst)}: is its '
            'encoder working, does another node publish joint_states?'
        )

    def _frozen(self, change: Array, reference: Array, step: float) -> Finding | None:
        if self._anchor is None or np.count_nonzero(change) == change.size:
            self._anchor = reference
            self._unchanged[:] = 0.0
            return None
        self._anchor = np.where(change, reference, self._anchor)
        moved = np.abs(reference - self._anchor)
        away = moved > FROZEN_DISTANCE
        if not away.any():
            self._unchanged[:] = 0.0
            return None
        # Drives of a busy machine get references late, and stand meanwhile.
        self._unchanged = np.where(away, self._unchanged + step * self._share(), 0.0)
        worst = int(self._unchanged.argmax())
        if self._unchanged[worst] < FROZEN_TIME * self._settings.feedback_timeout:
            return None
        return Fault.FEEDBACK_FROZEN, (
            f'the feedback of {self._axes.names[worst]} has not changed while its reference moved by '
            f'{moved[worst]:.3g} {self._axes.unit(worst)}: is its encoder working, does the drive follow?'
        )

    def _behind(self, error: Array) -> Finding | None:
        worst, allowed = int(error.argmax()), self._settings.following_error
        if error[worst] <= allowed:
            return None
        unit = self._axes.unit(worst)
        return Fault.FOLLOWING_ERROR, (
            f'{self._axes.names[worst]} is {error[worst]:.4g} {unit} behind its reference, allowed is '
            f'{allowed:g} {unit}: does the drive follow?'
        )
