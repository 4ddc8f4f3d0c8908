"""PrimitiveAction: sequences of motion primitives as goals of a driver's action."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Final

from action_msgs.msg import GoalStatus
from rclpy.action.client import ActionClient
from rclpy.task import Future
from std_msgs.msg import Bool

from robots_controller.cell.goal_watch import GoalWatch
from robots_controller.cell.primitive_motions import PrimitiveControl, PrimitiveMotions
from robots_controller.cell.program_host import ProgramHost
from robots_controller.nodes.autostart import Missing
from robots_controller.nodes.ports.program.feedback_client import FeedbackClient
from robots_core.cell_interface.driver_file import Driver, PrimitiveSettings
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.ros.messages import action_type
from robots_core.ros.qos import subscribe_any_state
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import Array
from robots_planning.commands.motion_primitives import MotionPrimitive
from robots_planning.nodes.primitive_messages import ACTION_TYPE, sequence_message

CHECK_PERIOD: Final = 0.02  # s
STOPPED: Final = 'the robot has stopped by itself'


class PrimitiveAction:
    """See `PrimitiveDriver`: one goal at a time, in the executor's thread.

    Args:
        driver: Its `primitives`, `joint_states` and `running`.
        held_up: As for `PlannerClient`.

    Raises:
        InvalidInputError: control_msgs is not installed, the driver takes no primitives, or its joint states
            are on another topic than the node's.
    """

    def __init__(
        self, node: RobotNode, driver: Driver, feedback: FeedbackClient, held_up: Callable[[], bool]
    ) -> None:
        self._node, self._feedback, self._held_up = node, feedback, held_up
        self._settings = _primitives(node, driver)
        self.name = self._settings.name
        self._action = action_type(ACTION_TYPE)
        if self._action is None:
            raise InvalidInputError(
                f'action {self.name} needs control_msgs with {ACTION_TYPE}, which is not installed; install '
                'it with ROS, or name the topic of a joint_trajectory_controller in the driver file'
            )
        self._client = ActionClient(node, self._action, self.name)
        self._handle: Any = None  # of the newest goal, while it runs
        self._watch = GoalWatch(self.name)
        self.planner = PrimitiveMotions(node.robot, self, self._measured)
        self.controller = PrimitiveControl(self.planner)
        self.check_guide = self.planner.check_guide
        self.wake = node.create_guard_condition(self.planner.step).trigger
        node.create_timer(CHECK_PERIOD, self._check)
        self._running_topic = driver.running

    def report_to(self, host: ProgramHost, _changed: Callable[[], None], _watchdog: float) -> None:
        """See `SuiteMotions`."""
        self.planner.on_result, self.planner.switching = host.motions.result, host.switching
        if self._running_topic:
            host.permission.remedy = f'programs run again when {self._running_topic} is true'
            subscribe_any_state(
                self._node,
                Bool,
                self._running_topic,
                lambda message: host.stop_changed('' if message.data else STOPPED),
            )

    def watch_readiness(self, _expected: Sequence[str]) -> Missing:
        """See `SuiteMotions`."""
        return self._missing

    def _missing(self) -> list[str]:
        found = [] if self.served else [self.name]
        return found if self._measured() is not None else [*found, 'joint_states of the driver']

    # -- see `PrimitiveDriver` ------------------------------------------------------------------------

    @property
    def served(self) -> bool:
        """See `PrimitiveDriver`."""
        return bool(self._client.server_is_ready()) and not self._held_up()

    def send(self, primitives: Sequence[MotionPrimitive]) -> None:
        """See `PrimitiveDriver`."""
        number = self._watch.sent(self._node.now())
        goal = self._action.Goal(trajectory=sequence_message(primitives, self._settings.frame))
        self._client.send_goal_async(goal, partial(self._advanced, number)).add_done_callback(
            partial(self._answered, number)
        )

    def cancel(self) -> None:
        """See `PrimitiveDriver`; a goal without an answer yet is canceled when it is accepted."""
        self._watch.cancel()
        if self._handle is not None:
            self._handle.cancel_goal_async()

    def end(self) -> None:
        """Cancel the goal, and end the client: as long as it is there, ROS keeps the node."""
        self.cancel()
        self._client.destroy()

    # -- the driver's answers -------------------------------------------------------------------------

    def _measured(self) -> Array | None:
        try:
            newest = self._feedback.newest()
        except RobotsError as error:
            self._node.refuse('joint_states', error)
            return None
        self._watch.measured(newest, self._node.now())
        return None if newest is None else newest.position

    def _check(self) -> None:
        self.planner.check(self._node.now())
        if problem := self._watch.problem(self._node.now(), served=self.served):
            self._fail(problem)

    def _answered(self, number: int, future: Future) -> None:
        handle = future.result()
        canceled = self._watch.answered(number, accepted=handle.accepted)
        if self._watch.executes(number):
            self._handle = handle
            handle.get_result_async().add_done_callback(partial(self._ended, number))
        elif self._watch.newest(number):
            self._fail(f'{self.name} has refused the motion')
        if canceled:
            handle.cancel_goal_async()

    def _advanced(self, number: int, message: Any) -> None:
        if self._watch.executes(number):
            self.planner.advanced(message.feedback.current_primitive_index)

    def _ended(self, number: int, future: Future) -> None:
        if not self._watch.executes(number):
            return
        self._handle = None
        self._watch.ended()
        response = future.result()
        result = response.result
        if response.status == GoalStatus.STATUS_SUCCEEDED and not result.error_code:
            self.planner.ended()
        elif response.status == GoalStatus.STATUS_CANCELED:
            self.planner.ended(canceled=True)
        else:
            text = result.error_string or f'code {result.error_code}'
            self.planner.ended(f'{self.name} has ended the motion: {text}')

    def _fail(self, reason: str) -> None:
        """Give up the goal; one that may still run is canceled."""
        self._watch.give_up()
        handle, self._handle = self._handle, None
        if handle is not None:
            handle.cancel_goal_async()
        self.planner.ended(reason)


def _primitives(node: RobotNode, driver: Driver) -> PrimitiveSettings:
    if driver.primitives is None:
        raise InvalidInputError('driver: the file names no `primitives`; hardware_node moves such a robot')
    if node.participant is not None:
        raise InvalidInputError('driver: a real robot excludes lock-step')
    own = node.resolve_topic_name('joint_states')
    if own != driver.joint_states:
        raise InvalidInputError(
            f'driver: joint_states is {driver.joint_states}, and must be {own} with `primitives`: the nodes '
            "of the cell read the driver's topic themselves; put the cell into its namespace"
        )
    return driver.primitives
