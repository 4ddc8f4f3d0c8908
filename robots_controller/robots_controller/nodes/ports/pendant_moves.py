"""PendantMoves: motions of the operator's page on their way to planning_node, as the commander PENDANT."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Final

from std_srvs.srv import SetBool

from robots_controller.cell.ports import Configured
from robots_controller.client.cell_services import CellServices
from robots_controller.nodes.ports.commanded_motions import STOP, commanded_motions
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import CommandRefusedError, RobotsError
from robots_core.ros.robot_node import RobotNode
from robots_planning.motion_settings import PENDANT, PENDANT_SETTINGS

TAKE: Final = 'controller_node/commander/pendant'
STANDING_TIME: Final = 1.0  # s, in which a jog before has ended
WATCH_PERIOD: Final = 0.1  # s
Done = Callable[[RobotsError | None], None]


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
    """One motion at a time; safe from any thread.

    The robot is taken for the motion and given back after it: a motion that is left behind by a pendant that
    has died continues with no program.

    Args:
        node: The node to publish and to call from; another thread spins it.
        services: Of the cell.
    """

    def __init__(self, node: RobotNode, services: CellServices) -> None:
        self._services = services
        planner = PendantPlanner(node, node.robot.axes_data.names)
        self._lock = threading.Lock()
        self._running: tuple[MotionCommand, Done] | None = None
        self._motions = commanded_motions(
            node, planner, services.send, self._on_result, patience=services.patience
        )
        node.create_timer(WATCH_PERIOD, self._watch)
        self._now, self._begun = node.now, 0.0
        self._waiting = False  # for the robot to stand, so that it can be taken
        services.prepare([STOP])
        services.prepare([TAKE], SetBool)

    def begin(self, command: MotionCommand, done: Done) -> None:
        """Take the robot, and command a motion; see `PendantPort.begin_move`."""
        with self._lock:
            self._running = command, done
        self._begun, self._waiting = self._now(), False
        self._take(command)

    def _take(self, command: MotionCommand) -> None:
        self._services.send(TAKE, SetBool, SetBool.Request(data=True), partial(self._taken, command))

    def end(self) -> None:
        """Give up the motion, if it runs, and give the robot back."""
        with self._lock:
            running, self._running = self._running, None
        if running is not None:
            self._motions.stop()
        self._services.send(TAKE, SetBool, SetBool.Request(data=False))

    def _taken(self, command: MotionCommand, answer: Any) -> None:
        if not self._is_current(command):  # released meanwhile
            return
        if answer.success:
            self._motions.send(command)
        elif self._now() - self._begun < STANDING_TIME:
            self._waiting = True
        else:
            self._on_result('', command, CommandRefusedError(answer.message))

    def _watch(self) -> None:
        self._motions.watch()
        running = self._running
        if self._waiting and running is not None:
            self._waiting = False
            self._take(running[0])

    def _is_current(self, command: MotionCommand) -> bool:
        with self._lock:
            return self._running is not None and self._running[0] is command

    def _on_result(self, _id: str, command: MotionCommand, error: RobotsError | None) -> None:
        with self._lock:
            running = self._running
            if running is None or running[0] is not command:
                return
            self._running = None
        running[1](error)
