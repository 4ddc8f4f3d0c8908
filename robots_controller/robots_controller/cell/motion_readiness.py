"""MotionReadiness: whether planner and controller can move the robot of a program that starts by itself."""

from collections.abc import Sequence

from robots_controller.cell.program_host import WATCHED_NODES

PLANNER, CONTROLLER = WATCHED_NODES


class MotionReadiness:
    """What is missing for motions.

    Args:
        expected: Further nodes that have to be there. With any, the controller has to report that it is
            ready, as it does after their first signs of life.
    """

    def __init__(self, expected: Sequence[str]) -> None:
        self._expected = expected
        self._troubles: dict[str, str] = {}  # by the names of the nodes that have reported
        self.reference = False
        """The controller has sent one: a motion is planned from it, and would be refused without."""

    def report(self, name: str, trouble: str) -> None:
        """A node has reported its health, for a person; '' if it is well."""
        if name in WATCHED_NODES:
            self._troubles[name] = trouble and f'{name} ({trouble})'
        elif name in self._expected:
            self._troubles[name] = ''

    def missing(self, *, planner: bool, controller: bool) -> list[str]:
        """What motions need and is not there, for people, if planner and controller take requests or not."""
        reported = not self._expected or CONTROLLER in self._troubles
        present = {
            PLANNER: planner,
            CONTROLLER: self.reference and controller and reported,
            **{name: name in self._troubles for name in self._expected},
        }
        missing = [name for name, there in present.items() if not there]
        return missing + [trouble for name, trouble in self._troubles.items() if trouble and present[name]]
