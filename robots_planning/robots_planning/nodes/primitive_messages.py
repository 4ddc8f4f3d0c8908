"""Motion primitives as messages of control_msgs."""

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from builtin_interfaces.msg import Time

from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.ros.messages import BUILD, doubles, message_class
from robots_planning.commands.motion_primitives import MotionPrimitive
from robots_planning.motion_kinds import CIRCLE, JOINT, JOINT_TO_POSE, LINE

ACTION_TYPE: Final = 'ExecuteMotionPrimitiveSequence'
LINEAR_JOINT, LINEAR_CARTESIAN, CIRCULAR_CARTESIAN = 0, 50, 51
TYPES: Final = {
    LINEAR_JOINT: 'LINEAR_JOINT',
    LINEAR_CARTESIAN: 'LINEAR_CARTESIAN',
    CIRCULAR_CARTESIAN: 'CIRCULAR_CARTESIAN',
}
TYPE_OF_KIND: Final = {JOINT.name: LINEAR_JOINT, LINE.name: LINEAR_CARTESIAN, CIRCLE.name: CIRCULAR_CARTESIAN}


def primitive_of(message: Any, pose_of: Callable[[Any], Pose]) -> MotionPrimitive:
    """The motion of a control_msgs/MotionPrimitive.

    Raises:
        InvalidInputError: an unknown type, or targets that do not belong to it; names what is valid.
    """
    poses, positions = [pose_of(pose) for pose in message.poses], np.array(message.joint_positions)
    arguments = {argument.name: argument.value for argument in message.additional_arguments}
    if arguments.get('move_time') == 0.0:  # none, as for drivers
        del arguments['move_time']
    if message.type == LINEAR_JOINT and positions.size:
        return MotionPrimitive(JOINT, positions, message.blend_radius, arguments)
    if message.type in {LINEAR_JOINT, LINEAR_CARTESIAN} and len(poses) == 1:
        kind = JOINT_TO_POSE if message.type == LINEAR_JOINT else LINE
        return MotionPrimitive(kind, poses[0], message.blend_radius, arguments)
    if message.type == CIRCULAR_CARTESIAN and len(poses) == 2:
        end, via = poses
        return MotionPrimitive(CIRCLE, (via, end), message.blend_radius, arguments)
    if message.type not in TYPES:
        known = ', '.join(f'{name} ({number})' for number, name in TYPES.items())
        raise InvalidInputError(f'type {message.type} is not known; valid are {known}')
    needed = {
        LINEAR_JOINT: 'joint_positions or 1 pose',
        LINEAR_CARTESIAN: '1 pose',
        CIRCULAR_CARTESIAN: '2 poses, the end and a point on the way',
    }[message.type]
    raise InvalidInputError(
        f'{TYPES[message.type]} needs {needed}, got {len(poses)} poses and {positions.size} joint_positions'
    )


def sequence_message(primitives: Sequence[MotionPrimitive], frame_id: str) -> Any:
    """A control_msgs/MotionPrimitiveSequence.

    Args:
        primitives: The motions; joint motions have joint positions as their targets.
        frame_id: Of the poses.

    Raises:
        InvalidInputError: control_msgs is not installed.
    """
    motions = [_message(primitive, frame_id) for primitive in primitives]
    return message_class('control_msgs/msg/MotionPrimitiveSequence')(motions=motions)


def _message(primitive: MotionPrimitive, frame_id: str) -> Any:
    argument = message_class('control_msgs/msg/MotionArgument')
    message = message_class('control_msgs/msg/MotionPrimitive')(
        type=TYPE_OF_KIND[primitive.kind.name],
        blend_radius=primitive.blend_radius,
        additional_arguments=[
            argument(name=name, value=value) for name, value in primitive.arguments.items()
        ],
    )
    target = primitive.target
    if primitive.kind is JOINT:
        message.joint_positions = doubles(np.asarray(target))
        return message
    poses: list[Any] = list(target) if isinstance(target, tuple) else [target]
    poses.reverse()  # the end stands first
    message.poses = [BUILD.pose_stamped(Time(), pose, frame_id) for pose in poses]
    return message
