"""ForeignWriters: stops the robot while another node writes to its drives."""

from __future__ import annotations

from typing import Final

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import Fault
from robots_core.ros.peers.presence import publishers_of
from robots_core.ros.robot_node import RobotNode

TOPICS: Final = ('joint_reference', 'drives_on')
PERIOD: Final = 0.1  # s between looks for others that publish these


class ForeignWriters:
    """Looks for publishers: not all drives can tell references of other nodes apart.

    Args:
        node: The controller's node.
        control: What is stopped.
    """

    def __init__(self, node: RobotNode, control: ControlLoop) -> None:
        self._node, self._control = node, control
        self._known: set[str] = set()
        node.create_timer(PERIOD, self._look)

    def _look(self) -> None:
        writers = {name for topic in TOPICS for name in publishers_of(self._node, topic).values()}
        # What a restart has left behind has this name.
        foreign = writers - {self._node.get_fully_qualified_name()}
        if foreign != self._known:
            reason = f'{", ".join(sorted(foreign))} publishes {" or ".join(TOPICS)}'
            self._control.watch(Fault.FOREIGN_WRITER, reason if foreign else '')
        self._known = foreign
