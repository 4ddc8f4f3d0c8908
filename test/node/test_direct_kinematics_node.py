"""direct_kinematics_node: joint_states in, tcp_pose out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import JointState

from bench import Bench
from robots_core import Pose, load_robot_model
from robots_core.blocks.direct_kinematics import DirectKinematics
from robots_core.errors import InvalidInputError
from robots_core.nodes.direct_kinematics_node import DirectKinematicsNode
from robots_core.ros.messages import doubles, pose_from_message
from robots_core.ros.qos import STATE

ROBOT = 'kuka_kr210_r2700'
TOOL = [0.1, 0.0, 0.3, 0.0, 0.7071067811865476, 0.0, 0.7071067811865476]


class KinematicsBench(Bench):
    """A node under test, fed and listened to by another."""

    def __init__(self, runner: Any, *, qos: QoSProfile = STATE, **parameters: Any) -> None:
        super().__init__(runner)
        self.node = self.start_node(DirectKinematicsNode, robot_model=ROBOT, **parameters)
        self.robot = load_robot_model(ROBOT)
        self.poses = self.collect('tcp_pose', PoseStamped, STATE)
        self.states = self.publisher('joint_states', JointState, qos)

    def send(self, q: np.ndarray, names: tuple[str, ...] | None = None) -> JointState:
        message = JointState(name=list(names or self.robot.axes_data.names), position=doubles(q))
        message.header.stamp = self.peer.get_clock().now().to_msg()
        self.states.publish(message)
        return message

    def pose_of(self, sent: JointState) -> Pose:
        """The pose that the node answers to a message, known by its stamp."""

        def answer() -> PoseStamped | None:
            return next((pose for pose in self.poses if pose.header.stamp == sent.header.stamp), None)

        found = self.wait(answer, 'the pose')
        assert found.header.frame_id == 'base'
        return pose_from_message(found.pose)


def _assert_same(first: Pose, second: Pose) -> None:
    # A quaternion of a description with twelve digits is normalised twice on the way.
    assert first.distance_to(second) == pytest.approx((0.0, 0.0), abs=1e-7)


def test_pose_of_newest_joint_states_is_published(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes)
    q = bench.robot.home + 0.1
    _assert_same(bench.pose_of(bench.send(q)), Pose(*bench.robot.direct_kinematics(q)))


def test_a_driver_that_sends_best_effort_is_heard(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes, qos=qos_profile_sensor_data)
    q = bench.robot.home + 0.1
    bench.wait(lambda: bench.send(q) and bench.poses, 'a pose')  # one of those that arrive
    _assert_same(pose_from_message(bench.poses[-1].pose), Pose(*bench.robot.direct_kinematics(q)))


def test_joints_are_matched_by_name(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes)
    q = bench.robot.home + 0.1
    names = ('gripper', *reversed(bench.robot.axes_data.names))
    sent = bench.send(np.array([0.04, *q[::-1]]), names)
    _assert_same(bench.pose_of(sent), Pose(*bench.robot.direct_kinematics(q)))


def test_tool_is_a_parameter_that_can_change(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes)
    bench.set_parameters(bench.node, tool=TOOL)
    expected = DirectKinematics(bench.robot, tool=Pose.from_quaternion(TOOL[:3], TOOL[3:]))
    _assert_same(bench.pose_of(bench.send(bench.robot.home)), expected.forward(bench.robot.home))


def test_of_a_robot_that_stands_every_pose_has_the_stamp_of_its_joint_states(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes)
    for q in (bench.robot.home, bench.robot.home, bench.robot.home + 0.1):
        _assert_same(bench.pose_of(bench.send(q)), Pose(*bench.robot.direct_kinematics(q)))


def test_a_tool_that_changes_while_the_robot_stands_is_used(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes)
    bench.pose_of(bench.send(bench.robot.home))
    bench.set_parameters(bench.node, tool=TOOL)
    expected = DirectKinematics(bench.robot, tool=Pose.from_quaternion(TOOL[:3], TOOL[3:]))
    _assert_same(bench.pose_of(bench.send(bench.robot.home)), expected.forward(bench.robot.home))


@pytest.mark.parametrize('bad', [[0.0, 0.0, 0.0], [0.0] * 7, [float('nan'), *TOOL[1:]]])
def test_tool_that_is_none_is_refused_and_the_old_one_stays(ros_nodes: Any, bad: list[float]):
    bench = KinematicsBench(ros_nodes, tool=TOOL)
    (result,) = bench.node.set_parameters([Parameter('tool', value=bad)])
    assert not result.successful
    assert 'tool' in result.reason
    expected = DirectKinematics(bench.robot, tool=Pose.from_quaternion(TOOL[:3], TOOL[3:]))
    _assert_same(bench.pose_of(bench.send(bench.robot.home)), expected.forward(bench.robot.home))


@pytest.mark.parametrize(
    ('name', 'value', 'message'),
    [
        ('tool', [0.0] * 7, 'parameter tool: .*quaternion'),
        ('tool', 'gun', 'parameter tool: .*STRING.*DOUBLE_ARRAY'),
        ('rate', 0.0, r'parameter rate: .*Min: 0.1, Max: 1000.0, value: 0.0'),
    ],
)
def test_bad_parameter_at_start_ends_the_node(ros_context: Any, name: str, value: object, message: str):
    with pytest.raises(InvalidInputError, match=message):
        DirectKinematicsNode(context=ros_context, parameter_overrides=[Parameter(name, value=value)])


def test_bad_joint_states_are_reported_and_survived(ros_nodes: Any):
    bench = KinematicsBench(ros_nodes)
    bench.send(np.zeros(2), ('A1', 'A2'))
    bench.until_health(DiagnosticStatus.WARN, 'lacks joint A3')
    assert not bench.poses
    bench.pose_of(bench.send(bench.robot.home))
    bench.wait(lambda: bench.health[-1].level == DiagnosticStatus.OK, 'well again')


def test_rate_is_limited(ros_nodes: Any):
    rate = 20.0
    bench = KinematicsBench(ros_nodes, rate=rate)
    start = bench.peer.get_clock().now().nanoseconds
    # Some hundred samples; the last one must be answered too, late samples are not lost.
    for offset in np.linspace(0.0, 0.1, 300):
        last = bench.send(bench.robot.home + offset)
        ros_nodes.wait_for(lambda: True)
    bench.pose_of(last)
    seconds = (bench.peer.get_clock().now().nanoseconds - start) * 1e-9
    # One tick may lie at each end of the interval.
    assert len(bench.poses) <= seconds * rate + 2
