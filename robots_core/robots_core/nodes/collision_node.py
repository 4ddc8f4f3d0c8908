"""collision_node: watches the robot and its path ahead, and stops it before it collides."""

from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.collision_guard import (
    CHECK_RATE,
    GUARD_MARGIN,
    LOOKAHEAD,
    CollisionGuard,
)
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import ENGINES, MARGINS, CollisionDetection
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.ros.joint_trajectories import SerializedTrajectory
from robots_core.ros.messages import (
    BUILD,
    NANOSECONDS,
    joint_motion,
    motion_result_from_message,
)
from robots_core.ros.peers.presence import is_served
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.running.run import run
from robots_core.validation import fraction, one_of

MAX_RATE = 250.0  # Hz
SERVICE_PERIOD = 5.0  # s between reports that nothing can stop the robot


class CollisionNode(RobotNode):
    """Publishes `collision_status` and `min_distance`, and stops the controller when the margin is undercut.

    Every `joint_trajectory` goes to a `CollisionGuard`, which checks the robot `rate` times a second.
    """

    diagnostics_group = 'surroundings'

    def __init__(self, **options: Any) -> None:
        super().__init__('collision_node', **options)
        margin = self.parameter('collision_margin', GUARD_MARGIN, 'distance to keep, m', bounds=MARGINS)
        engine = self.parameter(
            'collision_engine', 'fcl', f'one of {", ".join(ENGINES)}', read=one_of('engine', ENGINES)
        )
        lookahead = self.parameter('lookahead', LOOKAHEAD, 'stop this long before, s', bounds=(0.0, 60.0))
        rate = self.parameter('rate', CHECK_RATE, 'checks per second, Hz', bounds=(0.1, MAX_RATE))
        controller = self.parameter(
            'controller', 'controller_node', 'node whose ~/stop_before_collision is called'
        )
        self.guard = CollisionGuard(
            CollisionDetection(self.robot, engine=engine), self._stop, margin=margin, lookahead=lookahead
        )
        self._names = list(self.robot.axes_data.names)

        self._status = make_publisher(self, DiagnosticStatus, 'collision_status')
        self._distance = make_publisher(self, Float64, 'min_distance')
        self._stop_client = self.create_client(Trigger, f'{controller}/stop_before_collision')
        self._scene = WatchedScene(self, self._on_scene)
        subscribe(self, JointTrajectory, 'joint_trajectory', self._on_trajectory, raw=True)
        subscribe(self, Float64, 'motion_progress', self._on_progress)
        subscribe(self, DiagnosticStatus, 'motion_result', self._on_result)
        self.poll(JointState, 'joint_states', self._check, rate=rate)

    # -- what comes in -------------------------------------------------------------------------------

    def _on_scene(self, scene: Scene) -> None:
        self.guard.set_scene(scene)
        if not self.guard.stopping:
            self._clear()

    def _on_trajectory(self, raw: bytes) -> None:
        message = SerializedTrajectory(raw)
        if message.num_points < 2:  # an empty one stops, and one point is a streamed reference
            return
        times, rows = message.points(self._names, 'joint_trajectory')
        self.guard.planned(message.id, JointPath(times / NANOSECONDS, *rows))

    def _on_progress(self, message: Float64) -> None:
        self.guard.progress(fraction(message.data, 'motion_progress'))

    def _on_result(self, message: DiagnosticStatus) -> None:
        if self.guard.ended(motion_result_from_message(message)):
            self._clear()

    # -- what goes out -------------------------------------------------------------------------------

    def _check(self, message: JointState) -> None:
        stopping = self.guard.stopping
        q, q_dot, _ = joint_motion(message, self._names)
        seen = self.guard.check(q, q_dot)
        if stopping and not self.guard.stopping:
            self._clear()
        self._distance.publish(Float64(data=seen.distance))
        self._status.publish(BUILD.status(seen.status, self.robot_name))

    def _clear(self) -> None:
        self.ready(objects=len(self.guard.detection.scene.objects))

    def _stop(self, reason: str) -> bool:
        """Call the controller's ~/stop_before_collision; False if no node serves it."""
        client = self._stop_client
        served = is_served(self, client)
        text = 'stopped the controller' if served else f'no node serves {client.srv_name} to stop the robot'
        self.report_health(DiagnosticStatus.ERROR, f'{text}: {reason}')
        self.journal.error(f'{text}: {reason}', throttle_duration_sec=SERVICE_PERIOD)
        if served:
            client.call_async(Trigger.Request())
        return served


main: Final = partial(run, CollisionNode)
