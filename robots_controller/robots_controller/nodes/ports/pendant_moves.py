"""PendantMoves: motions of the operator's page on their way to planning_node, as the commander PENDANT."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

from std_srvs.srv import SetBool

from robots_controller.cell.ports import Configured
from robots_controller.client.cell_services import CellServices
from robots_controller.nodes.ports.commanded_motions import CANCEL, commanded_motions
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.pendant.jog.pendant_move import PendantMove
from robots_core.ros.robot_node import RobotNode
from robots_planning.motion_settings import PENDANT, PENDANT_SETTINGS

TAKE: Final = 'controller_node/commander/pendant'
WATCH_PERIOD: Final = 0.1  # s


class PendantPlanner(PlannerClient):
    """A planner with settings for motions of the pendant alone; those of programs are not touched."""

    def differs(self, settings: Mapping[str, object]) -> bool:
        """See `PlannerPort`."""
        return super().differs(_of_pendant(settings))

    def configure(self, settings: Mapping[str, object], done: Configured, *, moving: bool) -> None:
        """See `PlannerPort`."""
        super().configure(_of_pendant(settings), done, moving=moving)


def _of_pendant(settings: Mapping[str, object]) -> dict[str, object]:
    return {f'{PENDANT}{name}': settings[name] for name in PENDANT_SETTINGS}


class PendantMoves:
    """A `MovePort`: its `move` commands the motions.

    Args:
        node: The node to publish and to call from; another thread spins it.
        services: Of the cell.
    """

    def __init__(self, node: RobotNode, services: CellServices) -> None:
        self._services = services
        self.move = PendantMove(self, node.now)
        """The motion of the pendant."""
        planner = PendantPlanner(node, node.robot.axes_data.names)
        self._motions = commanded_motions(
            services, planner, lambda _id, command, error: self.move.ended(command, error)
        )
        self.send, self.cancel = self._motions.send, self._motions.cancel
        node.create_timer(WATCH_PERIOD, self._watch)
        services.prepare([CANCEL])
        services.prepare([TAKE], SetBool)

    def take(self, answered: Callable[[str], None]) -> None:
        """See `MovePort`."""
        request = SetBool.Request(data=True)
        self._services.send(
            TAKE, SetBool, request, lambda answer: answered('' if answer.success else answer.message)
        )

    def give_back(self) -> None:
        """See `MovePort`."""
        self._services.send(TAKE, SetBool, SetBool.Request(data=False))

    def _watch(self) -> None:
        self._motions.watch()
        self.move.check()
