"""Recorded bags as plain arrays."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.joint_rows import POINT_FIELDS, JointRows
from robots_controller.recording.message_rows import NANOSECONDS
from robots_core.errors import RobotsError
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory


def read_messages(bag: Bag | Path, topics: Collection[str]) -> dict[str, list[tuple[float, Any]]]:
    """Messages of some topics.

    Args:
        bag: A bag, or where it is: a rosbag2 folder, or one .mcap or .db3 file.
        topics: Full topic names.

    Returns:
        For each topic its (time of sending in s since the bag's first message, message), in order; empty
        where the bag does not hold the topic.

    Raises:
        RobotsError: what is wrong with the bag.
    """
    found = bag if isinstance(bag, Bag) else read_bag(bag)
    return {
        topic: [(found.since_start(stamp), message) for stamp, message in messages]
        for topic, messages in found.deserialized(topics).items()
    }


def seconds(stamp: Any) -> float:
    """A stamp or duration of a message in s."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def reference_trajectory(references: Sequence[Any] | JointRows) -> Trajectory:
    """The references of a controller as one trajectory.

    Their stamps are the instants when they were due: multiples of the controller's period, with gaps where
    messages were lost. A controller that was held up goes on from where it was: its references follow each
    other by one period whatever the clock says (see `late_references`).

    Args:
        references: JointTrajectory messages of one point, or their rows.

    Raises:
        RobotsError: less than two references.
    """
    rows = _rows(references)
    ticks, late = _steps(rows)
    position, velocity, acceleration = _whole(rows)
    time = rows.period * np.concatenate([[0], np.cumsum(np.where(late, 1, ticks))])
    return Trajectory(time, position, velocity, acceleration)


def late_references(references: Sequence[Any] | JointRows) -> Array:
    """How late each reference of a moving robot came after the one before, (m,) s; 0 for those in time.

    Raises:
        RobotsError: less than two references.
    """
    rows = _rows(references)
    ticks, late = _steps(rows)
    return np.concatenate([[0.0], rows.period * np.where(late, ticks - 1, 0)])


def _rows(references: Sequence[Any] | JointRows) -> JointRows:
    if isinstance(references, JointRows):
        return references
    points = [message.points[0] for message in references]
    stamps = [message.header.stamp for message in references]
    due = np.array([stamp.sec * NANOSECONDS + stamp.nanosec for stamp in stamps], np.int64)
    position, velocity, acceleration = (
        np.array([getattr(point, name) for point in points]) for name in POINT_FIELDS
    )
    period = seconds(points[0].time_from_start) if points else 0.0
    return JointRows(due, due, (position, velocity, acceleration), period)


def _whole(rows: JointRows) -> tuple[Array, Array, Array]:
    position, velocity, acceleration = rows.values
    if position is None or velocity is None or acceleration is None:
        raise RobotsError('joint_reference lacks positions, velocities or accelerations')
    return position, velocity, acceleration


def _steps(rows: JointRows) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Periods from each reference to the next, and whether the robot did not move on meanwhile."""
    if rows.stamp.size < 2:
        raise RobotsError(f'{rows.stamp.size} references make no trajectory, at least 2 are needed')
    position, velocity, _ = _whole(rows)
    ticks = np.maximum(np.round(np.diff(rows.stamp) / (NANOSECONDS * rows.period)).astype(np.int64), 1)
    late = np.zeros(ticks.size, dtype=bool)
    for gap in np.flatnonzero(ticks > 1).tolist():
        way = position[gap + 1] - position[gap]
        one = 0.5 * rows.period * (velocity[gap] + velocity[gap + 1])
        late[gap] = np.linalg.norm(way - one) < np.linalg.norm(way - ticks[gap] * one)
    return ticks, late
