"""The operator's page in a real browser, with the nodes of a cell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, Page
from trajectory_msgs.msg import JointTrajectory

from late_drives import LATE_DRIVES, SPARSE
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_controller.nodes.pendant_node import PendantNode
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.permissions import Action, refusal
from robots_controller.program.files.cell_frames import read_frames
from robots_controller.program.run_state import RunState
from robots_core import load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_planning.nodes.planning_node import PlanningNode

from .browser_page import FORWARDS, open_page, press, shown, take_control, wait
from .touched_tip import TOOL, TURNS, guide, save, touching

ROBOT = 'bello_bot'
TOUCHING = 'kuka_kr210_r2700'
LATE = 0.1  # rad
PAGE = {'port': 0, 'connection_timeout': 60.0}


def test_a_robot_is_jogged_and_stands_when_the_browser_is_gone(running: Browser, ros_nodes: Any) -> None:
    moving: list[bool] = [False]
    ros_nodes.create_node().create_subscription(
        JointTrajectory,
        'joint_reference',
        lambda message: moving.append(any(message.points[0].velocities)),
        1,
    )
    for kind in (LuaProgramNode, PlanningNode):
        ros_nodes.add(kind(**ros_nodes.options(robot_model=ROBOT)))
    ros_nodes.add(DriveNode(**ros_nodes.options(robot_model=ROBOT, **SPARSE)))
    options = {'robot_model': ROBOT, 'operating_mode': 'T1', **LATE_DRIVES, **SPARSE}
    ros_nodes.add(ControllerNode(**ros_nodes.options(**options)))
    node = ros_nodes.add(PendantNode(**ros_nodes.options(robot_model=ROBOT, **PAGE)))
    page = open_page(running, node.url)
    page.get_by_text('connected', exact=True).wait_for()
    take_control(page)
    page.locator('.jog-panel .rows:not(.blocked)').wait_for()
    press(page, FORWARDS)
    wait(page, lambda: moving[-1], 'it moves')
    page.context.close()
    ros_nodes.wait_for(lambda: not moving[-1], what='it stands')


def test_a_known_tool_is_found_within_a_tenth_of_a_millimetre_in_a_cell(
    window: Page, ros_nodes: Any, tmp_path: Path
) -> None:
    robot = load_robot_model(TOUCHING)
    program = tmp_path / 'touch.lua'
    moves = [np.degrees(touching(robot, turn)).tolist() for turn in TURNS]
    program.write_text(''.join(f'ptpJointSpaceAngles({str(q)[1:-1]})\nhalt()\n' for q in moves))
    ros_nodes.add(DriveNode(**ros_nodes.options(robot_model=TOUCHING, level='ideal', **SPARSE)))
    ros_nodes.add(PlanningNode(**ros_nodes.options(robot_model=TOUCHING)))
    ros_nodes.add(LuaProgramNode(**ros_nodes.options(robot_model=TOUCHING, program=str(program))))
    # The test itself waits until the robot stands: drives of a busy machine are late.
    late = {'robot_model': TOUCHING, 'goal_tolerance': LATE, **LATE_DRIVES, **SPARSE}
    ros_nodes.add(ControllerNode(**ros_nodes.options(**late)))
    node = ros_nodes.add(
        PendantNode(**ros_nodes.options(robot_model=TOUCHING, programs=str(tmp_path), **PAGE))
    )
    operator: PendantOperator = node.operator
    with shown(window, node.url) as page:
        page.get_by_text('connected', exact=True).wait_for()
        take_control(page)
        operator.open_program(operator.desk.holder, str(program))
        page.get_by_role('tab', name='Tools').click()
        tool = guide(page, 'Tool')
        for number in range(len(TURNS)):
            action = Action.RESUME if number else Action.RUN
            wait(page, lambda: _permitted(operator, action), 'a program that can go on')  # noqa: B023
            line = 2 * number + 2
            operator.act(operator.desk.holder, action)
            wait(page, lambda: _halted(operator, line), 'the next point')  # noqa: B023
            wait(page, lambda: _stands(operator, moves[number]), 'a robot that stands')  # noqa: B023
            tool.get_by_role('button', name='Touch here').first.click()
            tool.locator('.touched-point.touched').nth(number).wait_for()
        tool.locator('.found:not(.wrong)').first.wait_for()
        save(tool, 'gripper')
        tool.get_by_text('gripper is saved in frames.yaml.').wait_for()
    found = read_frames(tmp_path / 'frames.yaml').tools['gripper'].pose.r
    assert np.linalg.norm(found - TOOL) < 1e-4


def _permitted(operator: PendantOperator, action: Action) -> bool:
    return refusal(action, operator.state) is None


def _halted(operator: PendantOperator, line: int) -> bool:
    program = operator.state.program
    return program.state is RunState.PAUSED and program.line == line


def _stands(operator: PendantOperator, degrees: list[float]) -> bool:
    q, q_dot = operator.state.q, operator.state.q_dot
    return (
        q is not None
        and q_dot is not None
        and bool(np.abs(q - np.radians(degrees)).max() < 1e-5)
        and bool(np.abs(q_dot).max() < 1e-4)
    )
