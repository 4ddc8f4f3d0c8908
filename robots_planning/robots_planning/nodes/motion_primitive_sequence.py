"""ExecuteMotionPrimitiveSequence: PTP, LIN and CIRC of others, served where control_msgs is installed."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Final

from rclpy.task import Future
from std_msgs.msg import Float64

from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.ros.messages import BUILD, stamp_id
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_planning.commands.goal_outcome import Outcome
from robots_planning.commands.motion_planner import MotionPlanner
from robots_planning.commands.primitive_sequence import Command, PrimitiveSequence, checked_commands
from robots_planning.nodes.one_goal_server import Goal, OneGoalServer, resolve
from robots_planning.nodes.primitive_messages import primitive_of

ACTION: Final = 'execute_motion_primitive_sequence'
FEEDBACK_PERIOD: Final = 0.05  # s


class SequenceGoal(Goal):
    """A goal under way; see `Goal`."""

    def __init__(self, planner: MotionPlanner, handle: Any) -> None:
        super().__init__(handle)
        self.sequence = PrimitiveSequence(planner)


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
        self._commanded: dict[str, SequenceGoal] = {}
        self._progresses = PolledSubscription(node, Float64, 'motion_progress')
        self._progress = 0.0
        super().__init__(node, action, ACTION, partial(SequenceGoal, planner), period=FEEDBACK_PERIOD)

    async def _run(self, goal: SequenceGoal) -> Outcome:
        messages = goal.handle.request.trajectory.motions
        read = partial(primitive_of, pose_of=self._pose_of)
        commands = checked_commands(messages, read, self._node.robot, self._planner.settings)
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
        if goal.sequence.moves:
            self._timer.reset()
            await goal.done
        return goal.stopped or goal.sequence.outcome

    def _begin(self, goal: SequenceGoal, commands: Sequence[Command]) -> None:
        if goal.stopped is not None:
            return
        self._check()
        self._drop_progress()
        now = self._node.get_clock().now().nanoseconds
        ids = [stamp_id(BUILD.time(now + index)) for index in range(len(commands))]
        goal.sequence.begin(commands, ids)
        self._commanded |= dict.fromkeys(ids, goal)

    def _stop_goal(self, goal: SequenceGoal) -> None:
        if goal.sequence.give_up():
            self._stop_motion()

    def ended(self, result: MotionResult) -> None:
        """A command has ended; with the last one of a goal the goal has."""
        goal = self._commanded.pop(result.id, None)
        if goal is None:
            return
        self._drop_progress()
        if goal.sequence.ended(result):
            resolve(goal.done)

    # -- while it moves -------------------------------------------------------------------------------

    def _drop_progress(self) -> None:
        """What came is of the motion before."""
        self._progresses.take()
        self._progress = 0.0

    def _poll(self) -> None:
        """See `OneGoalServer`; what has come to the controller after a first stop is stopped again."""
        goal = self._goal
        if goal is None or not goal.sequence.moves:
            return
        if goal.stopped is not None:
            self._stop_motion()
            return
        message = self._progresses.take()
        if message is not None:
            self._progress = message.data
        index = goal.sequence.advanced(self._progress)
        if index is not None:
            goal.handle.publish_feedback(self._action.Feedback(current_primitive_index=index))
