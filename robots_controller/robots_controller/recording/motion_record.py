"""MotionRecord: the motions of a recorded bag, as they were commanded, planned and ended."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from robots_controller.recording.joint_rows import joint_columns, seconds
from robots_core.cell_interface.operating_modes import Commander
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only
from robots_planning.motion_kinds import KIND_OF_TOPIC, MotionKind
from robots_planning.motion_settings import MotionSettings, settings_from_text

if TYPE_CHECKING:
    from robots_planning.trajectory import Trajectory

OK: Final = 0  # DiagnosticStatus.OK
MOTION_TOPICS: Final = (
    *KIND_OF_TOPIC,
    'motion_settings',
    'joint_trajectory',
    'motion_plan',
    'motion_progress',
    'motion_result',
    'program_status',
    'commander',
)
Messages = Mapping[str, Sequence[tuple[float, Any]]]
"""(time in s, message) by topic, in order."""


@dataclass(frozen=True, eq=False)
class MotionRecord:
    """A motion command, and its part of what the robot moved in one go: blended motions share a plan.

    Attributes:
        id: Its stamp.
        file: The program that commanded it; '' if none ran.
        line: Its line there; 0 for none.
        kind: What kind of motion it is.
        settings: What held for it.
        q: Joint target, (n,); None for poses.
        pose: Target of tool0 in the robot's base; for a joint target where those joints lead; meaningless if
            it was refused.
        ok: The robot came to its target, or through its zone.
        message: The result's words.
        plan: The trajectory that it is a part of; None if nothing was planned.
        path_start: Where it begins on the plan, s.
        path_end: Where it ends there, s.
        start: When it began, s; NaN if it did not.
        end: When it ended, or passed its target on the way to the next, s; NaN if it did not begin.
        duration: From its start to its end, s, the end of the plan as the controller measured it; NaN if it
            did not begin.
        before: The motion before it, which runs through to it; None for the first after a stop.
        own: The robot stands at its end: no other motion follows on the plan.
        followed: The next plan was there before it ended: the references were at the target, but nothing
            waited for the drives.
    """

    id: str
    file: str
    line: int
    kind: MotionKind
    settings: MotionSettings
    q: Array | None
    pose: Pose
    ok: bool
    message: str
    plan: Trajectory | None = None
    path_start: float = math.nan
    path_end: float = math.nan
    start: float = math.nan
    end: float = math.nan
    duration: float = math.nan
    before: MotionRecord | None = None
    own: bool = True
    followed: bool = False

    @property
    def tool_target(self) -> Pose:
        """Target of the tool in the robot's base."""
        return self.pose @ self.settings.tool_pose

    @property
    def planned(self) -> float:
        """Its part of the plan, s; NaN without a plan."""
        return self.path_end - self.path_start

    @property
    def moved(self) -> bool:
        """The robot began with it."""
        return not math.isnan(self.end)

    @property
    def ended_early(self) -> bool:
        """The robot began with it and did not come to its target."""
        return self.moved and not self.ok

    @property
    def zone(self) -> tuple[float, bool]:
        """Size of the zone around its target, and whether it is one of joints (rad) or of the tool (m)."""
        joints, tool = (self.settings.joint_blend_zone, True), (self.settings.blend_zone, False)
        own, other = (tool, joints) if self.kind.cartesian else (joints, tool)
        return own if own[0] > 0.0 else other


def recorded_motions(messages: Messages, robot: BaseRobotModel) -> tuple[MotionRecord, ...]:
    """The motions of a bag in the order of their commands.

    A motion's place in time is where the controller's progress on the plan was at the motion's ends.

    Raises:
        RobotsError: a command, a trajectory or a setting that makes no sense.
    """
    plans = {_stamp_id(m): (time, m) for time, m in messages['joint_trajectory'] if len(m.points) > 1}
    results = {status_values(m).get('id'): (time, m) for time, m in messages['motion_result']}
    settings, program = (
        [(time, status_values(status)) for time, status in messages[topic]]
        for topic in ('motion_settings', 'program_status')
    )
    commanders = messages.get('commander', ())
    # Those that a status names; the first one that does counts.
    places = {values['motion']: values for _, values in reversed(program) if 'motion' in values}
    commands = sorted(
        ((time, topic, message) for topic in KIND_OF_TOPIC for time, message in messages[topic]),
        key=lambda item: seconds(item[2].header.stamp),
    )
    progress = np.array([(time, part.data) for time, part in messages['motion_progress']]).reshape(-1, 2)
    # Ends on the plan by command, of each plan by its id; a later plan carries an earlier one on.
    ends = {values.pop('id', ''): values for values in (status_values(m) for _, m in messages['motion_plan'])}
    plan_of = {command: id_ for id_, of_plan in ends.items() for command in of_plan}
    last_of = {plan: command for command, plan in plan_of.items()}
    motions: list[MotionRecord] = []
    chain: list[MotionRecord] = []
    stood = -math.inf
    for time, topic, message in commands:
        id_ = _stamp_id(message)
        ended, result = results.get(id_, (time, None))
        last = plan_of.get(id_, id_)
        now, place = _newest(program, time, {}), places.get(id_, {})
        commander = _newest(commanders, time, None)
        pendant = commander is not None and commander.data == Commander.PENDANT
        file = place.get('motion_file', now.get('file', ''))
        line = int(place.get('motion_line', now.get('line')) or 0)
        held = settings_from_text(_newest(settings, time, {}), pendant=pendant)
        sent = file, line, topic, message
        chain.append(_command(robot, held, sent, result, planned=last in plans))
        if id_ != last_of.get(last, id_):
            continue
        planned, (ended, result) = plans.get(last), results.get(last, (time, None))
        if planned is not None:
            # Planned while the motion before it was running, it starts at that one's end.
            if motions and planned[0] < stood:
                motions[-1] = replace(motions[-1], followed=True)
            start, stood = max(planned[0], stood), ended
            values = {} if result is None else status_values(result)
            done = _progress_between(progress, start, stood, float(values.get('progress', 1.0)))
            plan = _trajectory(planned[1], robot)
            of_plan = {c: float(end) for c, end in ends.get(last, {id_: plan.duration}).items()}
            of_plan[next(reversed(of_plan))] = plan.duration  # without rounding
            duration = float(values.get('duration', stood - start))
            before = motions[-1] if motions and not motions[-1].own else None
            chain = _on_plan(chain, plan, of_plan, done, duration, before=before)
        motions += chain
        chain = []
    return (*motions, *chain)


