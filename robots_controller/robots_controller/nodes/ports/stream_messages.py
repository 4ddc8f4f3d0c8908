"""One-point trajectory_msgs/JointTrajectory to a StreamPoint."""

from trajectory_msgs.msg import JointTrajectory

from robots_controller.control.streamed_reference import StreamPoint
from robots_core.ros.joint_trajectories import single_point
from robots_core.ros.messages import NANOSECONDS, nanoseconds


def stream_point_from_message(
    message: JointTrajectory, names: list[str], *, ros_time: int, now: float
) -> StreamPoint:
    """The point of a message, joints matched by name.

    It is due `time_from_start` after the message's stamp, or from now without a stamp, as in ros2_control.
    Velocity and acceleration are zero where they are missing.

    Args:
        message: With one point.
        names: The robot's joints, n of them.
        ros_time: Time on the clock of the message's stamp, ns.
        now: The same instant on the controller's clock, s.

    Raises:
        InvalidInputError: missing joints, arrays of other lengths, or values that are not finite.
    """
    position, velocity, acceleration = single_point(message, names, 'joint_trajectory')
    (point,) = message.points
    ahead = nanoseconds(point.time_from_start)
    if sent := nanoseconds(message.header.stamp):
        ahead += sent - ros_time
    due = (round(now * NANOSECONDS) + ahead) / NANOSECONDS
    return StreamPoint(position, velocity, acceleration, due)
