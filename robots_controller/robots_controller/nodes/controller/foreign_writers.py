"""ForeignWriters: stops the robot while another node writes to what moves it, and cannot be distinguished."""

from __future__ import annotations

from typing import Final

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import Fault
from robots_core.cell_interface.topic_writers import WRITERS
from robots_core.ros.peers.identified_messages import publishers_are_identified
from robots_core.ros.peers.presence import publishers_of
from robots_core.ros.robot_node import RobotNode

TO_DRIVES: Final = ('joint_reference', 'drives_on')
OTHERS: Final = ('joint_states', 'joint_trajectory', 'motion_result')
PERIOD: Final = 0.1  # s between searches for others that publish these


class ForeignWriters:
    """Looks for publishers that have no place on a topic.

    Not all drives can tell references of other nodes apart. On the other topics messages of other nodes are
    dropped, where the middleware identifies their publishers; without that, these stop the robot too.

    Args:
        node: The controller's node.
        control: What is stopped.
        identified: The middleware identifies publishers.
    """

    def __init__(self, node: RobotNode, control: ControlLoop, *, identified: bool | None = None) -> None:
        self._node, self._control = node, control
        identified = publishers_are_identified() if identified is None else identified
        self._topics = TO_DRIVES if identified else (*TO_DRIVES, *OTHERS)
        self._known: dict[str, set[str]] = {}
        node.create_timer(PERIOD, self._check)

    def _check(self) -> None:
        found = {topic: names for topic in self._topics if (names := self._foreign(topic))}
        if found != self._known:
            reason = '; '.join(
                f'{", ".join(sorted(names))} publishes {topic}' for topic, names in found.items()
            )
            self._control.watch(Fault.FOREIGN_WRITER, reason)
        self._known = found

    def _foreign(self, topic: str) -> set[str]:
        names = {*publishers_of(self._node, topic).values()}
        return WRITERS[topic].foreign(names, self._node.get_namespace(), places=topic not in TO_DRIVES)
