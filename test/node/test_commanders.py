"""One commander at a time, and operating modes, through the nodes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String, UInt64
from std_srvs.srv import SetBool

from bench import EVERY_STATE
from robots_core import load_robot_model
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import BUILD, stamp_id
from robots_core.ros.qos import COMMAND, SENSOR, STATE

from .program_cell import CRAWL, MOVE, ROBOT, ProgramCell

NAMES = load_robot_model(ROBOT).axes_data.names
HOLD_PERIOD = 0.02  # s
FOREVER = 'while true do wait(0.1) end\n'


class CommandedCell(ProgramCell):
    """A cell with a stranger that commands motions and a pendant that holds run."""

    def __init__(self, runner: Any, folder: Path, **controller: Any) -> None:
        super().__init__(runner, folder, **controller)
        self.commanders = self.collect('commander', String, EVERY_STATE, lambda m: m.data)
        self.modes = self.collect('operating_mode', String, EVERY_STATE, lambda m: m.data)
        self.stranger: Node = runner.create_node('stranger')
        self._commands = self.stranger.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
        self._hold: Any = None
        known = self.planner.admission.commanders
        self.wait(lambda: self.modes and known.mode and self._commands.get_subscription_count(), 'the cell')

    def order(self, q: np.ndarray) -> MotionResult:
        """Command a motion from another node than the program's; returns its result."""
        stamp = self.peer.get_clock().now().to_msg()
        self._commands.publish(BUILD.joint_state(stamp, NAMES, q))
        return self.wait(
            lambda: next((result for result in self.results if result.id == stamp_id(stamp)), None),
            'a result',
        )

    def take(self, commander: str, *, taken: bool = True) -> Any:
        return self.call(f'controller_node/commander/{commander}', SetBool.Request(data=taken), SetBool)

    def until_commander(self, commander: str) -> None:
        self.wait(lambda: self.commanders[-1:] == [commander], f'{commander} to command the robot')

    def hold_run(self) -> None:
        """Hold run from now on."""
        publisher = self.publisher('hold_to_run', Bool)
        self.runner.call(
            lambda: setattr(
                self,
                '_hold',
                self.peer.create_timer(HOLD_PERIOD, lambda: publisher.publish(Bool(data=True))),
            )
        )

    def release_run(self) -> None:
        self.runner.call(lambda: self.peer.destroy_timer(self._hold))
        self.publish('hold_to_run', Bool(data=False))

    def position(self) -> np.ndarray:
        return np.array(self.references[-1].positions)


@pytest.fixture
def cell(ros_nodes: Any, tmp_path: Path) -> CommandedCell:
    return CommandedCell(ros_nodes, tmp_path)


@pytest.fixture
def t1(ros_nodes: Any, tmp_path: Path) -> CommandedCell:
    return CommandedCell(ros_nodes, tmp_path, operating_mode='T1')


def test_a_program_has_the_robot_until_it_ends(cell: CommandedCell) -> None:
    start = cell.position()
    cell.start(FOREVER)
    cell.until_commander('PROGRAM')
    result = cell.order(start + 0.1)
    assert not result.ok
    assert result.message == (
        'PROGRAM commands the robot, not REMOTE; REMOTE takes it over by controller_node/take_over/remote'
    )
    refused = cell.take('remote')
    assert not refused.success
    assert refused.message == result.message
    np.testing.assert_array_equal(cell.position(), start)
    cell.command('stop')
    cell.until_commander('NOBODY')
    cell.wait(lambda: cell.order(start + 0.02).ok, 'a motion')


def test_a_take_over_ends_the_program_and_its_motion(cell: CommandedCell) -> None:
    cell.start(CRAWL + MOVE)
    cell.until_moving()
    cell.until_commander('PROGRAM')
    answer = cell.call('controller_node/take_over/remote')
    assert answer.success, answer.message
    cell.end('FAILED')
    assert 'REMOTE' in cell.status[-1]['error']
    cell.until_standing()
    cell.until_commander('REMOTE')
    refused = cell.call('lua_program_node/run')
    assert not refused.success
    assert refused.message.startswith('REMOTE commands the robot, not PROGRAM; PROGRAM takes it over by')
    assert cell.take('remote', taken=False).success
    cell.until_commander('NOBODY')


def test_in_t1_a_program_runs_while_run_is_held(t1: CommandedCell) -> None:
    t1.open('setOverride(0.02)\n' + MOVE)
    t1.wait(lambda: 'hold_to_run' in t1.call('lua_program_node/run').message, 'the refusal')
    t1.hold_run()
    t1.wait(lambda: t1.call('lua_program_node/run').success, 'the program')
    t1.until_moving()
    t1.release_run()
    t1.wait(lambda: t1.status[-1]['state'] == 'PAUSED' and t1.status[-1]['hold'] == 'release', 'the hold')
    t1.until_standing()
    assert not t1.call('lua_program_node/resume').success
    assert not t1.results
    t1.hold_run()
    t1.until_moving()
    t1.command('stop')
    t1.end('STOPPED')


