"""PathSwitches: when outputs are switched that belong to places on a path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, Literal

import numpy as np

from robots_controller.program.motion_command import MotionCommand, PathSwitch
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

# Points of the planned motion at which the tool is looked at: 1 mm apart on 0.4 m.
POINTS: Final = 400


class PathSwitches:
    """The switches on a path, each due at a progress of its planned time.

    The places are exact to the spacing of the given points: between two of them the tool's way is taken for
    straight. A place that lies before its motion is the motion's start.

    Args:
        motions: The motions that the path consists of, in their order: what each switches, and where the tool
            is at its end, (3,), m; the last one ends with the path.
        time: (m,) of the planned path, s.
        r: (m, 3) positions of the tool, m.
    """

    def __init__(self, motions: Sequence[tuple[Sequence[PathSwitch], Array]], time: Array, r: Array) -> None:
        way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(r, axis=0), axis=1))])
        self._waiting: list[tuple[float, PathSwitch]] = []
        start = 0
        for number, (switches, target) in enumerate(motions, 1):
            # A blended motion passes its target by: it ends where it comes closest.
            near = start + int(np.argmin(np.linalg.norm(r[start:] - target, axis=1)))
            end = time.size - 1 if number == len(motions) else near
            self._waiting += [(_progress(switch, time, way, start, end), switch) for switch in switches]
            start = end
        self._waiting.sort(key=lambda item: item[0])
        self._duration = float(time[-1])
        self._last: tuple[float, float] | None = None

    @property
    def next_progress(self) -> float | None:
        """Progress 0..1 at which the next switch is due, None if there is none."""
        return self._waiting[0][0] if self._waiting else None

    def due(self, progress: float) -> list[PathSwitch]:
        """The switches up to a progress, once."""
        switches = [switch for at, switch in self._waiting if at <= progress]
        del self._waiting[: len(switches)]
        return switches

    def delay(self, now: float, progress: float) -> float | None:
        """Seconds until the next switch is due, if the robot goes on as between the last two calls.

        Calls may come late and then one upon the other: the robot is taken for no faster than planned.

        Args:
            now: Time, s.
            progress: Where the robot is now, 0..1.

        Returns:
            None if that cannot be told yet, or the robot stands.
        """
        last, self._last = self._last, (now, progress)
        at = self.next_progress
        if last is None or at is None or progress <= last[1] or now <= last[0]:
            return None
        return max(0.0, (at - progress) * max((now - last[0]) / (progress - last[1]), self._duration))


def switches_on_path(
    chain: Sequence[MotionCommand], trajectory: Trajectory, direct_kinematics: Callable[[Array], Pose]
) -> PathSwitches:
    """The switches of motions that were planned as one.

    Args:
        chain: The motions in their order.
        trajectory: Their plan.
        direct_kinematics: Pose of tool0 for joint positions.
    """
    times = np.linspace(trajectory.time[0], trajectory.time[-1], POINTS)
    tool = _frame(chain[-1], 'tool')
    r = np.array([(direct_kinematics(trajectory.sample(t)[0]) @ tool).r for t in times])
    targets = [_target(command, direct_kinematics) for command in chain]
    switches = [command.switches for command in chain]
    return PathSwitches(list(zip(switches, targets, strict=True)), times, r)


def _target(command: MotionCommand, direct_kinematics: Callable[[Array], Pose]) -> Array:
    if command.q is not None:
        return (direct_kinematics(command.q) @ _frame(command, 'tool')).r
    assert command.pose is not None
    return (_frame(command, 'base') @ command.pose).r


def _frame(command: MotionCommand, name: Literal['tool', 'base']) -> Pose:
    values: Any = command.settings.get(name)
    return Pose.identity() if values is None else Pose.from_quaternion(values[:3], values[3:])


def _progress(switch: PathSwitch, time: Array, way: Array, start: int, end: int) -> float:
    first, last = float(time[start]), float(time[end])
    if switch.anchor == 'time_after_start':
        at = first + switch.at
    elif switch.anchor == 'time_before_end':
        at = last - switch.at
    elif switch.anchor == 'distance_after_start':
        # Where the tool stands the way has steps of zero: the first moment at a place counts.
        at = float(np.interp(way[start] + switch.at, *_moving(way, time)))
    else:
        at = float(np.interp(way[end] - switch.at, *_moving(way, time))) if switch.at > 0.0 else last
    at = min(max(at, first), last)
    return at / float(time[-1]) if time[-1] > 0.0 else 1.0


def _moving(way: Array, time: Array) -> tuple[Array, Array]:
    moving = np.concatenate([[True], np.diff(way) > 0.0])
    return way[moving], time[moving]
