"""The robot of a bag, and its references or feedback as arrays."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from robots_controller.recording.bag_file import Bag
from robots_controller.recording.message_rows import MessageRows, marks
from robots_core.errors import InvalidInputError
from robots_core.message_builder import NANOSECONDS
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

STATE_FIELDS: Final = ('position', 'velocity', 'effort')
POINT_FIELDS: Final = ('positions', 'velocities', 'accelerations')
NAMING: Final = ('program_status', 'motion_result')
"""Topics whose messages name the robot."""


@dataclass(frozen=True, eq=False)
class JointRows:
    """Messages of a topic, a row each, in the order of the robot's n joints.

    Attributes:
        sent: When each was sent, (k,) ns.
        stamp: Its stamp, (k,) ns.
        values: (k, n) positions, velocities, and efforts of a `JointState` or accelerations of a
            `JointTrajectory` of one point; None where they are not given.
        period: Time of the points from their stamps, s; 0 of a `JointState`.
    """

    sent: NDArray[np.int64]
    stamp: NDArray[np.int64]
    values: tuple[Array | None, Array | None, Array | None]
    period: float


def joint_rows(bag: Bag, topic: str, robot: BaseRobotModel) -> JointRows:
    """The rows of a topic of `sensor_msgs/JointState` or of one-point `trajectory_msgs/JointTrajectory`.

    Messages of one robot differ in their numbers alone and are read at once, others one by one.

    Raises:
        RobotsError: a joint that is missing, or messages that cannot be read.
    """
    found = bag.serialized(topic)
    if not found:
        none = np.zeros(0, np.int64)
        return JointRows(none, none, (None, None, None), 0.0)
    sent, data = np.array([stamp for stamp, _ in found], np.int64), [message for _, message in found]
    first = replace(bag, messages=((topic, *found[0]),)).deserialized([topic])[topic][0][1]
    at_once = _template(bag, first).read(data)
    if at_once is None:
        stamp, groups = _one_by_one(
            [message for _, message in bag.deserialized([topic])[topic]], robot, topic
        )
    else:
        stamp, filled = at_once
        columns = _columns(first, robot, topic)
        groups = [values[:, columns] if values.shape[1] > max(columns) else None for values in filled]
    position, velocity, third = groups
    after = first.points[0].time_from_start if hasattr(first, 'points') else None
    period = 0.0 if after is None else seconds(after)
    return JointRows(sent, stamp, (position, velocity, third), period)


def late_references(rows: JointRows) -> Array:
    """How late each reference of a moving robot came after the one before, (k,) s; 0 for those in time.

    Stamps are the instants when references were due: multiples of the controller's period, with gaps where
    messages were lost. A controller that was held up continues from where it was: its references follow each
    other by one period on any clock.
    """
    position, velocity, _ = rows.values
    assert position is not None
    assert velocity is not None
    ticks = np.maximum(np.round(np.diff(rows.stamp) / (NANOSECONDS * rows.period)).astype(np.int64), 1)
    late = np.zeros(rows.stamp.size)
    for gap in np.flatnonzero(ticks > 1).tolist():
        way = position[gap + 1] - position[gap]
        one = 0.5 * rows.period * (velocity[gap] + velocity[gap + 1])
        if np.linalg.norm(way - one) < np.linalg.norm(way - ticks[gap] * one):
            late[gap + 1] = rows.period * (ticks[gap] - 1)
    return late


def seconds(stamp: Any) -> float:
    """A stamp or duration of a message in s."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def _fields(message: Any) -> tuple[Any, tuple[str, ...]]:
    return (message.points[0], POINT_FIELDS) if hasattr(message, 'points') else (message, STATE_FIELDS)


def _template(bag: Bag, first: Any) -> MessageRows:
    holder, fields = _fields(first)
    groups = [marks(len(getattr(holder, name)), number) for number, name in enumerate(fields)]
    marked = replace(holder, **dict(zip(fields, groups, strict=True)))
    template = replace(first, points=[marked]) if hasattr(first, 'points') else marked
    return MessageRows(bag.typestore(), template, groups)


def _one_by_one(
    messages: Sequence[Any], robot: BaseRobotModel, topic: str
) -> tuple[NDArray[np.int64], list[Array | None]]:
    stamps = [m.header.stamp.sec * NANOSECONDS + m.header.stamp.nanosec for m in messages]
    columns = [_columns(message, robot, topic) for message in messages]
    fields = _fields(messages[0])[1]
    values: list[Array | None] = []
    for name in fields:
        rows = [np.asarray(getattr(_fields(message)[0], name), np.float64) for message in messages]
        given = all(row.size > max(places) for row, places in zip(rows, columns, strict=True))
        values.append(
            np.array([row[places] for row, places in zip(rows, columns, strict=True)]) if given else None
        )
    return np.array(stamps, np.int64), values


def _columns(message: Any, robot: BaseRobotModel, topic: str) -> list[int]:
    names = message.joint_names if hasattr(message, 'points') else message.name
    return joint_columns(names, robot, f'{topic.rpartition("/")[2]} of the bag')


def joint_columns(names: Sequence[str], robot: BaseRobotModel, what: str) -> list[int]:
    """Where each joint of a robot stands among the names of a message.

    Raises:
        InvalidInputError: one is missing; the text begins with `what`.
    """
    missing = [name for name in robot.axes_data.names if name not in names]
    if missing:
        raise InvalidInputError(
            f'{what} lacks joint {missing[0]} of {robot.name}: it has {", ".join(names) or "none"}'
        )
    return [list(names).index(name) for name in robot.axes_data.names]


def recorded_robot(bag: Bag, prefix: str, name: str = '') -> BaseRobotModel:
    """The robot of a bag whose topics begin with `prefix`: the one that is named, or that the bag names.

    Raises:
        RobotsError: nothing names it, or it is unknown.
    """
    statuses = {} if name else bag.deserialized([prefix + topic for topic in NAMING])
    named = (str(message.hardware_id) for found in statuses.values() for _, message in found)
    name = name or next(filter(None, named), '')
    if not name:
        raise InvalidInputError(
            f'{bag.path} does not say which robot it was recorded with; name it: --robot NAME'
        )
    return load_robot_model(name)
