"""Recorded bags as plain arrays."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots_controller.bag_file import read_bag
from robots_core.errors import RobotsError
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory


def read_messages(path: Path, topics: Collection[str]) -> dict[str, list[tuple[float, Any]]]:
    """Messages of some topics.

    Args:
        path: A rosbag2 folder, or one .mcap or .db3 file.
        topics: Full topic names.

    Returns:
        For each topic its (time of sending in s since the bag's first message, message), in order; empty
        where the bag does not hold the topic.

    Raises:
        RobotsError: what is wrong with the bag.
    """
    bag = read_bag(path)
    start = bag.messages[0][1] if bag.messages else 0
    return {
        topic: [(1e-9 * (stamp - start), message) for stamp, message in messages]
        for topic, messages in bag.deserialized(topics).items()
    }


def seconds(stamp: Any) -> float:
    """A stamp or duration of a message in s."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def reference_trajectory(references: Sequence[Any]) -> Trajectory:
    """The references of a controller, one JointTrajectory message each, as one trajectory.

    Their stamps are the instants when they were due: multiples of the controller's period, with gaps where
    messages were lost. A controller that was held up goes on from where it was: its references follow each
    other by one period whatever the clock says (see `late_references`).

    Raises:
        RobotsError: less than two references.
    """
    ticks, late = _steps(references)
    points = [message.points[0] for message in references]
    return Trajectory(
        _period(references) * np.concatenate([[0], np.cumsum(np.where(late, 1, ticks))]),
        np.array([p.positions for p in points]),
        np.array([p.velocities for p in points]),
        np.array([p.accelerations for p in points]),
    )


def late_references(references: Sequence[Any]) -> Array:
    """How late each reference of a moving robot came after the one before, (m,) s; 0 for those in time.

    Raises:
        RobotsError: less than two references.
    """
    ticks, late = _steps(references)
    return np.concatenate([[0.0], _period(references) * np.where(late, ticks - 1, 0)])


def _period(references: Sequence[Any]) -> float:
    return seconds(references[0].points[0].time_from_start)


def _steps(references: Sequence[Any]) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Periods from each reference to the next, and whether the robot did not move on meanwhile."""
    if len(references) < 2:
        raise RobotsError(f'{len(references)} references make no trajectory, at least 2 are needed')
    period = _period(references)
    due = np.array([seconds(message.header.stamp) for message in references])
    ticks = np.maximum(np.round(np.diff(due) / period).astype(np.int64), 1)
    late = np.zeros(ticks.size, dtype=bool)
    for gap in np.flatnonzero(ticks > 1).tolist():
        before, after = references[gap].points[0], references[gap + 1].points[0]
        way = np.subtract(after.positions, before.positions)
        one = 0.5 * period * np.add(before.velocities, after.velocities)
        late[gap] = np.linalg.norm(way - one) < np.linalg.norm(way - ticks[gap] * one)
    return ticks, late
