"""visualizer_node: a page at a published address that follows joint_states."""

from __future__ import annotations

import socket
from typing import Any
from urllib.request import urlopen

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState

from robots_core import load_robot_model
from robots_core.blocks.visualizer import Visualizer
from robots_core.errors import InvalidInputError
from robots_core.nodes.visualizer_node import VisualizerNode
from robots_core.ros.messages import diagnostic_values, doubles
from robots_core.ros.qos import COMMAND, STATE

ROBOT = 'bello_bot'


def make_node(runner: Any, **parameters: Any) -> VisualizerNode:
    values = {'robot_model': ROBOT, 'port': 0, **parameters}
    overrides = [Parameter(name, value=value) for name, value in values.items()]
    return runner.add(VisualizerNode(context=runner.context, parameter_overrides=overrides))


def test_health_has_the_address_of_the_page(ros_nodes: Any):
    health: list[DiagnosticStatus] = []
    ros_nodes.create_node().create_subscription(
        DiagnosticArray, '/diagnostics', lambda message: health.extend(message.status), COMMAND
    )
    node = make_node(ros_nodes)
    ros_nodes.wait_for(lambda: health, what='health')
    assert health[-1].level == DiagnosticStatus.OK
    url = diagnostic_values(health[-1])['url']
    assert url == node.url
    with urlopen(url, timeout=240.0) as page:  # noqa: S310  # our own address
        assert page.status == 200


def test_page_follows_joint_states_and_survives_bad_ones(ros_nodes: Any, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Visualizer, 'watched', True)
    node = make_node(ros_nodes)
    robot = load_robot_model(ROBOT)
    tester = ros_nodes.create_node()
    health: list[DiagnosticStatus] = []
    tester.create_subscription(
        DiagnosticArray, '/diagnostics', lambda message: health.extend(message.status), COMMAND
    )
    publisher = tester.create_publisher(JointState, 'joint_states', STATE)
    ros_nodes.wait_for(lambda: publisher.get_subscription_count() == 1, what='the node listens')

    def shown(q: np.ndarray) -> bool:
        expected, _ = robot.direct_kinematics(q)
        position = np.asarray(node._visualizer._tool_frame.position)
        return bool(np.abs(position - expected).max() < 1e-6)  # the page may keep single precision

    names = list(robot.axes_data.names)
    publisher.publish(JointState(name=names, position=doubles(robot.home + 0.1)))
    ros_nodes.wait_for(lambda: shown(robot.home + 0.1), what='the page follows')
    publisher.publish(JointState(name=names, position=doubles(np.full(7, np.nan))))
    ros_nodes.wait_for(lambda: any('is nan' in status.message for status in health), what='a warning')
    assert shown(robot.home + 0.1)
    publisher.publish(JointState(name=names[::-1], position=doubles((robot.home - 0.1)[::-1])))
    ros_nodes.wait_for(lambda: shown(robot.home - 0.1), what='the page follows again')


def test_busy_port_is_no_error(ros_nodes: Any):
    with socket.create_server(('127.0.0.1', 0)) as busy:
        port = busy.getsockname()[1]
        assert int(make_node(ros_nodes, port=port).url.rpartition(':')[2]) > port


def test_bad_host_ends_the_node(ros_context: Any):
    overrides = [Parameter('host', value='192.0.2.1')]  # reserved for documentation
    with pytest.raises(InvalidInputError, match='cannot serve at host'):
        VisualizerNode(context=ros_context, parameter_overrides=overrides)
