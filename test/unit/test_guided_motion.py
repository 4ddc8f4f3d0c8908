"""A program hands the robot over to a sensor or a person, and takes it back when it stands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_planning import RobotCommandState

from .lua_host import DEADLINE, LuaHost, wait_until

MODES = [('followReference', RobotCommandState.TRAJECTORY), ('jog', RobotCommandState.TEACH)]


@pytest.mark.parametrize(('function', 'mode'), MODES)
def test_an_input_or_the_time_ends_it(tmp_path: Path, function: str, mode: RobotCommandState):
    host = LuaHost(tmp_path, joint_position=lambda: np.zeros(6))
    host.start(f"""
        print(tostring({function}(0.01)))
        print('now')
        print(tostring({function}(1000, 2)))
        print(tostring({function}(1000, 2, false)))""")
    for _ in range(2):
        host.wait_for_print()
    wait_until(lambda: host.program.command_state is mode)
    host.program.digital_inputs = [0, 1]
    host.wait_for_print()
    host.program.digital_inputs = [0, 0]
    assert host.program.join(DEADLINE)
    assert host.printed == ['false', 'now', 'true', 'true']
    assert host.program.command_state is RobotCommandState.IDLE


@pytest.mark.parametrize(('function', 'mode'), MODES)
def test_the_host_hears_who_guides_the_robot(tmp_path: Path, function: str, mode: RobotCommandState):
    told: list[RobotCommandState] = []
    host = LuaHost(tmp_path, joint_position=lambda: np.zeros(6), guide=told.append)
    assert host.run(f'{function}(0.001)') is None
    assert told == [mode, RobotCommandState.IDLE]


def test_the_program_goes_on_when_the_robot_stands(tmp_path: Path):
    looks = iter([*np.linspace(0.0, 0.5, 8), *np.full(100, 0.5)])
    host = LuaHost(tmp_path, joint_position=lambda: np.full(6, next(looks)))
    assert host.run('followReference(0.001)') is None
    assert next(looks) == 0.5  # the moving ones are over
    assert len(list(looks)) < 100 - 3


def test_a_robot_that_nobody_lets_go_of_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr('robots_controller.program.guided_motion.LONGEST_BRAKING', 0.3)
    looks = iter(np.linspace(0.0, 50.0, 1000))
    host = LuaHost(tmp_path, joint_position=lambda: np.full(6, next(looks)))
    error = host.fails('\njog(0.001)')
    assert 'the robot still moves 0.3 s after the end of TEACH: who guides it?' in str(error)
    assert error.line == 2


def test_a_stop_takes_the_robot_back(tmp_path: Path):
    host = LuaHost(tmp_path, joint_position=lambda: np.zeros(6))
    host.start("print('now') followReference(1000)")
    host.wait_for_print()
    host.program.stop()
    assert host.program.join(DEADLINE)
    assert host.program.command_state is RobotCommandState.IDLE
