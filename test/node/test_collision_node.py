"""collision_node: distance and status out, objects in, and the controller stopped before a collision."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker, MarkerArray

from bench import Bench
from robots_core import Pose, load_robot_model
from robots_core.blocks import CollisionDetection, Scene, SceneObject
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError
from robots_core.nodes.collision_node import CollisionNode
from robots_core.robot_model.shapes import Sphere
from robots_core.ros.messages import diagnostic_values, doubles, motion_result_message
from robots_core.ros.qos import COMMAND, STATE
from scene_markers import markers

ROBOT = 'kuka_kr210_r2700'


class CollisionBench(Bench):
    """The node under test between drives, planner, controller and a sensor of obstacles."""

    def __init__(self, runner: Any, **parameters: Any) -> None:
        super().__init__(runner, 'controller_node')
        self.robot = load_robot_model(ROBOT)
        self.distances = self.collect('min_distance', Float64, STATE, lambda message: message.data)
        self.statuses = self.collect('collision_status', DiagnosticStatus, STATE)
        self.stops = 0
        self.peer.create_service(Trigger, '~/stop_before_collision', self.on_stop)
        self.node = self.start_node(CollisionNode, robot_model=ROBOT, **parameters)
        for topic, kind, qos in (
            ('joint_states', JointState, STATE),
            ('joint_trajectory', JointTrajectory, COMMAND),
            ('motion_progress', Float64, STATE),
            ('motion_result', DiagnosticStatus, COMMAND),
            ('collision_objects', MarkerArray, STATE),
        ):
            self.publisher(topic, kind, qos)
        self.wait(
            lambda: self.node._stop_client.service_is_ready() and self.peer.count_publishers('min_distance'),
            'the node is connected',
        )

    def on_stop(self, _: Any, response: Any) -> Any:
        self.stops += 1
        response.success = True
        return response

    def stand(self, q: np.ndarray, q_dot: np.ndarray | None = None) -> None:
        """Publish feedback, and wait for the answer."""
        count = len(self.statuses)
        names = list(self.robot.axes_data.names)
        message = JointState(name=['gripper', *reversed(names)], position=[0.0, *map(float, reversed(q))])
        if q_dot is not None:
            message.velocity = [0.0, *map(float, reversed(q_dot))]
        self.publish('joint_states', message)
        self.wait(lambda: len(self.statuses) > count, 'a status')

    def move(self, start: np.ndarray, end: np.ndarray, duration: float, stamp: int) -> None:
        """Send a trajectory in a straight line from rest to rest."""
        zero = doubles(np.zeros(len(start)))
        message = JointTrajectory(joint_names=list(self.robot.axes_data.names))
        message.header.stamp = Time(sec=stamp)
        for q, time in ((start, 0.0), (end, duration)):
            point = JointTrajectoryPoint(positions=doubles(q), velocities=zero, accelerations=zero)
            point.time_from_start.sec = int(time)
            message.points.append(point)
        self.publish('joint_trajectory', message)
        self.wait(lambda: f'{stamp}.000000000' in self.node.guard.motions, 'the motion is known')

    def place(self, *objects: SceneObject) -> None:
        self.publish('collision_objects', markers(Scene(objects), Time()))
        names = {item.name for item in objects}
        self.wait(
            lambda: names <= {item.name for item in self.node.guard.detection.scene.objects},
            'objects are known',
        )


@pytest.fixture
def bench(ros_nodes: Any) -> CollisionBench:
    return CollisionBench(ros_nodes)


def ball(robot: Any, q: np.ndarray, *, radius: float = 0.1) -> SceneObject:
    """A ball around tool0 of a configuration."""
    return SceneObject('ball', Sphere(radius), Pose(robot.direct_kinematics(q)[0], np.eye(3)))


def turned(robot: Any, angle: float) -> np.ndarray:
    q = robot.home.copy()
    q[0] += angle
    return q


def test_distance_and_status_follow_joint_states(bench: CollisionBench):
    home = bench.robot.home
    expected = CollisionDetection(bench.robot).distance(home)
    assert expected is not None
    bench.stand(home)
    bench.wait(lambda: bench.distances, 'a distance')
    assert bench.distances[-1] == pytest.approx(expected.distance, abs=1e-9)
    status = bench.statuses[-1]
    assert status.level == DiagnosticStatus.OK
    assert status.hardware_id == ROBOT
    values = diagnostic_values(status)
    assert (values['first'], values['second']) == (expected.first, expected.second)
    first, second = (np.array(values[f'point_{which}'].split(), dtype=float) for which in ('first', 'second'))
    assert np.linalg.norm(first - second) == pytest.approx(expected.distance, abs=1e-5)  # six digits


def test_an_object_that_comes_is_named_with_what_it_touches(bench: CollisionBench):
    home = bench.robot.home
    bench.place(ball(bench.robot, home))
    bench.stand(home)
    status = bench.statuses[-1]
    assert status.level == DiagnosticStatus.ERROR
    assert 'ball' in status.message
    assert 'link_6/flange - ball' in diagnostic_values(status)['contacts']
    bench.wait(lambda: bench.distances[-1] == 0.0, 'distance 0')
    # Nothing moves, so there is nothing to stop.
    assert bench.stops == 0
    bench.publish('collision_objects', MarkerArray(markers=[Marker(action=Marker.DELETEALL)]))
    bench.wait(lambda: not bench.node.guard.detection.scene.objects, 'the ball is gone')
    bench.stand(home)
    assert bench.statuses[-1].level == DiagnosticStatus.OK


def test_a_path_into_an_object_is_stopped_when_it_is_near(bench: CollisionBench):
    home, there = bench.robot.home, turned(bench.robot, 1.2)
    bench.stand(home)
    bench.place(ball(bench.robot, turned(bench.robot, 1.0)))
    bench.move(home, there, 10.0, 5)
    danger = bench.node.guard.motions['5.000000000'].danger
    assert danger is not None
    bench.stand(home)
    assert bench.statuses[-1].level == DiagnosticStatus.WARN
    assert 'ball' in diagnostic_values(bench.statuses[-1])['ahead']
    assert bench.stops == 0  # still far ahead
    near = danger.time - bench.node.guard.lookahead + 0.1
    bench.publish('motion_progress', Float64(data=near / 10.0))
    bench.wait(lambda: bench.stops == 1, 'the controller is stopped')
    bench.until_health(DiagnosticStatus.ERROR, 'stopped the controller')
    bench.publish('motion_progress', Float64(data=(near + 0.05) / 10.0))
    result = MotionResult('5.000000000', ok=False, message='stopped')
    bench.publish('motion_result', motion_result_message(result, ROBOT))
    bench.wait(lambda: not bench.node.guard.motions, 'the motion has ended')
    assert bench.stops == 1  # asked once


def test_a_robot_that_is_jogged_is_stopped_while_it_can_brake(bench: CollisionBench):
    bench.place(ball(bench.robot, turned(bench.robot, 1.0)))
    jogging = np.array([0.3, 0.0, 0.0, 0.0, 0.0, 0.0])
    bench.stand(turned(bench.robot, 0.3), jogging)
    near = next(
        turned(bench.robot, angle)
        for angle in np.arange(0.3, 1.0, 0.01)
        if bench.node.guard.detection.distance(turned(bench.robot, angle)).distance < 0.03  # type: ignore[union-attr]
    )
    bench.stand(near, -jogging)
    bench.stand(near, 0.0 * jogging)
    assert bench.stops == 0  # far away, leaving, or at rest
    bench.stand(near, jogging)
    bench.wait(lambda: bench.stops == 1, 'the controller is stopped')
    bench.until_health(DiagnosticStatus.ERROR, 'stopped the controller')
    bench.health.clear()
    bench.stand(near, -jogging)
    bench.wait(lambda: any(item.level == DiagnosticStatus.OK for item in bench.health), 'all is well again')


def test_bad_objects_are_refused_and_change_nothing(bench: CollisionBench):
    bench.place(ball(bench.robot, bench.robot.home))
    bad = Marker(ns='arrow', type=Marker.ARROW)
    bad.pose.orientation.w = 1.0
    bench.publish('collision_objects', MarkerArray(markers=[bad]))
    bench.until_health(DiagnosticStatus.WARN, "'arrow'")
    assert [item.name for item in bench.node.guard.detection.scene.objects] == ['ball']


def test_bad_feedback_is_reported(bench: CollisionBench):
    names = list(bench.robot.axes_data.names)
    bench.publish('joint_states', JointState(name=names, position=[math.nan] * len(names)))
    bench.until_health(DiagnosticStatus.WARN, 'nan')
    assert not bench.statuses


def test_the_scene_file_is_read_and_its_mistakes_stop_the_start(ros_nodes: Any, tmp_path: Path):
    path = tmp_path / 'cell.yaml'
    path.write_text('objects:\n  - {name: floor, box: {size: [1, 1, 0.1]}, pose: {position: [3, 0, 0]}}\n')
    bench = CollisionBench(ros_nodes, scene=str(path), collision_engine='coal')
    assert [item.name for item in bench.node.guard.detection.scene.objects] == ['floor']
    path.write_text('objects:\n  - {name: floor, box: {size: [1, 1]}}\n')
    overrides = [Parameter('robot_model', value=ROBOT), Parameter('scene', value=str(path))]
    with pytest.raises(InvalidInputError, match=r'cell\.yaml:2: size must have shape'):
        CollisionNode(context=ros_nodes.context, parameter_overrides=overrides)


@pytest.mark.parametrize(
    ('name', 'value'),
    [('collision_margin', -1.0), ('collision_engine', 'ode'), ('rate', 0.0), ('lookahead', -1.0)],
)
def test_invalid_parameters_stop_the_start(ros_nodes: Any, name: str, value: Any):
    overrides = [Parameter('robot_model', value=ROBOT), Parameter(name, value=value)]
    with pytest.raises(InvalidInputError, match=name):
        CollisionNode(context=ros_nodes.context, parameter_overrides=overrides)
