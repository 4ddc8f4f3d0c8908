"""planning_node with everything around it."""

from __future__ import annotations

from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rclpy.duration import Duration
from std_msgs.msg import Bool
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from robots_core import Pose, load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.ros.messages import (
    BUILD,
    doubles,
    message_class,
    motion_result_from_message,
    motion_result_message,
    stamp_id,
)
from robots_core.ros.qos import COMMAND, STATE
from robots_planning import Trajectory
from robots_planning.motion_kinds import MOTION_KINDS
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = 'bello_bot'


class PlanningBench(Bench):
    """The node under test with everything around it: program, controller, sensor."""

    def __init__(self, runner: Any, **parameters: Any) -> None:
        super().__init__(runner)
        self.robot = load_robot_model(parameters.setdefault('robot_model', ROBOT))
        self.names = list(self.robot.axes_data.names)
        self.trajectories = self.collect('joint_trajectory', JointTrajectory, COMMAND)
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.finished = self.collect('finished', Bool, STATE, lambda message: message.data)
        self.references: Any = None
        self.node = self.start_node(PlanningNode, **parameters)
        for topic, kind, qos in (
            *((kind.topic, message_class(kind.message_type), COMMAND) for kind in MOTION_KINDS),
            ('trigger', Bool, COMMAND),
            ('reference_pose', PoseStamped, STATE),
            ('motion_result', DiagnosticStatus, COMMAND),
        ):
            self.publisher(topic, kind, qos)
        self.wait(
            lambda: self.peer.count_publishers('joint_trajectory') and self.finished, 'the node is connected'
        )

    def stand(self, q: np.ndarray, q_dot: np.ndarray | None = None, q_ddot: np.ndarray | None = None) -> None:
        """Publish a reference, as the controller does, and wait until the node has received it."""
        if self.references is None:
            self.references = self.peer.create_publisher(JointTrajectory, 'joint_reference', STATE)
            self.wait(lambda: self.references.get_subscription_count() > 0, 'the reference is subscribed')
            self.wait(
                lambda: self.node.get_publishers_info_by_topic('joint_reference'), 'its publisher is known'
            )
        zero = np.zeros(len(q))
        order = list(reversed(range(len(q))))  # references are matched by name
        point = JointTrajectoryPoint(
            positions=doubles(q[order]),
            velocities=doubles((zero if q_dot is None else q_dot)[order]),
            accelerations=doubles((zero if q_ddot is None else q_ddot)[order]),
        )
        self.references.publish(
            JointTrajectory(joint_names=[self.names[index] for index in order], points=[point])
        )
        assert self.references.wait_for_all_acked(Duration(seconds=10.0))

    def below(self, distance: float = 0.1) -> Pose:
        """A pose straight below home."""
        start = Pose(*self.robot.direct_kinematics(self.robot.home))
        return Pose(start.r - [0.0, 0.0, distance], start.T)

    def command(self, topic: str, target: Any, stamp: int) -> str:
        """Send a command with a stamp; returns its id."""
        time = Time(sec=stamp)
        if topic == 'ptpjoint_joint':
            message: Any = BUILD.joint_state(time, self.names, target)
        else:
            message = BUILD.pose_stamped(time, target)
        self.publish(topic, message)
        return stamp_id(time)

    def planned(self, count: int = 1) -> Trajectory:
        """The newest trajectory, after `count` have come."""
        self.wait(lambda: len(self.trajectories) >= count, f'{count} trajectories')
        message = self.trajectories[-1]
        return Trajectory(
            np.array([p.time_from_start.sec + 1e-9 * p.time_from_start.nanosec for p in message.points]),
            *(
                np.array([getattr(point, field) for point in message.points])
                for field in ('positions', 'velocities', 'accelerations')
            ),
        )

    def refusal(self, id_: str) -> MotionResult:
        """The result of a refused command."""
        self.wait(lambda: any(result.id == id_ for result in self.results), f'a result of {id_}')
        result = next(result for result in self.results if result.id == id_)
        assert not result.ok
        return result

    def end(self, id_: str, *, ok: bool = True) -> None:
        """End a motion, as the controller does."""
        result = MotionResult(id_, ok, 'reached' if ok else 'stopped')
        self.publish('motion_result', motion_result_message(result, ROBOT))
        self.wait(lambda: not self.node.planner.holds(id_), 'the result is with the node')
        self.wait(lambda: id_ in [result.id for result in self.results], 'the result is with the test')
