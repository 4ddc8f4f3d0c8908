"""planning_node: motion commands to verified joint trajectories."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rclpy.parameter import Parameter
from rclpy.subscription import Subscription
from std_msgs.msg import Bool, Float64
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.collision_detection import MARGINS, CollisionDetection
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import RobotsError
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.pose import Pose
from robots_core.ros.messages import (
    BUILD,
    NANOSECONDS,
    action_type,
    id_stamp,
    message_class,
    motion_result_from_message,
    motion_result_message,
    number_in,
    pose_in_base,
    stamp_id,
)
from robots_core.ros.peers.heartbeat import HeartbeatWatch, watchdog_parameter
from robots_core.ros.peers.presence import Sender, publishers_of
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.validation import Array, fraction, one_of
from robots_planning.commands.motion_plan import MotionPlan
from robots_planning.commands.motion_planner import BLEND_PATIENCE, MotionPlanner
from robots_planning.motion_kinds import MOTION_KINDS, MotionKind
from robots_planning.motion_settings import (
    DESCRIPTIONS,
    PENDANT,
    PENDANT_SETTINGS,
    RANGES,
    MotionSettings,
    checked,
    of_pendant,
    settings_status,
)
from robots_planning.nodes.command_intake import CommandAdmission, CommandInbox
from robots_planning.nodes.controller_reference import ControllerReference
from robots_planning.nodes.follow_joint_trajectory import FollowJointTrajectory
from robots_planning.nodes.jog_stream import JogStream
from robots_planning.nodes.motion_messages import target_of, trajectory_message
from robots_planning.nodes.motion_primitive_sequence import MotionPrimitiveSequence
from robots_planning.pathplanning import COLLISION_MARGIN, PathPlanning
from robots_planning.trajectory import Trajectory

CHECK_PERIOD = 0.1  # s between checks for a first reference
NEW_COMMAND = ('queue', 'replace')


class PlanningNode(RobotNode):
    """Motion commands as messages to a `MotionPlanner`, its plans to `joint_trajectory`.

    Planning has its own thread. `trigger` and `finished` are those of the paper's section 3.
    """

    diagnostics_group = 'motion'

    def __init__(self, **options: Any) -> None:
        super().__init__('planning_node', **options)
        self._declare_settings()
        self._names = list(self.robot.axes_data.names)
        collision = CollisionDetection(
            self.robot, engine=self.parameter('collision_engine', 'fcl', 'fcl or coal')
        )
        margin = self.parameter(
            'collision_margin', COLLISION_MARGIN, 'distance that motions keep, m', bounds=MARGINS
        )
        planning = PathPlanning(self.robot, collision=collision, collision_margin=margin)
        self._scene = WatchedScene(self, planning.set_scene)
        planning.warm_up()
        self.planner = MotionPlanner(planning, self)
        self.planner.configure(self._settings())
        self._pendant = self._pendant_settings()
        self._progress: Subscription | None = None
        self._use_new_command(
            self.parameter(
                'new_command',
                NEW_COMMAND[0],
                'a joint motion commanded while the robot moves: queue it, or replace the running one',
                read=one_of('new_command', NEW_COMMAND),
            )
        )
        watchdog = watchdog_parameter(self)
        self.admission = CommandAdmission(self, self.planner, watchdog)
        """Of the commands."""
        self._inbox = CommandInbox(self)
        self._worker = ThreadPoolExecutor(1, 'planner')
        self.closing.callback(self._worker.shutdown, cancel_futures=True)
        self._patience = self.create_timer(BLEND_PATIENCE, self._release, autostart=False)

        self._reference = ControllerReference(self)
        self._trajectory_publisher = make_publisher(self, JointTrajectory, 'joint_trajectory')
        self._plan_publisher = make_publisher(self, DiagnosticStatus, 'motion_plan')
        self._result_publisher = make_publisher(self, DiagnosticStatus, 'motion_result')
        self._finished_publisher = make_publisher(self, Bool, 'finished')
        self.finished(done=False)
        self._subscribe()
        self._settings_publisher = make_publisher(self, DiagnosticStatus, 'motion_settings')
        self._publish_settings()
        self._jogging = JogStream(
            self,
            self._reference,
            standing=self.planner.standing,
            busy=lambda: self.planner.moving,
            commanders=self.admission.commanders,
        )
        self._jogging.jogging.use_tool(self.planner.settings.tool_pose, self.planner.settings.hold)
        self.add_post_set_parameters_callback(self._on_settings)
        self._actions: list[FollowJointTrajectory | MotionPrimitiveSequence] = []
        self._serve_actions()
        HeartbeatWatch(self, ['controller_node'], watchdog, self._on_controller_watched)
        self._search_timer = self.create_timer(CHECK_PERIOD, self._find_reference)
        self.report_health(DiagnosticStatus.WARN, 'waiting for joint_reference')

    def _serve_actions(self) -> None:
        if (action := action_type('FollowJointTrajectory')) is not None:
            self._actions.append(
                FollowJointTrajectory(
                    self,
                    action,
                    lambda make, id_: self._worker.submit(self._send_given, make, id_),
                    self.reference,
                )
            )
        if (action := action_type('ExecuteMotionPrimitiveSequence')) is not None:
            self._actions.append(
                MotionPrimitiveSequence(
                    self,
                    action,
                    self.planner,
                    check=partial(self.admission.check, Commander.REMOTE),
                    pose_of=self._pose,
                    take=lambda act: self._inbox.put(self.get_clock().now().to_msg(), act),
                )
            )

    def _declare_settings(self) -> None:
        default = MotionSettings()
        for name, text in DESCRIPTIONS.items():
            value = getattr(default, name)
            self._declare_setting(name, list(value) if isinstance(value, tuple) else value, text)
        for name, value in PENDANT_SETTINGS.items():
            self._declare_setting(name, value, f'{DESCRIPTIONS[name]}; of the pendant', PENDANT)

    def _declare_setting(self, name: str, value: Any, text: str, prefix: str = '') -> None:
        bounds = RANGES[name][:2] if name in RANGES else None
        self.parameter(f'{prefix}{name}', value, text, bounds=bounds, read=checked(name))

    def _subscribe(self) -> None:
        for kind in MOTION_KINDS:
            command, message_type = partial(self._on_command, kind), message_class(kind.message_type)
            self._inbox.subscribed(self.create_subscription_with_sender(message_type, kind.topic, command))
        subscribe(self, DiagnosticStatus, 'motion_result', self._on_motion_result)
        subscribe(self, PoseStamped, 'reference_pose', self._on_reference_pose)
        self.create_subscription_with_sender(Bool, 'trigger', self._on_trigger)

    def _use_new_command(self, value: str) -> None:
        replace = value == 'replace'
        self.planner.replace_motions(replace=replace)
        if replace and self._progress is None:  # only then it matters; it comes often
            self._progress = subscribe(self, Float64, 'motion_progress', self._on_progress)

    @property
    def moving(self) -> bool:
        """A motion is on its way, somebody jogs, or the controller's reference moves for another reason."""
        return self.planner.moving or self._jogging.jogging.active or self._reference.moves

    # -- messages to the planner ---------------------------------------------------------------------

    def _on_command(self, kind: MotionKind, message: Any, sender: Sender) -> None:
        stamp = message.header.stamp
        if stamp.sec == 0 and stamp.nanosec == 0:
            stamp = self.get_clock().now().to_msg()
        self._inbox.put(stamp, partial(self._command, kind, message, stamp_id(stamp), sender))

    def _command(self, kind: MotionKind, message: Any, id_: str, sender: Sender) -> None:
        try:
            commander = self.admission.check_sent(sender)
            target = target_of(kind, message, self._names, self.robot.base_link)
        except RobotsError as error:
            self.planner.refuse(id_, kind, error)
            return
        settings = self.planner.settings
        if commander is Commander.PENDANT:
            settings = of_pendant(settings, self._pendant)
        if not self.planner.command(id_, kind, target, settings):
            self.journal.warning(f'{kind.title}: command {id_} came twice, the second is ignored')

    def held_up(self, silence: float) -> None:
        """The others have missed this node, and have given up what they had commanded."""
        self.admission.held_up(silence)

    def _pose(self, message: PoseStamped) -> Pose:
        return pose_in_base(message.header.frame_id, message.pose, self.robot.base_link)

    def _on_reference_pose(self, message: PoseStamped) -> None:
        self.planner.reference_pose = None  # a trigger does not lead to one before this, whatever it is
        self.planner.reference_pose = self._pose(message)

    def _on_trigger(self, message: Bool, sender: Sender) -> None:
        self.admission.check_sent(sender)
        stamp = self.get_clock().now().to_msg()
        self._inbox.put(stamp, partial(self.planner.trigger, stamp_id(stamp), level=message.data))

    def _settings(self) -> MotionSettings:
        values: dict[str, Any] = {name: self.get_parameter(name).value for name in DESCRIPTIONS}
        return MotionSettings(**values | {name: tuple(values[name]) for name in ('tool', 'base', 'payload')})

    def _pendant_settings(self) -> dict[str, Any]:
        return {name: self.get_parameter(f'{PENDANT}{name}').value for name in PENDANT_SETTINGS}

    def _on_settings(self, parameters: list[Parameter]) -> None:
        self._inbox.deliver_all()  # what came before, for which the settings before hold
        for parameter in parameters:
            if parameter.name == 'new_command':
                self._use_new_command(str(parameter.value))
            elif parameter.name == 'collision_margin':
                self.planner.planning.collision_margin = float(parameter.value)
        settings = self._settings()
        self._jogging.jogging.use_tool(settings.tool_pose, settings.hold)
        self.planner.configure(settings)
        self._pendant = self._pendant_settings()
        if any(parameter.name.removeprefix(PENDANT) in DESCRIPTIONS for parameter in parameters):
            self._publish_settings()

    def _publish_settings(self) -> None:
        # A command follows the change that it is meant for: in a recording, the settings of a command are
        # those that were published last before it.
        status = settings_status(self._settings(), self._pendant)
        self._settings_publisher.publish(BUILD.status(status, self.robot_name))

    def _release(self) -> None:
        self._patience.cancel()
        self.planner.end_wait()

    def _on_progress(self, message: Float64) -> None:
        self.planner.progress(fraction(message.data, 'motion_progress'))

    def _on_controller_watched(self, _: str, reason: str) -> None:
        if reason:
            self.planner.lose_controller(reason)

    def _on_motion_result(self, message: DiagnosticStatus) -> None:
        result = motion_result_from_message(message)
        for action in () if result.blocked else self._actions:
            action.ended(result)
        ended = partial(self.planner.result, result, number_in(result.details, 'ended', self.time()))
        if result.blocked:  # the path around is planned as a command: from the last reference, in its phase
            self._inbox.put(self.get_clock().now().to_msg(), ended)
        else:
            ended()

    # -- the planner's port: messages out, from its thread too ---------------------------------------

    def time(self) -> float:
        """See `MotionPlannerPort`."""
        return self.get_clock().now().nanoseconds / NANOSECONDS

    def reference(self) -> tuple[Array, Array] | None:
        """See `MotionPlannerPort`."""
        return self._reference.newest()

    def controllers(self) -> frozenset[bytes]:
        """See `MotionPlannerPort`: the publishers of references."""
        return frozenset(publishers_of(self, 'joint_reference'))

    def missed(self) -> bool:
        """See `MotionPlannerPort`."""
        return self.admission.missed()

    def submit(self, work: Callable[[], None]) -> None:
        """See `MotionPlannerPort`; in simulated time at once, as it takes none of it."""
        if self.simulated_time:
            work()
        else:
            self._worker.submit(work).add_done_callback(self._on_planned)

    def release_after(self, patience: float) -> None:
        """See `MotionPlannerPort`."""
        self._patience.timer_period_ns = int(1e9 * patience)
        self._patience.reset()

    def send(self, plan: MotionPlan) -> None:
        """See `MotionPlannerPort`."""
        self._plan_publisher.publish(BUILD.status(plan.status, self.robot_name))
        self._trajectory_publisher.publish(
            trajectory_message(plan.trajectory, self._names, id_stamp(plan.id), join_time=plan.join_time)
        )
        limit = plan.motion.report.limiting
        self.journal.info(
            f'{plan.title} planned: {plan.motion.duration:.3f} s, '
            f'limited by {100.0 * limit.ratio:.0f} % of the {limit.quantity} of {limit.joint}'
        )
        self.ready()

    def answer(self, result: MotionResult) -> None:
        """See `MotionPlannerPort`."""
        self._result_publisher.publish(motion_result_message(result, self.robot_name))

    def refused(self, topic: str, error: RobotsError) -> None:
        """See `MotionPlannerPort`."""
        self.refuse(topic, error)

    def finished(self, *, done: bool) -> None:
        """See `MotionPlannerPort`."""
        self._finished_publisher.publish(Bool(data=done))

    def _on_planned(self, future: Future[None]) -> None:
        if not future.cancelled() and (error := future.exception()) is not None:
            self.thread_failed(error)

    def _send_given(self, make: Callable[[Array], Trajectory], id_: str) -> None:
        self.admission.check(Commander.REMOTE)
        self.planner.send_given(id_, make)

    # -- references ----------------------------------------------------------------------------------

    def _find_reference(self) -> None:
        """Ready as soon as there is a place to plan from."""
        with self.refusing('joint_reference'):
            if self.reference() is not None:
                self.destroy_timer(self._search_timer)
                self.ready()


main: Final = partial(run, PlanningNode)
