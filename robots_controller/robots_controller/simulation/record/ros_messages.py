"""Messages of the cell's topics without ROS, as rosbags has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, Final

import numpy as np
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from robots_core.base_frames import BASE_FRAME
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.trajectory import Trajectory

NANOSECONDS: Final = 1_000_000_000
TOOL_FRAME: Final = 'tool0'
OK, WARN, ERROR = 0, 1, 2  # levels of diagnostic_msgs/DiagnosticStatus
STRING_ARRAY: Final = 9  # type of rcl_interfaces/ParameterValue
INFO: Final = 20  # level of rcl_interfaces/Log


@lru_cache(maxsize=1)
def typestore() -> Typestore:
    """The message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)


def message(type_name: str, *fields: Any) -> Any:
    """A message of its fields in their order."""
    return typestore().types[type_name](*fields)


def stamp(nanoseconds: int) -> Any:
    """builtin_interfaces/Time."""
    return message('builtin_interfaces/msg/Time', *divmod(nanoseconds, NANOSECONDS))


def id_of(nanoseconds: int) -> str:
    """Id of the command with this stamp, as nodes write it."""
    return f'{nanoseconds // NANOSECONDS}.{nanoseconds % NANOSECONDS:09d}'


def header(nanoseconds: int, frame: str = '') -> Any:
    """std_msgs/Header."""
    return message('std_msgs/msg/Header', stamp(nanoseconds), frame)


def text(value: str) -> Any:
    """std_msgs/String."""
    return message('std_msgs/msg/String', value)


def diagnostic_status(name: str, words: str, robot: str, level: int, values: Mapping[str, object]) -> Any:
    """diagnostic_msgs/DiagnosticStatus."""
    pairs = [message('diagnostic_msgs/msg/KeyValue', key, str(value)) for key, value in values.items()]
    return message('diagnostic_msgs/msg/DiagnosticStatus', level, name, words, robot, pairs)


def joint_state(nanoseconds: int, names: Sequence[str], *values: Array) -> Any:
    """sensor_msgs/JointState of positions, velocities and efforts, as far as they are given."""
    given = [np.asarray(row, np.float64) for row in values]
    given += [np.zeros(0)] * (3 - len(given))
    return message('sensor_msgs/msg/JointState', header(nanoseconds), list(names), *given)


def pose_stamped(nanoseconds: int, pose: Pose, frame: str = BASE_FRAME) -> Any:
    """geometry_msgs/PoseStamped, by default in the base frame."""
    point = message('geometry_msgs/msg/Point', *map(float, pose.r))
    quaternion = message('geometry_msgs/msg/Quaternion', *map(float, pose.quaternion()))
    body = message('geometry_msgs/msg/Pose', point, quaternion)
    return message('geometry_msgs/msg/PoseStamped', header(nanoseconds, frame), body)


def matrix(values: Array, *labels: str) -> Any:
    """std_msgs/Float64MultiArray of a matrix, row by row, its dimensions labelled."""
    strides = (values.size, values.shape[1])
    dimensions = [
        message('std_msgs/msg/MultiArrayDimension', *one)
        for one in zip(labels, values.shape, strides, strict=True)
    ]
    layout = message('std_msgs/msg/MultiArrayLayout', dimensions, 0)
    return message('std_msgs/msg/Float64MultiArray', layout, np.array(values.ravel(), np.float64))


def twist_stamped(nanoseconds: int, twist: Array) -> Any:
    """geometry_msgs/TwistStamped of m/s and rad/s, (6,), in the base frame."""
    body = message('geometry_msgs/msg/Twist', *_vectors(twist))
    return message('geometry_msgs/msg/TwistStamped', header(nanoseconds, BASE_FRAME), body)


def wrench_stamped(nanoseconds: int, wrench: Array) -> Any:
    """geometry_msgs/WrenchStamped on the tool, in its axes, of (6,)."""
    body = message('geometry_msgs/msg/Wrench', *_vectors(wrench))
    return message('geometry_msgs/msg/WrenchStamped', header(nanoseconds, TOOL_FRAME), body)


def _vectors(values: Array) -> list[Any]:
    return [message('geometry_msgs/msg/Vector3', *row) for row in values.reshape(2, 3).tolist()]


def path(nanoseconds: int, poses: Sequence[Pose]) -> Any:
    """nav_msgs/Path in the base frame."""
    stamped = [pose_stamped(nanoseconds, pose) for pose in poses]
    return message('nav_msgs/msg/Path', header(nanoseconds, BASE_FRAME), stamped)


def joint_trajectory(
    nanoseconds: int, names: Sequence[str], points: Sequence[tuple[int, Array, Array, Array]], frame: str = ''
) -> Any:
    """trajectory_msgs/JointTrajectory of points: time (ns), position, velocity, acceleration."""
    rows = [
        message(
            'trajectory_msgs/msg/JointTrajectoryPoint',
            *(np.asarray(values, np.float64) for values in (q, q_dot, q_ddot)),
            np.zeros(0),
            message('builtin_interfaces/msg/Duration', *divmod(at, NANOSECONDS)),
        )
        for at, q, q_dot, q_ddot in points
    ]
    return message('trajectory_msgs/msg/JointTrajectory', header(nanoseconds, frame), list(names), rows)


def planned_trajectory(
    nanoseconds: int, names: Sequence[str], trajectory: Trajectory, join_time: float
) -> Any:
    """The same of a whole trajectory, whose first point has this time, s."""
    times = np.round(trajectory.time * NANOSECONDS) + round(join_time * NANOSECONDS)
    points = zip(
        times.astype(np.int64).tolist(),
        trajectory.position,
        trajectory.velocity,
        trajectory.acceleration,
        strict=True,
    )
    return joint_trajectory(nanoseconds, names, list(points), BASE_FRAME)


def image(kind: str, label: str, values: Array) -> Any:
    """std_msgs/UInt8MultiArray of digital values or Float64MultiArray of analog ones."""
    size = values.size
    dimension = message('std_msgs/msg/MultiArrayDimension', label, size, size)
    layout = message('std_msgs/msg/MultiArrayLayout', [dimension] if label else [], 0)
    if kind == 'digital':
        return message('std_msgs/msg/UInt8MultiArray', layout, values.astype(np.uint8))
    return message('std_msgs/msg/Float64MultiArray', layout, np.array(values, np.float64))


def string_parameters(nanoseconds: int, node: str, values: Mapping[str, Sequence[str]]) -> Any:
    """rcl_interfaces/ParameterEvent of new parameters that are lists of strings."""
    none = np.zeros(0, np.uint8), np.zeros(0, np.bool_), np.zeros(0, np.int64), np.zeros(0)
    parameters = [
        message(
            'rcl_interfaces/msg/Parameter',
            name,
            message(
                'rcl_interfaces/msg/ParameterValue', STRING_ARRAY, False, 0, 0.0, '', *none, list(strings)
            ),
        )
        for name, strings in values.items()
    ]
    return message('rcl_interfaces/msg/ParameterEvent', stamp(nanoseconds), node, parameters, [], [])


def log(nanoseconds: int, name: str, words: str) -> Any:
    """rcl_interfaces/Log."""
    return message('rcl_interfaces/msg/Log', stamp(nanoseconds), INFO, name, words, '', '', 0)
