"""A cell outlives wrong programs: each is explained, and the next one runs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from robots_core import load_robot_model
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE

from .cell_process import CellThread

ROBOT = 'bello_bot'
WRONG = [
    ('wait(1 2)', "1: ')' expected near '2'"),
    ('local t = nil\nt.x = 1', "2: attempt to index a nil value (local 't')"),
    ('ptpCartesianSpace(9, 9, 9, 0, 0, 0)', '1: ptpCartesianSpace: '),
    ('ptpJointSpaceAngles(0/0, 0, 0, 0, 0, 0, 0)', '1: ptpJointSpaceAngles: '),
    ('ptpJointSpaceAngles(0, 0, 0, 999, 0, 0, 0)', 'J4 = 999 deg is outside its limits ['),
    ('ptpJointSpaceAngles(0, 0)', '1: ptpJointSpaceAngles: '),
    ('setDigitalOutput(99, 1)', '1: setDigitalOutput: '),
    ('error("my own words")', 'my own words'),
]


class Operator:
    """Opens and runs programs by the node's services."""

    def __init__(self, nodes: Any) -> None:
        self.nodes = nodes
        self.node = nodes.create_node('operator')
        self.status: dict[str, str] = {}
        services = {'set_parameters': SetParameters, 'open': Trigger, 'run': Trigger}
        self._clients = {
            name: self.node.create_client(kind, f'lua_program_node/{name}') for name, kind in services.items()
        }
        self.node.create_subscription(DiagnosticStatus, 'program_status', self._on_status, STATE)

    def _on_status(self, message: DiagnosticStatus) -> None:
        self.status = diagnostic_values(message)

    def until_found(self) -> None:
        """A service drops its answers to a client that it has not found yet: ask what changes nothing."""
        for client in self._clients.values():
            self.nodes.wait_for(client.service_is_ready, what=client.service_name)
        futures: list[Any] = []

        def answered() -> bool:
            futures.append(self._clients['set_parameters'].call_async(SetParameters.Request()))
            return any(future.done() for future in futures)

        self.nodes.wait_for(answered, what='an answer')

    def _call(self, name: str, request: Any) -> Any:
        future = self._clients[name].call_async(request)
        return self.nodes.wait_for(lambda: future.done() and future.result(), what=name)

    def run(self, program: Path) -> str:
        """Open and run a program; returns '' or why it failed."""
        parameter = Parameter('program', value=str(program)).to_parameter_msg()
        self._call('set_parameters', SetParameters.Request(parameters=[parameter]))
        opened = self._call('open', Trigger.Request())
        if not opened.success:
            return str(opened.message)
        started = self._call('run', Trigger.Request())
        assert started.success, started.message
        self.nodes.wait_for(
            lambda: (
                self.status.get('file') == program.name and self.status.get('state') in ('FINISHED', 'FAILED')
            ),
            what=f'the end of {program.name}',
        )
        return self.status['error']


def test_every_mistake_is_explained_and_the_next_program_runs(
    ros_nodes: Any, start_cell: Callable[..., CellThread], tmp_path: Path
) -> None:
    cell = start_cell('--robot', ROBOT, '--lockstep', '--rate', '50')
    cell.until_ready()
    operator = Operator(ros_nodes)
    operator.until_found()
    good = tmp_path / 'good.lua'
    home = np.degrees(load_robot_model(ROBOT).home)
    turned = ', '.join(f'{angle:.6f}' for angle in np.add(home, [5.0, *6 * [0.0]]))
    there = ', '.join(f'{angle:.6f}' for angle in home)
    good.write_text(f'ptpJointSpaceAngles({turned})\nptpJointSpaceAngles({there})\n')
    for number, (text, message) in enumerate(WRONG):
        wrong = tmp_path / f'wrong_{number}.lua'
        wrong.write_text(text)
        error = operator.run(wrong)
        assert message in error
        assert wrong.name in error
        assert operator.run(good) == ''
    assert 'there is no program' in operator.run(tmp_path / 'missing.lua')
    assert operator.run(good) == ''
    assert not cell.node_pids().keys() ^ {
        'controller_node',
        'direct_kinematics_node',
        'drive_node',
        'lua_program_node',
        'planning_node',
        'robot_state_node',
    }
    assert 'Traceback' not in cell.logs
