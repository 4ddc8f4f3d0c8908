"""trajectory_msgs/MultiDOFJointTrajectory to the motion of a robot's base."""

from geometry_msgs.msg import Vector3
from trajectory_msgs.msg import MultiDOFJointTrajectory

from robots_core.blocks.multibody.base_motion import BaseMotion
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector

WORLD_FRAME = 'world'


def base_motion_from_message(message: MultiDOFJointTrajectory) -> BaseMotion:
    """How the base moves: one joint, one point.

    The transform is that of the base in frame `world` (or none); its place has no effect. Velocity and
    acceleration are in base axes, the acceleration is without gravity; either may be left out at rest. What
    is linear in the velocity has no effect.

    Raises:
        InvalidInputError: another count, frame, or values that are not finite or no orientation.
    """
    if message.header.frame_id not in {'', WORLD_FRAME}:
        raise InvalidInputError(
            f'the base moves in frame {message.header.frame_id!r}; it must be {WORLD_FRAME!r}'
        )
    if len(message.points) != 1 or len(message.points[0].transforms) != 1:
        raise InvalidInputError('the motion of a base is one point with one transform')
    point = message.points[0]
    for name in ('velocities', 'accelerations'):
        if len(getattr(point, name)) > 1:
            raise InvalidInputError(f'{len(getattr(point, name))} {name} came; a base has one or none')
    o = point.transforms[0].rotation
    values = {}
    if point.velocities:
        values['angular_velocity'] = _vector(point.velocities[0].angular, 'angular velocity')
    if point.accelerations:
        values['acceleration'] = _vector(point.accelerations[0].linear, 'acceleration')
        values['angular_acceleration'] = _vector(point.accelerations[0].angular, 'angular acceleration')
    return BaseMotion(Pose.from_quaternion([0.0, 0.0, 0.0], [o.x, o.y, o.z, o.w]).T, **values)


def _vector(vector: Vector3, name: str) -> Array:
    return finite_vector([vector.x, vector.y, vector.z], 3, name)
