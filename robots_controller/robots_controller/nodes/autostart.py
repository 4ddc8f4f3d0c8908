"""Autostart: starts the program when everything that its motions need is there, however long that takes."""

from collections.abc import Callable, Sequence
from typing import Final

from robots_controller.runtime_folder import first_time
from robots_core.errors import RobotsError
from robots_core.ros.robot_node import RobotNode

PERIOD: Final = 0.1  # s
REPORT_PERIOD: Final = 5.0  # s


Missing = Callable[[], list[str]]
"""Gives what motions need and is not there, for people; not called any more when nothing is missing."""


class Autostart:
    """Waits until the robot can move, and starts the program once in each launch.

    A node that a supervisor restarts does not run its program: people near the robot do not expect it to
    move then.

    Args:
        watch_readiness: Called if autostart is wanted, with the names of the expected nodes.
        start: Opens and runs the program.

    Parameters:
        autostart: It is wanted.
        launch: Names the launch; '' for one that begins with this node.
        expected_nodes: Nodes of the cell that the robot does not move without.
    """

    def __init__(
        self, node: RobotNode, watch_readiness: Callable[[Sequence[str]], Missing], start: Callable[[], None]
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
        self._missing = watch_readiness([name for name in expected if name])
        self._timer = node.create_timer(PERIOD, self._check)

    def _check(self) -> None:
        if missing := self._missing():
            text, now = f'autostart waits for {" and ".join(missing)}', self._node.now()
            if text != self._said or now - self._said_at >= REPORT_PERIOD:
                self._said, self._said_at = text, now
                self._node.journal.warning(text)
            return
        self._node.destroy_timer(self._timer)
        self._start()
