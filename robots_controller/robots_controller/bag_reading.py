"""Recorded bags as plain arrays."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.interfaces import ConnectionExtRosbag2
from rosbags.rosbag2 import Reader, ReaderError
from rosbags.typesys import Stores, get_typestore

from robots_core.errors import RobotsError
from robots_planning.trajectory import Trajectory


def read_messages(bag: Path, topics: Collection[str]) -> dict[str, list[tuple[float, Any]]]:
    """Messages of some topics.

    Args:
        bag: A rosbag2 folder.
        topics: Full topic names.

    Returns:
        For each topic its (time of sending in s since the bag's first message, message), in order; empty
        where the bag does not hold the topic.

    Raises:
        RobotsError: the folder is not a readable bag.
    """
    typestore = get_typestore(Stores.ROS2_JAZZY)
    messages: dict[str, list[tuple[float, Any]]] = {topic: [] for topic in topics}
    try:
        with Reader(bag) as reader:
            start = reader.start_time
            wanted = [c for c in reader.connections if c.topic in messages]
            assert all(isinstance(c.ext, ConnectionExtRosbag2) for c in wanted)
            for connection, stamp, data in reader.messages(wanted) if wanted else ():
                message = typestore.deserialize_cdr(data, connection.msgtype)
                messages[connection.topic].append((1e-9 * (stamp - start), message))
    except ReaderError as error:
        raise RobotsError(f'{bag} is not a readable bag: {error}') from error
    return messages


def seconds(stamp: Any) -> float:
    """A stamp or duration of a message in s."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def reference_trajectory(references: list[Any]) -> Trajectory:
    """The references of a controller, one JointTrajectory message each, as one trajectory.

    Their stamps are the instants when they were due: multiples of the controller's period, with gaps where
    messages were lost.

    Raises:
        RobotsError: less than two references.
    """
    if len(references) < 2:
        raise RobotsError(f'{len(references)} references make no trajectory, at least 2 are needed')
    period = seconds(references[0].points[0].time_from_start)
    due = np.array([seconds(message.header.stamp) for message in references])
    ticks = np.round((due - due[0]) / period)
    points = [message.points[0] for message in references]
    return Trajectory(
        ticks * period,
        np.array([p.positions for p in points]),
        np.array([p.velocities for p in points]),
        np.array([p.accelerations for p in points]),
    )
