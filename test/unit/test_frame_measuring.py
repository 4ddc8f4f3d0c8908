"""Measuring of tools, bases and payloads step by step, without a browser."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pendant_desk import ME, READY, Desk
from robots_controller.measuring.frame_measuring import FrameMeasuring
from robots_controller.pendant.motion_recording import MeasuredMotion, MotionRecording
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.program.files.cell_frames import CellFrames, Tool, read_frames, write_frames
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks.calibration.payload_identification import identify_payload
from robots_core.blocks.multibody.numerical_dynamics import NumericalDynamics
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import CommandRefusedError, MeasurementError, RobotsError
from robots_core.orientation import rotation_from_vector
from robots_core.validation import Array

TOOL = Pose([0.02, -0.01, 0.24], rotation_from_vector(np.array([0.3, 0.0, 0.0])))
TIP = np.array([1.6, 0.1, 1.0])
MIDDLE = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
TURNS = ([0.5, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.3, 0.6])
DEADLINE = 60.0  # s, for a machine that is slow and busy


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


@pytest.fixture
def measuring(robot: BaseRobotModel) -> FrameMeasuring:
    return FrameMeasuring(robot)


def placed(robot: BaseRobotModel, tool: Pose, where: Array, point: Array, turn: list[float]) -> Array:
    """Joint positions (n,) with a point of the tool at a place."""
    T = MIDDLE @ rotation_from_vector(np.array(turn))
    solutions: Array = robot.inverse_kinematics_analytic(where - T @ (tool.r + tool.T @ point), T)
    return solutions[0]


def touch_tool(measuring: FrameMeasuring, robot: BaseRobotModel) -> None:
    for turn in TURNS:
        measuring.touch('tool', placed(robot, TOOL, TIP, np.zeros(3), turn))


def test_a_tool_is_measured_and_saved(
    measuring: FrameMeasuring, robot: BaseRobotModel, tmp_path: Path
) -> None:
    file = tmp_path / 'frames.yaml'
    write_frames(file, CellFrames({'gripper': Tool(Pose.identity(), (9.0, 0.0, 0.0, 0.1))}))
    touch_tool(measuring, robot)
    assert len(measuring.residuals()) == 4
    assert max(measuring.residuals()) < 1e-9
    measuring.touch('orientation', placed(robot, TOOL, TIP, np.array([0.0, 0.0, -0.1]), [0.1, 0.0, 0.0]))
    with pytest.raises(MeasurementError, match='second point of the orientation is missing'):
        measuring.tool('-z')
    measuring.touch('orientation', placed(robot, TOOL, TIP, np.array([0.08, 0.0, -0.1]), [0.0, 0.1, 0.0]))
    with pytest.raises(MeasurementError, match='all 2 points are touched'):
        measuring.touch('orientation', np.array(robot.home))
    measuring.save_tool(file, 'gripper', '-z')
    saved = read_frames(file).tools['gripper']
    assert saved.pose.distance_to(TOOL) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert saved.payload == (9.0, 0.0, 0.0, 0.1)  # stays
    assert measuring.points['tool'] == []
    measuring.history.undo()
    assert read_frames(file).tools['gripper'].pose.r[2] == 0.0


def test_a_point_can_be_touched_again(measuring: FrameMeasuring, robot: BaseRobotModel) -> None:
    touch_tool(measuring, robot)
    measuring.points['tool'][2] = Pose(measuring.points['tool'][2].r + 0.01, measuring.points['tool'][2].T)
    with pytest.raises(MeasurementError, match='fits the others least'):
        measuring.tool_center()
    assert max(measuring.residuals()) > 1e-3  # shown all the same
    measuring.remove('tool', 2)
    assert not measuring.complete('tool')
    measuring.touch('tool', placed(robot, TOOL, TIP, np.zeros(3), TURNS[2]))
    np.testing.assert_allclose(measuring.tool_center().r, TOOL.r, atol=1e-9)


def test_a_base_is_touched_with_a_tool_of_the_file(
    measuring: FrameMeasuring, robot: BaseRobotModel, tmp_path: Path
) -> None:
    file = tmp_path / 'frames.yaml'
    write_frames(file, CellFrames({'pen': Tool(TOOL)}))
    base = Pose(TIP, rotation_from_vector(np.array([0.1, 0.0, 0.4])))
    for point in ([0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.1, 0.2, 0.0]):
        q = placed(robot, TOOL, base.r + base.T @ point, np.zeros(3), [0.2, 0.0, 0.0])
        with pytest.raises(MeasurementError, match='of 3 points are touched'):
            measuring.save_base(file, 'table', 'pen')
        measuring.touch('base', q)
    with pytest.raises(RobotsError, match=r"no tool is named 'pencil' in frames\.yaml; tools are pen"):
        measuring.save_base(file, 'table', 'pencil')
    measuring.save_base(file, 'table', 'pen')
    found = read_frames(file)
    assert found.bases['table'].distance_to(base) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert found.names('tool') == ('pen',)


def test_a_file_that_was_broken_by_hand_is_not_overwritten(
    measuring: FrameMeasuring, robot: BaseRobotModel, tmp_path: Path
) -> None:
    file = tmp_path / 'frames.yaml'
    file.write_text('tools:\n  pen: {position: [0, 0]}\n')
    touch_tool(measuring, robot)
    with pytest.raises(RobotsError, match=r'frames\.yaml:2: position'):
        measuring.save_tool(file, 'gripper', '-z')
    assert file.read_text() == 'tools:\n  pen: {position: [0, 0]}\n'
    assert measuring.complete('tool')  # nothing is lost
    with pytest.raises(RobotsError, match='name of the tool is empty'):
        measuring.save_tool(tmp_path / 'new.yaml', '', '-z')


def recorded_motion(robot: BaseRobotModel, payload: Payload) -> Iterator[MeasuredMotion]:
    dynamics = NumericalDynamics(robot, payload=payload)
    speed, swing = np.array([0.5, 0.6, 0.7, 1.0, 1.3, 1.6]), np.array([0.1, 0.1, 0.1, 0.6, 0.6, 0.6])
    for t in np.arange(0.0, 8.0, 0.01):
        q, q_dot, q_ddot = (swing * speed**k * np.sin(speed * t + k * np.pi / 2) for k in (0, 1, 2))
        yield MeasuredMotion(float(t), q + robot.home, dynamics.torques(q + robot.home, q_dot, q_ddot))


def test_a_payload_is_identified_from_a_recording(
    measuring: FrameMeasuring, robot: BaseRobotModel, tmp_path: Path
) -> None:
    motion = [*recorded_motion(robot, Payload(60.0, np.array([0.05, -0.1, 0.25])))]
    recording = MotionRecording(lambda: motion.pop(0) if motion else None)
    recording.start()
    assert recording.running
    deadline = time.monotonic() + DEADLINE
    while motion:
        assert time.monotonic() < deadline, 'the recording'
        time.sleep(0.01)
    recording.stop()
    assert not recording.running
    assert recording.duration == pytest.approx(7.99)
    found = identify_payload(robot, recording.samples())
    assert found.payload.mass == pytest.approx(60.0, abs=0.3)
    file = tmp_path / 'frames.yaml'
    measuring.save_payload(file, 'gripper', found)
    mass, *center = read_frames(file).tools['gripper'].payload
    assert mass == found.payload.mass
    np.testing.assert_allclose(center, [0.05, -0.1, 0.25], atol=2e-3)


# -- what the page permits --------------------------------------------------------------------------------


def test_a_robot_that_moves_is_not_measured() -> None:
    desk = Desk()
    operator: PendantOperator = desk.operator
    with pytest.raises(CommandRefusedError, match='no_position'):
        operator.touch(ME, 'tool')
    q = np.array(desk.robot.home)
    operator.state = replace(READY, q=q, q_dot=0.1 * desk.robot.axes_data.velocity)
    with pytest.raises(CommandRefusedError, match='moving'):
        operator.touch(ME, 'tool')
    with pytest.raises(CommandRefusedError, match='controlled'):
        operator.touch('another', 'tool')
    operator.state = replace(READY, q=q, q_dot=np.zeros_like(q))
    operator.touch(ME, 'tool')
    assert operator.measuring.points['tool'][0].distance_to(Pose(*desk.robot.direct_kinematics(q))) == (0, 0)
