"""MotionRecord: the motions of a recorded bag, as they were commanded, planned and ended."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from robots_controller.recording.bag_reading import seconds
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only
from robots_planning.motion_kinds import KIND_OF_TOPIC, LINE, MotionKind
from robots_planning.motion_results import PASSED
from robots_planning.motion_settings import MotionSettings, settings_from_text
from robots_planning.trajectory import Trajectory

OK: Final = 0  # DiagnosticStatus.OK
MOTION_TOPICS: Final = (
    *KIND_OF_TOPIC, 'motion_settings', 'joint_trajectory', 'motion_result', 'program_status'
)  # fmt: skip
Messages = Mapping[str, Sequence[tuple[float, Any]]]
"""(time in s, message) by topic, in order."""


@dataclass(frozen=True, eq=False)
class CommandRecord:
    """A motion command.

    Attributes:
        id: Its stamp.
        file: The program that commanded it; '' if none ran.
        line: Its line there.
        kind: What kind of motion it is.
        settings: What held for it.
        q: Joint target, (n,); None for poses.
        pose: Target of tool0 in the robot's base; for a joint target where those joints lead; nothing if not
            `ok`.
        ok: The robot came there.
        message: The result's words.
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

    @property
    def tool_target(self) -> Pose:
        """Target of the tool in the robot's base."""
        return self.pose @ self.settings.tool_pose

    @property
    def straight(self) -> bool:
        """The tool moves on a straight line."""
        return self.kind is LINE

    @property
    def zone(self) -> tuple[float, bool]:
        """Size of the zone around its target, and whether it is one of joints (rad) or of the tool (m)."""
        joints, tool = (self.settings.joint_blend_zone, True), (self.settings.blend_zone, False)
        own, other = (tool, joints) if self.kind.cartesian else (joints, tool)
        return own if own[0] > 0.0 else other


@dataclass(frozen=True, eq=False)
class MotionRecord:
    """What the robot moved in one go: one command, or several that ran through from one to the next.

    Attributes:
        commands: In order; the robot stands after the last.
        plan: The planned trajectory; None if nothing was planned.
        start: When it began, s.
        end: When its result came, s.
        duration: From its start until the robot stood, as the controller measured it, s.
        followed: The next motion was there before it ended: the references were at the target, but nobody
            waited for the drives.
    """

    commands: tuple[CommandRecord, ...]
    plan: Trajectory | None
    start: float
    end: float
    duration: float
    followed: bool = False


def recorded_motions(messages: Messages, robot: BaseRobotModel) -> tuple[MotionRecord, ...]:
    """The motions of a bag in order.

    Raises:
        RobotsError: a command, a trajectory or a setting that makes no sense.
    """
    plans = {_stamp_id(m): (time, m) for time, m in messages['joint_trajectory'] if len(m.points) > 1}
    results = {status_values(m).get('id'): (time, m) for time, m in messages['motion_result']}
    settings, program = _Timeline(messages['motion_settings']), _Timeline(messages['program_status'])
    # Those that a status tells of; the first one that does counts.
    places = {told['motion']: told for told in reversed(program.values) if 'motion' in told}
    commands = sorted(
        ((time, topic, message) for topic in KIND_OF_TOPIC for time, message in messages[topic]),
        key=lambda item: seconds(item[2].header.stamp),
    )
    motions: list[MotionRecord] = []
    chain: list[CommandRecord] = []
    end = 0.0
    for time, topic, message in commands:
        result = results.get(_stamp_id(message), (time, None))
        told = settings.at(time)
        place = places.get(_stamp_id(message), {})
        now = program.at(time)
        chain.append(
            _command(
                robot,
                (topic, message),
                result[1],
                settings_from_text(told) if told else MotionSettings(),
                (
                    place.get('motion_file', now.get('file', '')),
                    int(place.get('motion_line', now.get('line')) or 0),
                ),
            )
        )
        planned = plans.get(chain[-1].id)
        if planned is None and chain[-1].message == PASSED:
            continue
        plan = None
        if planned is not None:
            plan = _trajectory(planned[1], robot)
            time = planned[0]  # noqa: PLW2901  # the robot starts with its plan
        # Planned while the motion before it was running, it starts at that one's end.
        if motions and time < end:
            motions[-1] = replace(motions[-1], followed=True)
        start, end = max(time, end), result[0]
        measured = {} if result[1] is None else status_values(result[1])
        duration = float(measured.get('duration', end - start))
        motions.append(MotionRecord(tuple(chain), plan, start, end, duration))
        chain = []
    if chain:
        motions.append(MotionRecord(tuple(chain), None, end, end, 0.0))
    return tuple(motions)


def status_values(status: Any) -> dict[str, str]:
    """The key-value pairs of a DiagnosticStatus."""
    return {item.key: item.value for item in status.values}


class _Timeline:
    """What statuses said, by time.

    Args:
        messages: (time in s, status), in order.
    """

    def __init__(self, messages: Sequence[tuple[float, Any]]) -> None:
        self._times = [time for time, _ in messages]
        self.values = [status_values(message) for _, message in messages]

    def at(self, time: float) -> dict[str, str]:
        """The last one until a time, s; empty if there is none."""
        index = bisect_right(self._times, time) - 1
        return self.values[index] if index >= 0 else {}


def _command(
    robot: BaseRobotModel,
    sent: tuple[str, Any],
    result: Any,
    settings: MotionSettings,
    place: tuple[str, int],
) -> CommandRecord:
    topic, message = sent
    ok = result is not None and result.level == OK
    q, pose = None, Pose.identity()
    if not ok:
        pass  # what was refused need not be a target
    elif hasattr(message, 'position'):
        names = list(message.name)
        q = read_only(np.array([message.position[names.index(name)] for name in robot.axes_data.names]))
        pose = Pose(*robot.direct_kinematics(q))
    else:
        target = message.poses[-1].pose if hasattr(message, 'poses') else message.pose
        p, o = target.position, target.orientation
        tool = Pose.from_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])
        pose = settings.in_base(tool) @ settings.tool_pose.inverse()
    return CommandRecord(
        id=_stamp_id(message),
        file=place[0],
        line=place[1],
        kind=KIND_OF_TOPIC[topic],
        settings=settings,
        q=q,
        pose=pose,
        ok=ok,
        message='no result was recorded' if result is None else str(result.message),
    )


def _trajectory(message: Any, robot: BaseRobotModel) -> Trajectory:
    missing = [name for name in robot.axes_data.names if name not in message.joint_names]
    if missing:
        raise RobotsError(
            f'joint_trajectory {_stamp_id(message)} lacks joint {missing[0]} of {robot.name}: it has '
            f'{", ".join(message.joint_names) or "none"}'
        )
    columns = [list(message.joint_names).index(name) for name in robot.axes_data.names]
    # The first point's time tells where it goes on from the running motion.
    time = np.array([seconds(point.time_from_start) for point in message.points])
    position, velocity, acceleration = (
        np.array([getattr(point, name) for point in message.points])[:, columns]
        for name in ('positions', 'velocities', 'accelerations')
    )
    return Trajectory(time - time[0], position, velocity, acceleration)


def _stamp_id(message: Any) -> str:
    stamp = message.header.stamp
    return f'{stamp.sec}.{stamp.nanosec:09d}'
