"""CellClient: motions, inputs and outputs, and programs of a cell from Python."""

from __future__ import annotations

import runpy
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rcl_interfaces.msg import Log

from robots_controller.client import CellClient
from robots_controller.program.run_state import RunState
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import (
    CommandRefusedError,
    InvalidInputError,
    JointLimitError,
    PlanningError,
    ProgramError,
    RobotsError,
)
from robots_core.pose import Pose

from .program_cell import ProgramCell

PATIENCE = 240.0  # s, for a machine that is slow and busy
UP = Pose(np.array([0.0, 0.0, 0.05]), np.eye(3))
NEAR = np.radians([10.0, -80.0, 80.0, 0.0, 60.0, 0.0])


@pytest.fixture(scope='module')
def cell(module_ros_nodes: Any, tmp_path_factory: pytest.TempPathFactory) -> ProgramCell:
    return ProgramCell(module_ros_nodes, tmp_path_factory.mktemp('cell'))


@pytest.fixture(scope='module')
def client(cell: ProgramCell) -> Iterator[CellClient]:
    with CellClient(patience=PATIENCE) as client:
        assert client.robot.name == cell.program.robot.name
        yield client


def test_motions_reach_their_targets_with_the_settings_of_the_client(
    cell: ProgramCell, client: CellClient
) -> None:
    client.change_settings(tool=UP)
    client.move_joint(NEAR).wait()
    np.testing.assert_allclose(cell.until_standing(), np.degrees(NEAR), atol=1e-9)
    target = client.tool_pose @ UP
    progress = list(client.move_line(target, cartesian_speed=0.1).updates(0.01))
    assert progress == sorted(progress)
    assert progress[-1] == 1.0
    cell.wait(lambda: np.allclose(client.tool_pose.r, target.r, atol=1e-9), 'the drives')
    client.change_settings(tool=Pose.identity())


def test_motions_commanded_ahead_blend(cell: ProgramCell, client: CellClient) -> None:
    cell.results.clear()
    first = client.move_joint(NEAR, joint_blend_zone=0.1)
    second = client.move_joint(0.9 * NEAR)
    second.wait()
    assert first.done
    cell.wait(lambda: len(cell.results) == 2, 'the results')
    assert {one.message for one in cell.results} == {'passed', 'reached'}  # two nodes report them


