"""ExecuteMotionPrimitiveSequence: PTP, LIN and CIRC of others, served where control_msgs is installed."""

from collections.abc import Callable
from typing import Any, Final

from rclpy.task import Future
from std_msgs.msg import Float64

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, PlanningError, RobotsError
from robots_core.pose import Pose
from robots_core.ros.messages import BUILD, stamp_id
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.commands.motion_primitives import MOST_PRIMITIVES, MotionPrimitive
from robots_planning.motion_settings import MotionSettings
from robots_planning.nodes.one_goal_server import (
    INVALID_GOAL,
    SUCCESSFUL,
    Goal,
    OneGoalServer,
    Outcome,
    resolve,
)
from robots_planning.nodes.primitive_messages import primitive_of

ACTION: Final = 'execute_motion_primitive_sequence'
FEEDBACK_PERIOD: Final = 0.05  # s


class SequenceGoal(Goal):
    """A goal under way; see `Goal`."""

    def __init__(self, handle: Any) -> None:
        super().__init__(handle)
        self.ids: list[str] = []
        self.open: set[str] = set()
        """Ids of the commands that have not ended."""
        self.failed: Outcome | None = None
        self.index = -1
        """Of the primitive that was reported last."""


class MotionPrimitiveSequence(OneGoalServer[SequenceGoal]):
    """The action server; see `OneGoalServer`.

    Args:
        node: Owner.
        action: Its type.
        planner: Takes the motions as commands.
        check: Raises a RobotsError if commands from other nodes are not permitted.
        pose_of: Reads a PoseStamped.
        take: Calls its argument in its turn among other commands.
    """

    def __init__(
        self,
        node: RobotNode,
        action: Any,
        planner: MotionPlanner,
        *,
        check: Callable[[], None],
        pose_of: Callable[[Any], Pose],
        take: Callable[[Callable[[], object]], None],
    ) -> None:
        self._planner, self._take = planner, take
        self._check, self._pose_of = check, pose_of
        self._goal: SequenceGoal | None = None
        self._commanded: dict[str, SequenceGoal] = {}
        self._progresses = PolledSubscription(node, Float64, 'motion_progress')
        self._progress = 0.0
        self._timer = node.create_timer(FEEDBACK_PERIOD, self._poll, autostart=False)
        super().__init__(node, action, ACTION, SequenceGoal)

    async def _run(self, goal: SequenceGoal) -> Outcome:
        commands = self._commands(goal.handle.request.trajectory.motions)
        begun = Future()

        def begin() -> None:
            try:
                self._begin(goal, commands)
                begun.set_result(None)
            except RobotsError as error:
                begun.set_result(error)

        self._take(begin)
        if (error := await begun) is not None:
            raise error
        if goal.ids:
            self._timer.reset()
            await goal.done
        return goal.stopped or goal.failed or Outcome(SUCCESSFUL, 'reached')

    def _commands(self, messages: Any) -> list[tuple[MotionPrimitive, MotionSettings]]:
        """The motions with their settings, all checked before the first one begins."""
        if not 0 < len(messages) <= MOST_PRIMITIVES:
            raise InvalidInputError(
                f'a sequence needs 1 to {MOST_PRIMITIVES} primitives, got {len(messages)}'
            )
        found = []
        for index, message in enumerate(messages):
            try:
                primitive = primitive_of(message, self._pose_of)
                last = index == len(messages) - 1
                settings = primitive.settings(self._node.robot, self._planner.settings, last=last)
            except RobotsError as error:
                raise InvalidInputError(f'primitive {index}: {error.message}') from error
            found.append((primitive, settings))
        return found

    def _begin(self, goal: SequenceGoal, commands: list[tuple[MotionPrimitive, MotionSettings]]) -> None:
        if goal.stopped is not None:
            return
        self._check()
        if self._planner.moving:
            raise PlanningError('the robot is still moving; wait for its motion_result or stop it')
        self._drop_progress()
        now = self._node.get_clock().now().nanoseconds
        goal.ids = [stamp_id(BUILD.time(now + index)) for index in range(len(commands))]
        goal.open = set(goal.ids)
        self._commanded |= dict.fromkeys(goal.ids, goal)
        for id_, (primitive, settings) in zip(goal.ids, commands, strict=True):
            self._planner.command(id_, primitive.kind, primitive.target, settings)

    def _leave(self, goal: SequenceGoal) -> None:
        del goal
        self._timer.cancel()

    def _stop_goal(self, goal: SequenceGoal) -> None:
        if goal.open:
            self._planner.give_up('its goal was stopped')
            self._stop_motion()

    def ended(self, result: MotionResult) -> None:
        """A command has ended; with the last one of a goal the goal has."""
        goal = self._commanded.pop(result.id, None)
        if goal is None:
            return
        self._drop_progress()
        goal.open.discard(result.id)
        if not result.ok and goal.failed is None:
            index = goal.ids.index(result.id)
            goal.failed = Outcome(INVALID_GOAL, f'primitive {index}: {result.message}')
        if not goal.open:
            resolve(goal.done)

    # -- while it moves -------------------------------------------------------------------------------

    def _drop_progress(self) -> None:
        """What came is of the motion before."""
        self._progresses.take()
        self._progress = 0.0

    def _poll(self) -> None:
        """Send feedback; stop again what has come to the controller after a first stop."""
        goal = self._goal
        if goal is None or not goal.open:
            return
        if goal.stopped is not None:
            self._stop_motion()
            return
        message = self._progresses.take()
        if message is not None:
            self._progress = message.data
        motions = self._planner.motions
        current = motions[0].left(self._progress)[0] if motions else ''
        if current in goal.open and (index := goal.ids.index(current)) > goal.index:
            goal.index = index
            goal.handle.publish_feedback(self._action.Feedback(current_primitive_index=index))
