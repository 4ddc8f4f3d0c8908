"""Programs with real planner, controller and drives: interrupts, aborts, stops and switches on the path."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import UInt8MultiArray
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core import load_robot_model
from robots_core.motion_result import MotionResult
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_from_message
from robots_core.ros.qos import COMMAND, STATE
from robots_planning.nodes.planning_node import PlanningNode

ROBOT = 'kuka_kr210_r2700'
HOME = 'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
AWAY = 'ptpJointSpaceAngles(60, -60, 70, 0, 60, 0)\n'
# For what happens on the way: a busy machine notices late that the robot moves.
SLOWLY = 'setSpeed(0.2)\n'
# None of the samples may be lost to a test that looks at all of them.
EVERY = QoSProfile(depth=10_000, durability=STATE.durability, reliability=STATE.reliability)


class Cell:
    """Everything from the program to the drives, in one process."""

    def __init__(self, runner: Any, planner_runner: Any, folder: Path) -> None:
        self.runner, self.folder = runner, folder
        self.robot = load_robot_model(ROBOT)
        self.peer = peer = runner.create_node('peer')
        self.references: list[tuple[float, np.ndarray]] = []
        self.results: list[MotionResult] = []
        self.status: list[dict[str, str]] = []
        self.outputs: list[tuple[float, list[int]]] = []
        peer.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, EVERY)
        peer.create_subscription(UInt8MultiArray, 'digital_outputs', self._on_outputs, EVERY)
        peer.create_subscription(
            DiagnosticStatus, 'program_status', lambda m: self.status.append(diagnostic_values(m)), EVERY
        )
        peer.create_subscription(
            DiagnosticStatus,
            'motion_result',
            lambda m: self.results.append(motion_result_from_message(m)),
            COMMAND,
        )
        self.inputs = peer.create_publisher(UInt8MultiArray, 'digital_inputs', STATE)
        overrides = [Parameter('robot_model', value=ROBOT)]
        for kind in (DriveNode, ControllerNode):
            runner.add(kind(context=runner.context, parameter_overrides=overrides))
        self.program = runner.add(LuaProgramNode(context=runner.context, parameter_overrides=overrides))
        # Signs of life do not come from a planner that shares its middleware with the controller.
        self.planner = planner_runner.add(
            PlanningNode(context=planner_runner.context, parameter_overrides=overrides)
        )
        names = ('open', 'run', 'stop')
        self.clients = {name: peer.create_client(Trigger, f'lua_program_node/{name}') for name in names}
        for client in self.clients.values():
            self.wait(client.service_is_ready, 'the services')
        self.wait(lambda: self.references and self.planner._reference is not None, 'the robot')
        self.wait(self.inputs.get_subscription_count, 'the inputs')

    def now(self) -> float:
        """The nodes' clock, s."""
        return 1e-9 * self.peer.get_clock().now().nanoseconds

    def _on_reference(self, message: JointTrajectory) -> None:
        stamp, point = message.header.stamp, message.points[0]
        values = np.array([point.positions, point.velocities, point.accelerations])
        self.references.append((stamp.sec + 1e-9 * stamp.nanosec, values))

    def _on_outputs(self, message: UInt8MultiArray) -> None:
        self.outputs.append((self.now(), list(message.data)))

    def wait(self, condition: Any, what: str) -> Any:
        return self.runner.wait_for(condition, what=what)

    def call(self, name: str) -> None:
        future = self.clients[name].call_async(Trigger.Request())
        self.wait(future.done, f'the answer of ~/{name}')
        assert future.result().success, future.result().message

    def start(self, text: str) -> None:
        """Run a program from home, without the way there among what is recorded."""
        path = self.folder / 'test.lua'
        for program in (HOME, text):
            path.write_text(program)
            (result,) = self.program.set_parameters([Parameter('program', value=str(path))])
            assert result.successful
            self.status.clear()
            self.call('open')
            self.call('run')
            if program is HOME:
                self.end('FINISHED')
                self.results.clear()
                self.references.clear()

    def end(self, state: str) -> dict[str, str]:
        self.wait(
            lambda: self.status and self.status[-1]['state'] in ('FINISHED', 'FAILED', 'STOPPED'), 'its end'
        )
        assert self.status[-1]['state'] == state, self.status[-1]
        self.catch_up()
        return self.status[-1]

    def catch_up(self) -> None:
        """Wait for all references until now: on a busy machine they come after the program's news."""
        now = self.now()
        self.wait(lambda: self.references[-1][0] >= now, 'the references until now')

    def until_moving(self, part: float = 0.3) -> None:
        """Wait until the first axis has turned by a part of 60 degrees."""
        self.wait(
            lambda: self.references and self.references[-1][1][0, 0] > part * np.radians(60.0), 'it moves'
        )

    def set_input(self, value: int) -> None:
        self.inputs.publish(UInt8MultiArray(data=[value]))

    def angles(self) -> np.ndarray:
        """Recorded references, (m, n) deg."""
        return np.degrees([values[0] for _, values in list(self.references)])

    def output_change(self, index: int, value: int) -> float:
        """When an output got a value, s."""
        return self.wait(
            lambda: next((time for time, data in self.outputs if data[index - 1] == value), None),
            f'output {index} = {value}',
        )

    def check(self) -> None:
        """All references keep their limits, and are on the straight line in joint space from home."""
        axes = self.robot.axes_data
        values = np.array([values for _, values in self.references])
        assert (np.abs(values[:, 1]) <= axes.velocity * (1.0 + 1e-6)).all()
        assert (np.abs(values[:, 2]) <= axes.acceleration * (1.0 + 1e-6)).all()
        turned = (self.angles() - [0, -90, 90, 0, 90, 0]) / [60, 30, -20, 1, -30, 1]
        assert np.ptp(turned[:, [0, 1, 2, 4]], axis=1).max() < 1e-6


