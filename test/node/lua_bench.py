"""lua_program_node, and the robot's side played by a test."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Log
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, String, UInt8MultiArray
from std_srvs.srv import SetBool, Trigger
from trajectory_msgs.msg import JointTrajectory

from bench import EVERY_STATE, Bench
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.ros.messages import diagnostic_values, message_class, motion_result_message, stamp_id
from robots_core.ros.qos import COMMAND
from robots_planning.motion_kinds import MOTION_KINDS

ROBOT = 'kuka_kr210_r2700'
MOVE = 'ptpJointSpaceAngles(0, -90, 45, 0, 45, 0)'


class LuaBench(Bench):
    """The node under test, and a test node that plays planning_node and controller_node."""

    def __init__(self, runner: Any, folder: Path, *, planner: bool = True, **parameters: Any) -> None:
        super().__init__(runner, 'monitor')
        self.folder = folder
        self.commands: list[tuple[str, Any]] = []
        self.controller_calls: list[str] = []
        self.on_controller_call: Callable[[str], None] = lambda _: None
        self.on_command: Callable[[str], None] = self.answer
        self.states = self.collect('command_state', String, EVERY_STATE, lambda m: m.data)
        self.status = self.collect('program_status', DiagnosticStatus, EVERY_STATE)
        self.digital = self.collect('digital_outputs', UInt8MultiArray, EVERY_STATE, lambda m: list(m.data))
        self.analog = self.collect('analog_outputs', Float64MultiArray, EVERY_STATE, lambda m: list(m.data))
        self.log = self.collect('/rosout', Log, EVERY_STATE)
        # As a recorder does: subscribed to the commands without planning them.
        self.collect('ptpjoint_joint', JointState, COMMAND)
        for name in ('pause', 'resume', 'cancel'):
            self.peer.create_service(
                Trigger, f'controller_node/{name}', lambda _, r, name=name: self._controller(name, r)
            )
        self.on_taken: Callable[[], None] = lambda: None
        self.peer.create_service(SetBool, 'controller_node/commander/program', self._take)
        self.planner: Any = None
        if planner:
            self.start_planner()
        self.node = self.start_node(LuaProgramNode, robot_model=ROBOT, **parameters)
        self.wait(lambda: self.states and self.status, 'the first states')

    def start_planner(self) -> None:
        self.planner = self.runner.create_node('planning_node')
        self.results = self.planner.create_publisher(DiagnosticStatus, 'motion_result', COMMAND)
        for kind in MOTION_KINDS:
            self.planner.create_subscription(
                message_class(kind.message_type), kind.topic, partial(self._command, kind.topic), COMMAND
            )
        self.planner.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)

    def _command(self, topic: str, message: Any) -> None:
        self.commands.append((topic, message))
        self.on_command(stamp_id(message.header.stamp))

    def _controller(self, name: str, response: Trigger.Response) -> Trigger.Response:
        self.controller_calls.append(name)
        self.on_controller_call(name)
        response.success = True
        return response

    def _take(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        if request.data:
            self.on_taken()
        response.success = True
        return response

    def answer(self, id_: str, message: str = 'reached', *, ok: bool = True, **details: str) -> None:
        self.results.publish(motion_result_message(MotionResult(id_, ok, message, details), ROBOT))

    def command_id(self) -> str:
        return stamp_id(self.commands[-1][1].header.stamp)

    def ask(self, name: str) -> Trigger.Response:
        return self.call(f'lua_program_node/{name}')

    def write(self, text: str) -> None:
        path = self.folder / 'test.lua'
        path.write_text(text)
        (result,) = self.node.set_parameters([Parameter('program', value=str(path))])
        assert result.successful

    def start(self, text: str) -> None:
        self.write(text)
        self.status.clear()
        for name in ('open', 'run'):
            response = self.ask(name)
            assert response.success, response.message

    def wait_for_state(self, state: str) -> dict[str, str]:
        def found() -> dict[str, str] | None:
            values = [diagnostic_values(status) for status in self.status]
            return next((value for value in values if value['state'] == state), None)

        return self.wait(found, f'state {state}')

    def wait_for_command(self) -> None:
        self.wait(lambda: self.commands, 'a motion command')


def ignore(_: str) -> None:
    """Answers a command with nothing."""


class SettingsBench(LuaBench):
    """A planner with parameters, which it notes with every command."""

    def start_planner(self) -> None:
        super().start_planner()
        self.settings: list[dict[str, Any]] = []
        for name, value in (
            ('speed_fraction', 0.8),
            ('cartesian_speed', 0.5),
            ('blend_zone', 0.0),
            ('joint_blend_zone', 0.0),
            ('tool', [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        ):
            self.planner.declare_parameter(name, value)

    def _command(self, topic: str, message: Any) -> None:
        self.settings.append({name: p.value for name, p in self.planner._parameters.items()})
        super()._command(topic, message)
