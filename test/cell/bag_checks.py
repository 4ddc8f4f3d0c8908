"""What every recorded bag of a program has to pass."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import POINT_FIELDS, JointRows, late_references, seconds
from robots_core import BaseRobotModel
from robots_planning import Trajectory

Messages = Mapping[str, Sequence[tuple[float, Any]]]
PERIOD = 0.004  # s, of the references, by default
SMOOTHING = ControllerSettings().smoothing_time  # s
# The controller's guard lets rounding pass, and so do second differences of float64 positions.
EXACT = 1.0 + 1e-5
# A quintic between two references without the step of acceleration in between passes its ends by
# up to 37.4 % of that step (the step at one end).
OVERSHOOT = 0.374


def read_messages(bag: Path, topics: Collection[str]) -> dict[str, list[tuple[float, Any]]]:
    """Messages of some topics with their times since the bag's first message, s."""
    found = read_bag(bag)
    return {
        topic: [(1e-9 * (stamp - found.messages[0][1]), message) for stamp, message in messages]
        for topic, messages in found.deserialized(topics).items()
    }


def reference_trajectory(references: Sequence[Any]) -> Trajectory:
    """The references of a controller as one trajectory, with gaps where messages were lost."""
    points = [message.points[0] for message in references]
    due = [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in references]
    q, q_dot, q_ddot = (np.array([getattr(point, name) for point in points]) for name in POINT_FIELDS)
    rows = JointRows(np.array(due), np.array(due), (q, q_dot, q_ddot), seconds(points[0].time_from_start))
    ticks = np.maximum(np.round(1e-9 * np.diff(rows.stamp) / rows.period), 1.0)
    steps = rows.period * ticks - late_references(rows)[1:]
    return Trajectory(np.concatenate([[0.0], np.cumsum(steps)]), q, q_dot, q_ddot)


def resampled_acceleration(period: float = PERIOD) -> float:
    """The largest acceleration between references, as part of its limit.

    The moving average over the references of `SMOOTHING` makes steps of that part of the acceleration limit,
    and of twice as much where it reverses.
    """
    return 1.0 + OVERSHOOT * 2.0 / round(SMOOTHING / period)


def check_references(
    bag: Messages,
    robot: BaseRobotModel,
    period: float = PERIOD,
    *,
    streamed: bool = False,
) -> Trajectory:
    """References keep all limits, as values, as steps and, by a factor, resampled at 1 kHz; returns them.

    Streamed ones are not resampled: nothing smooths the reversal of their acceleration from one to the next.
    """
    resampled = resampled_acceleration(period)
    axes = robot.axes_data
    trajectory = reference_trajectory([message for _, message in bag['/joint_reference']])
    # While processes join, the middleware may hold up a publisher; the robot still stands then.
    moved = np.diff(trajectory.position, axis=0).any(axis=1)
    moving = moved | trajectory.velocity[:-1].any(axis=1) | trajectory.velocity[1:].any(axis=1)
    longest = np.diff(trajectory.time)[moving].max(initial=0.0)
    assert longest < 1.5 * period, 'the recorder lost references of a motion'
    step = np.diff(trajectory.position, axis=0) / period
    for velocity in (trajectory.velocity, step):
        assert np.max(np.abs(velocity) / axes.velocity) <= EXACT
    for acceleration in (trajectory.acceleration, np.diff(step, axis=0) / period):
        assert np.max(np.abs(acceleration) / axes.acceleration) <= EXACT
    if streamed:
        return trajectory
    q, q_dot, q_ddot = trajectory.sample(np.arange(0.0, trajectory.duration, 1e-3))
    assert np.all(q >= axes.lower)
    assert np.all(q <= axes.upper)
    # Between two references the speed gains at most what that much acceleration gains in half the time.
    gained = 0.5 * period * axes.acceleration * (resampled - 1.0)
    assert np.all(np.abs(q_dot) <= axes.velocity * EXACT + gained)
    assert np.max(np.abs(q_ddot) / axes.acceleration) <= resampled
    return trajectory


def changes(bag: Messages, image: str) -> list[tuple[float, int, float]]:
    """(time, channel from 1, new value) of all changes in an image of inputs or outputs, in order."""
    found = []
    before: Any = None
    for time, message in bag[f'/{image}']:
        values = np.asarray(message.data, dtype=float)
        if before is not None:
            found += [
                (time, index + 1, float(values[index])) for index in np.flatnonzero(values != before).tolist()
            ]
        before = values
    return found
