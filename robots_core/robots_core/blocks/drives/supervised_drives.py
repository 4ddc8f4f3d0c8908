"""SupervisedDrives: drives that refuse what they cannot follow, ramp down when references end, and brake."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from typing import Final

import numpy as np

from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.periodic.watchdog import WATCHDOG, Watchdog
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

# References that come late are extrapolated for so many periods: the clock of their sender is not in step.
MAX_EXTRAPOLATED: Final = 5
# The last reference before this one may be of the period before, and this one of the period after.
SLACK_PERIODS: Final = 2.0
# Part of the velocity limits: below it drives stand, and their brakes close.
STANDING: Final = 0.01
# Of the deceleration, for the approach to a reference that has moved on meanwhile.
APPROACH_SHARE: Final = 0.8
JOINED: Final = 1e-6  # rad, m
REFUSED: Final = 'reference refused'


class DriveState(StrEnum):
    """What the drives do."""

    BRAKED = 'braked'
    FOLLOWING = 'following'
    RAMPING = 'ramping down'
    CATCHING_UP = 'catching up'


class SupervisedDrives:
    """Drives of a robot with brakes, which begin closed.

    The brakes open for a reference that stands where the robot stands. From then on the drives follow as long
    as each reference can be reached from the one before within the velocity limits; others are refused.
    Without references, and when they are switched off, the drives ramp down inside the acceleration limits,
    and their brakes close after the timeout; with references that come back meanwhile they catch up.

    Args:
        drives: The drives, at rest.
        axes: The robot's limits.
        period: Time of one step, s.
        timeout: Time without references after which the brakes close, s; infinite for never.
        processor_share: See `Watchdog`.
    """

    def __init__(
        self,
        drives: DriveTrain,
        axes: AxesData,
        *,
        period: float,
        timeout: float = WATCHDOG,
        processor_share: Callable[[], float] = lambda: 1.0,
    ) -> None:
        self.drives, self.state = drives, DriveState.BRAKED
        self.problem = ''
        """Why references are not followed, for a person; '' if they are."""
        self._axes, self._period, self._timeout = axes, period, timeout
        self._step = SLACK_PERIODS * period * axes.velocity
        self._fastest = axes.velocity * (1.0 + JOINED)
        self._on = True
        self._q, self._q_dot = drives.position.copy(), np.zeros(axes.num_axes)
        self._last = self._target = self._q
        self._target_dot = self._q_dot
        self._last_stamp = self._last_time = -np.inf
        self._silent = 0
        self._watchdog = Watchdog(timeout, processor_share)

    @property
    def braked(self) -> bool:
        """The brakes are closed."""
        return self.state is DriveState.BRAKED

    @property
    def standing(self) -> bool:
        """The axes stand, and nothing moves them."""
        return self._slow(self.drives.velocity) and not self._q_dot.any()

    def power(self, *, on: bool) -> None:
        """Switch the drives on or off; off, they ramp down and brake."""
        if on and not self._on:
            self.problem = ''
        self._on = on

    def step(
        self, now: float, q: Array | None, q_dot: Array | None = None, stamp: float | None = None
    ) -> tuple[Array, Array]:
        """One period.

        Args:
            now: Time, s.
            q: Reference positions, (n,), rad (m), finite; None if no valid reference came.
            q_dot: Reference velocities, (n,), rad/s (m/s).
            stamp: When the reference was due, s on its sender's clock; `now` by default, and for 0.

        Returns:
            Positions and velocities (n,) of the axes at the end of the period.
        """
        accepted = q is not None and q_dot is not None and self._accepts(now, q, q_dot, stamp or now)
        self._watchdog.look(now, alive=accepted)
        if accepted:
            assert q is not None
            assert q_dot is not None
            self._silent, self.problem = 0, ''
            if self.state is DriveState.BRAKED:
                self.drives.rest()  # what they hold may weigh more than when the brakes closed
                self.state = DriveState.CATCHING_UP
            self._target, self._target_dot = q, q_dot
        else:
            self._silent += 1
            if self.state is DriveState.BRAKED:
                return self.drives.hold()
            if self._silent <= MAX_EXTRAPOLATED and self._on:
                self._target = self._inside(self._target + self._period * self._target_dot)
            else:
                self.state = DriveState.RAMPING
        if self.state is DriveState.FOLLOWING:
            self._q, self._q_dot = self._target, self._target_dot
        elif self._silent <= MAX_EXTRAPOLATED and self._on:
            self._catch_up(self._target, self._target_dot)
        else:
            self._ramp_down()
        position, velocity = self.drives.step(self._q, self._q_dot)
        if self.state is DriveState.RAMPING and self._may_brake(velocity):
            self._brake()
            return self.drives.position, self.drives.velocity
        return position, velocity

    def ahead(self, references: Array) -> int:
        """How many of the next references are followed as they come.

        Args:
            references: (k, 3, n): position, velocity, acceleration; one in each period.
        """
        if self.state is not DriveState.FOLLOWING or not self._on or not len(references):
            return 0
        change = np.abs(np.diff(references[:, 0], axis=0, prepend=self._last[None]))
        inside = (change <= self._step) & (np.abs(references[:, 1]) <= self._fastest)
        followed = inside.all(axis=1)
        return len(references) if followed.all() else int(np.argmin(followed))

    def pass_over(self, now: float, reference: Array) -> None:
        """The drives have followed references as `ahead` says, the last one, (3, n), at `now`, s."""
        self._watchdog.look(now, alive=True)
        self._silent, self.problem = 0, ''
        self._last_stamp = self._last_time = now
        self._last = self._target = self._q = reference[0]
        self._target_dot = self._q_dot = reference[1]

    # -- which references ------------------------------------------------------------------------------

    def _accepts(self, now: float, q: Array, q_dot: Array, stamp: float) -> bool:
        if not self._on:
            return False
        if q is self._last and not q_dot.any() and self.state is DriveState.FOLLOWING:
            reason = ''
        elif self.state is DriveState.BRAKED:
            reason = self._away(q, q_dot)
        else:
            reason = self._too_far(now, q, q_dot, stamp)
        if reason:
            if not self.problem.startswith(REFUSED):
                self.problem = f'{REFUSED}: {reason}'
            return False
        self._last, self._last_stamp, self._last_time = q, stamp, now
        return True

    def _away(self, q: Array, q_dot: Array) -> str:
        """Why the brakes stay closed."""
        away = np.abs(q - self.drives.position)
        worst = int((away - self._step).argmax())
        if away[worst] > self._step[worst]:
            name, unit = self._axes.names[worst], self._axes.unit(worst)
            return f'it is {away[worst]:.4g} {unit} from where {name} stands, with its brakes closed'
        if (np.abs(q_dot) > STANDING * self._axes.velocity).any():
            return 'it moves while the brakes are closed'
        return ''

    def _too_far(self, now: float, q: Array, q_dot: Array, stamp: float) -> str:
        """Why the axes could not get there within their velocity limits."""
        change = np.abs(q - self._last)
        if not (change <= self._step).all():
            elapsed = max(stamp - self._last_stamp, now - self._last_time)
            allowed = self._step + min(elapsed, self._timeout) * self._axes.velocity
            worst = int((change - allowed).argmax())
            if change[worst] > allowed[worst]:
                name, unit = self._axes.names[worst], self._axes.unit(worst)
                limit = f'{allowed[worst]:.4g} {unit}'
                return f'{name} would step by {change[worst]:.4g} {unit}, its limits allow {limit}'
            self.state = DriveState.CATCHING_UP  # the machine has held up its sender, or these drives
        fast = np.abs(q_dot) > self._fastest
        if fast.any():
            worst = int(fast.argmax())
            return f'{self._axes.names[worst]} would move at {q_dot[worst]:.4g} {self._axes.unit(worst)}/s'
        return ''

    # -- without them ----------------------------------------------------------------------------------

    def _ramp_down(self) -> None:
        most = self._period * self._axes.acceleration
        before = self._q_dot
        # Subtracting a speed from itself leaves zero exactly, so that the ramp ends.
        self._q_dot = before + np.clip(-before, -most, most)
        self._q = self._inside(self._q + 0.5 * self._period * (before + self._q_dot))

    def _may_brake(self, velocity: Array) -> bool:
        silent = not self._on or self._watchdog.lost
        return silent and self._slow(velocity) and not self._q_dot.any()

    def _slow(self, velocity: Array) -> bool:
        return bool((np.abs(velocity) <= STANDING * self._axes.velocity).all())

    def _brake(self) -> None:
        self.drives.rest()
        self.state = DriveState.BRAKED
        self._q, self._q_dot = self.drives.position.copy(), np.zeros_like(self._q_dot)
        self.problem = self.problem or ('the references have ended' if self._on else 'switched off')

    def _catch_up(self, q: Array, q_dot: Array) -> None:
        """Approach a reference that moves, inside the limits."""
        self.state = DriveState.CATCHING_UP
        axes, dt, before = self._axes, self._period, self._q_dot
        most = dt * axes.acceleration
        error = q - self._q - 0.5 * dt * (before + q_dot)
        far = np.abs(error)
        towards = np.minimum(0.5 * far / dt, np.sqrt(2.0 * APPROACH_SHARE * axes.acceleration * far))
        wanted = q_dot + np.copysign(towards, error)
        velocity = np.clip(np.clip(wanted, before - most, before + most), -axes.velocity, axes.velocity)
        position = self._inside(self._q + 0.5 * dt * (before + velocity))
        if (np.abs(q - position) <= JOINED).all() and (np.abs(q_dot - velocity) <= most).all():
            self.state, position, velocity = DriveState.FOLLOWING, q, q_dot
        self._q, self._q_dot = position, velocity

    def _inside(self, q: Array) -> Array:
        inside: Array = np.clip(q, self._axes.lower, self._axes.upper)
        return inside
