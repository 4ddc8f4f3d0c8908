"""The operator's page in a real browser, with the nodes of a cell."""

from __future__ import annotations

from typing import Any

from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_controller.nodes.pendant_node import PendantNode
from robots_core.nodes.drive_node import DriveNode
from robots_planning.nodes.planning_node import PlanningNode

from .browser_page import FORWARDS, browser, open_page, press, take_control, wait

ROBOT = 'bello_bot'
PATIENT = 20.0  # s, with drives that a busy machine delays


def test_a_robot_is_jogged_and_stands_when_the_browser_is_gone(ros_nodes: Any) -> None:
    moving: list[bool] = [False]
    ros_nodes.create_node().create_subscription(
        JointTrajectory,
        'joint_reference',
        lambda message: moving.append(any(message.points[0].velocities)),
        1,
    )
    for kind in (DriveNode, LuaProgramNode, PlanningNode):
        ros_nodes.add(kind(**ros_nodes.options(robot_model=ROBOT)))
    options = {'robot_model': ROBOT, 'feedback_timeout': PATIENT, 'operating_mode': 'T1'}
    ros_nodes.add(ControllerNode(**ros_nodes.options(**options)))
    node = ros_nodes.add(PendantNode(**ros_nodes.options(robot_model=ROBOT, port=0)))
    with browser('--disable-gpu') as running:
        page = open_page(running, node.url)
        page.get_by_text('connected', exact=True).wait_for()
        take_control(page)
        page.locator('.jog-panel .rows:not(.blocked)').wait_for()
        press(page, FORWARDS)
        wait(page, lambda: moving[-1], 'it moves')
        page.context.close()
        ros_nodes.wait_for(lambda: not moving[-1], what='it stands')
