"""ROS messages to and from the plain values that blocks understand."""

from __future__ import annotations

import array
import math
import struct
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from typing import Any, Final

import numpy as np
from builtin_interfaces.msg import Duration, Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import TwistStamped, WrenchStamped
from sensor_msgs.msg import JointState

from robots_core.base_frames import TOOL_FRAME, frame_in_base
from robots_core.blocks.following.pose_reference import FASTEST
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, JointNamesError, MotionEndedError
from robots_core.message_builder import MessageBuilder
from robots_core.pose import Pose
from robots_core.status import Level, Status
from robots_core.validation import Array, bounded_vector

# CDR: the encapsulation, and then a message that begins with a header has the stamp's two 32-bit words.
ENCAPSULATION_SIZE: Final = 4
NANOSECONDS: Final = 1_000_000_000
FARTHEST: Final = 1000.0  # m
JOINT_FIELDS: Final = {'positions': 'position', 'velocities': 'velocity', 'efforts': 'effort'}
RESULT_NUMBERS: Final = ('ended', 'progress')
SERIALIZED_STAMP: Final = struct.Struct('<iI')
STAMP_END: Final = ENCAPSULATION_SIZE + SERIALIZED_STAMP.size
LITTLE_ENDIAN: Final = b'\0\1\0\0'  # the encapsulation of this byte order


def doubles(values: Array) -> array.array[float]:
    """A float64 array as the type that message fields take without a loop."""
    return array.array('d', np.ascontiguousarray(values, dtype=np.float64).tobytes())


def nanoseconds(time: Time | Duration) -> int:
    """A stamp or a duration in ns."""
    return int(time.sec) * NANOSECONDS + int(time.nanosec)


def seconds(time: Time | Duration) -> float:
    """A stamp or a duration in s: the double nearest to it, as blocks compute it."""
    return nanoseconds(time) / NANOSECONDS


def stamp_id(stamp: Time) -> str:
    """A command's id: its stamp as seconds.nanoseconds."""
    return f'{stamp.sec}.{stamp.nanosec:09d}'


def serialized_stamp_id(data: bytes) -> str:
    """The id of a serialized message that begins with a header, without deserializing it."""
    sec, nanosec = SERIALIZED_STAMP.unpack_from(data, ENCAPSULATION_SIZE)
    return f'{sec}.{nanosec:09d}'


def id_stamp(id_: str) -> Time:
    """The stamp of a command's id."""
    seconds, nanoseconds = id_.split('.')
    return Time(sec=int(seconds), nanosec=int(nanoseconds))


def joint_indices(names: Sequence[str], wanted: Sequence[str], what: str) -> list[int]:
    """Where each wanted joint stands in a message; order and additional joints do not matter.

    Raises:
        JointNamesError: a wanted joint is missing or named twice.
    """
    if list(names) == list(wanted):
        return list(range(len(wanted)))
    if len(set(names)) != len(names):
        raise JointNamesError(f'{what} names a joint twice: {", ".join(names)}')
    missing = [name for name in wanted if name not in names]
    if missing:
        raise JointNamesError(
            f'{what} lacks joint {missing[0]}: it has {", ".join(names) or "no joints"}; '
            f'needed are {", ".join(wanted)}'
        )
    return [list(names).index(name) for name in wanted]


def joint_values(names: Sequence[str], values: Sequence[float], wanted: Sequence[str], what: str) -> Array:
    """Values of the wanted joints, (n,), matched by name.

    Raises:
        InvalidInputError: a missing joint, or not one value per name.
    """
    if len(values) != len(names):
        raise InvalidInputError(f'{what} has {len(values)} values for {len(names)} joints')
    indices = joint_indices(names, wanted, what)
    return np.asarray(values, dtype=np.float64)[indices]


def joint_motion(message: JointState, wanted: Sequence[str]) -> tuple[Array, Array | None, Array | None]:
    """Positions of the wanted joints, and velocities and efforts where there are any, (n,) each.

    Raises:
        InvalidInputError: a missing joint, no positions, or not one value per name.
    """
    count, indices = len(message.name), joint_indices(message.name, wanted, 'joint_states')
    rows: list[Array | None] = []
    for plural, field in JOINT_FIELDS.items():
        values = getattr(message, field)
        if len(values) not in {0, count}:
            raise InvalidInputError(f'joint_states has {len(values)} {plural} for {count} joints')
        rows.append(np.asarray(values, dtype=np.float64)[indices] if len(values) else None)
    q, q_dot, tau = rows
    if q is None:
        raise InvalidInputError('joint_states has no positions')
    return q, q_dot, tau


