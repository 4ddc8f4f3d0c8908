"""FollowedMotion: a trajectory on its way through the controller."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

import numpy as np

from robots_core.blocks.zones.zone import Zone
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.validation import Array
from robots_planning.timing.path_speed_cap import PathSpeedCap
from robots_planning.trajectory import Trajectory

# Two motions join where position, velocity and acceleration are the same, except for rounding in both
# polynomials: rad (m), s.
JOIN_TOLERANCE = 1e-7


@dataclass(frozen=True, eq=False)
class Border:
    """A part of a motion across the border of a zone.

    Attributes:
        zone: The zone.
        start: Path time at which the robot has to stand while the border is closed, s.
        end: Path time from which on it is on the permitted side again, s.
    """

    zone: Zone
    start: float
    end: float


class FollowedMotion:
    """A trajectory, how far it is followed, and what came in between.

    Args:
        trajectory: The path and its planned timing.
        id_: The command that asked for it.
        cap: Highest speed on its path, in its place; None for its own.
        borders: Of zones, that it crosses, in the order of their zones.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        id_: str,
        cap: PathSpeedCap | None = None,
        borders: tuple[Border, ...] = (),
    ) -> None:
        self.trajectory = trajectory
        self.id = id_
        self.start = 0.0
        """Time of the start, s."""
        self.cap = cap
        self.borders = borders
        self.held: PathSpeedCap | None = None
        """Highest speed before a border that is closed now, in the place of `cap`."""
        self._ending: tuple[PathSpeedCap, float, float, PathSpeedCap] | None = None
        self.path_time = 0.0
        self.failure: str | None = None
        self.settling_since: float | None = None
        self.successor: FollowedMotion | None = None
        """Goes on in the place of this one from `join_time` on."""
        self.join_time = np.inf
        self.passes = False
        """The successor carries this motion on and does not replace it."""
        self._before: tuple[FollowedMotion, float] | None = None
        self._times: list[float] = trajectory.time.tolist()

    def outcome(self, now: float, message: str, *, ok: bool, blocked: bool = False) -> MotionResult:
        """Its result, if it ends now (s)."""
        details: dict[str, str | float] = {
            'duration': round(now - self.start, 6),
            'planned_duration': round(min(self.trajectory.duration, self.join_time), 6),
            'progress': round(self.progress, 6),
        }
        return MotionResult(self.id, ok, message, details, blocked)

    @property
    def progress(self) -> float:
        """Done part of the path time, 0..1."""
        return min(1.0, self.path_time / self.trajectory.duration)

    def runs_like(self, trajectory: Trajectory, s: float) -> bool:
        """This motion is at path time `s` where a trajectory begins, and moves as that one does there."""
        states = zip(self.trajectory.sample(s), trajectory.sample(0.0), strict=True)
        return all(float(np.abs(own - its).max()) <= JOIN_TOLERANCE for own, its in states)

    def join(self, successor: FollowedMotion, join_time: float, *, passes: bool) -> None:
        """Let another motion continue from a path time on."""
        self.successor, self.join_time, self.passes = successor, join_time, passes
        successor._before = (self, join_time)
        self.slow_down()

    def slow_down(self) -> None:
        """Lower the cap to what the successor permits, and those of the motions before as far as it takes."""
        before = self.cap
        self.set_cap(self.cap)
        slower = before is not None and self.cap is not None and self.cap.begin < before.begin
        if slower and self._before is not None:
            self._before[0].slow_down()

    def set_cap(self, cap: PathSpeedCap | None) -> None:
        """Follow the path no faster; its successor has its cap already."""
        after = None if self.successor is None else self.successor.cap
        if cap is not None and after is not None:
            cap = cap.ending(self.join_time, after.begin)
        self.cap = cap

    def crosses(self, zone: str, horizon: float) -> bool:
        """The border of a zone is crossed within so much path time (s), by this motion or its successors."""
        near = self.path_time + horizon
        own = (border for border in self.borders if border.zone.name == zone and border.end > self.path_time)
        if any(border.start <= min(near, self.join_time) for border in own):
            return True
        rest = near - self.join_time
        return self.successor is not None and rest > 0.0 and self.successor.crosses(zone, rest)

    def ending(self, path_time: float, speed: float) -> PathSpeedCap:
        """Its cap if it has to be left at a path time (s) with at most this speed."""
        assert self.cap is not None
        if self._ending is None or self._ending[:3] != (self.cap, path_time, speed):
            self._ending = (self.cap, path_time, speed, self.cap.ending(path_time, speed))
        return self._ending[3]

    def forget_before(self) -> None:
        """What was before is long past; a robot may be led on for hours."""
        self._before = None

    def position(self, s: float) -> Array:
        """Joint positions at path time `s`, (n,), of the motions before and after it too.

        Standing before the first and after the last.
        """
        if self.successor is not None and s > self.join_time:
            return self.successor.position(s - self.join_time)
        if self._before is not None and s < 0.0:
            motion, join_time = self._before
            return motion.position(s + join_time)
        c, x = self._locate(s)
        return np.asarray(c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))))

    def sample(self, s: float) -> Array:
        """Position and its first and second derivative by path time, (3, n)."""
        c, x = self._locate(s)
        x2, x3, x4 = x * x, x**3, x**4
        basis = np.array(
            [
                [1.0, x, x2, x3, x4, x4 * x],
                [0.0, 1.0, 2.0 * x, 3.0 * x2, 4.0 * x3, 5.0 * x4],
                [0.0, 0.0, 2.0, 6.0 * x, 12.0 * x2, 20.0 * x3],
            ]
        )
        return np.asarray(basis @ c)

    def samples(self, s: Array) -> Array:
        """The same at path times `s` (k,) on this motion, (k, 3, n), to the last bit."""
        trajectory = self.trajectory
        segments = np.searchsorted(trajectory.time[1:-1], s, side='right')
        x = s - trajectory.time[segments]
        # Powers of numpy and of Python differ in their last bits.
        x2, (x3, x4) = x * x, np.array([(one**3, one**4) for one in x.tolist()]).reshape(-1, 2).T
        basis = np.zeros((s.size, 3, 6))
        basis[:, 0] = np.stack([np.ones_like(x), x, x2, x3, x4, x4 * x], axis=1)
        basis[:, 1, 1:] = np.stack([np.ones_like(x), 2.0 * x, 3.0 * x2, 4.0 * x3, 5.0 * x4], axis=1)
        basis[:, 2, 2:] = np.stack([np.full_like(x, 2.0), 6.0 * x, 12.0 * x2, 20.0 * x3], axis=1)
        return np.asarray(basis @ trajectory.coefficients[segments])

    def _locate(self, s: float) -> tuple[Array, float]:
        """Polynomial of the interval that holds `s` and the time since its start."""
        s = min(max(s, 0.0), self._times[-1])
        segment = min(bisect_right(self._times, s), len(self._times) - 1) - 1
        return self.trajectory.coefficients[segment], s - self._times[segment]
