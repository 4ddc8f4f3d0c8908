"""MotionClient: sends a program's motions to the planning node and hears how they end."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, Final

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from robots_controller.interpreter.program_state import MotionCommand
from robots_core.errors import PlanningError, RobotsError
from robots_core.nodes.messages import MotionResult, joint_state_message, pose_stamped_message, stamp_id
from robots_core.nodes.qos import COMMAND
from robots_planning.robot_command_state import RobotCommandState

# A node restarts in about this time; a robot that nobody plans for must not be waited for longer.
LOST_TIMEOUT: Final = 2.0  # s
WATCH_PERIOD: Final = 0.1  # s
UNKNOWN_NODE: Final = '_NODE_NAME_UNKNOWN_'

_TOPICS: Final[dict[RobotCommandState, tuple[str, Any]]] = {
    RobotCommandState.PTPJOINT_JOINT: ('ptpjoint_joint', JointState),
    RobotCommandState.PTPJOINT_CARTESIAN: ('ptpjoint_cartesian', PoseStamped),
    RobotCommandState.PTPCARTESIAN: ('ptpcartesian', PoseStamped),
}


class MotionClient:
    """One motion at a time: sent when somebody plans it, ended by its result or when that somebody is gone.

    Args:
        node: The node to speak through.
        joint_names: The robot's joints.
        planner_timeout: Longest wait for a node that plans, s.
        on_result: The motion ended; None, or why the robot does not stand at the target. Called from the
            executor's thread.
    """

    def __init__(
        self,
        node: Node,
        *,
        joint_names: tuple[str, ...],
        planner_timeout: float,
        on_result: Callable[[RobotsError | None], None],
    ) -> None:
        self._node = node
        self._joint_names = joint_names
        self._planner_timeout = planner_timeout
        self._on_result = on_result
        self._lock = threading.Lock()
        self._last_stamp = 0
        self._command: MotionCommand | None = None  # to be sent
        self._id = ''  # of the one that was sent
        self._since = 0.0  # when the command came, or when all its servers were last seen
        self._servers: dict[bytes, str] = {}  # who could end the motion: endpoint and its node
        self._stopping = False
        self._publishers = {
            state: node.create_publisher(kind, topic, COMMAND) for state, (topic, kind) in _TOPICS.items()
        }
        node.create_subscription(DiagnosticStatus, 'motion_result', self._on_motion_result, COMMAND)
        self._controller = {
            name: node.create_client(Trigger, f'controller_node/{name}')
            for name in ('pause', 'resume', 'stop')
        }
        node.create_timer(WATCH_PERIOD, self._watch)

    def send(self, command: MotionCommand) -> None:
        """Send a motion, at once or as soon as somebody plans it."""
        with self._lock:
            self._command, self._id, self._since = command, '', time.monotonic()
            self._stopping = False
            self._send_if_planned()

    def stop(self) -> None:
        """Give up the motion; its result still comes, or at once if it was not sent."""
        with self._lock:
            if self._command is None:
                # A motion that is being planned reaches the controller after its stop: `_watch` repeats it.
                self._stopping = bool(self._id)
            unsent, self._command = self._command is not None, None
        self.ask_controller('stop')
        if unsent:
            self._on_result(PlanningError('stopped before it began'))

    def ask_controller(self, service: str) -> None:
        """Call `pause`, `resume` or `stop` of the controller without waiting."""
        client = self._controller[service]
        if client.service_is_ready():
            client.call_async(Trigger.Request())
        else:
            self._node.get_logger().warning(
                f'controller_node/{service} is not there: is controller_node running?',
                throttle_duration_sec=5.0,
            )

    def planner_listens(self, state: RobotCommandState = RobotCommandState.PTPJOINT_JOINT) -> bool:
        """A node that publishes `joint_trajectory` is subscribed to a motion's topic.

        The number of subscriptions alone says nothing: a recorder has them too.
        """
        planners = _names(self._node.get_publishers_info_by_topic('joint_trajectory'))
        return bool(planners & _names(self._node.get_subscriptions_info_by_topic(_TOPICS[state][0])))

    # -- both threads, locked -------------------------------------------------------------------

    def _send_if_planned(self) -> None:
        command = self._command
        if command is None or not self.planner_listens(command.state):
            return
        stamp = self._next_stamp()
        if command.q is not None:
            message: Any = joint_state_message(stamp, self._joint_names, command.q)
        else:
            assert command.pose is not None
            message = pose_stamped_message(stamp, command.pose)
        self._command, self._id = None, stamp_id(stamp)
        self._since, self._servers = time.monotonic(), self._result_servers()
        self._publishers[command.state].publish(message)

    def _next_stamp(self) -> Time:
        # The stamp is the command's id: unique even while a simulated clock stands still.
        self._last_stamp = max(self._node.get_clock().now().nanoseconds, self._last_stamp + 1)
        seconds, nanoseconds = divmod(self._last_stamp, 1_000_000_000)
        return Time(sec=seconds, nanosec=nanoseconds)

    def _result_servers(self) -> dict[bytes, str]:
        # By endpoint: a node that was started anew knows nothing of the motion.
        endpoints = self._node.get_publishers_info_by_topic('motion_result')
        return {bytes(endpoint.endpoint_gid): endpoint.node_name for endpoint in endpoints}

    # -- the executor's thread ------------------------------------------------------------------

    def _on_motion_result(self, message: DiagnosticStatus) -> None:
        result = MotionResult.from_message(message)
        with self._lock:
            if not self._id or result.id != self._id:
                return
            self._id, self._stopping = '', False
        error = None
        if not result.ok:
            error = RobotsError(result.message)
            error.details.update(result.details)
        self._on_result(error)

    def _watch(self) -> None:
        with self._lock:
            now, stopping = time.monotonic(), self._stopping
            problem = self._unplanned(now) if self._command is not None else self._lost(now)
            if problem:
                self._command, self._id, self._stopping = None, '', False
        if problem:
            self._on_result(PlanningError(problem))
            self.ask_controller('stop')
        elif stopping:
            self.ask_controller('stop')

    def _unplanned(self, now: float) -> str:
        self._send_if_planned()
        if self._command is None or now - self._since < self._planner_timeout:
            return ''
        topic = _TOPICS[self._command.state][0]
        return (
            f'nobody plans {topic} within {self._planner_timeout:g} s: planning_node is not running, '
            'or in another namespace'
        )

    def _lost(self, now: float) -> str:
        if not self._id:
            return ''
        present = self._result_servers()
        gone = [name for gid, name in self._servers.items() if gid not in present]
        self._servers |= present
        if self._servers and not gone:
            self._since = now
        if now - self._since < LOST_TIMEOUT:
            return ''
        names = ', '.join(sorted(gone)) or 'everyone who could end the motion'
        return f'{names} has been gone for {LOST_TIMEOUT:g} s while the robot moved: is it still running?'


def _names(endpoints: list[Any]) -> set[str]:
    return {
        f'{endpoint.node_namespace.rstrip("/")}/{endpoint.node_name}'
        for endpoint in endpoints
        if endpoint.node_name != UNKNOWN_NODE
    }
