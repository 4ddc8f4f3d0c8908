"""ForeignWriters: nodes that publish what moves the robot, and have no place there."""

from collections.abc import Callable
from typing import Final

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import Fault
from robots_core.cell_interface.topic_writers import WRITERS

TO_DRIVES: Final = ('joint_reference', 'drives_on')
OTHERS: Final = ('joint_states', 'joint_trajectory', 'motion_result')


class ForeignWriters:
    """Stops the robot while there are any.

    Not all drives can tell references of other nodes apart. On the other topics messages of other nodes are
    dropped, where the middleware identifies their publishers; without that, these stop the robot too.

    Args:
        control: Stops the robot.
        namespace: Where the suite's nodes are.
        identified: The middleware identifies publishers.
    """

    def __init__(self, control: ControlLoop, namespace: str, *, identified: bool) -> None:
        self._control, self._namespace, self._identified = control, namespace, identified
        self._topics = TO_DRIVES if identified else (*TO_DRIVES, *OTHERS)
        self._known: dict[str, set[str]] = {}

    def suspected(self, count: Callable[[str], int]) -> bool:
        """There may be some, or no more, by the number of publishers of a topic: names take longer."""
        # The numbers include the controller itself.
        return bool(self._known) or not self._identified or any(count(topic) > 1 for topic in TO_DRIVES)

    def check(self, publishers: Callable[[str], set[str]]) -> None:
        """Look at the full names of the nodes that publish a topic."""
        found = {topic: names for topic in self._topics if (names := self._foreign(topic, publishers(topic)))}
        if found != self._known:
            reason = '; '.join(
                f'{", ".join(sorted(names))} publishes {topic}' for topic, names in found.items()
            )
            self._control.watch(Fault.FOREIGN_WRITER, reason)
        self._known = found

    def _foreign(self, topic: str, names: set[str]) -> set[str]:
        return WRITERS[topic].foreign(names, self._namespace, places=topic not in TO_DRIVES)
