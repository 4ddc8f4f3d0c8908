"""MotionChain: motions that run through from one to the next, as one."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from robots_core.errors import PlanningError, RobotsError
from robots_core.validation import Array
from robots_planning.commands.motion_plan import CommandChain, MotionPlan, OpenEnd, QueuedCommand
from robots_planning.motion_kinds import LINE
from robots_planning.pathplanning import PathPlanning, in_base, tool_section
from robots_planning.paths.blending import Measure, blend, joint_distance
from robots_planning.paths.joint_path import JointPath
from robots_planning.planner_choice import planner_for
from robots_planning.timing.time_optimal import TimeOptimalTiming
from robots_planning.timing.timed_path import PathStart, TimedPath
from robots_planning.timing.tool_limits import PathLimits, chain_limits
from robots_planning.trajectory import Trajectory, one_after_another
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN


class MotionChain:
    """Plans chains of commands: the path of each motion, blends at the targets in between, one time law.

    The time law is that of dynamic programming over path and speed, with the settings of each motion up to
    the middle of the blend behind it. Jerk limits hold in a chain with a motion that is `jerk_limited`; joint
    motions alone do not ask for them here, as keeping them around corners costs more than the blend gains on
    many robots. A chain that would be faster with stops at its targets stops there. All motions of a chain
    have one payload.

    A chain whose commands are not all known is planned to a stop at the last one, and carried on from the
    middle of its plan, with the speed and the acceleration that it has there.

    Args:
        planning: Plans single motions, and checks all.
    """

    def __init__(self, planning: PathPlanning) -> None:
        self._robot, self._planning = planning.robot, planning

    def plan(self, chain: CommandChain, q_start: Array) -> MotionPlan:
        """The plan of a chain from rest.

        Raises:
            RobotsError: one of the motions is impossible, or all together.
        """
        commands = chain.commands
        if len(commands) == 1:
            only = commands[0]
            motion = self._planning.plan(only.kind, q_start, only.target, only.settings)
            return MotionPlan(only.id, motion, {only.id: motion.duration}, only.kind.title)
        paths = self._paths(commands, q_start)
        plans: list[tuple[Trajectory, tuple[float, ...], OpenEnd | None]] = []
        # A blend at a corner that leads almost straight back may permit no speed; then the chain stops there.
        with contextlib.suppress(PlanningError):
            if paths:
                path, corners = self._blended(commands, paths)
                timed = self._timing(commands).timed(path, self._limits(commands, path, corners))
                plans.append(_opened(chain, timed, corners, paths))
        try:
            plans.append((*self._with_stops(commands, q_start), None))
        except RobotsError:
            if not plans:
                raise
        trajectory, ends, open_end = min(plans, key=lambda plan: plan[0].duration)
        return self._checked(commands, trajectory, ends, open_end)

    def continue_from(self, end: OpenEnd, chain: CommandChain) -> MotionPlan:
        """The plan of a chain that carries on the one before: from the start of its open end.

        Raises:
            RobotsError: one of the motions is impossible, they cannot run through, or limits cannot be kept.
        """
        commands = (*end.commands, *chain.commands)
        new = self._paths(chain.commands, end.paths[-1].q[-1])
        if not new:
            raise PlanningError(f'motion {chain.commands[0].id} has no path to run through to')
        paths = [*end.paths, *new]
        whole, corners = self._blended((end.before[0], *commands), [end.before[1], *paths])
        q, q_dot, q_ddot = end.state
        # A plan's times are whole nanoseconds: its point is that close to the corner.
        _, q_s, _ = (values[0] for values in whole.evaluate(corners[:1]))
        q_corner = whole.evaluate(corners[:1])[0][0]
        start = float(corners[0] + (q - q_corner) @ q_s / (q_s @ q_s))
        path, corners = whole.rest(start), (corners[1:] - start) / (1.0 - start)
        limits = self._limits(commands, path, corners)
        timing = self._timing(commands)
        timed = timing.continued_from(path, limits, PathStart.of(path, q_dot, q_ddot, end.smoothing))
        timed = replace(timed, trajectory=_from_state(timed.trajectory, end.state))
        joined = CommandChain(commands, goes_on=chain.goes_on)
        return self._checked(commands, *_opened(joined, timed, corners, paths), start_motion=(q_dot, q_ddot))

    def _checked(
        self,
        commands: tuple[QueuedCommand, ...],
        trajectory: Trajectory,
        ends: tuple[float, ...],
        open_end: OpenEnd | None,
        start_motion: tuple[Array, Array] | None = None,
    ) -> MotionPlan:
        last, ends = commands[-1], (*ends, trajectory.duration)
        tools = [
            tool_section(command.kind, command.settings, end)
            for command, end in zip(commands, ends, strict=True)
        ]
        motion = self._planning.checked(
            trajectory, last.kind, last.settings, tools=tools, start_motion=start_motion
        )
        by_id = dict(zip((command.id for command in commands), ends, strict=True))
        own = last if open_end is None else commands[-1 - len(open_end.commands)]
        title = ' + '.join(command.kind.title for command in commands)
        return MotionPlan(own.id, motion, by_id, title, open_end)

    def _paths(self, commands: tuple[QueuedCommand, ...], q_start: Array) -> list[JointPath]:
        """The path of every motion alone; none at all if one of them has none to run through."""
        paths: list[JointPath] = []
        for command in self._limited(commands):
            path = self._path(command, paths[-1].q[-1] if paths else q_start)
            if path is None:
                return []
            paths.append(path)
        return paths

    def _blended(
        self, commands: tuple[QueuedCommand, ...], paths: list[JointPath]
    ) -> tuple[JointPath, Array]:
        """The path with blends, and s at its corners."""
        return blend(paths, [self._zone(command) for command in commands[:-1]])

    def _limits(self, commands: tuple[QueuedCommand, ...], path: JointPath, corners: Array) -> PathLimits:
        sections = [(command.settings, command.kind.cartesian) for command in commands]
        return chain_limits(self._robot, path, corners, sections)

    def _with_stops(
        self, commands: tuple[QueuedCommand, ...], q_start: Array
    ) -> tuple[Trajectory, tuple[float, ...]]:
        """The motions from rest to rest, and when each but the last ends; raises as `plan`."""
        parts: list[Trajectory] = []
        q = q_start
        for command in self._limited(commands):
            plan = self._planning.trajectory(command.kind, q, command.target, command.settings)
            parts.append(plan)
            q = plan.position[-1]
        ends = np.cumsum([part.duration for part in parts[:-1]])
        return one_after_another(parts), tuple(map(float, ends))

    @staticmethod
    def _limited(commands: tuple[QueuedCommand, ...]) -> list[QueuedCommand]:
        """The motions, all with jerk limits if one of them has."""
        jerk_limited = _jerk_limited(commands)
        return [
            replace(command, settings=replace(command.settings, jerk_limited=jerk_limited))
            for command in commands
        ]

    def _path(self, command: QueuedCommand, q_start: Array) -> JointPath | None:
        """The path that a motion alone would take; None if it cannot run through."""
        start = self._robot.axes_data.check_position(q_start, 'q_start')
        goal = in_base(command.kind, command.target, command.settings)
        return self._planning.generator(command.kind, command.settings).joint_path(start, goal)

    def _zone(self, command: QueuedCommand) -> tuple[float, Measure]:
        """Size of the zone behind a motion, and the distance that it is a size of."""
        settings = command.settings
        tip = partial(self._distance, settings.tool_pose.r)
        joints, tool = (settings.joint_blend_zone, joint_distance), (settings.blend_zone, tip)
        own, other = (tool, joints) if command.kind.cartesian else (joints, tool)
        return own if own[0] > 0.0 else other

    def _distance(self, tool: Array, q: Array, corner: Array) -> Array:
        """Distances of the tool's tip in some postures from where it is in another, (m,) m."""
        r, T = self._robot.tool_poses(np.vstack([q, corner]))
        tip = r + T @ tool
        return np.asarray(np.linalg.norm(tip[:-1] - tip[-1], axis=1))

    def _timing(self, commands: tuple[QueuedCommand, ...]) -> TimeOptimalTiming:
        axes, inside = self._robot.axes_data, 1.0 - LIMIT_MARGIN
        loaded = self._planning.loaded(commands[-1].settings.payload)
        effort = jerk = None
        if planner_for(LINE, commands[-1].settings).keeps_torque:
            effort = axes.effort * inside
        if _jerk_limited(commands):
            jerk = axes.jerk * inside * min(command.settings.acceleration_fraction for command in commands)
        return TimeOptimalTiming(
            loaded, axes.velocity * inside, axes.acceleration * inside, effort, jerk=jerk
        )


