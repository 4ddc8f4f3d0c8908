"""MotionClient: sends a program's motions to the planning node and hears how they end."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any, Final

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from nav_msgs.msg import Path
from rclpy.node import Node
from std_srvs.srv import Trigger

from robots_controller.nodes.planner_settings import BLEND_ZONES, PlannerSettings
from robots_controller.program.motion_command import MotionCommand
from robots_core.errors import PlanningError, RobotsError
from robots_core.ros.message_class import message_class
from robots_core.ros.messages import (
    joint_state_message,
    motion_result_from_message,
    pose_stamped_message,
    stamp_id,
)
from robots_core.ros.qos import COMMAND
from robots_planning.motion_kinds import JOINT, MOTION_KINDS, MotionKind

# A node restarts in about this time; a robot that nobody plans for must not be waited for longer.
LOST_TIMEOUT: Final = 2.0  # s
WATCH_PERIOD: Final = 0.1  # s
# Motions on their way at once: fewer than the controller queues and than the middleware keeps of commands.
MOST_SENT: Final = 50
UNKNOWN_NODE: Final = '_NODE_NAME_UNKNOWN_'


class MotionClient:
    """Motions in their order: sent when somebody plans them, ended by their results or when nobody is left.

    A motion is sent at once; the program sends the next one before its end only if they blend. Before a
    motion, planning_node gets the settings it was commanded with, if they have changed.

    Args:
        node: The node to speak through.
        joint_names: The robot's joints.
        planner_timeout: Longest wait for a node that plans, s.
        on_sent: A motion was sent, with its id.
        on_result: A motion ended; its id ('' if it was not sent), and None, or why the robot is not at the
            target. Called from the executor's thread.
    """

    def __init__(
        self,
        node: Node,
        *,
        joint_names: tuple[str, ...],
        planner_timeout: float,
        on_sent: Callable[[str, MotionCommand], None],
        on_result: Callable[[str, MotionCommand, RobotsError | None], None],
    ) -> None:
        self._node = node
        self._joint_names = joint_names
        self._planner_timeout = planner_timeout
        self._on_sent = on_sent
        self._on_result = on_result
        # Entered again by an answer of the planner that is there at once.
        self._lock = threading.RLock()
        self._last_stamp = 0
        self._unsent: deque[MotionCommand] = deque()
        self._sent: dict[str, MotionCommand] = {}  # by id, oldest first
        self._settings = PlannerSettings(node)
        self._setting: MotionCommand | None = None  # whose settings are on their way
        self._flush = False
        self._planners: set[bytes] = set()  # endpoints of those who plan
        self._since = 0.0  # when the command came, or when all its servers were last seen
        self._servers: dict[bytes, str] = {}  # who could end the motion: endpoint and its node
        self._stopping = False
        self._publishers = {
            kind: node.create_publisher(message_class(kind.message_type), kind.topic, COMMAND)
            for kind in MOTION_KINDS
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
            if not self._unsent:
                self._since = time.monotonic()
            self._unsent.append(command)
            self._stopping = self._flush = False
            self._send_planned()

    def flush(self) -> None:
        """No motion follows for now: a planner need not wait for the next one to blend into."""
        with self._lock:
            self._flush = True
            self._send_planned()

    def stop(self) -> None:
        """Give up all motions; the results of those that were sent still come."""
        with self._lock:
            # A motion that is being planned reaches the controller after its stop: `_watch` repeats it.
            self._stopping = bool(self._sent)
            unsent = list(self._unsent)
            self._unsent.clear()
            self._setting = None
        self.ask_controller('stop')
        for command in unsent:
            self._on_result('', command, PlanningError('stopped before it began'))

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

    def planner_listens(self, kind: MotionKind = JOINT) -> bool:
        """A node that publishes `joint_trajectory` is subscribed to a motion's topic.

        The number of subscriptions alone says nothing: a recorder has them too.
        """
        publishers = self._node.get_publishers_info_by_topic('joint_trajectory')
        planners = _names(publishers)
        endpoints = {bytes(endpoint.endpoint_gid) for endpoint in publishers}
        if endpoints - self._planners:  # one that was started anew has not heard our settings
            self._settings.forget()
        self._planners = endpoints
        return bool(planners & _names(self._node.get_subscriptions_info_by_topic(kind.topic)))

    # -- both threads, locked -------------------------------------------------------------------

    @property
    def _full(self) -> bool:
        return len(self._sent) >= MOST_SENT

    def _send_planned(self) -> None:
        while self._unsent and self._setting is None and not self._full:
            command = self._unsent[0]
            if not self.planner_listens(command.kind):
                return
            if self._settings.differ(command.settings):
                if not self._settings.ready:
                    return
                self._setting = command
                done = partial(self._on_settings, command)
                self._settings.apply(command.settings, done, moving=bool(self._sent))
                return
            self._publish(self._unsent.popleft())
        if self._flush and not self._unsent and self._sent and self._setting is None and self._settings.ready:
            self._flush = False
            last = next(reversed(self._sent.values()))
            settings = {**last.settings, **dict.fromkeys(BLEND_ZONES, 0.0)}
            self._settings.apply(settings, lambda _: None, moving=True)

    def _on_settings(self, command: MotionCommand, error: PlanningError | None) -> None:
        with self._lock:
            if self._setting is not command:  # given up meanwhile
                return
            self._setting = None
            if error is None:
                self._publish(self._unsent.popleft())
                self._send_planned()
                return
            self._unsent.clear()
        self._on_result('', command, error)

    def _publish(self, command: MotionCommand) -> None:
        stamp = self._next_stamp()
        if command.q is not None:
            message: Any = joint_state_message(stamp, self._joint_names, command.q)
        elif command.path:
            message = Path(poses=[pose_stamped_message(stamp, pose) for pose in command.path])
            message.header = message.poses[0].header
        else:
            assert command.pose is not None
            message = pose_stamped_message(stamp, command.pose)
        id_ = stamp_id(stamp)
        self._sent[id_] = command
        self._since, self._servers = time.monotonic(), self._result_servers()
        self._on_sent(id_, command)
        self._publishers[command.kind].publish(message)

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
        result = motion_result_from_message(message)
        with self._lock:
            command = self._sent.pop(result.id, None)
            if command is None:
                return
            before = {}
            if result.ok:  # those before it have ended too
                before = {id_: one for id_, one in self._sent.items() if _number(id_) < _number(result.id)}
                for id_ in before:
                    del self._sent[id_]
            if not self._sent:
                self._stopping = False
            if result.ok:
                self._since = time.monotonic()
                self._send_planned()
        error = None
        if not result.ok:
            error = RobotsError(result.message)
            error.details.update(result.details)
        for id_, one in before.items():
            self._on_result(id_, one, None)
        self._on_result(result.id, command, error)

    def _watch(self) -> None:
        with self._lock:
            now, stopping = time.monotonic(), self._stopping
            waiting = self._unsent and not self._full
            problem = self._unplanned(now) if waiting else self._lost(now)
            given_up = list(self._sent.items()) + [('', command) for command in self._unsent]
            if problem:
                self._sent.clear()
                self._unsent.clear()
                self._setting, self._stopping = None, False
        if problem:
            for id_, command in given_up:
                self._on_result(id_, command, PlanningError(problem))
            self.ask_controller('stop')
        elif stopping:
            self.ask_controller('stop')

    def _unplanned(self, now: float) -> str:
        self._send_planned()
        if not self._unsent or now - self._since < self._planner_timeout:
            return ''
        if self._setting is not None:
            return f'planning_node has not answered for {self._planner_timeout:g} s: is it still running?'
        return (
            f'nobody plans {self._unsent[0].kind.topic} within {self._planner_timeout:g} s: planning_node is '
            'not running, or in another namespace'
        )

    def _lost(self, now: float) -> str:
        if not self._sent:
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


def _number(id_: str) -> int:
    return int(id_.replace('.', ''))


def _names(endpoints: list[Any]) -> set[str]:
    return {
        f'{endpoint.node_namespace.rstrip("/")}/{endpoint.node_name}'
        for endpoint in endpoints
        if endpoint.node_name != UNKNOWN_NODE
    }
