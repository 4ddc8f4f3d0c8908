"""LenientPlanning: notes what is wrong with a motion, and brings the robot to its target anyway."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from robots_core.errors import RobotsError, UnreachablePoseError
from robots_core.pose import Pose
from robots_planning.motion_kinds import JOINT_TO_POSE, MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning, PlannedMotion
from robots_planning.trajectory_generators.trajectory_generator import Target, rest_trajectory
from robots_planning.verification.trajectory_verification import verify


class LenientPlanning(PathPlanning):
    """Plans as `PathPlanning` does; a motion that it refuses is noted, and replaced.

    What takes its place is the same motion without the check for collisions, or a joint motion to its
    target, or, to a target that cannot be reached, none. So a program continues, and its other motions are
    judged from where they begin. After a target that was not reached that is not so: what is wrong with
    the path of a tool from there is not reported.

    Attributes:
        problems: What is wrong, by the plan that took the motion's place.
    """

    def __init__(self, planning: PathPlanning) -> None:
        super().__init__(
            planning.robot, collision=planning.collision, collision_margin=planning.collision_margin
        )
        self.problems: dict[PlannedMotion, RobotsError] = {}
        self._astray = False

    def plan(
        self,
        kind: MotionKind,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings | None = None,
    ) -> PlannedMotion:
        """See `PathPlanning.plan`; raises nothing."""
        astray, self._astray = self._astray, False
        try:
            return super().plan(kind, q_start, target, settings)
        except RobotsError as problem:
            error = problem
        end = target[-1] if isinstance(target, tuple) else target
        for other, goal in ((kind, target), (JOINT_TO_POSE, end)):
            if other.cartesian and isinstance(error, UnreachablePoseError):
                continue
            if other is JOINT_TO_POSE and not isinstance(goal, Pose):
                continue
            collision, self.collision = self.collision, None
            try:
                motion = super().plan(other, q_start, goal, settings)
            except RobotsError:
                continue
            finally:
                self.collision = collision
            # A path of the tool from a place where the program never is has no meaning.
            if not (astray and kind.cartesian):
                self.problems[motion] = error
            return motion
        self._astray = True
        q = np.asarray(q_start, dtype=np.float64)
        stay = rest_trajectory(q, q)
        motion = PlannedMotion(stay, kind, verify(stay, self.robot))
        self.problems[motion] = error
        return motion
