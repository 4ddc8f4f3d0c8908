"""PathSwitches: when outputs are switched that belong to places on a path."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from robots_controller.program.motions.motion_command import MotionCommand, PathSwitch
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

if TYPE_CHECKING:
    from robots_planning.trajectory import Trajectory

STEP: Final = 2e-3  # s, between the places of the tool from which the length of its path is computed
MOST_STEPS: Final = 2000  # of a motion; a longer one has longer steps
FINE: Final = 32  # parts of two steps, where a place is looked for


class PathSwitches:
    """The switches on a path, each due at a progress of its planned time.

    Args:
        places: When each is due, s of the path's planned time, and the motion that it belongs to.
        duration: Of the path, s.
    """

    def __init__(self, places: Sequence[tuple[float, PathSwitch, MotionCommand]], duration: float) -> None:
        self._duration = duration
        self._waiting = sorted(
            ((at / duration if duration > 0.0 else 1.0, switch, command) for at, switch, command in places),
            key=lambda item: item[0],
        )
        self._last: tuple[float, float] | None = None

    @property
    def next_progress(self) -> float:
        """Progress 0..1 at which the next switch is due, infinite if there is none."""
        return self._waiting[0][0] if self._waiting else math.inf

    def due(self, progress: float) -> list[PathSwitch]:
        """The switches up to a progress, once."""
        switches = [switch for at, switch, _ in self._waiting if at <= progress]
        del self._waiting[: len(switches)]
        return switches

    def waiting(self, command: MotionCommand) -> tuple[PathSwitch, ...]:
        """The switches of a motion that are not due yet."""
        return tuple(switch for _, switch, of in self._waiting if of is command)

    def leave(self, commands: Collection[MotionCommand]) -> None:
        """Forget the switches of motions that have another path now."""
        self._waiting = [item for item in self._waiting if item[2] not in commands]

    def delay(self, now: float, progress: float) -> float:
        """Seconds until the next switch is due, if the robot continues as between the last two calls.

        Calls may come late and then one upon the other: the robot is taken for no faster than planned.

        Args:
            now: Time, s.
            progress: Where the robot is now, 0..1.

        Returns:
            Infinite if that is not known yet, there is none, or the robot stands.
        """
        last, self._last = self._last, (now, progress)
        if last is None or progress <= last[1] or now <= last[0]:
            return math.inf
        duration = max((now - last[0]) / (progress - last[1]), self._duration)
        return max(0.0, (self.next_progress - progress) * duration)


def switches_on_path(
    chain: Sequence[tuple[float, MotionCommand]],
    trajectory: Trajectory,
    direct_kinematics: Callable[[Array], tuple[Array, Array]],
) -> PathSwitches:
    """The switches of motions that were planned as one.

    A place is one on the path of the motion's own tool between the motion's start and end. One that lies
    before the motion is its start, one behind it its end.

    Args:
        chain: The motions in order, each with its end, s of the plan.
        trajectory: Their plan.
        direct_kinematics: Position (3,) and orientation (3, 3) of tool0 for joint positions.
    """
    places: list[tuple[float, PathSwitch, MotionCommand]] = []
    start = 0.0
    for end, command in chain:
        path = None
        for switch in command.switches:
            if switch.anchor == 'time_after_start':
                at = start + switch.at
            elif switch.anchor == 'time_before_end':
                at = end - switch.at
            else:
                path = path or ToolPath(trajectory, direct_kinematics, _tool(command), start, end)
                after_start = switch.anchor == 'distance_after_start'
                at = path.time(switch.at if after_start else path.length - switch.at)
            places.append((min(max(at, start), end), switch, command))
        start = end
    return PathSwitches(places, trajectory.duration)


@cache
def warm_up(robot: BaseRobotModel) -> None:
    """Load all code that finds a place, which takes some tenths of a second in a fresh process.

    In the thread that takes the planned motions, a stop would have to wait for it.
    """
    from robots_planning.trajectory import Trajectory  # noqa: PLC0415  # loads the compiler

    q, rest = robot.home, np.zeros((2, robot.num_axes))
    trajectory = Trajectory(np.array([0.0, STEP]), np.stack([q, q]), rest, rest)
    ToolPath(trajectory, robot.direct_kinematics, np.zeros(3), 0.0, STEP)


class ToolPath:
    """The path of a tool on a part of a trajectory.

    Args:
        trajectory: The trajectory.
        direct_kinematics: Position (3,) and orientation (3, 3) of tool0 for joint positions.
        tool: Position of the tool centre point in tool0, (3,) m.
        start: Where the part begins, s.
        end: Where it ends, s.
    """

    def __init__(
        self,
        trajectory: Trajectory,
        direct_kinematics: Callable[[Array], tuple[Array, Array]],
        tool: Array,
        start: float,
        end: float,
    ) -> None:
        self._trajectory, self._direct_kinematics, self._tool = trajectory, direct_kinematics, tool
        pairs = int(np.clip(np.ceil((end - start) / STEP), 2, MOST_STEPS)) // 2
        times = np.linspace(start, end, 2 * pairs + 1)
        r = self._positions(times)
        parts = np.linalg.norm(np.diff(r, axis=0), axis=1)
        chords, wholes = parts[::2] + parts[1::2], np.linalg.norm(r[2::2] - r[:-2:2], axis=1)
        self._times = times[::2]
        # Chords of half the length are short of the arc by a quarter (Richardson's extrapolation).
        self._lengths = np.append(0.0, np.cumsum(chords + (chords - wholes) / 3.0))

    @property
    def length(self) -> float:
        """M."""
        return float(self._lengths[-1])

    def time(self, distance: float) -> float:
        """When the tool has first gone this far, m; the start or the end where it lies outside."""
        if distance <= 0.0:
            return float(self._times[0])
        if distance >= self.length:
            return float(self._times[-1])
        index = int(np.searchsorted(self._lengths, distance)) - 1
        times = np.linspace(self._times[index], self._times[index + 1], FINE + 1)
        parts = np.linalg.norm(np.diff(self._positions(times), axis=0), axis=1)
        lengths = np.append(0.0, np.cumsum(parts))
        before, after = self._lengths[index : index + 2]
        wanted = (distance - before) / (after - before) * lengths[-1]
        last = int(np.searchsorted(lengths, wanted))
        return float(np.interp(wanted, lengths[last - 1 : last + 1], times[last - 1 : last + 1]))

    def _positions(self, times: Array) -> Array:
        q = self._trajectory.sample(times)[0]
        return np.array([r + T @ self._tool for r, T in map(self._direct_kinematics, q)])


def _tool(command: MotionCommand) -> Array:
    values: Any = command.settings.get('tool')
    return np.array([0.0, 0.0, 0.0] if values is None else values[:3])
