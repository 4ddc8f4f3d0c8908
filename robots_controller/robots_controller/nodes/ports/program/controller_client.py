"""ControllerClient: a program's requests to controller_node, and what that reports of the robot."""

import threading
from collections.abc import Callable
from functools import partial
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool, Trigger

from robots_controller.cell.program_host import ProgramHost
from robots_controller.control.controller_request import ControllerRequest
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.ros.peers.presence import is_served
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode

MISSING_SHOWN = 5.0  # s
ANSWER_TIME = 2.0  # s
POLL = 0.01  # s: ROS reports no service that appears


class ControllerClient:
    """See `ControllerPort`; safe from any thread."""

    def __init__(self, node: RobotNode) -> None:
        self._node = node
        self._requests = {
            name: node.create_client(Trigger, f'controller_node/{name}')
            for name in ('pause', 'resume', 'cancel')
        }
        self._commander = node.create_client(SetBool, 'controller_node/commander/program')
        self._override = make_publisher(node, Float64, 'override')
        self._taken = self._asked = False
        self._answered = threading.Event()

    @property
    def works(self) -> bool:
        """The controller serves requests."""
        return is_served(self._node, self._requests['cancel'])

    def report_to(self, host: ProgramHost, changed: Callable[[], None]) -> None:
        """Report to a program's host; `changed` is called after each report."""
        self._host, self._changed = host, changed

        def stopped(message: DiagnosticStatus) -> None:
            host.stop_changed('' if message.level == DiagnosticStatus.OK else message.message)

        takers: dict[str, tuple[Any, Callable[[Any], object]]] = {
            'stop_status': (DiagnosticStatus, stopped),
            'commander': (String, self._on_commander),
            'operating_mode': (String, lambda one: host.mode_changed(OperatingMode(one.data))),
            'run_enabled': (Bool, lambda one: host.run_enabled(enabled=one.data)),
        }
        for topic, (message_type, take) in takers.items():
            subscribe(self._node, message_type, topic, partial(self._report, take))

    def _report(self, take: Callable[[Any], object], message: Any) -> None:
        take(message)
        self._changed()

    def request(self, request: ControllerRequest) -> None:
        """See `ControllerPort`."""
        client = self._requests[request]
        if is_served(self._node, client):
            client.call_async(Trigger.Request())
        else:
            self._node.journal.warning(
                f'controller_node/{request} is not there: is controller_node running?',
                throttle_duration_sec=MISSING_SHOWN,
            )

    def command(self, *, taken: bool) -> None:
        """See `ControllerPort`; a controller that comes later is asked then."""
        self._taken = taken
        answered = self._answered = threading.Event()
        self._asked = is_served(self._node, self._commander)
        if self._asked:
            future = self._commander.call_async(SetBool.Request(data=taken))
            future.add_done_callback(partial(self._on_answer, answered))

    def wait_for_command(self) -> None:
        """See `ControllerPort`; in simulated time the answer comes before a motion is planned."""
        if self._node.simulated_time:
            return
        deadline = self._node.now() + ANSWER_TIME
        while not self._answered.wait(POLL) and self._node.now() < deadline:
            # Planner and controller may have found each other before this node has found the controller.
            if not self._asked:
                self.command(taken=True)
        self._answered.set()  # where none answers, the next motion does not wait again

    def set_override(self, value: float) -> None:
        """See `ControllerPort`."""
        self._override.publish(Float64(data=value))

    def _on_answer(self, answered: threading.Event, future: Any) -> None:
        answer = future.result()
        if self._taken and answer is not None and not answer.success:
            self._taken = False  # the program asks again when it is resumed
            self._host.lose_robot(answer.message)
            self._changed()
        answered.set()

    def _on_commander(self, message: String) -> None:
        commander = Commander(message.data)
        if commander is Commander.NOBODY and self._taken:  # of a controller that was restarted
            self.command(taken=True)
        self._host.permission.commander_changed(commander)