@pytest.fixture
def cell(ros_nodes: Any, more_ros_nodes: Any, tmp_path: Path) -> Cell:
    return Cell(ros_nodes, more_ros_nodes, tmp_path)


def test_an_input_interrupts_the_motion_which_then_goes_on(cell: Cell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() setDigitalOutput(1, 1) wait(1) setDigitalOutput(1, 0) end)\n'
        + SLOWLY
        + AWAY
    )
    cell.until_moving()
    begin = cell.now()
    cell.set_input(1)
    cell.output_change(1, 1)
    cell.end('FINISHED')
    assert [data[0] for _, data in cell.outputs][-2:] == [1, 0]
    # It brakes when the handler begins, and stands once, on the path, until the handler's second is over.
    stood = [(time, q[0] / np.radians(60.0)) for time, (q, q_dot, _) in cell.references if not q_dot.any()]
    times, parts = np.array([(time, part) for time, part in stood if 0.01 < part < 0.99]).T
    assert times[0] > begin
    assert times[-1] > begin + 1.0 - 0.01  # a reference comes every 4 ms
    assert parts[0] > 0.3
    assert np.ptp(parts) < 1e-12
    assert [result.message for result in cell.results] == ['reached']
    np.testing.assert_allclose(cell.angles()[-1], [60, -60, 70, 0, 60, 0], atol=1e-9)
    cell.check()


def test_a_handler_that_aborts_ends_the_motion_where_it_stands(cell: Cell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() return "abort" end)\n'
        + SLOWLY
        + AWAY
        + 'setDigitalOutput(2, 1)\nwait(0.1)\n'
        + HOME
    )
    cell.until_moving()
    cell.set_input(1)
    after = cell.output_change(2, 1)
    cell.catch_up()
    stood = next(values for time, values in reversed(cell.references) if time <= after)
    assert not stood[1].any()
    assert 0.3 < stood[0, 0] / np.radians(60.0) < 0.99
    cell.end('FINISHED')
    assert [result.ok for result in cell.results] == [False, True]
    np.testing.assert_allclose(cell.angles()[-1], [0, -90, 90, 0, 90, 0], atol=1e-9)
    cell.check()


def test_a_handler_that_moves_ends_the_motion_and_it_is_commanded_anew(cell: Cell) -> None:
    cell.start(
        'onDigitalInput(1, true, function() '
        + HOME.strip()
        + ' setDigitalOutput(3, 1) end)\n'
        + SLOWLY
        + AWAY
    )
    cell.until_moving()
    cell.set_input(1)
    cell.output_change(3, 1)
    cell.end('FINISHED')
    assert [result.ok for result in cell.results] == [False, True, True]
    turned = cell.angles()[:, 0]
    assert turned.argmax() > turned.size // 2  # home again in between
    farthest = int(turned[: turned.size // 2].argmax())
    assert turned[farthest:].min() == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(cell.angles()[-1], [60, -60, 70, 0, 60, 0], atol=1e-9)
    cell.check()


def test_a_stop_leaves_the_robot_on_its_path_and_the_program_runs_again(cell: Cell) -> None:
    cell.start(SLOWLY + AWAY)
    cell.until_moving()
    cell.call('stop')
    cell.end('STOPPED')
    cell.wait(lambda: cell.results, 'the result')
    assert [result.ok for result in cell.results] == [False]
    cell.wait(lambda: not cell.references[-1][1][1].any(), 'it stands')
    assert 0.3 < cell.angles()[-1, 0] / 60.0 < 0.99
    cell.status.clear()
    cell.call('run')
    cell.end('FINISHED')
    np.testing.assert_allclose(cell.angles()[-1], [60, -60, 70, 0, 60, 0], atol=1e-9)
    cell.check()


def test_outputs_switch_at_their_places_on_the_path(cell: Cell) -> None:
    places = np.arange(0.05, 0.40, 0.05)  # m
    switches = ', '.join(
        f'{{distance_after_start = {place:.2f}, output = 1, value = {number % 2 == 0}}}'.replace(
            'T', 't'
        ).replace('F', 'f')
        for number, place in enumerate(places)
    )
    speed = 0.2  # m/s
    cell.start(
        f'setSpeed(nil, {speed})\nlinearRelative({{0, 0, -0.45, 0, 0, 0}}, {{on_path = {{{switches}}}}})\n'
    )
    cell.end('FINISHED')
    references = list(cell.references)  # more are coming
    time = np.array([time for time, _ in references])
    r = np.array([cell.robot.direct_kinematics(values[0])[0] for _, values in references])
    way = np.linalg.norm(r - r[0], axis=1)
    changes = [moment for (_, before), (moment, after) in pairwise(cell.outputs) if before[0] != after[0]]
    assert len(changes) == len(places)
    late = (np.interp(changes, time, way) - places) / speed  # s
    # The controller's moving average lags by 10 ms; a machine that is busy may delay one or the other.
    assert np.median(np.abs(late)) < 0.02
    assert np.abs(late).max() < 0.1
