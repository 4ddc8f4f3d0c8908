"""One file with the parameters of all nodes of a cell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from robots_controller.nodes.controller_node import ControllerNode
from robots_core.nodes.drive_node import DriveNode
from robots_planning.nodes.planning_node import PlanningNode

CONFIG = Path(__file__).parents[2] / 'robots_controller' / 'config' / 'cell_parameters.yaml'


@pytest.mark.parametrize('namespace', ['', 'left'])
def test_each_node_takes_its_part_of_the_file(ros_nodes: Any, namespace: str) -> None:
    arguments = ['--ros-args', '--params-file', str(CONFIG)]
    drive, controller, planner = (
        ros_nodes.add(made(namespace=namespace, context=ros_nodes.context, cli_args=arguments))
        for made in (DriveNode, ControllerNode, PlanningNode)
    )
    for node in (drive, controller, planner):
        assert node.get_parameter('robot_model').value == 'ur5e'
    assert drive.get_parameter('level').value == 'second_order'
    assert controller.get_parameter('goal_tolerance').value == 0.001
    assert planner.get_parameter('cartesian_speed').value == 0.25
