"""PathSwitchingMessages: plans and progress as messages to `PathSwitching`."""

from __future__ import annotations

import math
import threading
from functools import partial
from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Float64
from trajectory_msgs.msg import JointTrajectory

from robots_controller.cell.path_switching import PathSwitching
from robots_core.errors import RobotsError
from robots_core.ros.joint_trajectories import SerializedTrajectory
from robots_core.ros.lockstep.phases import NEVER, Phase
from robots_core.ros.lockstep.timed_work import LockstepTurn
from robots_core.ros.messages import diagnostic_values, number_in, serialized_stamp_id
from robots_core.ros.qos import subscribe
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.timed_node import TimedNode
from robots_core.validation import fraction
from robots_planning.nodes.motion_messages import trajectory_from_message

if TYPE_CHECKING:
    from robots_planning.trajectory import Trajectory


class PathSwitchingMessages:
    """Subscribes `joint_trajectory`, `motion_plan` and `motion_progress`."""

    def __init__(self, node: TimedNode, switching: PathSwitching, joint_names: tuple[str, ...]) -> None:
        self._node, self._switching, self._joint_names = node, switching, joint_names
        self._timer: threading.Timer | None = None
        self._trajectories: dict[str, bytes] = {}  # whose `motion_plan` has not come yet
        self._ends: dict[str, dict[str, float]] = {}  # of a motion whose trajectory has not come yet
        subscribe(node, DiagnosticStatus, 'motion_plan', self._on_plan)
        # A motion that switches nothing is not worth its deserialization.
        subscribe(node, JointTrajectory, 'joint_trajectory', self._on_trajectory, raw=True)
        self._turn: LockstepTurn | None = None
        if node.participant is None:
            subscribe(node, Float64, 'motion_progress', self._on_progress)
        else:
            # Progress comes in every period; it is checked only while there is something to switch, after
            # the controller and before any node that observes the outputs.
            self._turn = node.participant.create_turn(self._check, phase=Phase.DRIVES)
            self._progress = PolledSubscription(node, Float64, 'motion_progress')

    def _on_trajectory(self, data: bytes) -> None:
        id_ = serialized_stamp_id(data)
        if self._switching.waits_for(id_):  # not a stream
            self._trajectories[id_] = data
            self._put(id_)

    def _on_plan(self, message: DiagnosticStatus) -> None:
        ends = diagnostic_values(message)
        id_ = ends.pop('id', '')
        if self._switching.waits_for(id_):
            self._ends[id_] = {one: number_in(ends, one, 0.0) for one in ends}
            self._put(id_)

    def _put(self, id_: str) -> None:
        """Hand a motion on when both of its messages have come."""
        if id_ not in self._trajectories or id_ not in self._ends:
            return
        data, ends = self._trajectories.pop(id_), self._ends.pop(id_)
        self._switching.planned(id_, ends, partial(self._trajectory, data))
        if self._turn is not None and self._switching.pending and self._turn.due == NEVER:
            self._progress.take()  # of the motion before
            self._turn.ask(self._node.now())

    def _check(self, now: float) -> None:
        assert self._turn is not None
        message = self._progress.take()
        if message is not None:
            self._switching.progress(now, message.data)
        if self._switching.pending:
            self._turn.ask(now)  # this phase is over: in the next period

    def _trajectory(self, data: bytes) -> Trajectory | None:
        try:
            return trajectory_from_message(SerializedTrajectory(data), self._joint_names)[0]
        except RobotsError:  # the controller refuses it and says why
            return None

    def _on_progress(self, message: Float64) -> None:
        now = self._node.now()
        self._switching.progress(now, fraction(message.data, 'motion_progress'))
        # In simulated time progress comes in every period, and nothing is extrapolated.
        if self._switching.next_time < math.inf and not self._node.simulated_time:
            if self._timer is not None:
                self._timer.cancel()
            # In a thread of its own: a timer of the node waits until the executor has ended other callbacks.
            self._timer = threading.Timer(max(0.0, self._switching.next_time - now), self._switch)
            self._timer.daemon = True
            self._timer.start()

    def _switch(self) -> None:
        self._switching.step(self._node.now())
