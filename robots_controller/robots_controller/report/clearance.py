"""Clearance: how close the robot came to itself and its surroundings, and when."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_controller.recording.motion_record import MotionRecord
from robots_controller.report.recorded_run import RecordedRun
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.validation import Array, read_only

CURVE_PERIOD: Final = 0.04  # s between points of the curve; the smallest distance is searched exactly


@dataclass(frozen=True, eq=False)
class Clearance:
    """Distances over a run.

    Attributes:
        smallest: Smallest distance, m; 0 in contact.
        time: When, s.
        line: Line of the motion then; 0 for none.
        first: Name of one part.
        second: Name of the other part.
        curve: (time in s, distance in m), (k, 2).
        motions: Smallest distance of each motion of the run, m; NaN of one that did not begin.
    """

    smallest: float
    time: float
    line: int
    first: str
    second: str
    curve: Array
    motions: tuple[float, ...] = ()

    def describe(self) -> str:
        """One line for a person."""
        where = f' in line {self.line}' if self.line else ''
        if self.smallest <= 0.0:
            return f'{self.first} meets {self.second} at {self.time:.2f} s{where}'
        return (
            f'{1e3 * self.smallest:.1f} mm between {self.first} and {self.second} at {self.time:.2f} s{where}'
        )


def clearance(run: RecordedRun, scene: Scene) -> Clearance | None:
    """The distances of a run in a scene; None if there is nothing to come close to, or no motion.

    The path between the samples of the drives is checked too: nothing is missed.

    Raises:
        InvalidInputError: the scene does not fit the robot.
    """
    if run.time.size < 2:
        return None
    collision = CollisionDetection(run.robot, scene=scene)
    q, q_dot = run.feedback
    path = JointPath(run.time, q, q_dot, run.reference[2])
    closest = collision.closest_approach(path)
    if closest is None:
        return None
    times = np.arange(run.time[0], run.time[-1], CURVE_PERIOD)
    found = [collision.distance(path.sample(time)) for time in times]
    curve = [(time, near.distance) for time, near in zip(times, found, strict=True) if near is not None]
    near = closest.proximity
    motions = tuple(_of_motion(collision, path, motion) for motion in run.motions)
    return Clearance(
        smallest=near.distance,
        time=closest.time,
        line=next((m.line for m in run.motions if m.moved and m.start <= closest.time <= m.end), 0),
        first=near.first,
        second=near.second,
        curve=read_only(np.array(curve).reshape(-1, 2)),
        motions=motions,
    )


def _of_motion(collision: CollisionDetection, path: JointPath, motion: MotionRecord) -> float:
    """The smallest distance while a motion runs, m; NaN if it did not begin."""
    rows = (path.time >= motion.start) & (path.time <= motion.end)
    if not motion.moved or rows.sum() < 2:
        return math.nan
    values = (path.time, path.position, path.velocity, path.acceleration)
    closest = collision.closest_approach(JointPath(*(one[rows] for one in values)))
    return math.nan if closest is None else closest.proximity.distance
