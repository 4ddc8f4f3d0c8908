"""Motions that a node commands outside of robot programs, such as a client or a pendant."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticStatus

from robots_controller.cell.program_motions import ProgramMotions
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.nodes.ports.program.program_clock import ProgramClock
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import RobotsError
from robots_core.ros.messages import motion_result_from_message
from robots_core.ros.qos import subscribe
from robots_core.ros.timed_node import TimedNode

CANCEL = 'controller_node/cancel'


def commanded_motions(
    node: TimedNode,
    planner: PlannerClient,
    send: Callable[[str], None],
    on_result: Callable[[str, MotionCommand, RobotsError | None], None],
    *,
    patience: float,
) -> ProgramMotions:
    """Motions that get their results from `motion_result`; the owner calls `watch` now and then.

    Args:
        node: The node to subscribe from.
        planner: Of the same node.
        send: Calls a service of the cell without waiting for its answer.
        on_result: A motion has ended: its id, its command, and why it failed.
        patience: Longest wait for the planner, s.
    """
    motions = ProgramMotions(
        planner,
        lambda: send(CANCEL),
        ProgramClock(node),
        planner_timeout=patience,
        on_sent=lambda _id, _command: None,
        on_result=on_result,
    )
    subscribe(
        node,
        DiagnosticStatus,
        'motion_result',
        lambda message: motions.result(motion_result_from_message(message)),
    )
    return motions
