"""Inputs and outputs of Lua programs over time: waits, pulses and interrupts."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from robots_controller.program.run_state import RunState

from .lua_host import DEADLINE, LuaHost, wait_until

MOVE = 'ptpJointSpaceAngles(0, 0, 0, 0, 0, 0)'


def test_wait_for_an_input_ends_with_it_or_in_time(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("""
        print(waitDigitalInput(1, true, 0.01))
        print(waitDigitalInput(1, true))
        print(waitDigitalInput(2, 0, 0))""")
    host.wait_for_print()
    host.program.digital_inputs = [1]
    assert host.program.join(DEADLINE)
    assert host.printed == ['false', 'true', 'true']


@pytest.mark.parametrize(
    ('comparison', 'holds'),
    [('<', 1.0), ('<=', 2.0), ('>', 3.0), ('>=', 2.0), ('==', 2.0), ('~=', 1.0)],
)
def test_wait_for_an_analog_input_compares(tmp_path: Path, comparison: str, holds: float):
    host = LuaHost(tmp_path)
    host.program.analog_inputs = [{'<': 5.0, '<=': 5.0}.get(comparison, 2.0 if comparison == '~=' else 0.0)]
    host.start(
        f"print(waitAnalogInput(1, '{comparison}', 2, 0)) print(waitAnalogInput(1, '{comparison}', 2))"
    )
    host.wait_for_print()
    host.program.analog_inputs = [holds]
    assert host.program.join(DEADLINE)
    assert host.printed == ['false', 'true']


def test_unknown_comparison_names_the_valid_ones(tmp_path: Path):
    error = LuaHost(tmp_path).fails("waitAnalogInput(1, '=', 2)")
    assert "comparison = the string '='; valid is '<', '<=', '>', '>=', '==', '~='" in str(error)


def test_pulse_ends_while_the_program_goes_on(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert (
        host.run("pulseDigitalOutput(1, 0.02) print('on') wait(0.05) print(1) pulseDigitalOutput(2, 0.01)")
        is None
    )
    assert [(change.index, change.value) for change in host.outputs] == [(1, 1), (1, 0), (2, 1), (2, 0)]
    assert host.printed == ['on', '1']


def test_pulse_ends_although_the_program_computes_is_paused_or_stopped(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start('pulseDigitalOutput(1, 0.02) while true do end')
    wait_until(lambda: len(host.outputs) == 2)
    host.program.stop()
    assert host.program.join(DEADLINE)
    host.start("pulseDigitalOutput(1, 0.05) print('on') while true do end")
    host.wait_for_print()
    host.program.pause()
    wait_until(lambda: len(host.outputs) == 4)
    host.program.stop()
    assert host.program.join(DEADLINE)
    host.start("pulseDigitalOutput(1, 1000) print('on') while true do end")
    host.wait_for_print()
    host.program.stop()
    assert host.program.join(DEADLINE)
    assert [change.value for change in host.outputs] == [1, 0] * 3


class BrakingHost(LuaHost):
    """A host that notes holds and aborts; aborted motions end at once."""

    def __init__(self, folder: Path) -> None:
        self.holds: list[bool] = []
        self.aborts = 0
        super().__init__(folder, hold=lambda *, held: self.holds.append(held), abort=self._abort)
        self.holding = True

    def _abort(self) -> None:
        self.aborts += 1
        threading.Thread(target=self.program.finish_motion).start()


def test_input_interrupts_a_motion_and_lets_it_go_on(tmp_path: Path):
    host = BrakingHost(tmp_path)
    host.start(f"""
        onDigitalInput(1, true, function() print('handler') setDigitalOutput(1, 1) wait(0.01) end)
        {MOVE}
        print('there')""")
    host.wait_for_command()
    host.program.digital_inputs = [1]
    host.wait_for_print()
    wait_until(lambda: host.holds == [True, False])
    assert len(host.program.motions) == 1
    host.program.finish_motion()
    assert host.program.join(DEADLINE)
    assert host.printed == ['handler', 'there']
    assert host.aborts == 0


def test_handler_aborts_the_motion(tmp_path: Path):
    host = BrakingHost(tmp_path)
    host.start(f"onDigitalInput(1, 1, function() return 'abort' end) {MOVE} print('after')")
    host.wait_for_command()
    host.program.digital_inputs = [1]
    assert host.program.join(DEADLINE)
    assert (host.printed, host.aborts, host.holds) == (['after'], 1, [True, False])
    assert host.finished == [None]


def test_handler_moves_the_robot_and_the_interrupted_motion_comes_anew(tmp_path: Path):
    host = BrakingHost(tmp_path)
    host.start(f"""
        onDigitalInput(1, 1, function() ptpJointSpaceAngles(1, 1, 1, 1, 1, 1) end)
        {MOVE}
        print('there')""")
    host.wait_for_command()
    host.program.digital_inputs = [1]
    host.wait_for_command()
    host.program.finish_motion()
    host.wait_for_command()
    assert [command.line for command in host.commands] == [3, 2, 3]
    assert host.commands[2] is host.commands[0]
    host.program.finish_motion()
    assert host.program.join(DEADLINE)
    assert host.finished == [None]


def test_input_interrupts_a_computing_program(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start(
        "local on = false onDigitalInput(2, 1, function() on = true end) print('a') while not on do end"
    )
    host.wait_for_print()
    host.program.digital_inputs = [0, 1]
    assert host.program.join(DEADLINE)
    assert host.finished == [None]


@pytest.mark.parametrize('where', ['while true do end', MOVE])
def test_endless_handler_is_stopped(tmp_path: Path, where: str):
    host = BrakingHost(tmp_path)
    host.start(f"onDigitalInput(1, 1, function() print('in') while true do end end) print('a') {where}")
    host.wait_for_print()
    host.program.digital_inputs = [1]
    host.wait_for_print()
    host.program.stop()
    assert host.program.join(DEADLINE)
    assert host.program.run_state is RunState.STOPPED


@pytest.mark.parametrize('where', ['while true do end', MOVE])
def test_failing_handler_fails_the_program_with_its_line(tmp_path: Path, where: str):
    host = BrakingHost(tmp_path)
    host.start(f"onDigitalInput(1, 1, function()\n error('burst') end) print('a')\n {where}")
    host.wait_for_print()
    if where == MOVE:
        host.wait_for_command()
    host.program.digital_inputs = [1]
    assert host.program.join(DEADLINE)
    assert str(host.finished[-1]) == 'test.lua:2: burst'
    assert host.aborts == (where == MOVE)


def test_every_change_calls_its_handler_once(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("""
        for value = 0, 1 do onDigitalInput(1, value, function() print(value) end) end
        print('ready')
        waitDigitalInput(2, 1)""")
    host.wait_for_print()
    for value in (1, 0, 1):
        host.program.digital_inputs = [value]
        host.wait_for_print()
    host.program.digital_inputs = [1, 1]
    assert host.program.join(DEADLINE)
    assert host.printed == ['ready', '1', '0', '1']
