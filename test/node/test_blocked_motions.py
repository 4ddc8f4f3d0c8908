"""planning_node and controller_node where an obstacle stops a motion: messages and services."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.parameter import Parameter
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import MarkerArray

from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core import Pose, load_robot_model
from robots_core.blocks import CollisionDetection, Scene, SceneObject
from robots_core.cell_interface.motion_result import BLOCKED, MotionResult
from robots_core.nodes.collision_node import CollisionNode
from robots_core.nodes.drive_node import DriveNode
from robots_core.robot_model.shapes import Capsule
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import (
    diagnostic_values,
    motion_result_from_message,
    motion_result_message,
    stamp_id,
)
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.timed_node import TimedNode
from robots_planning.nodes.planning_node import PlanningNode
from scene_markers import markers

from .planning_bench import ROBOT, PlanningBench

POST = Scene((SceneObject('post', Capsule(0.05, 1.6), Pose(np.array([1.2, -1.2, 1.0]), np.eye(3))),))
PROGRAM = """ptpJointSpaceAngles(15, -70, 90, 0, 70, 0)
ptpJointSpaceAngles({75, -70, 90, 0, 70, 0}, {avoid = true, on_blocked = 'replan'})
"""
KUKA = 'kuka_kr210_r2700'
COMES_AFTER = 2.2  # s, on the way of the second motion
SETTINGS = {'avoid': True, 'on_blocked': 'replan', 'most_replans': 1}


def test_a_blocked_motion_is_sent_again_under_its_id_and_ended_when_it_was_too_often(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes)
    start, target = bench.robot.home, bench.robot.home + 0.3
    bench.stand(start)
    parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in SETTINGS.items()]
    client = bench.peer.create_client(SetParametersAtomically, 'planning_node/set_parameters_atomically')
    bench.wait(client.service_is_ready, 'the parameters are served')
    done = client.call_async(SetParametersAtomically.Request(parameters=parameters))
    bench.wait(done.done, 'the settings are set')
    id_ = bench.command('ptpjoint_joint', target, 5)
    bench.planned()
    blocked = MotionResult(id_, ok=False, message=BLOCKED, details={'progress': '0.4'}, blocked=True)
    assert motion_result_from_message(motion_result_message(blocked, ROBOT)) == blocked
    stands = start + 0.1
    bench.stand(stands)
    bench.publish('motion_result', motion_result_message(blocked, ROBOT))
    around = bench.planned(2)
    assert [stamp_id(message.header.stamp) for message in bench.trajectories] == [id_, id_]
    np.testing.assert_allclose(around.position[[0, -1]], [stands, target], atol=1e-9)
    bench.publish('motion_result', motion_result_message(blocked, ROBOT))
    bench.wait(lambda: bench.results and not bench.results[-1].blocked, 'the last result')
    assert 'again, after 1 replanned path,' in bench.results[-1].message
    assert len(bench.trajectories) == 2
    assert not bench.node.planner.moving


class Obstacle(TimedNode):
    """Puts a post into the way at a simulated time; collects references and the states of the program."""

    phase = Phase.ENVIRONMENT

    def __init__(self, **options: Any) -> None:
        super().__init__('obstacle', **options)
        self.positions: list[tuple[float, ...]] = []
        self.states: list[dict[str, str]] = []
        self.stops: list[dict[str, str]] = []
        self._publisher = self.create_publisher(MarkerArray, 'collision_objects', COMMAND)
        self.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, COMMAND)
        self.create_subscription(
            DiagnosticStatus, 'program_status', lambda m: self.states.append(diagnostic_values(m)), STATE
        )
        self.create_subscription(DiagnosticStatus, 'stop_status', self._on_stop, STATE)
        self._begin = self.now()
        self.start_loop(self._put, period=0.01, name='obstacle')

    def _on_reference(self, message: JointTrajectory) -> None:
        self.positions.append(tuple(message.points[0].positions))

    def _on_stop(self, message: DiagnosticStatus) -> None:
        if message.level == DiagnosticStatus.ERROR:
            self.stops.append({'message': message.message, **diagnostic_values(message)})

    def _put(self, now: float) -> None:
        if self._publisher is not None and now >= self._begin + COMES_AFTER:
            self._publisher.publish(markers(POST, self.get_clock().now().to_msg()))
            self._publisher = None


def run_into_the_post(ros_nodes: Any, program: Path, text: str) -> Obstacle:
    """In lock-step: the stop is that of `collision_node`, the path around that of `planning_node`."""
    program.write_text(text)
    shared = {'robot_model': KUKA, 'lockstep': True}
    obstacle = ros_nodes.add(Obstacle(**ros_nodes.options(lockstep=True)))
    for kind, parameters in (
        (DriveNode, {'drive': 'ideal', 'rate': 50.0}),
        (ControllerNode, {'rate': 50.0}),
        (CollisionNode, {}),
        (PlanningNode, {}),
        (LuaProgramNode, {'program': str(program), 'autostart': True}),
    ):
        ros_nodes.add(kind(**ros_nodes.options(**shared, **parameters)))
    nodes = ('drive_node', 'controller_node', 'collision_node', 'planning_node', 'lua_program_node')
    run = ros_nodes.coordinate(*nodes, 'obstacle')
    ended = ('FINISHED', 'FAILED')
    ros_nodes.wait_for(
        lambda: obstacle.states and obstacle.states[-1]['state'] in ended, what='the end of the program'
    )
    ros_nodes.call(run.end)
    return obstacle


def test_a_robot_that_an_obstacle_stops_goes_around_it(ros_nodes: Any, tmp_path: Path) -> None:
    obstacle = run_into_the_post(ros_nodes, tmp_path / 'around.lua', PROGRAM)
    assert obstacle.states[-1]['state'] == 'FINISHED', obstacle.states[-1]
    assert not obstacle.stops
    positions = np.array(obstacle.positions)
    np.testing.assert_allclose(np.degrees(positions[-1]), [75, -70, 90, 0, 70, 0], atol=1e-6)
    steps = np.abs(np.diff(positions, axis=0)).max(axis=1) > 0.0
    assert np.count_nonzero(np.diff(steps.astype(int)) == 1) == 3  # begins to move: there, forth, around
    collision = CollisionDetection(load_robot_model(KUKA), scene=POST)
    assert all(not collision.in_contact(q) for q in positions[positions[:, 0] > np.radians(15.0)])


def test_a_robot_that_does_not_go_around_stays_and_its_program_fails_even_with_pcall(
    ros_nodes: Any, tmp_path: Path
) -> None:
    there, forth = PROGRAM.replace(", on_blocked = 'replan'", '').splitlines()
    text = f'{there}\npcall(function() {forth} end)\nwait(1)\n{there}\n'
    obstacle = run_into_the_post(ros_nodes, tmp_path / 'caught.lua', text)
    assert obstacle.states[-1]['state'] == 'FAILED', obstacle.states[-1]
    (stop,) = obstacle.stops
    assert re.fullmatch('stopped before a collision: .* from post after .*', stop['message'])
    assert (stop['fault'], stop['category']) == ('obstacle', '2')
    positions = np.degrees(np.array(obstacle.positions)[:, 0])
    assert 15.0 < positions[-1] == positions.max() < 75.0  # it has not gone back
