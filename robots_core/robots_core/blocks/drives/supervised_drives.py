"""SupervisedDrives: drives that refuse what they cannot follow, ramp down when references end, and brake."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from typing import Final

import numpy as np

from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.blocks.drives.reference_check import TOLERANCE, ReferenceCheck
from robots_core.periodic.watchdog import WATCHDOG, Watchdog
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

# References that come late are extrapolated for so many periods: the clock of their sender is not in step.
MAX_EXTRAPOLATED: Final = 5
# Braked drives stand so near to a reference at most that the brakes open for it.
NEAR_PERIODS: Final = 2.0  # at the velocity limits
# Part of the velocity limits: below it drives stand, and their brakes close.
STANDING: Final = 0.01
# Drives that catch up may accelerate by this part of the limits more: a reference that brakes as hard as they
# permit could not be reached without running past it otherwise. So large, one missing reference is made good
# in the next period.
RESERVE: Final = 1.0
# Of this reserve, for the approach to a reference.
APPROACH_SHARE: Final = 0.8
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
    as the references, at the times of their stamps, keep the limits of velocity and acceleration; others are
    refused (`ReferenceCheck`). A reference that is missing is extrapolated; the next one is caught up with,
    inside the velocity limits and with `RESERVE` more than the acceleration limits. Without references, and
    when they are switched off, the drives ramp down inside the acceleration limits, and their brakes close
    after the timeout; with references that come back meanwhile they catch up. After a reference that stands
    none is missing until the timeout: their sender may leave out those that would be the same.

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
        self._near = NEAR_PERIODS * period * axes.velocity
        self._fastest = axes.velocity * (1.0 + TOLERANCE)
        self._hardest = axes.acceleration * (1.0 + TOLERANCE)
        self._with_reserve = (1.0 + RESERVE) * self._hardest
        self._on = True
        self._check = ReferenceCheck(axes, period=period, timeout=timeout)
        # What the drives are given; the mean velocity is that of the last period.
        self._q, self._q_dot = drives.position.copy(), np.zeros(axes.num_axes)
        self._mean = self._q_dot
        self._target, self._target_dot = self._q, self._q_dot
        self._silent = 0
        self._settled: Array | None = None  # the reference at which a step of the drives changes nothing
        self._watchdog = Watchdog(timeout, processor_share)

    @property
    def braked(self) -> bool:
        """The brakes are closed."""
        return self.state is DriveState.BRAKED

    @property
    def standing(self) -> bool:
        """The axes stand, and nothing moves them."""
        if self._settled is not None:
            return True
        return self._slow(self.drives.velocity) and not self._q_dot.any()

    @property
    def settled(self) -> bool:
        """No step changes anything until a reference comes, the drives are switched off or time is out."""
        return self._settled is not None

    def power(self, *, on: bool) -> None:
        """Switch the drives on or off; off, they ramp down and brake."""
        if on != self._on:
            self.problem = ''
            self._settled = None
            self._check.forget()
        self._on = on

    def step(
        self,
        now: float,
        q: Array | None,
        q_dot: Array | None = None,
        stamp: float | None = None,
        sender_period: float = 0.0,
    ) -> tuple[Array, Array]:
        """One period.

        Args:
            now: Time, s.
            q: Reference positions, (n,), rad (m), finite; None if no valid reference came.
            q_dot: Reference velocities, (n,), rad/s (m/s).
            stamp: When the reference was due, s on its sender's clock; `now` by default, unknown for 0.
            sender_period: Time between two references of the sender, s; that of the drives by default.

        Returns:
            Positions and velocities (n,) of the axes at the end of the period.
        """
        due = now if stamp is None else stamp or -np.inf
        accepted = q is not None and q_dot is not None and self._accepts(now, q, q_dot, due, sender_period)
        self._watchdog.check(now, alive=accepted)
        left_out = q is None and self._on and not self._watchdog.lost and self._reference_stands
        if self._settled is not None and (left_out or (accepted and self._is_settled(q, q_dot))):
            return self.drives.position, self.drives.velocity
        self._settled = None
        if accepted:
            assert q is not None
            assert q_dot is not None
            self._receive(q, q_dot)
        elif not left_out:
            self._miss()
        if self.state is DriveState.BRAKED:
            return self.drives.hold()
        before = self.drives.position, self.drives.velocity
        if self.state is DriveState.FOLLOWING and self._reaches(self._target):
            self._move(self._target, self._target_dot)
        elif self._silent <= MAX_EXTRAPOLATED and self._on:
            self._catch_up(self._target, self._target_dot)
        else:
            self._ramp_down()
        position, velocity = self.drives.step(self._q, self._q_dot)
        if (accepted or left_out) and self._stays(before):
            self._settled = self._target
        if self.state is DriveState.RAMPING and self._may_brake(velocity):
            self._brake()
            return self.drives.position, self.drives.velocity
        return position, velocity

    def follow(
        self,
        now: float,
        came: Sequence[bytes],
        read: Callable[[bytes], tuple[Array, Array, float] | None],
        sender_period: Callable[[], float],
    ) -> tuple[Array, Array]:
        """One period with all references that came since the last one, of which the newest valid one counts.

        Args:
            now: Time, s.
            came: The references, as they were sent.
            read: Positions, velocities and stamp of one, see `step`; None if it is not valid.
            sender_period: See `step`, once all are read.
        """
        newest: tuple[Array | None, Array | None, float | None] = None, None, None
        for reference in came:
            if (found := read(reference)) is not None:
                newest = found
                if reference is not came[-1]:
                    self._overtaken(now, *found)
        return self.step(now, *newest, sender_period=sender_period())

    def _overtaken(self, now: float, q: Array, q_dot: Array, stamp: float) -> None:
        """If the drives still stand at a reference that a newer one has overtaken, its stamp begins anew."""
        if self._reference_stands and not q_dot.any() and np.array_equal(q, self._target):
            self._check.begin(now, self._check.last, q_dot, stamp)

    def ahead(self, references: Array) -> int:
        """How many of the next references are followed as they come.

        Args:
            references: (k, 3, n): position, velocity, acceleration; one in each period.
        """
        if self.state is not DriveState.FOLLOWING or not self._on or self._silent or not len(references):
            return 0
        mean = np.diff(references[:, 0], axis=0, prepend=self._q[None]) / self._period
        acceleration = np.diff(mean, axis=0, prepend=self._mean[None]) / self._period
        inside = (np.abs(mean) <= self._fastest) & (np.abs(references[:, 1]) <= self._fastest)
        followed = (inside & (np.abs(acceleration) <= self._hardest)).all(axis=1)
        return len(references) if followed.all() else int(np.argmin(followed))

    def pass_over(self, now: float, references: Array) -> None:
        """The drives have followed references, (k, 3, n), as `ahead` says, the last one at `now`, s."""
        self._watchdog.check(now, alive=True)
        self._silent, self.problem, self._settled = 0, '', None
        if len(references) > 1:
            self._q = references[-2, 0]
        self._target, self._target_dot = references[-1, 0].copy(), references[-1, 1].copy()
        self._move(self._target, self._target_dot)
        self._check.begin(now, self._q, self._mean, now)

    # -- which references ------------------------------------------------------------------------------

    def _accepts(self, now: float, q: Array, q_dot: Array, stamp: float, sender_period: float) -> bool:
        if not self._on:
            return False
        check = self._check
        if self.state is DriveState.BRAKED:
            reason = self._away(q, q_dot)
        elif self._is_settled(q, q_dot) or (
            q is check.last and not q_dot.any() and self.state is DriveState.FOLLOWING
        ):
            check.receive(stamp, sender_period)
            reason = ''
        else:
            reason = check.problem(now, q, q_dot, stamp, sender_period)
        if reason:
            if not self.problem.startswith(REFUSED):
                self.problem = f'{REFUSED}: {reason}'
            return False
        if self.state is DriveState.BRAKED:
            check.begin(now, q, q_dot, stamp)
        else:
            check.take(now, q, stamp)
        return True

    def _receive(self, q: Array, q_dot: Array) -> None:
        self._silent, self.problem = 0, ''
        if self.state is DriveState.BRAKED:
            self.drives.rest()  # what they hold may weigh more than when the brakes closed
            self._stand()
            self.state = DriveState.CATCHING_UP
        self._target, self._target_dot = q, q_dot

    def _miss(self) -> None:
        self._silent = MAX_EXTRAPOLATED + 1 if self._watchdog.lost else self._silent + 1
        if self.state is DriveState.BRAKED:
            return
        if self._silent <= MAX_EXTRAPOLATED and self._on:
            self._target = self._inside(self._target + self._period * self._target_dot)
        else:
            self.state = DriveState.RAMPING

    def _away(self, q: Array, q_dot: Array) -> str:
        """Why the brakes stay closed."""
        away = np.abs(q - self.drives.position)
        worst = int((away - self._near).argmax())
        if away[worst] > self._near[worst]:
            name, unit = self._axes.names[worst], self._axes.unit(worst)
            return f'it is {away[worst]:.4g} {unit} from where {name} stands, with its brakes closed'
        if (np.abs(q_dot) > STANDING * self._axes.velocity).any():
            return 'it moves while the brakes are closed'
        return ''

    # -- what the drives are given ---------------------------------------------------------------------

    def _move(self, q: Array, q_dot: Array) -> None:
        self._mean = (q - self._q) / self._period
        self._q, self._q_dot = q, q_dot

    def _stand(self) -> None:
        self._q, self._q_dot = self.drives.position.copy(), np.zeros_like(self._q_dot)
        self._mean = self._q_dot

    def _reaches(self, q: Array) -> bool:
        """The limits, with the reserve, permit the axes to be there at the end of this period."""
        mean = (q - self._q) / self._period
        acceleration = (mean - self._mean) / self._period
        inside = (np.abs(mean) <= self._fastest) & (np.abs(acceleration) <= self._with_reserve)
        return bool(inside.all())

    @property
    def _before(self) -> Array:
        """Velocities at the end of the last period, as far as its mean velocities permit them."""
        most = 0.5 * self._period * self._axes.acceleration
        before: Array = np.clip(self._q_dot, self._mean - most, self._mean + most)
        return before

    def _ramp_down(self) -> None:
        most = self._period * self._axes.acceleration
        before = self._before
        # Subtracting a speed from itself leaves zero exactly, so that the ramp ends.
        velocity = before + np.clip(-before, -most, most)
        self._move(self._inside(self._q + 0.5 * self._period * (before + velocity)), velocity)

    def _may_brake(self, velocity: Array) -> bool:
        silent = not self._on or self._watchdog.lost
        return silent and self._slow(velocity) and not self._q_dot.any()

    def _slow(self, velocity: Array) -> bool:
        return bool((np.abs(velocity) <= STANDING * self._axes.velocity).all())

    def _brake(self) -> None:
        self.drives.rest()
        self.state = DriveState.BRAKED
        self._stand()
        self.problem = self.problem or ('the references have ended' if self._on else 'switched off')

    @property
    def _reference_stands(self) -> bool:
        """The drives follow a reference that was the same before."""
        if self._settled is not None:
            return True
        return self.state is DriveState.FOLLOWING and not (self._target_dot.any() or self._mean.any())

    def _is_settled(self, q: Array | None, q_dot: Array | None) -> bool:
        return q is not None and q is self._settled and q_dot is self._target_dot

    def _stays(self, before: tuple[Array, Array]) -> bool:
        """The reference stands, and the step to it has changed neither of these: position and velocity."""
        drives = self.drives
        return (
            self.state is DriveState.FOLLOWING
            and drives.led_by_reference_alone
            and not (self._mean.any() or self._q_dot.any())
            and np.array_equal(drives.position, before[0])
            and np.array_equal(drives.velocity, before[1])
            and self._slow(drives.velocity)
        )

    def _catch_up(self, q: Array, q_dot: Array) -> None:
        """Approach a reference that moves, inside the limits and the reserve."""
        if self._joins(q, q_dot):
            self.state = DriveState.FOLLOWING
            self._move(q, q_dot)
            return
        self.state = DriveState.CATCHING_UP
        axes, dt, before = self._axes, self._period, self._before
        most = dt * (1.0 + RESERVE) * axes.acceleration
        error = q - self._q - 0.5 * dt * (before + q_dot)
        far = np.abs(error)
        rate = APPROACH_SHARE * RESERVE * axes.acceleration
        towards = np.minimum(0.5 * far / dt, np.sqrt(2.0 * rate * far))
        wanted = q_dot + np.copysign(towards, error)
        velocity = np.clip(np.clip(wanted, before - most, before + most), -axes.velocity, axes.velocity)
        position = self._inside(self._q + 0.5 * dt * (before + velocity))
        self._move(position, velocity)

    def _joins(self, q: Array, q_dot: Array) -> bool:
        """The next reference can be reached too, if it keeps the limits."""
        most = 0.5 * self._period * self._with_reserve
        return self._reaches(q) and bool((np.abs(q_dot - (q - self._q) / self._period) <= most).all())

    def _inside(self, q: Array) -> Array:
        inside: Array = np.clip(q, self._axes.lower, self._axes.upper)
        return inside
