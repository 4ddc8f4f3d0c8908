"""PathPlanning: switches between the planners by the kind of motion."""

import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.results import CollisionError
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import CollisionDetection, checked_margin
from robots_core.blocks.inverse_kinematics.hold import POSE, held_by
from robots_core.blocks.multibody.loaded_robot import loaded_robot
from robots_core.blocks.zones.zone_detection import ZoneDetection
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, LINE, MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.planner_choice import planner_for
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.trajectory_generator import (
    Target,
    ToolGeometry,
    TrajectoryGenerator,
)
from robots_planning.verification.limit_use import ToolSection
from robots_planning.verification.payload_weight import check_weight
from robots_planning.verification.trajectory_verification import VerificationReport, verify

COLLISION_MARGIN: Final = 0.005
"""Distance that motions keep by default, live and simulated, m."""
WARM_UP_STEP = 0.01  # rad, m
MOST_GENERATORS = 16  # kept for the settings that were used last


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A verified plan.

    Attributes:
        trajectory: The trajectory.
        kind: Kind of the command; None for a trajectory that was given.
        report: What verification found; `report.ok` is true.
        via: Postures (k, n) that a path around obstacles leads along, rad (m); None of other motions, and of
            blended ones.
    """

    trajectory: Trajectory
    kind: MotionKind | None
    report: VerificationReport
    via: Array | None = None

    @property
    def duration(self) -> float:
        """Planned duration, s."""
        return self.trajectory.duration

    @property
    def limiting_axis(self) -> str:
        """The axis with the highest use of a velocity, acceleration or torque limit."""
        return self.report.limiting.joint


class PathPlanning:
    """The paper's path-planning component: the right generator for every kind of motion, then verification.

    Generators keep scratch memory: use an instance in one thread.

    Args:
        robot: The robot.
        collision: Checks motions for collisions and zones; None disables both.
        collision_margin: Distance that every motion keeps, m, from 0.

    Raises:
        InvalidInputError: a margin that is negative or not finite.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        *,
        collision: CollisionDetection | None = None,
        collision_margin: float = 0.0,
    ) -> None:
        self.robot = robot
        self.loaded = lru_cache(MOST_GENERATORS)(partial(loaded_robot, robot))
        """The robot with a payload; see `loaded_robot`."""
        self._generators = lru_cache(MOST_GENERATORS)(self._make)
        self.collision = collision
        self.collision_margin = checked_margin(collision_margin)
        self._zones: ZoneDetection | None = None
        self.cancelled: Callable[[], bool] = lambda: False
        """Whether the motion that is being planned was cancelled; long plans check it now and then."""

    def set_scene(self, scene: Scene) -> None:
        """Plan in another scene from the next motion on; from any thread, also while one is being planned.

        Raises:
            InvalidInputError: see `CollisionDetection.set_scene`.
        """
        if self.collision is not None:
            self.collision = self.collision.with_scene(scene)

    def plan(
        self,
        kind: MotionKind,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings | None = None,
    ) -> PlannedMotion:
        """Plan and verify a motion from rest to rest.

        Args:
            kind: One of `MOTION_KINDS`.
            q_start: Joint positions to start from, (n,), rad (m).
            target: What the kind needs: joint positions (n,), a Pose of the tool in the frame `base` of the
                settings, or the poses of a curve: (via, end) or (via, second via, start) of a circle, all to
                pass of a spline.
            settings: Modal settings.

        Raises:
            JointLimitError: start or target outside the axis limits.
            UnreachablePoseError: no joint positions inside the limits reach the pose.
            PlanningError: the motion is impossible, or its plan breaks a limit; says where and why.
            CollisionError: the motion collides, or comes closer to something than the margin.
            ZoneError: it crosses the border of a zone that nothing opens.
            InvalidInputError: a target of another kind than the motion's.
        """
        settings = settings or MotionSettings()
        trajectory = self.trajectory(kind, q_start, target, settings)
        via = self.generator(kind, settings).via
        geometry: ToolGeometry = {}
        tools: tuple[ToolSection, ...] = ()
        if kind.cartesian:
            if held_by(self.robot.num_axes, settings.hold) != POSE:  # the tool turns as the arm must
                tools = (tool_section(kind, settings, trajectory.duration),)
            start = self.robot.pose(trajectory.position[0]) @ settings.tool_pose
            geometry = self.generator(kind, settings).geometry(start, in_base(kind, target, settings))
        try:
            motion = self.checked(trajectory, kind, settings, geometry=geometry, tools=tools)
            return replace(motion, via=via)
        except CollisionError as error:
            if not (kind.cartesian and settings.avoid):
                raise
            advice = self._way_around(q_start, target, settings)
            raise CollisionError(error.place, self.collision_margin, advice) from error

    def _way_around(self, q_start: ArrayLike, target: Target, settings: MotionSettings) -> str:
        """Whether a joint motion leads where a path of the tool collides, for a person."""
        end = target[-1] if isinstance(target, tuple | list) else target
        function = JOINT_TO_POSE.functions[0]
        try:
            motion = self.plan(JOINT_TO_POSE, q_start, end, settings)
        except RobotsError as error:
            return f'{function} does not lead there either: {error.message}'
        return f'{function} leads there around it in {motion.duration:.2f} s, on a free path of the axes'

    def trajectory(
        self,
        kind: MotionKind,
        q_start: ArrayLike,
        target: Target,
        settings: MotionSettings,
    ) -> Trajectory:
        """The plan alone, without verification; arguments as for `plan`.

        Raises:
            RobotsError: as `plan`.
        """
        return self.generator(kind, settings).generate(q_start, in_base(kind, target, settings))

    def reach(self, pose: Pose, q_start: Array, settings: MotionSettings) -> Array:
        """Joint positions (n,) that a joint motion to a pose leads to, rad (m); arguments as for `plan`.

        Raises:
            UnreachablePoseError: none inside the limits reach the pose.
        """
        start = self.robot.axes_data.check_position(q_start, 'q_start')
        return self.generator(JOINT_TO_POSE, settings).reach(settings.in_base(pose), start)

    def plan_moving(
        self,
        kind: MotionKind,
        motion: tuple[ArrayLike, ArrayLike, ArrayLike],
        target: Target,
        settings: MotionSettings,
    ) -> PlannedMotion:
        """`plan` of a joint motion from a robot that moves: see `TrajectoryGenerator.generate_moving`."""
        goal = in_base(kind, target, settings)
        trajectory = self.generator(kind, settings).generate_moving(motion, goal)
        return self.checked(trajectory, kind, settings, start_motion=motion[1:])

    def checked(
        self,
        trajectory: Trajectory,
        kind: MotionKind | None = None,
        settings: MotionSettings | None = None,
        *,
        geometry: ToolGeometry | None = None,
        tools: Sequence[ToolSection] = (),
        start_motion: tuple[ArrayLike, ArrayLike] | None = None,
    ) -> PlannedMotion:
        """A trajectory that has passed verification and the check for collisions; arguments as for `verify`.

        Raises:
            PlanningError: it breaks a limit, or the axes cannot hold the payload.
            CollisionError: it collides, or comes closer to something than the margin.
            ZoneError: it crosses the border of a zone that nothing opens.
        """
        settings = settings or MotionSettings()
        torque = kind is not None and self.generator(kind, settings).keeps_torque
        report = verify(
            trajectory,
            self.loaded(settings.payload),
            **(geometry or {}),
            tool=settings.tool_pose,
            tools=tools,
            torque=torque,
            start_motion=start_motion,
        )
        if not report.ok:
            what = f'the plan of {kind.title}' if kind is not None else 'the trajectory'
            raise PlanningError(f'{what} breaks a limit: {report.describe()}')
        check_weight(trajectory, self.loaded(settings.payload), settings.payload[0])
        alone = ToolSection(trajectory.duration, settings.tool_pose.r, np.inf, np.inf)
        self.check_collisions(trajectory, tools or [alone])
        return PlannedMotion(trajectory, kind, report)

    def check_collisions(self, trajectory: Trajectory, tools: Sequence[ToolSection]) -> None:
        """Pass a trajectory on which nothing comes closer than the margin, and no zone's border is crossed.

        Args:
            trajectory: The trajectory.
            tools: The tools on it, in their order.

        Raises:
            CollisionError: something comes closer; names the bodies and the first place on the path.
            ZoneError: a border that nothing opens is crossed; names zone, body and place.
        """
        if self.collision is None:
            return
        path = JointPath(*trajectory.points)
        scene = self.collision.scene
        self.collision.check(path, margin=self.collision_margin)
        if self._zones is None or self._zones.scene is not scene:
            self._zones = ZoneDetection(self.robot, scene)
        since = path.start
        for section, following in zip(tools, (*tools[1:], None), strict=True):
            if following is None or not np.array_equal(section.tool, following.tool):
                self._zones.set_tool(section.tool)
                self._zones.check(path, since, min(section.until, path.end))
                since = section.until

    def obstacle_ahead(self, trajectory: Trajectory, since: float) -> str:
        """What a trajectory comes too close to from a time on, s, for a person."""
        place = None
        if self.collision is not None:
            path = JointPath(*trajectory.points)
            place = self.collision.first_approach(path, margin=self.collision_margin, since=since)
        return (
            'nothing that the planner has in its scene'
            if place is None
            else place.describe(self.collision_margin)
        )

    def warm_up(self) -> None:
        """Plan two tiny joint motions and a line, so that the first real ones find their code loaded."""
        home = self.robot.home
        axes = self.robot.axes_data
        near = home + np.where(home + WARM_UP_STEP < axes.upper, WARM_UP_STEP, -WARM_UP_STEP)
        pose = self.robot.pose(near)
        for kind, target in ((JOINT, near), (JOINT_TO_POSE, pose), (LINE, pose)):
            # A home may be singular, and then has no line; its code is loaded all the same.
            with contextlib.suppress(RobotsError):
                self.plan(kind, home, target)

    def generator(self, kind: MotionKind, settings: MotionSettings) -> TrajectoryGenerator:
        """The planner of a kind of motion; made once for the same settings.

        Raises:
            InvalidInputError: settings that the robot or the planner cannot keep.
        """
        generator = self._generators(kind, settings)
        generator.surround(self.collision, self.collision_margin, self.cancelled)
        return generator

    def _make(self, kind: MotionKind, settings: MotionSettings) -> TrajectoryGenerator:
        planner = planner_for(kind, settings)
        if kind.target == 'joints':  # which need no configuration, and every robot has them
            settings = replace(settings, configuration='')
        return planner.from_settings(self.loaded(settings.payload), settings)


def tool_section(kind: MotionKind, settings: MotionSettings, until: float) -> ToolSection:
    """The speed limits of the tool in a motion that ends at `until`, s."""
    speeds = (settings.cartesian_speed, settings.rotation_speed) if kind.cartesian else (np.inf, np.inf)
    return ToolSection(until, settings.tool_pose.r, *speeds)


def in_base(kind: MotionKind, target: Target, settings: MotionSettings) -> Target:
    """A target in the robot's base frame.

    Raises:
        InvalidInputError: a target of another kind than the motion's.
    """
    match target:
        case Pose() if kind.target == 'pose':
            return settings.in_base(target)
        case tuple() | list() if kind.target == 'poses' and all(isinstance(pose, Pose) for pose in target):
            return tuple(settings.in_base(pose) for pose in target if isinstance(pose, Pose))
        case _ if kind.target == 'joints' and not isinstance(target, Pose):
            return target
    needed = {'joints': 'joint positions', 'pose': 'a Pose', 'poses': 'poses'}[kind.target]
    raise InvalidInputError(f'{kind.title} needs {needed} as target, got {type(target).__name__}')
