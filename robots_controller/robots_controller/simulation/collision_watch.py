"""CollisionWatch: what comes how close to a simulated robot, as `collision_node` tells it in a live cell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.collision.joint_path import JointPath
from robots_core.blocks.collision.results import Proximity
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

# As collision_node.
MARGIN: Final = 0.002  # m
REACTION_TIME: Final = 0.1  # s
WATCH_RATE: Final = 25.0  # Hz


@dataclass(frozen=True)
class Clearness:
    """How close the robot is to something.

    Attributes:
        distance: m; 0 in contact, infinite if there is nothing.
        words: For a person.
        near: It is closer than the margin.
        values: Who is closest to whom, where, and the margin.
    """

    distance: float
    words: str
    near: bool
    values: dict[str, object]


class CollisionWatch:
    """Looks at distances; a robot that stands is looked at once.

    Args:
        detection: Knows the robot and the scene.
        axes: The robot's limits.
    """

    def __init__(self, detection: CollisionDetection, axes: AxesData) -> None:
        self._detection, self._margin, self._acceleration = detection, MARGIN, axes.acceleration
        self._q: Array | None = None
        self._seen = Clearness(np.inf, 'nothing to collide with', near=False, values={'margin': MARGIN})

    def look(self, q: Array) -> Clearness:
        """The distances at joint positions (n,)."""
        if self._q is None or not np.array_equal(q, self._q):
            self._q = q.copy()
            closest = self._detection.distance(q)
            if closest is not None:
                self._seen = self._clearness(closest)
        return self._seen

    def ahead(self, q: Array, q_dot: Array) -> bool:
        """Something is in the way of a robot that moves without a path, (n,) each, while it could brake."""
        time = REACTION_TIME + float((np.abs(q_dot) / self._acceleration).max())
        way = JointPath.straight(q, q + time * q_dot)
        return self._detection.first_approach(way, margin=self._margin) is not None

    def _clearness(self, closest: Proximity) -> Clearness:
        values: dict[str, object] = {
            'margin': self._margin,
            'first': closest.first,
            'second': closest.second,
            'distance': closest.distance,
            'point_first': _triple(closest.point_first),
            'point_second': _triple(closest.point_second),
        }
        return Clearness(closest.distance, closest.describe(), closest.distance < self._margin, values)


def _triple(point: Array) -> str:
    return ' '.join(f'{value:.6f}' for value in point)