def _on_plan(
    chain: Sequence[MotionRecord],
    plan: Trajectory,
    ends: Mapping[str, float],
    done: tuple[Array, Array],
    measured: float,
    *,
    before: MotionRecord | None,
) -> list[MotionRecord]:
    """Motions of one plan with their places there and in time.

    They end on it at `ends`, s by id; `done` are times (k,) s and the parts that were done then, `measured`
    the duration by the controller, s, and `before` is the motion that runs through to the first one.
    """
    times, parts = done
    found: list[MotionRecord] = []
    start, path_start = float(times[0]), 0.0
    for motion in chain:
        path_end = ends[motion.id]
        own = path_end == plan.duration
        stops = motion is chain[-1] or not motion.ok
        end = float(times[-1] if stops else np.interp(path_end / plan.duration, parts, times))
        motion = replace(  # noqa: PLW2901
            motion,
            plan=plan,
            path_start=path_start,
            path_end=path_end,
            before=found[-1] if found else before,
            own=own,
        )
        if motion.ok or path_start < parts[-1] * plan.duration:
            duration = measured - (start - float(times[0])) if stops else end - start
            motion = replace(motion, start=start, end=end, duration=duration)  # noqa: PLW2901
        found.append(motion)
        start, path_start = end, path_end
    return found


def _progress_between(progress: Array, start: float, end: float, reached: float) -> tuple[Array, Array]:
    """Times (s) and done parts of a motion from start to end, from those of all motions, (k, 2)."""
    times, parts = progress[slice(*np.searchsorted(progress[:, 0], (start, end)))].T
    begun = int(np.flatnonzero(np.diff(parts, prepend=1.0) < 0.0).max(initial=0))
    return (
        np.concatenate([[start], times[begun:], [end]]),
        np.concatenate([[0.0], np.minimum(parts[begun:], reached), [reached]]),
    )


def status_values(status: Any) -> dict[str, str]:
    """The key-value pairs of a DiagnosticStatus."""
    return {item.key: item.value for item in status.values}


def _newest(items: Sequence[tuple[float, Any]], time: float, default: Any) -> Any:
    """The last one until a time, s, of items with their times, in order; the default if there is none."""
    index = bisect_right(items, time, key=lambda item: item[0]) - 1
    return items[index][1] if index >= 0 else default


def _command(
    robot: BaseRobotModel,
    settings: MotionSettings,
    sent: tuple[str, int, str, Any],
    result: Any,
    *,
    planned: bool,
) -> MotionRecord:
    file, line, topic, message = sent
    ok = result is not None and result.level == OK
    q, pose = None, Pose.identity()
    if not (ok or planned):
        pass  # what was refused need not be a target
    elif hasattr(message, 'position'):
        names = list(message.name)
        q = read_only(np.array([message.position[names.index(name)] for name in robot.axes_data.names]))
        pose = robot.pose(q)
    else:
        target = message.poses[-1].pose if hasattr(message, 'poses') else message.pose
        p, o = target.position, target.orientation
        tool = Pose.from_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])
        pose = settings.in_base(tool) @ settings.tool_pose.inverse()
    return MotionRecord(
        id=_stamp_id(message),
        file=file,
        line=line,
        kind=KIND_OF_TOPIC[topic],
        settings=settings,
        q=q,
        pose=pose,
        ok=ok,
        message='no result was recorded' if result is None else str(result.message),
    )


def _trajectory(message: Any, robot: BaseRobotModel) -> Trajectory:
    from robots_planning.trajectory import Trajectory  # noqa: PLC0415  # loads the compiler

    columns = joint_columns(message.joint_names, robot, f'joint_trajectory {_stamp_id(message)}')
    # The first point's time is where it continues from the running motion.
    time = np.array([seconds(point.time_from_start) for point in message.points])
    position, velocity, acceleration = (
        np.array([getattr(point, name) for point in message.points])[:, columns]
        for name in ('positions', 'velocities', 'accelerations')
    )
    return Trajectory(time - time[0], position, velocity, acceleration)


def _stamp_id(message: Any) -> str:
    stamp = message.header.stamp
    return f'{stamp.sec}.{stamp.nanosec:09d}'