def test_what_cannot_be_moved_to_is_refused_where_it_is_commanded_or_waited_for(client: CellClient) -> None:
    with pytest.raises(JointLimitError, match='A1 = 10 rad is outside'):
        client.move_joint([10.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InvalidInputError, match=r'speed_fraction = 2'):
        client.move_joint(NEAR, speed_fraction=2.0)
    with pytest.raises(InvalidInputError, match=r'unknown setting sped; settings are speed_fraction'):
        client.change_settings(sped=1.0)
    with pytest.raises(InvalidInputError, match=r'override = 2 must be in \[0, 1\]'):
        client.set_override(2.0)
    with pytest.raises(InvalidInputError, match='at least one pose'):
        client.move_spline([])
    with pytest.raises(InvalidInputError, match=r'\[1, 2, 3\] is no Pose'):
        client.move_circle(client.tool_pose, [1, 2, 3])  # type: ignore[arg-type]
    far = client.move_line(Pose(np.array([9.0, 0.0, 0.0]), np.eye(3)))
    with pytest.raises(RobotsError, match='reach'):
        far.wait()
    assert far.done
    client.move_joint(NEAR).wait()


def test_after_a_motion_that_failed_nothing_is_executed_until_the_client_has_heard_of_it(
    cell: ProgramCell, client: CellClient
) -> None:
    place = cell.until_standing()
    client.set_override(0.001)  # not far, however late the robot is stopped
    motions = [client.move_line(Pose(np.array([9.0, 0.0, 0.0]), np.eye(3)))]

    def command() -> None:
        while True:
            motions.append(client.move_joint(0.5 * NEAR))

    with pytest.raises(PlanningError, match=r'^not commanded, as a motion before it has failed: .*reach'):
        command()
    assert all(motion.done for motion in motions)
    np.testing.assert_allclose(cell.until_standing(), place, atol=2.0)
    client.set_override(1.0)
    client.move_joint(0.8 * NEAR).wait()
    for motion in motions:
        with pytest.raises(RobotsError):  # canceled, given up, or planned while the robot was moving
            motion.wait()
    client.move_joint(NEAR).wait()


@pytest.mark.parametrize('how', ['cancel', 'stop'])
def test_a_motion_can_be_ended_and_a_stop_holds_until_its_reset(
    cell: ProgramCell, client: CellClient, how: str
) -> None:
    client.set_override(0.002)
    motion = client.move_joint(0.8 * NEAR)
    cell.until_moving()
    assert not motion.wait(0.0)
    getattr(client, how)()
    with pytest.raises(RobotsError, match=how):
        motion.wait()
    client.set_override(1.0)
    if how == 'stop':
        with pytest.raises(RobotsError, match='stop by ~/stop'):
            client.move_joint(NEAR).wait()
        cell.until_standing()
        client.reset()
    client.move_joint(NEAR).wait()


def test_inputs_and_outputs_by_name(cell: ProgramCell, client: CellClient) -> None:
    io = client.io
    assert 'digital_output.1' in io.names
    io['digital_output.2'] = True
    assert io['digital_output.2'] is True
    cell.wait(lambda: cell.outputs[-1][1] == 1, 'the output')
    io['analog_output.1'] = 2.5
    assert io['analog_output.1'] == 2.5
    io.force('digital_input.1', True)
    assert io['digital_input.1'] is True
    io.release('digital_input.1')
    assert io['digital_input.1'] is False
    cell.set_input(1)
    assert io.wait_for('digital_input.1', True)
    assert not io.wait_for('digital_input.1', False, timeout=0.0)
    with pytest.raises(InvalidInputError, match='gun'):
        io['gun']
    with pytest.raises(InvalidInputError, match=r'analog_output\.1'):
        io['analog_output.1'] = True
    io['digital_output.2'] = np.bool_(False)  # what comparisons of arrays yield
    assert io['digital_output.2'] is False
    for wrong in (None, 'on', 2**63):
        with pytest.raises(InvalidInputError, match=r'digital_input\.1\.force got'):
            io.force('digital_input.1', wrong)  # type: ignore[arg-type]


def test_programs_run_to_their_end_again_and_again(
    cell: ProgramCell, client: CellClient, tmp_path: Path
) -> None:
    path = tmp_path / 'greeting.lua'
    path.write_text('setDigitalOutput(1, 1)\n')
    printed: list[str] = []
    client.program.on_print = printed.append
    client.program.open(path)
    for _ in range(2):
        client.program.run()
        assert client.program.wait()
        assert client.program.state is RunState.FINISHED
    cell.wait(lambda: cell.outputs[-1][0] == 1, 'the output')
    # What the node prints itself goes to /rosout only if no context of this process has ended before.
    cell.publish('/rosout', Log(name='lua_program_node.print', msg='hello'))
    cell.wait(lambda: printed == ['hello'], 'the print')
    path.write_text('\nerror("no part")\n')
    client.program.open(path)
    client.program.run()
    with pytest.raises(ProgramError, match='no part'):
        client.program.wait()
    assert client.program.line == 2
    with pytest.raises(RobotsError, match=r'missing\.lua'):
        client.program.open(tmp_path / 'missing.lua')


def test_a_late_report_of_the_run_before_is_not_taken_for_the_end(
    cell: ProgramCell, client: CellClient, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / 'waiting.lua'
    path.write_text('wait(3600)\n')
    client.program.open(path)
    client.program.run()
    client.program.stop()
    with pytest.raises(ProgramError, match='the program was stopped'):
        client.program.wait()
    trigger = client.program._connection.trigger

    def late(service: str) -> str:
        cell.program.host.reporter.report()
        return trigger(service)

    monkeypatch.setattr(client.program._connection, 'trigger', late)
    client.program.run()
    assert client.program.state is RunState.RUNNING
    assert not client.program.wait(0.0)
    client.program.stop()
    with pytest.raises(ProgramError, match='the program was stopped'):
        client.program.wait()


def test_the_client_commands_a_robot_that_it_has_taken(cell: ProgramCell, client: CellClient) -> None:
    client.take_command()
    cell.wait(lambda: client.commander is Commander.REMOTE, 'the commander')
    (cell.folder / 'move.lua').write_text('ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)')
    client.program.open(cell.folder / 'move.lua')
    with pytest.raises(RobotsError, match='REMOTE commands the robot, not PROGRAM'):
        client.program.run()
    client.give_back_command()
    client.program.run()
    client.program.wait()
    cell.set_parameters(cell.controller, operating_mode='T1')
    cell.wait(lambda: client.operating_mode == 'T1', 'the mode')
    with pytest.raises(CommandRefusedError, match='T1'):
        client.take_command()
    cell.set_parameters(cell.controller, operating_mode='AUTOMATIC')


def test_a_fault_is_seen_and_reset(cell: ProgramCell, client: CellClient) -> None:
    client.emergency_stop()
    cell.wait(lambda: client.fault, 'the fault')
    with pytest.raises(RobotsError, match='emergency'):
        client.move_joint(NEAR).wait()
    client.reset()
    cell.wait(lambda: not client.fault, 'its end')
    client.move_joint(NEAR).wait()


def test_no_cell_is_an_error(ros_domain: int) -> None:
    with pytest.raises(
        RobotsError, match=rf'has not answered .* is the cell running, in ROS domain {ros_domain}'
    ):
        CellClient('/nowhere', patience=0.1)


@pytest.mark.usefixtures('cell')
def test_the_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path('examples/drive_a_cell.py')['main']()
    assert '100% at' in capsys.readouterr().out
