"""SuiteMotions: the robot of a program is moved by planning_node and controller_node."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from trajectory_msgs.msg import JointTrajectory

from robots_controller.cell.motion_readiness import MotionReadiness
from robots_controller.cell.program_host import WATCHED_NODES, ProgramHost
from robots_controller.nodes.autostart import Missing
from robots_controller.nodes.ports.program.controller_client import ControllerClient
from robots_controller.nodes.ports.program.path_switching_messages import PathSwitchingMessages
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_core.blocks.following.guide import Guide
from robots_core.ros.messages import motion_result_from_message
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode


class SuiteMotions:
    """Planner and controller of a program's host; for `held_up` see `PlannerClient`."""

    def __init__(self, node: RobotNode, held_up: Callable[[], bool]) -> None:
        self._node = node
        self.planner = PlannerClient(node, node.robot.axes_data.names, held_up)
        """Plans motions."""
        self.controller = ControllerClient(node)
        """Follows them."""

    def report_to(self, host: ProgramHost, changed: Callable[[], None], watchdog: float) -> None:
        """Report to a program's host from now on; `changed` is called after each report."""
        node = self._node
        PathSwitchingMessages(node, host.switching, node.robot.axes_data.names)

        def ended(message: DiagnosticStatus) -> None:
            host.motions.result(motion_result_from_message(message))
            changed()

        subscribe(node, DiagnosticStatus, 'motion_result', ended)
        self.controller.report_to(host, changed)
        self.watch = HeartbeatWatch(node, WATCHED_NODES, watchdog, host.node_changed)

    def watch_readiness(self, expected: Sequence[str]) -> Missing:
        """Watch what autostart waits for, see `MotionReadiness`, until nothing is missing."""
        node, readiness = self._node, MotionReadiness(expected)
        prefix = node.get_namespace().rstrip('/') + '/'

        def on_reference(_: JointTrajectory) -> None:
            readiness.reference = True

        def on_health(message: DiagnosticArray) -> None:
            for status in message.status:
                trouble = '' if status.level == DiagnosticStatus.OK else status.message
                readiness.report(status.name.removeprefix(prefix), trouble)

        subscriptions = (
            subscribe(node, JointTrajectory, 'joint_reference', on_reference),
            subscribe(node, DiagnosticArray, '/diagnostics', on_health),
        )

        def missing() -> list[str]:
            planner = self.planner
            plans = planner.listens() and planner.configurable and bool(planner.followers())
            found = readiness.missing(planner=plans, controller=self.controller.works)
            for subscription in () if found else subscriptions:
                node.destroy_subscription(subscription)
            return found

        return missing

    def check_guide(self, guide: Guide) -> None:
        """Whatever guides the robot, planner and controller can follow."""

    def end(self) -> None:
        """Motions end with the program."""
