"""What may change while nodes run: what is declared, what is documented and what is refused are one table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.parameter import Parameter
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from bench import Bench
from late_drives import LATE_DRIVES
from robots_controller.nodes.controller_node import ControllerNode
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.cell_interface.parameter_changes import CHANGES, Change, change_of
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import doubles
from robots_core.ros.qos import COMMAND
from robots_core.ros.robot_node import RobotNode
from robots_planning.nodes.planning_node import PlanningNode

from .planning_bench import PlanningBench
from .suite_nodes import OPTIONS, suite_nodes

PAGE = Path(__file__).parents[2] / 'docs' / 'reference' / 'parameter_changes.md'
NUMBERS = (
    Parameter.Type.INTEGER,
    Parameter.Type.DOUBLE,
    Parameter.Type.INTEGER_ARRAY,
    Parameter.Type.DOUBLE_ARRAY,
)
OF_SEVERAL_UNITS = ('tool', 'base', 'work', 'payload', 'base_orientation', 'initial_position')
"""Lists of metres and quaternions, and the like, which a check of their own bounds."""
RCLPY: set[str] = {'use_sim_time', 'start_type_description_service'}


@pytest.mark.parametrize('name', sorted(suite_nodes()))
def test_the_table_has_what_a_node_lets_change(ros_nodes: Any, name: str) -> None:
    node = ros_nodes.add(suite_nodes()[name](**ros_nodes.options(**OPTIONS.get(name, {}))))
    declared = set(node._parameters) - RCLPY
    assert {one for one in declared if not node.describe_parameter(one).read_only} == set(
        CHANGES.get(name, {})
    )
    if isinstance(node, RobotNode):
        (result,) = node.set_parameters([Parameter('use_sim_time', value=True)])
        assert not result.successful
        assert 'chosen at the start' in result.reason


@pytest.mark.parametrize('name', sorted(suite_nodes()))
def test_numbers_have_a_range(ros_nodes: Any, name: str) -> None:
    kind, options = suite_nodes()[name], OPTIONS.get(name, {})
    node = ros_nodes.add(kind(**ros_nodes.options(**options)))
    for parameter in node.get_parameters(sorted(set(node._parameters) - RCLPY)):
        if parameter.type_ not in NUMBERS:
            continue
        if parameter.name in OF_SEVERAL_UNITS:
            per_axis = parameter.name == 'initial_position'
            huge = [1e300] * (node.robot.num_axes if per_axis else len(parameter.value))
            with pytest.raises(RobotsError, match='e\\+300'):
                kind(**ros_nodes.options(**options, **{parameter.name: huge}))
        else:
            descriptor = node.describe_parameter(parameter.name)
            assert [*descriptor.floating_point_range, *descriptor.integer_range], parameter.name


def test_numbers_in_a_list_stay_in_their_range(ros_nodes: Any) -> None:
    for value in (0.0, 1001.0, float('nan')):
        with pytest.raises(InvalidInputError, match=r'parameter bandwidth: \S+ must be in \[0.01, 1000\]'):
            DriveNode(**ros_nodes.options(bandwidth=[15.0, value]))


def test_the_documentation_has_the_table() -> None:
    said = {change: change.name.lower().replace('_', ' ') for change in Change}

    def beside_a_person(node: str, parameter: str) -> str:
        (change,) = {change_of(node, parameter, mode) for mode in (OperatingMode.T1, OperatingMode.T2)}
        assert change is not None
        return said[change]

    meanings, _, parameters = PAGE.read_text().partition('## Parameters')
    assert all(f'| {name} | {change} |' in meanings for change, name in said.items())
    assert [line for line in parameters.splitlines() if '| `' in line] == [
        f'| `{node}` | `{parameter}` | {said[change]} | {beside_a_person(node, parameter)} |'
        for node, changes in CHANGES.items()
        for parameter, change in changes.items()
    ]


def test_the_margin_of_collisions_stays_while_the_robot_moves(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes)
    bench.stand(bench.robot.home)
    bench.set_parameters(bench.node, collision_margin=0.01)
    motion = bench.command('ptpjoint_joint', bench.robot.home + 0.1, 5)
    bench.planned()
    (result,) = bench.node.set_parameters([Parameter('collision_margin', value=0.02)])
    assert (result.successful, result.reason) == (
        False,
        'collision_margin may change only while the robot stands',
    )
    bench.set_parameters(bench.node, collision_margin=0.01, blend_zone=0.05)  # as it is; for the next motion
    bench.end(motion)
    bench.set_parameters(bench.node, collision_margin=0.02)
    assert bench.node.planner.planning.collision_margin == 0.02


def test_the_margin_of_collisions_stays_while_others_move_the_robot(ros_nodes: Any) -> None:
    bench = PlanningBench(ros_nodes)
    home, still = bench.robot.home, np.zeros(bench.robot.num_axes)
    for moving in ({'q_dot': still + 0.1}, {'q_ddot': still + 0.1}):
        bench.stand(home, **moving)  # a stream, or the motion of another planner
        with pytest.raises(
            InvalidInputError, match='collision_margin may change only while the robot stands'
        ):
            bench.set_parameters(bench.node, collision_margin=0.01)
    bench.stand(home)
    bench.set_parameters(bench.node, collision_margin=0.01)


def test_a_stream_of_a_sensor_counts_as_moving_until_the_robot_stands(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    options = {'robot_model': 'kuka_kr210_r2700', 'realtime_priority': 0}
    bench.start_node(DriveNode, **options)
    bench.start_node(ControllerNode, **options, **LATE_DRIVES)
    planner = bench.start_node(PlanningNode, robot_model='kuka_kr210_r2700')
    bench.wait(planner.reference, 'the robot')
    assert not planner.moving
    sensor = ros_nodes.create_node('inverse_kinematics_node')
    stream = sensor.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
    bench.wait(stream.get_subscription_count, 'the controller listens')
    q = np.array(planner.robot.home) + 0.05
    point = JointTrajectoryPoint(positions=doubles(q), velocities=doubles(0.0 * q))
    point.time_from_start.nanosec = 4_000_000
    names = list(planner.robot.axes_data.names)

    def guided() -> bool:
        message = JointTrajectory(joint_names=names, points=[point])
        message.header.stamp = sensor.get_clock().now().to_msg()
        stream.publish(message)
        return planner.moving

    bench.wait(guided, 'a moving robot')
    bench.wait(lambda: not planner.moving, 'a standing robot')


@pytest.mark.parametrize(
    ('name', 'value', 'reason'),
    [
        ('collision_margin', 0.0, r'collision_margin out of range Min: 0.0005, Max: 0.5, value: 0.0'),
        ('collision_margin', 1e9, r'collision_margin out of range Min: 0.0005, Max: 0.5'),
        ('cartesian_speed', 1e9, r'cartesian_speed out of range Min: 1e-05, Max: 20.0, value: 1000000000.0'),
        ('blend_zone', 1e9, r'blend_zone out of range Min: 0.0, Max: 1.0'),
        ('tool', [1e9, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], r'tool\[0\] = 1e\+09 m must be within \+-10 m'),
        ('payload', [1e9, 0.0, 0.0, 0.0], r'payload\[0\] = 1e\+09'),
    ],
)
def test_values_that_no_arm_works_with_are_refused(
    ros_nodes: Any, name: str, value: Any, reason: str
) -> None:
    bench = Bench(ros_nodes)
    node = bench.start_node(PlanningNode)
    with pytest.raises(InvalidInputError, match=reason):
        bench.set_parameters(node, **{name: value})
