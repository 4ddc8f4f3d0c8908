"""Clearance: how close the robot came to itself and its surroundings, and when."""

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final

import numpy as np

from robots_controller.recording.motion_record import MotionRecord
from robots_controller.report.recorded_run import RecordedRun
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.results import PathProximity
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
        motions: Smallest distance of each motion of the run, m; NaN of one that did not begin.
        path: The run.
        collision: Of the robot in the scene.
    """

    smallest: float
    time: float
    line: int
    first: str
    second: str
    motions: tuple[float, ...]
    path: JointPath
    collision: CollisionDetection

    @cached_property
    def curve(self) -> Array:
        """(time in s, distance in m), (k, 2)."""
        times = np.arange(self.path.start, self.path.end, CURVE_PERIOD)
        found = [self.collision.distance(self.path.sample(time)) for time in times]
        near = [(time, one.distance) for time, one in zip(times, found, strict=True) if one is not None]
        return read_only(np.array(near).reshape(-1, 2))

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
    rows = [_rows(path, motion) for motion in run.motions]
    edges = {0, path.time.size - 1}.union(*(part for part in rows if part))
    # Each part between two edges is searched once: motions may overlap, and there is time between them.
    found = []
    for first, last in pairwise(sorted(edges)):
        values = (path.time, path.position, path.velocity, path.acceleration)
        closest = collision.closest_approach(JointPath(*(one[first : last + 1] for one in values)))
        if closest is None:
            return None
        found.append((first, last, closest))
    closest = min((one for _, _, one in found), key=_distance)
    near = closest.proximity
    return Clearance(
        smallest=near.distance,
        time=closest.time,
        line=next((m.line for m in run.motions if m.moved and m.start <= closest.time <= m.end), 0),
        first=near.first,
        second=near.second,
        motions=tuple(
            min((_distance(one) for first, last, one in found if part[0] <= first and last <= part[-1]))
            if part
            else math.nan
            for part in rows
        ),
        path=path,
        collision=collision,
    )


def _rows(path: JointPath, motion: MotionRecord) -> tuple[int, ...]:
    """The first and the last point of a motion on the path; () of one that did not begin, or has one."""
    first = int(np.searchsorted(path.time, motion.start))
    last = int(np.searchsorted(path.time, motion.end, side='right')) - 1
    return (first, last) if motion.moved and first < last else ()


def _distance(closest: PathProximity) -> float:
    return closest.proximity.distance