def _opened(
    chain: CommandChain, timed: TimedPath, corners: Array, paths: Sequence[JointPath]
) -> tuple[Trajectory, tuple[float, ...], OpenEnd | None]:
    """The trajectory of a chain, the ends of its commands but the last, and its open end if it continues."""
    trajectory, ends = timed.trajectory, timed.times_of(corners).tolist()
    count = len(chain.commands) // 2
    if not chain.goes_on or count == 0:
        return trajectory, tuple(ends), None
    row = int(np.argmin(np.abs(timed.s - corners[count - 1])))
    ends[count - 1] = float(trajectory.time[row])
    state = (trajectory.position[row], trajectory.velocity[row], trajectory.acceleration[row])
    before = (chain.commands[count - 1], paths[count - 1])
    open_end = OpenEnd(
        chain.commands[count:], ends[count - 1], state, timed.smoothing, before, tuple(paths[count:])
    )
    return trajectory, tuple(ends), open_end


def _from_state(trajectory: Trajectory, state: tuple[Array, Array, Array]) -> Trajectory:
    """The trajectory without the rounding of its start."""
    time, *rows = trajectory.points
    whole = [np.concatenate([first[None], row[1:]]) for first, row in zip(state, rows, strict=True)]
    return Trajectory(time, *whole)


def _jerk_limited(commands: tuple[QueuedCommand, ...]) -> bool:
    return any(command.settings.jerk_limited for command in commands)
