"""MotionQueue: the motion that the controller follows, and those that come after it."""

from __future__ import annotations

from collections import deque

import numpy as np

from robots_controller.control.followed_motion import FollowedMotion
from robots_core.errors import TrajectoryRefusedError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

# A planned start may differ from the reference by the rounding of its way through a message and by what
# the smoothing still levels out; a larger step would be a jump of the robot.
START_TOLERANCE = 1e-6  # rad, m
LONGEST_QUEUE = 64  # motions; more were not sent by a program that waits for its robot


class MotionQueue:
    """Motions in their order.

    A motion that starts where the one before it ends waits for its turn. One that joins the running one at a
    path time, with its position, velocity and acceleration there, takes its place from then on. One that
    joins the last one before its end carries that one on: what is left of it then is not followed.
    """

    def __init__(self, axes: AxesData) -> None:
        self.current: FollowedMotion | None = None
        self.waiting: deque[FollowedMotion] = deque()
        self._axes = axes

    def put(self, motion: FollowedMotion, reference: Array, join_time: float = 0.0) -> None:
        """Take a motion.

        Args:
            motion: What to follow.
            reference: Where the robot's reference stands if no motion is followed, (3, n).
            join_time: Path time of the running motion at which this one continues in its place, s; below 0:
                that of the last motion, from its end, at which this one carries it on; 0: after its end.

        Raises:
            TrajectoryRefusedError: it starts nowhere that the robot will be, the running motion has been
                given up, or there are too many.
        """
        trajectory, running = motion.trajectory, self.current
        if running is not None and running.failure is not None:
            raise TrajectoryRefusedError(
                'the robot is still moving: it stops, and may be sent again when it stands'
            )
        if join_time != 0.0:
            self._join(motion, join_time)
            return
        if trajectory.velocity[0].any() or trajectory.acceleration[0].any():
            raise TrajectoryRefusedError(
                'the trajectory starts with a velocity, but the robot will stand there; to go on from a '
                'running motion, its first point says at which time of that motion'
            )
        if running is None:
            self._check_start(trajectory, reference[0], 'stands; plan from the current joint_reference')
            self.current = motion
            return
        if len(self.waiting) >= LONGEST_QUEUE:
            raise TrajectoryRefusedError(
                f'{LONGEST_QUEUE} motions are waiting, more are not taken; wait for their results'
            )
        self._check_start(
            trajectory,
            self._last(running).trajectory.position[-1],
            'ends with the motion before it; wait for its motion_result or plan from its end',
        )
        self.waiting.append(motion)

    def start_next(self, now: float) -> None:
        """Follow the next motion, if there is one; the current one is over."""
        self.current = self.waiting.popleft() if self.waiting else None
        if self.current is not None:
            self.current.start = now

    def join(self, now: float) -> FollowedMotion | None:
        """Go on with the successor if it is time; returns the motion that it replaces."""
        replaced = self.current
        if replaced is None or replaced.successor is None or replaced.path_time < replaced.join_time:
            return None
        replaced.forget_before()
        self.current = replaced.successor
        self.current.failure = replaced.failure
        self.current.path_time = replaced.path_time - replaced.join_time
        self.current.start = now - self.current.path_time
        return replaced

    @property
    def all(self) -> list[FollowedMotion]:
        """All motions, in their order; from any thread."""
        current, waiting = self.current, list(self.waiting)
        heads = waiting if current is None else [current, *waiting]
        return [motion for head in heads for motion in (head, *_successors(head))]

    def clear(self) -> list[FollowedMotion]:
        """Forget all motions; returns those that never began."""
        unbegun = _successors(self.current)
        for motion in self.waiting:
            unbegun += [motion, *_successors(motion)]
        self.current = None
        self.waiting.clear()
        return unbegun

    def _join(self, motion: FollowedMotion, join_time: float) -> None:
        running, passes = self.current, join_time < 0.0
        if passes and running is not None:
            running = self._last(running)
            join_time += running.trajectory.duration
        if running is None or running.path_time > join_time:
            at = 'it stands' if running is None else f'that one is at {running.path_time:.3f} s'
            raise TrajectoryRefusedError(
                f'the trajectory should go on at {join_time:.3f} s of the running motion, but {at}: it came '
                'too late'
            )
        if not passes and (self.waiting or running.successor is not None):
            raise TrajectoryRefusedError('another motion is already to follow the running one')
        if not running.runs_like(motion.trajectory, join_time):
            raise TrajectoryRefusedError(
                f'the trajectory does not go on from the running motion at {join_time:.3f} s: it was planned '
                'from something else'
            )
        running.join(motion, join_time, passes=passes)

    def _last(self, running: FollowedMotion) -> FollowedMotion:
        """The motion after which nothing follows yet."""
        last = self.waiting[-1] if self.waiting else running
        return (last, *_successors(last))[-1]

    def _check_start(self, trajectory: Trajectory, position: Array, where: str) -> None:
        offset = trajectory.position[0] - position
        worst = int(np.abs(offset).argmax())
        if abs(offset[worst]) > START_TOLERANCE:
            name, unit = self._axes.names[worst], self._axes.unit(worst)
            raise TrajectoryRefusedError(
                f'the trajectory starts {offset[worst]:+.6g} {unit} from where {name} {where}', joint=name
            )


def _successors(motion: FollowedMotion | None) -> list[FollowedMotion]:
    """Those that continue from a motion, one after the other."""
    found: list[FollowedMotion] = []
    while motion is not None and (motion := motion.successor) is not None:
        found.append(motion)
    return found