@cache
def message_class(type_name: str) -> Any:
    """The class of a message type.

    Args:
        type_name: As package/msg/Name.

    Raises:
        InvalidInputError: the package is not installed, or has no such message.
    """
    package, _, name = type_name.split('/')
    try:
        module = import_module(f'{package}.msg')
    except ImportError as error:
        raise InvalidInputError(f'{type_name}: the package {package!r} cannot be imported: {error}') from None
    found = getattr(module, name, None)
    if found is None:
        raise InvalidInputError(f'{type_name}: {package!r} has no message {name!r}')
    return found


def action_type(name: str) -> Any:
    """An action of control_msgs; None where that is not installed, or has no such action."""
    try:
        return getattr(import_module('control_msgs.action'), name, None)
    except ImportError:
        return None


def ros_message(type_name: str, **fields: Any) -> Any:
    """A message of rclpy's classes, see `MessageBuilder`."""
    for name, value in fields.items():
        if isinstance(value, np.ndarray):  # as the type that fields take without a loop
            fields[name] = array.array('B', value.tobytes()) if value.dtype == np.uint8 else doubles(value)
        elif name == 'level':
            fields[name] = bytes([value])
    return message_class(type_name)(**fields)


BUILD: Final = MessageBuilder(ros_message)


def pose_from_message(message: PoseMessage) -> Pose:
    """A Pose from geometry_msgs/Pose.

    Raises:
        InvalidInputError: values that are not finite, a quaternion of no usable length, or a position
            further than `FARTHEST` from the frame.
    """
    p, o = message.position, message.orientation
    r = bounded_vector([p.x, p.y, p.z], 3, 'position', FARTHEST, 'm')
    return Pose.from_quaternion(r, [o.x, o.y, o.z, o.w])


def pose_in_base(frame: str, message: PoseMessage, base_link: Pose) -> Pose:
    """The pose in the robot's base, of a message in one of `BASE_FRAMES`.

    Args:
        frame: Of the message's header.
        message: The pose there.
        base_link: See `BaseRobotModel.base_link`.

    Raises:
        InvalidInputError: another frame, or what `pose_from_message` refuses.
    """
    return frame_in_base(frame, base_link) @ pose_from_message(message)


def twist_in_base(message: TwistStamped, base_link: Pose) -> Array:
    """The twist (6,), m/s and rad/s, of a tool along and about the axes of the base.

    Args:
        message: In one of `BASE_FRAMES`.
        base_link: See `BaseRobotModel.base_link`.

    Raises:
        InvalidInputError: another frame, or values that are not finite or beyond `FASTEST`.
    """
    v, w = message.twist.linear, message.twist.angular
    turn = frame_in_base(message.header.frame_id, base_link).T
    twist = bounded_vector([v.x, v.y, v.z, w.x, w.y, w.z], 6, 'twist', FASTEST, 'm/s, rad/s')
    return np.ravel(twist.reshape(2, 3) @ turn.T)


def wrench_from_message(message: WrenchStamped) -> Array:
    """The wrench on the tool, (6,) N and N m, of a geometry_msgs/WrenchStamped in tool0.

    Raises:
        InvalidInputError: it is in another frame.
    """
    if message.header.frame_id != TOOL_FRAME:
        raise InvalidInputError(f'frame {message.header.frame_id!r}: the wrench must be in {TOOL_FRAME}')
    f, m = message.wrench.force, message.wrench.torque
    return np.array([f.x, f.y, f.z, m.x, m.y, m.z])


def diagnostic_status(
    name: str, message: str, *, level: bytes = DiagnosticStatus.OK, hardware_id: str = '', **values: object
) -> DiagnosticStatus:
    """A DiagnosticStatus with its key-value pairs."""
    return BUILD.status(Status(name, message, Level(level[0]), values), hardware_id)


def diagnostic_values(status: DiagnosticStatus) -> dict[str, str]:
    """The key-value pairs of a DiagnosticStatus."""
    return {item.key: item.value for item in status.values}


def number_in(values: Mapping[str, str], key: str, default: float) -> float:
    """A number among the key-value pairs of a DiagnosticStatus; the default where there is none.

    Raises:
        InvalidInputError: a text that is no finite number.
    """
    text = values.get(key, default)
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InvalidInputError(f'{key} = {text!r} must be a finite number')
    return number


def motion_result_message(result: MotionResult, robot: str) -> DiagnosticStatus:
    """A result as it travels on `motion_result`; `robot` is the robot's name."""
    return BUILD.status(result.status, robot)


def motion_result_from_message(status: DiagnosticStatus) -> MotionResult:
    """The result of a message; all details are texts.

    Raises:
        InvalidInputError: a detail that is a number of motions, and here none.
    """
    details = diagnostic_values(status)
    for key in RESULT_NUMBERS:
        number_in(details, key, 0.0)
    id_, code = details.pop('id', ''), details.pop('code', MotionEndedError.code)
    ok, blocked = (status.level == level for level in (DiagnosticStatus.OK, DiagnosticStatus.WARN))
    return MotionResult(id_, ok, status.message, details, blocked, code)
