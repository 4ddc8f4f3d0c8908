"""CollisionGuard: watches the robot and its path ahead, and has it stopped before it collides."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.results import RESOLUTION, PathProximity, Proximity
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import CollisionDetection, checked_margin
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError
from robots_core.status import Level, Status
from robots_core.validation import Array

# Less than what the planner keeps: a robot that lags behind its reference by a millimetre needs no stop.
GUARD_MARGIN: Final = 0.002  # m
LOOKAHEAD: Final = 1.0  # s
CHECK_RATE: Final = 25.0  # Hz
FASTEST: Final = 2.0  # of the axes' velocity limits; the bounds of a path are not tight
STANDING: Final = 1e-3  # of the axes' velocity limits; measured velocities are never quite zero
# A check, a call of the service and a period of the controller may pass before a guided robot brakes.
REACTION_TIME: Final = 0.1  # s


@dataclass(frozen=True)
class CollisionStatus:
    """How close the robot is to something.

    Attributes:
        distance: m; 0 in contact, infinite if there is nothing to collide with.
        status: An error below the margin, a warning if a place ahead on the path is; with the margin, the
            closest bodies and their nearest points, contacts, what is ahead.
    """

    distance: float
    status: Status


@dataclass
class _Motion:
    path: JointPath
    danger: PathProximity | None
    stopped: bool = False


class CollisionGuard:
    """Stops the robot where the margin is undercut.

    The path of a motion is checked when it is planned and when the scene changes, so that nothing between
    two checks of the robot is missed; the robot is stopped on its path as soon as a place that is too close
    lies within `lookahead`. A robot that moves without a path is stopped as soon as the way that it needs to
    brake is not free; one that has stood too close may move away, and one that has stood in contact may move
    anywhere until it is free.

    Args:
        detection: Of the robot and its scene.
        stop: Stops the robot for a reason; returns False if it cannot.
        margin: Distance to keep, m.
        lookahead: How far ahead on the path a place may be, s, when the robot is stopped.

    Raises:
        InvalidInputError: a margin that is negative or not finite.
    """

    def __init__(
        self,
        detection: CollisionDetection,
        stop: Callable[[str], bool],
        *,
        margin: float = GUARD_MARGIN,
        lookahead: float = LOOKAHEAD,
    ) -> None:
        self.detection, self.margin, self.lookahead = detection, checked_margin(margin), lookahead
        self._stop = stop
        self.motions: dict[str, _Motion] = {}
        """Those that run or wait, by their ids."""
        self._progress = 0.0
        self._floor = self.margin
        self._stood: Proximity | None = None
        self._guided_into = False
        self._q: Array | None = None
        self._closest: Proximity | None = None

    @property
    def stopping(self) -> bool:
        """The robot was to be stopped, and the reason still exists."""
        return self._guided_into or any(motion.stopped for motion in self.motions.values())

    @property
    def endangered(self) -> bool:
        """A place on a path is too close to something."""
        return any(motion.danger is not None for motion in self.motions.values())

    def set_scene(self, scene: Scene) -> None:
        """Replace the scene, and check what is left of all paths.

        Raises:
            InvalidInputError: see `CollisionDetection.set_scene`.
        """
        self.detection.set_scene(scene)
        self._q = None
        for motion, now in self._times():
            motion.danger = self.detection.first_approach(motion.path, margin=self.margin, since=now)
        self._stop_before_dangers()

    def planned(self, id_: str, path: JointPath) -> None:
        """Watch a motion from now on, after those before it; one with a known id has another path now.

        Raises:
            InvalidInputError: a path of another number of axes, or far past their limits.
        """
        self._check_path(path)
        motion = _Motion(path, self.detection.first_approach(path, margin=self.margin))
        if next(iter(self.motions), id_) == id_:  # the first one, or its path around an obstacle
            self._progress = 0.0
        self.motions[id_] = motion
        self._floor = self._margin_from(self.detection.distance(path.sample(path.start)))
        self._stop_before_dangers()

    def _margin_from(self, start: Proximity | None) -> float:
        """The margin of what begins here: a robot that is too close already may leave, m."""
        return self.margin if start is None else min(self.margin, max(start.distance - 2.0 * RESOLUTION, 0.0))

    def _check_path(self, path: JointPath) -> None:
        """Refuse what no controller follows: how long its check takes has no bound."""
        axes = self.detection.robot.axes_data
        for position in (path.position.min(axis=0), path.position.max(axis=0)):
            axes.check_position(position, 'the path')
        too_fast = np.flatnonzero(~(path.fastest() <= FASTEST * axes.velocity))
        if too_fast.size:
            axis = too_fast[0]
            raise InvalidInputError(
                f'{axes.names[axis]} moves at up to {path.fastest()[axis]:.6g} '
                f'{axes.unit(axis, "velocity")} on the path, its limit is {axes.velocity[axis]:.6g}'
            )

    def progress(self, progress: float) -> None:
        """Take the done part of the first motion, 0..1."""
        self._progress = progress
        self._stop_before_dangers()

    def ended(self, result: MotionResult) -> bool:
        """Take the end of a motion, unless it may go around an obstacle; True if it was the last one."""
        if result.blocked or self.motions.pop(result.id, None) is None:
            return False
        self._progress = 0.0
        return not self.motions

    def check(self, q: Array, q_dot: Array | None) -> CollisionStatus:
        """Look at the robot.

        Args:
            q: Measured joint positions, (n,), rad (m).
            q_dot: Measured joint velocities, (n,), rad/s (m/s); None if they are unknown.

        Raises:
            InvalidInputError: values of another shape or not finite.
        """
        if self._q is None or not np.array_equal(q, self._q):
            self._closest, self._q = self.detection.distance(q), q.copy()
        closest = self._closest
        if not self.motions:
            self._watch_guided(q, q_dot)
        elif closest is not None and closest.distance < self._floor:
            for motion in self.motions.values():
                self._stop_motion(motion, closest.describe())
        return self._status(q, closest)

    def _watch_guided(self, q: Array, q_dot: Array | None) -> None:
        """Stop a robot that moves without a path before it comes too close to something."""
        danger, axes = None, self.detection.robot.axes_data
        if q_dot is not None and (np.abs(q_dot) <= STANDING * axes.velocity).all():
            self._stood = self._closest
        if q_dot is not None and q_dot.any() and not self._leaves_contact():
            q_dot = np.clip(q_dot, -axes.velocity, axes.velocity)  # a driver may report anything
            time = REACTION_TIME + float((np.abs(q_dot) / axes.acceleration).max())
            way = JointPath.straight(q, q + time * q_dot)
            danger = self.detection.first_approach(way, margin=self._margin_from(self._stood))
        self._guided_into = danger is not None and self._stop(danger.proximity.describe())

    def _leaves_contact(self) -> bool:
        """The robot touches something, and has stood so: no direction leads closer."""
        return all(one is not None and one.in_contact for one in (self._stood, self._closest))

    def _status(self, q: Array, closest: Proximity | None) -> CollisionStatus:
        values: dict[str, object] = {'margin': self.margin}
        if closest is None:
            return CollisionStatus(np.inf, Status('collision', 'nothing to collide with', values=values))
        values |= {
            'first': closest.first,
            'second': closest.second,
            'distance': closest.distance,
            'point_first': _triple(closest.point_first),
            'point_second': _triple(closest.point_second),
        }
        if closest.in_contact:
            values['contacts'] = '; '.join(' - '.join(pair) for pair in self.detection.contacts(q))
        level = Level.ERROR if closest.distance < self.margin else Level.OK
        text = closest.describe()
        danger = next((motion.danger for motion in self.motions.values() if motion.danger), None)
        if danger is not None:
            values['ahead'] = danger.describe()
            if level is Level.OK:
                level, text = Level.WARN, f'ahead: {danger.describe()}'
        return CollisionStatus(closest.distance, Status('collision', text, level, values))

    def _times(self) -> list[tuple[_Motion, float]]:
        """All motions with their path times, s; those that wait for the first are at their start."""
        done = self._progress
        times = []
        for motion in self.motions.values():
            times.append((motion, motion.path.start + done * (motion.path.end - motion.path.start)))
            done = 0.0
        return times

    def _stop_before_dangers(self) -> None:
        for motion, now in self._times():
            place = motion.danger
            if place is not None and now <= place.time <= now + self.lookahead:
                self._stop_motion(motion, place.describe())

    def _stop_motion(self, motion: _Motion, reason: str) -> None:
        if not motion.stopped:
            motion.stopped = self._stop(reason)


def _triple(point: Array) -> str:
    return ' '.join(f'{value:.6f}' for value in point)
