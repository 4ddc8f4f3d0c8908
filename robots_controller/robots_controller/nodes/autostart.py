"""Autostart: starts the program when everything that its motions need is there, however long that takes."""

from collections.abc import Callable, Sequence
from typing import Final, Protocol

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.ports.program.controller_client import ControllerClient
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.runtime_folder import first_time
from robots_core.errors import RobotsError
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode

PERIOD: Final = 0.1  # s
REPORT_PERIOD: Final = 5.0  # s
NEEDED: Final = ('planning_node', 'controller_node')


class MotionReadiness:
    """Whether planner and controller can move the robot.

    Args:
        node: The program's node.
        planner: Sends motions.
        controller: Sends requests to the controller.
        expected: Further nodes that have to be there. With any, the controller has to report that it is
            ready, as it does after their first signs of life.
    """

    def __init__(
        self,
        node: RobotNode,
        planner: PlannerClient,
        controller: ControllerClient,
        expected: Sequence[str] = (),
    ) -> None:
        self._node, self._planner, self._controller = node, planner, controller
        self._expected = expected
        self._controller_works = False
        self._troubles: dict[str, str] = {}
        self._subscriptions = [
            subscribe(node, JointTrajectory, 'joint_reference', self._on_reference),
            subscribe(node, DiagnosticArray, '/diagnostics', self._on_health),
        ]

    def _on_reference(self, _: JointTrajectory) -> None:
        # A motion is planned from the reference: without one it would be refused.
        self._controller_works = True

    def _on_health(self, message: DiagnosticArray) -> None:
        prefix = self._node.get_namespace().rstrip('/') + '/'
        for status in message.status:
            name = status.name.removeprefix(prefix)
            if name in NEEDED:
                well = status.level == DiagnosticStatus.OK
                self._troubles[name] = '' if well else f'{name} ({status.message})'
            elif name in self._expected:
                self._troubles[name] = ''

    def missing(self) -> list[str]:
        """What motions need and is not there, for people."""
        planner = self._planner
        reported = not self._expected or 'controller_node' in self._troubles
        present = {
            'planning_node': planner.listens() and planner.configurable and bool(planner.followers()),
            'controller_node': self._controller_works and self._controller.works and reported,
            **{name: name in self._troubles for name in self._expected},
        }
        missing = [name for name, there in present.items() if not there]
        return missing + [trouble for name, trouble in self._troubles.items() if trouble and present[name]]

    def close(self) -> None:
        """Listen no longer."""
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)


class Readiness(Protocol):
    """What is watched until the robot can move."""

    def missing(self) -> list[str]:
        """What motions need and is not there, for people."""

    def close(self) -> None:
        """It is not watched any longer."""


class Autostart:
    """Waits until the robot can move, and starts the program once in each launch.

    A node that a supervisor restarts does not run its program: people near the robot do not expect it to
    move then.

    Args:
        node: The program's node.
        readiness: Makes what is watched, if it is wanted, of the names of the expected nodes.
        start: Opens and runs the program.

    Parameters:
        autostart: It is wanted.
        launch: Names the launch; '' for one that begins with this node.
        expected_nodes: Nodes of the cell that the robot does not move without.
    """

    def __init__(
        self, node: RobotNode, readiness: Callable[[Sequence[str]], Readiness], start: Callable[[], None]
    ) -> None:
        self._node, self._start = node, start
        self._said, self._said_at = '', 0.0
        wanted = node.parameter('autostart', False, 'open and run the program as soon as the robot can move')
        launch = node.parameter('launch', '', 'autostart runs the program once for each of these names')
        expected = node.parameter(
            'expected_nodes', [''], "nodes that autostart waits for too, as 'collision_node'"
        )
        if not wanted:
            return
        try:
            again = bool(launch) and not first_time(f'autostart {launch}')
        except RobotsError as error:
            node.journal.error(f'no autostart: {error}')
            return
        if again:
            node.journal.warning(
                'no autostart: this node has been started anew since the launch; ~/open and ~/run start '
                'the program'
            )
            return
        self._readiness = readiness([name for name in expected if name])
        self._timer = node.create_timer(PERIOD, self._check)

    def _check(self) -> None:
        if missing := self._readiness.missing():
            text, now = f'autostart waits for {" and ".join(missing)}', self._node.now()
            if text != self._said or now - self._said_at >= REPORT_PERIOD:
                self._said, self._said_at = text, now
                self._node.journal.warning(text)
            return
        self._node.destroy_timer(self._timer)
        self._readiness.close()
        self._start()
