"""A program hands the robot over to a sensor or a person, and takes it back when it stands."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.program.joint_feedback import JointFeedback
from robots_core.blocks.following.guide import Guide
from robots_planning import RobotCommandState

from .lua_host import DEADLINE, LuaHost, wait_until

MODES = [
    ('followReference', RobotCommandState.TRAJECTORY, Guide.SENSOR),
    ('jog', RobotCommandState.TEACH, Guide.PERSON),
]


@pytest.mark.parametrize(('function', 'state', 'guide'), MODES)
def test_an_input_or_the_time_ends_it(tmp_path: Path, function: str, state: RobotCommandState, guide: Guide):
    guides: list[Guide] = []
    host = LuaHost(tmp_path, joint_feedback=lambda: JointFeedback(np.zeros(6)), guide=guides.append)
    host.start(f"""
        print(tostring({function}(0.01)))
        print('now')
        print(tostring({function}(1000, 2)))
        print(tostring({function}(1000, 2, false)))""")
    for _ in range(2):
        host.wait_for_print()
    wait_until(lambda: host.program.command_state is state)
    host.program.digital_inputs = [0, 1]
    host.wait_for_print()
    host.program.digital_inputs = [0, 0]
    assert host.program.join(DEADLINE)
    assert host.printed == ['false', 'now', 'true', 'true']
    assert host.program.command_state is RobotCommandState.IDLE
    assert guides == 3 * [guide, Guide.NONE]


HANDLED = """
    onDigitalInput(1, true, function() {handler} end)
    print(followReference(1000, 2))"""


def handled(tmp_path: Path, handler: str) -> tuple[list[str], list[str]]:
    """What the cell is asked for, and what is printed, if an input changes while a sensor guides."""
    asked: list[str] = []
    host = LuaHost(
        tmp_path,
        joint_feedback=lambda: JointFeedback(np.zeros(6)),
        guide=lambda guide: asked.append(guide.value),
        command=lambda command: (asked.append(command.function), host.program.finish_motion()),
    )
    host.start(HANDLED.format(handler=handler))
    wait_until(lambda: asked == ['SENSOR'])
    host.program.digital_inputs = [1]
    host.wait_for_print()
    host.program.digital_inputs = [1, 1]
    assert host.program.join(DEADLINE)
    return asked, host.printed


def test_a_handler_that_moves_the_robot_takes_it_back_meanwhile(tmp_path: Path):
    asked, printed = handled(tmp_path, "ptpJointSpaceAngles(0, 0, 0, 0, 0, 0) print('moved')")
    assert asked == ['SENSOR', 'NONE', 'ptpJointSpaceAngles', 'SENSOR', 'NONE']
    assert printed == ['moved', 'true']


def test_a_handler_that_aborts_ends_the_guidance(tmp_path: Path):
    asked, printed = handled(tmp_path, "print('aborts') return 'abort'")
    assert asked == ['SENSOR', 'NONE']
    assert printed == ['aborts', 'true']


def test_an_arc_does_not_hand_the_robot_over(tmp_path: Path):
    guides: list[Guide] = []
    host = LuaHost(tmp_path, guide=guides.append)
    assert host.run('circCartesianSpace({1, 0, 1, 0, 90, 0}, {1, 0.5, 1, 0, 90, 0})') is None
    assert host.commands[0].kind.state is RobotCommandState.TRAJECTORY
    assert guides == []


def test_the_program_goes_on_when_the_robot_stands(tmp_path: Path):
    checks = iter([*np.linspace(0.0, 0.5, 8), *np.full(100, 0.5)])
    host = LuaHost(tmp_path, joint_feedback=lambda: JointFeedback(np.full(6, next(checks))))
    assert host.run('followReference(0.001)') is None
    assert next(checks) == 0.5  # the moving ones are over
    assert len(list(checks)) < 100 - 3


def test_a_robot_that_nobody_lets_go_of_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr('robots_controller.program.motions.guided_motion.LONGEST_BRAKING', 0.3)
    checks = iter(np.linspace(0.0, 50.0, 1000))
    host = LuaHost(tmp_path, joint_feedback=lambda: JointFeedback(np.full(6, next(checks))))
    error = host.fails('\njog(0.001)')
    assert 'still moves 0.3 s after the end of TEACH; something else than the program' in str(error)
    assert error.line == 2


def test_a_stop_takes_the_robot_back(tmp_path: Path):
    host = LuaHost(tmp_path, joint_feedback=lambda: JointFeedback(np.zeros(6)))
    host.start("print('now') followReference(1000)")
    host.wait_for_print()
    host.program.stop()
    assert host.program.join(DEADLINE)
    assert host.program.command_state is RobotCommandState.IDLE
