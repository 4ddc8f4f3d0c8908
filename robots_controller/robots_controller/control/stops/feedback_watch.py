"""FeedbackWatch: feedback that is lost, frozen, jumps or is too far from the reference."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from operator import sub
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
    """Judges the feedback of each period, all axes at once.

    It computes with lists: for the few axes of a robot that takes less time than calls of numpy.
    """

    def __init__(self, axes: AxesData, settings: ControllerSettings, share: Callable[[], float]) -> None:
        self._axes, self._settings = axes, settings
        self._watchdog, self._share = Watchdog(settings.feedback_timeout, share), share
        self.position: Array | None = None
        """Newest feedback, (n,), rad (m)."""
        self.time = -math.inf
        """When it came, s."""
        self._looked = -math.inf
        self._interval = settings.feedback_timeout / MOST_CHECKS
        self._moved = -math.inf
        self._anchor: list[float] | None = None
        self._unchanged = [0.0] * axes.num_axes  # s, each with its reference away

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
            position, velocity, _ = reference.tolist()
            if any(velocity):
                self._moved = now
            measured = feedback.tolist()
            change = _distances(measured, self.position.tolist())
            finding = (
                self._jumped(now, change)
                or self._frozen(change, position, min(now - self.time, timeout / CHECKS))
                or self._behind(_distances(measured, position))
            )
        self.position, self.time = feedback, now
        return finding

    def _jumped(self, now: float, change: list[float]) -> Finding | None:
        if max(change) <= JUMP:
            return None
        allowed = np.full(len(change), JUMP)
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

    def _frozen(self, change: list[float], reference: list[float], step: float) -> Finding | None:
        if self._anchor is None or all(change):
            self._anchor = reference
            self._unchanged = [0.0] * len(reference)
            return None
        self._anchor = [
            new if changed else old for changed, new, old in zip(change, reference, self._anchor, strict=True)
        ]
        moved = _distances(reference, self._anchor)
        if max(moved) <= FROZEN_DISTANCE:
            self._unchanged = [0.0] * len(moved)
            return None
        # Drives of a busy machine get references late, and stand meanwhile.
        step *= self._share()
        self._unchanged = [
            unchanged + step if away > FROZEN_DISTANCE else 0.0
            for unchanged, away in zip(self._unchanged, moved, strict=True)
        ]
        longest = max(self._unchanged)
        if longest < FROZEN_TIME * self._settings.feedback_timeout:
            return None
        worst = self._unchanged.index(longest)
        return Fault.FEEDBACK_FROZEN, (
            f'the feedback of {self._axes.names[worst]} has not changed while its reference moved by '
            f'{moved[worst]:.3g} {self._axes.unit(worst)}: is its encoder working, does the drive follow?'
        )

    def _behind(self, error: list[float]) -> Finding | None:
        largest, allowed = max(error), self._settings.following_error
        if largest <= allowed:
            return None
        worst = error.index(largest)
        unit = self._axes.unit(worst)
        return Fault.FOLLOWING_ERROR, (
            f'{self._axes.names[worst]} is {largest:.4g} {unit} behind its reference, allowed is '
            f'{allowed:g} {unit}: does the drive follow?'
        )


def _distances(values: Sequence[float], others: Sequence[float]) -> list[float]:
    return list(map(abs, map(sub, values, others)))