def test_a_pendant_that_is_killed_during_a_step_loses_the_robot(t1: CommandedCell) -> None:
    pendant = t1.runner.create_node('pendant_node')
    beats = pendant.create_publisher(UInt64, 'pendant_node/heartbeat', SENSOR)
    commands = pendant.create_publisher(JointState, 'ptpjoint_joint', COMMAND)
    t1.wait(lambda: beats.get_subscription_count() and commands.get_subscription_count(), 'the cell')
    alive = pendant.create_timer(0.04, lambda: beats.publish(UInt64(data=1)))
    watch = t1.controller._commanders.watch
    t1.wait(lambda: not watch.unseen, 'a sign of life')
    t1.publish('override', Float64(data=0.002), STATE)
    assert t1.take('pendant').success
    t1.until_commander('PENDANT')
    t1.hold_run()
    commands.publish(BUILD.joint_state(t1.peer.get_clock().now().to_msg(), NAMES, t1.position() + 0.1))
    t1.until_moving()
    t1.runner.call(lambda: pendant.destroy_timer(alive))
    t1.until_commander('NOBODY')
    t1.until_standing()
    t1.wait(lambda: t1.results, 'the result of the motion')
    assert t1.results[-1].message.startswith('no sign of life of pendant_node for 1 s')
    assert t1.take('program').success  # another one can have it


def test_in_t1_nobody_commands_by_topics(t1: CommandedCell) -> None:
    result = t1.order(t1.position() + 0.1)
    assert not result.ok
    assert result.message == (
        'REMOTE does not command the robot in operating mode T1, but in AUTOMATIC, REMOTE'
    )


def test_the_mode_changes_while_the_robot_stands(cell: CommandedCell) -> None:
    with pytest.raises(InvalidInputError, match="unknown operating mode 'T3'; valid are AUTOMATIC, T1"):
        cell.set_parameters(cell.controller, operating_mode='T3')
    cell.start(CRAWL + MOVE)
    cell.until_moving()
    with pytest.raises(InvalidInputError, match='operating_mode may change only while the robot stands'):
        cell.set_parameters(cell.controller, operating_mode='REMOTE')
    cell.command('stop')
    cell.end('STOPPED')
    cell.until_commander('NOBODY')
    cell.wait(lambda: not cell.controller.moving, 'the robot stands')
    cell.start('setOverride(1)\n' + FOREVER)
    cell.until_commander('PROGRAM')
    cell.set_parameters(cell.controller, operating_mode='REMOTE')
    cell.end('FAILED')
    assert 'PROGRAM does not command the robot in operating mode REMOTE' in cell.status[-1]['error']
    cell.wait(lambda: cell.order(cell.position() + 0.01).ok, 'a motion by a topic')


@pytest.mark.parametrize('run', ['held', 'released'])
def test_a_change_to_automatic_pauses_a_program_until_it_is_resumed(t1: CommandedCell, run: str) -> None:
    t1.open(CRAWL + 'wait(2)\n' + MOVE)
    t1.hold_run()
    t1.wait(lambda: t1.call('lua_program_node/run').success, 'the program')
    t1.until_commander('PROGRAM')
    if run == 'released':
        t1.release_run()
        t1.wait(lambda: t1.status[-1].get('hold') == 'release', 'the hold')
    t1.set_parameters(t1.controller, operating_mode='AUTOMATIC')
    t1.wait(lambda: t1.status[-1].get('hold') == 'pause', 'the pause')
    t1.wait(lambda: t1.modes[-1] == 'AUTOMATIC', 'the mode')
    count = len(t1.references)
    t1.wait(lambda: len(t1.references) > count + 25, 'references')
    assert not any(any(point.velocities) for point in t1.references)
    assert t1.status[-1]['state'] == 'PAUSED'
    t1.command('resume')
    t1.until_moving()
    t1.command('stop')
    t1.end('STOPPED')


def test_a_held_program_fails_by_a_change_to_remote_and_another_commander_moves_the_robot(
    t1: CommandedCell,
) -> None:
    t1.open(FOREVER)
    t1.hold_run()
    t1.wait(lambda: t1.call('lua_program_node/run').success, 'the program')
    t1.until_commander('PROGRAM')
    t1.release_run()
    t1.wait(lambda: t1.status[-1].get('hold') == 'release', 'the hold')
    t1.set_parameters(t1.controller, operating_mode='REMOTE')
    t1.end('FAILED')
    assert 'PROGRAM does not command the robot in operating mode REMOTE' in t1.status[-1]['error']
    t1.wait(lambda: t1.order(t1.position() + 0.01).ok, 'a motion by a topic')
