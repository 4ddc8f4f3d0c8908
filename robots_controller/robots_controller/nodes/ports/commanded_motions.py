"""Motions that a node commands outside of robot programs, such as a client or a pendant."""

from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticStatus

from robots_controller.cell.program_motions import ProgramMotions
from robots_controller.client.cell_services import CellServices
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.nodes.ports.program.program_clock import ProgramClock
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import RobotsError
from robots_core.ros.messages import motion_result_from_message
from robots_core.ros.qos import subscribe

CANCEL = 'controller_node/cancel'


def commanded_motions(
    services: CellServices,
    planner: PlannerClient,
    on_result: Callable[[str, MotionCommand, RobotsError | None], None],
) -> ProgramMotions:
    """Motions that get their results from `motion_result`; the owner calls `watch` now and then.

    Args:
        services: Of the cell, with the patience for the planner too.
        planner: Of the same node.
        on_result: A motion has ended: its id, its command, and why it failed.
    """
    motions = ProgramMotions(
        planner,
        lambda: services.send(CANCEL),
        ProgramClock(services.node),
        planner_timeout=services.patience,
        on_sent=lambda _id, _command: None,
        on_result=on_result,
    )
    subscribe(
        services.node,
        DiagnosticStatus,
        'motion_result',
        lambda message: motions.result(motion_result_from_message(message)),
    )
    return motions
