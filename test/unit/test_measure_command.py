"""robots measure: tools, bases and payloads from files, without the page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robots_controller.commands.robots import run
from robots_controller.commands.tool_arguments import HALF_AXES
from robots_controller.program.files.cell_frames import CellFrames, Tool, read_frames, write_frames
from robots_controller.program.files.taught_points import TaughtPoint, write_points
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import NumericalDynamics, Payload
from robots_core.blocks.calibration.three_points import AXES
from robots_core.exit_codes import ExitCode
from robots_core.orientation import rotation_from_vector
from written_bags import BAG_TYPES, write_bag

ROBOT = 'kuka_kr210_r2700'
TIP, TOOL = np.array([1.6, 0.1, 1.0]), np.array([0.02, -0.01, 0.24])
MIDDLE = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
TURNS = ([0.5, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.3, 0.6])


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model(ROBOT)


@pytest.fixture
def points(robot: BaseRobotModel, tmp_path: Path) -> Path:
    """Points of a program that names its robot: of a tool, of its orientation, and of a base."""
    (tmp_path / 'touch.lua').write_text(f'-- Robot: {ROBOT}\n')
    tool = Pose(TOOL, np.eye(3))
    wanted = {f'P{i}': (TIP, np.zeros(3), turn) for i, turn in enumerate(TURNS, 1)}
    wanted['shaft'] = (TIP, np.array([0.0, 0.0, -0.1]), [0.1, 0.0, 0.0])
    wanted['side'] = (TIP, np.array([0.08, 0.0, -0.1]), [0.0, 0.1, 0.0])
    for name, way in {'origin': [0, 0, 0], 'x': [0.3, 0, 0], 'y': [0.05, 0.2, 0]}.items():
        wanted[name] = (TIP + way, np.zeros(3), [0.2, 0.0, 0.0])
    file = tmp_path / 'touch.points.yaml'
    write_points(file, {name: touching(robot, tool, *one) for name, one in wanted.items()})
    return file


def touching(robot: BaseRobotModel, tool: Pose, where: Any, point: Any, turn: Any) -> TaughtPoint:
    """Where the robot holds a point of its tool at a place."""
    T = MIDDLE @ rotation_from_vector(np.array(turn))
    q = robot.inverse_kinematics_analytic(where - T @ (tool.r + point), T)[0]
    return TaughtPoint(q, Pose(*robot.direct_kinematics(q)))


def measured(capsys: pytest.CaptureFixture[str], *words: object) -> dict[str, Any]:
    assert run(['measure', *map(str, words), '--json']) == ExitCode.OK
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_a_tool_is_measured_from_taught_points_and_saved(
    points: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ('tool', points, '--points', 'P1', 'P2', 'P3', 'P4', '--orientation', 'shaft', 'side')
    found = measured(capsys, *words)
    np.testing.assert_allclose(found['position'], TOOL, atol=1e-9)
    np.testing.assert_allclose(found['touched'], TIP, atol=1e-9)
    assert found['residuals'].keys() == {'P1', 'P2', 'P3', 'P4'}
    assert max(*found['residuals'].values(), *found['std']) < 1e-9
    assert found['saved'] is None
    frames = points.with_name('frames.yaml')
    assert not frames.exists()
    assert run(['measure', *map(str, words), '--name', 'pen']) == ExitCode.OK
    shown = capsys.readouterr().out
    assert f'tool pen is saved in {frames}' in shown.replace('\n', '')
    assert '240.00' in shown
    pose = read_frames(frames).tools['pen'].pose
    assert pose.distance_to(Pose(TOOL, np.eye(3))) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_a_point_that_does_not_fit_is_named(points: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ('measure', 'tool', str(points), '--points', 'P1', 'P2', 'x', 'P4', '--name', 'pen')
    assert run(words) == ExitCode.BAD_INPUT
    error = capsys.readouterr().err
    assert 'fits the others least' in error
    assert '(point 3 is x) [R109]' in error
    assert not points.with_name('frames.yaml').exists()
    assert run(['measure', 'tool', str(points), '--points', 'P0']) == ExitCode.BAD_INPUT
    assert "no point is named 'P0'; points are P1, P2, P3, P4, origin, shaft" in capsys.readouterr().err


def test_a_base_is_measured_with_a_tool_of_the_file(points: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frames = points.with_name('cell.yaml')
    write_frames(frames, CellFrames({'pen': Tool(Pose(TOOL, np.eye(3)))}))
    words = ('base', points, '--points', 'origin', 'x', 'y', '--tool', 'pen', '--frames', frames)
    found = measured(capsys, *words, '--name', 'table')
    np.testing.assert_allclose(found['position'], TIP, atol=1e-9)
    assert found['saved'] == str(frames)
    assert read_frames(frames).names('base') == ('table',)
    assert read_frames(frames).names('tool') == ('pen',)
    assert run(['measure', 'base', str(points), '--points', 'origin', 'x', 'y', '--tool', 'pin']) == 2
    assert "no tool is named 'pin'" in capsys.readouterr().err


def write_motion(robot: BaseRobotModel, path: Path, *, torques: bool) -> Path:
    """A bag of a robot that turns a payload."""
    dynamics = NumericalDynamics(robot, payload=Payload(60.0, np.array([0.05, -0.1, 0.25])))
    speed, swing = np.array([0.5, 0.6, 0.7, 1.0, 1.3, 1.6]), np.array([0.1, 0.1, 0.1, 0.6, 0.6, 0.6])
    types = BAG_TYPES.types
    messages: list[tuple[float, str, Any]] = [
        (
            0.0,
            '/motion_result',
            types['diagnostic_msgs/msg/DiagnosticStatus'](
                level=0, name='', message='', hardware_id=ROBOT, values=[]
            ),
        )
    ]
    for t in np.arange(0.0, 8.0, 0.01):
        q, q_dot, q_ddot = (swing * speed**k * np.sin(speed * t + k * np.pi / 2) for k in (0, 1, 2))
        q = q + robot.home
        tau = dynamics.torques(q, q_dot, q_ddot) if torques else np.zeros(0)
        stamp = types['builtin_interfaces/msg/Time'](sec=int(t), nanosec=round(1e9 * (t % 1.0)) % 10**9)
        header = types['std_msgs/msg/Header'](stamp=stamp, frame_id='')
        names = list(robot.axes_data.names)
        state = types['sensor_msgs/msg/JointState'](header, names, q, q_dot, tau)
        messages.append((float(t), '/joint_states', state))
    return write_bag(path, messages)


def test_a_payload_is_identified_from_a_bag_and_saved_with_its_tool(
    robot: BaseRobotModel, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag, frames = write_motion(robot, tmp_path / 'bag', torques=True), tmp_path / 'frames.yaml'
    write_frames(frames, CellFrames({'pen': Tool(Pose(TOOL, np.eye(3)))}))
    found = measured(capsys, 'payload', bag, '--name', 'pen', '--frames', frames)
    assert found['mass'] == pytest.approx(60.0, abs=0.3)
    assert 0.0 < found['mass_std'] < 1.0
    assert found['torque_residuals'].keys() == set(robot.axes_data.names)
    tool = read_frames(frames).tools['pen']
    assert tool.payload == pytest.approx((found['mass'], *found['center']))
    np.testing.assert_allclose(tool.pose.r, TOOL, atol=1e-9)
    assert run(['measure', 'payload', str(bag)]) == ExitCode.OK
    assert 'centre of mass x' in capsys.readouterr().out


def test_a_bag_without_torques_is_refused(
    robot: BaseRobotModel, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_motion(robot, tmp_path / 'bag', torques=False)
    assert run(['measure', 'payload', str(bag)]) == ExitCode.BAD_INPUT
    assert 'has no torques (effort) in /joint_states' in capsys.readouterr().err


def test_the_robot_must_be_known(points: Path, capsys: pytest.CaptureFixture[str]) -> None:
    points.with_name('touch.lua').unlink()
    assert run(['measure', 'tool', str(points)]) == ExitCode.BAD_INPUT
    assert 'name it: --robot NAME' in capsys.readouterr().err


def test_the_half_axes_are_those_of_the_measurement() -> None:
    assert set(HALF_AXES) == set(AXES)
