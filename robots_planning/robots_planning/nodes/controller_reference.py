"""ControllerReference: where the controller's reference is, and whether it moves."""

from threading import Lock

from trajectory_msgs.msg import JointTrajectory

from robots_core.ros.joint_trajectories import single_point
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.validation import Array

TOPIC = 'joint_reference'


class ControllerReference:
    """Follows `joint_reference` when it is asked for; safe from any thread."""

    def __init__(self, node: RobotNode) -> None:
        self._node, self._names = node, list(node.robot.axes_data.names)
        self._subscription = PolledSubscription(node, JointTrajectory, TOPIC)
        self._lock = Lock()
        self._newest: tuple[Array, Array] | None = None
        self._rests = True

    def newest(self) -> tuple[Array, Array] | None:
        """Position, rad (m), and velocity, rad/s (m/s), (n,) each; None before the first one.

        Raises:
            InvalidInputError: it is not a reference of this robot.
        """
        with self._lock:
            message = self._subscription.take()
            if message is not None:
                q, q_dot, q_ddot = single_point(message, self._names, TOPIC)
                # A stream that turns round accelerates where it has no velocity.
                self._newest, self._rests = (q, q_dot), not (q_dot.any() or q_ddot.any())
            return self._newest

    @property
    def moves(self) -> bool:
        """It moves, whatever the reason."""
        with self._node.refusing(TOPIC):
            self.newest()
        return not self._rests
