"""CollisionFreeJoint: point-to-point motion of the axes around all obstacles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar, Final, Self

import numpy as np
from numpy.typing import ArrayLike
from ruckig import Synchronization

from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.errors import PlanningError, UnreachablePoseError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, positive
from robots_planning.free_paths.errors import BlockedPostureError
from robots_planning.free_paths.free_path_search import FreePath, FreePathSearch
from robots_planning.free_paths.free_postures import blocked_target, check_start, distinct
from robots_planning.free_paths.rounding import rounded
from robots_planning.motion_settings import MotionSettings
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.time_optimal import TimeOptimalTiming
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.joint_space import SHORTEST_MOVE, TURN, JointSpaceGenerator
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN, Target, rest_trajectory

MOST_POSTURES: Final = 16  # of a pose, the nearest
REDUNDANT_SEEDS: Final = 12  # that the inverse kinematics without a closed form starts from


class CollisionFreeJoint(JointSpaceGenerator):
    """The axes move on a path that is certified free between its samples, in the shortest time along it.

    Where the straight line in joint space is free, the path is that line. Otherwise two trees of certified
    lines are searched for a way (`FreePathSearch`), which is made faster and whose corners are rounded. The
    motion does not stop at them. Velocity, acceleration and torque limits hold everywhere (see
    `TimeOptimalTiming`), with `jerk_limited` those of the jerk too.

    A target pose is reached in any posture that the limits allow: the nearest that a free line leads to, or
    else the first that the search meets.

    Args:
        robot: The robot.
        collision: Of the robot in its scene; None if there is nothing to avoid.
        margin: Distance that the path keeps, m, from 0.
        budget: Longest search, in seconds of `POSTURES_PER_SECOND` postures.
        seed: Of the search's random numbers, from 0.
        jerk_limited: Keep the axes' jerk limits.
        options: See `JointSpaceGenerator`.

    Raises:
        InvalidInputError: an option that is not valid.
    """

    starts_moving: ClassVar[bool] = False
    keeps_torque = True
    synchronization = Synchronization.Time

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        collision: CollisionDetection | None = None,
        margin: float = 0.0,
        budget: float = 2.0,
        seed: int = 0,
        jerk_limited: bool = False,
        **options: Any,
    ) -> None:
        super().__init__(robot, **options)
        self.collision, self.margin = collision, margin
        self._cancelled: Callable[[], bool] = lambda: False
        self._budget, self._seed = positive(budget, 'budget', 's'), seed
        effort = robot.axes_data.effort * (1.0 - LIMIT_MARGIN)
        self._timing = TimeOptimalTiming(
            robot, self.velocity, self.acceleration, effort, jerk=self.jerk if jerk_limited else None
        )
        self._last: tuple[object, JointPath, Array] | None = None

    @classmethod
    def from_settings(cls, robot: BaseRobotModel, settings: MotionSettings, **options: Any) -> Self:
        """See `TrajectoryGenerator.from_settings`."""
        return super().from_settings(
            robot, settings, budget=settings.avoid_budget, jerk_limited=settings.jerk_limited, **options
        )

    def surround(
        self, collision: CollisionDetection | None, margin: float, cancelled: Callable[[], bool]
    ) -> None:
        """See `TrajectoryGenerator.surround`."""
        self.collision, self.margin, self._cancelled = collision, margin, cancelled

    def _plan(self, start: Array, target: Target) -> Trajectory:
        goals = self._goals(start, target)
        if float(np.abs(goals[0] - start).max()) < SHORTEST_MOVE:
            return rest_trajectory(start, goals[0])
        return self._timing.timed(self._path(start, goals)).trajectory

    def generate_moving(self, motion: tuple[ArrayLike, ArrayLike, ArrayLike], target: Target) -> Trajectory:
        """See `TrajectoryGenerator.generate_moving`: from rest only."""
        return super(JointSpaceGenerator, self).generate_moving(motion, target)

    def _path(self, start: Array, goals: Array) -> JointPath:
        """The certified path from a posture to one of several others; raises as `_free_path`."""
        self.via = np.empty((0, start.size))
        if self.collision is None:
            return super()._path(start, goals)
        key = (start.tobytes(), goals.tobytes(), self.collision.scene, self.margin)
        if self._last is not None and self._last[0] == key:  # asked again, for a chain or its stops
            self.via = self._last[2]
            return self._last[1]
        way = self._free_path(self.collision, start, goals)
        path, self.via = rounded(way), way.postures[1:-1]
        self._last = (key, path, self.via)
        return path

    def _free_path(self, collision: CollisionDetection, start: Array, goals: Array) -> FreePath:
        """See `FreePathSearch.path`; raises a BlockedPostureError where start or all targets are not free."""
        if collision.blind:
            raise PlanningError(
                f'{self.robot.name} has no collision shapes, so that it can avoid nothing; its URDF needs '
                '<collision> in its links'
            )
        check_start(collision, start)
        reasons = [blocked_target(collision, start, goal, self.margin) for goal in goals]
        free = goals[[reason is None for reason in reasons]]
        if not len(free):
            raise _all_blocked([reason for reason in reasons if reason is not None])
        search = FreePathSearch(collision, margin=self.margin, budget=self._budget, seed=self._seed)
        return search.path(start, free, self._cancelled)

    def _goals(self, start: Array, target: Target) -> Array:
        """Postures (k, n) that reach a target, the nearest first."""
        first = self.goal(start, target)
        if not isinstance(target, Pose) or self.collision is None:
            return first[None]
        axes = self.robot.axes_data
        found = np.vstack([first, *self._others(start, target)])
        turned = np.remainder(found - start + np.pi, TURN) - np.pi
        found = distinct(np.where(axes.continuous, start + turned, found))
        times = np.abs((found[1:] - start) / axes.velocity).max(axis=1)
        return np.vstack([found[:1], found[1:][np.argsort(times, kind='stable')]])[:MOST_POSTURES]

    def _others(self, start: Array, pose: Pose) -> list[Array]:
        """More postures that reach a pose of the tool, (n,) each."""
        if self.hold == POSE and self._closed_form is not None:
            tool0 = pose if self.tool is None else pose @ self.tool.inverse()
            found = list(self._closed_form.solve_all(tool0, turns=True))
            if found or self.configuration is not None:
                chosen = self.configuration
                return [q for q in found if chosen is None or self._closed_form.configuration(q) == chosen]
        low, high = self.robot.axes_data.one_turn
        others = []
        for seed in np.random.default_rng(0).uniform(low, high, (REDUNDANT_SEEDS, start.size)):
            try:
                others.append(super().reach(pose, seed))
            except UnreachablePoseError:  # from this seed; the first search has found the pose in reach
                continue
        return others


def _all_blocked(reasons: list[BlockedPostureError]) -> BlockedPostureError:
    """The reason of the nearest posture, and how many there are."""
    first = reasons[0]
    if len(reasons) == 1:
        return first
    return BlockedPostureError(
        f'none of {len(reasons)} postures that reach the target is free; of the nearest, {first.message}',
        **first.details,
    )
