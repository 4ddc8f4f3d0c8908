"""MotionPorts: what moves the robot of a program."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from robots_controller.cell.ports import ControllerPort, PlannerPort
from robots_controller.nodes.autostart import Readiness
from robots_core.blocks.following.guide import Guide


@dataclass(frozen=True)
class MotionPorts:
    """The ports of a program's host to planner and controller.

    Attributes:
        planner: Plans motions.
        controller: Follows them.
        report: Begins to report to the host.
        readiness: Makes what autostart waits for, of the names of nodes that are expected.
        end: Ends what moves the robot, when the node ends.
        check_guide: Raises a RobotsError where nothing can guide the robot.
    """

    planner: PlannerPort
    controller: ControllerPort
    report: Callable[[], object]
    readiness: Callable[[Sequence[str]], Readiness]
    end: Callable[[], object] = lambda: None
    check_guide: Callable[[Guide], object] = lambda _: None
