"""Every function of robot programs has an example, and the examples run."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.interpreter.lua_tokens import lua_tokens
from robots_controller.program.files.program_header import read_program_header
from robots_controller.program_check.lua_calls import lua_calls
from robots_controller.simulate import simulate

PROGRAMS = Path(__file__).parents[2] / 'programs'
GUIDED = PROGRAMS / 'language' / 'guided.lua'
EXAMPLES = sorted(set((PROGRAMS / 'language').glob('*.lua')) - {GUIDED})
# Those of programs/ run in lock-step and simulated, see test_parity.
SHOWN = [*EXAMPLES, GUIDED, *PROGRAMS.glob('*.lua'), *PROGRAMS.glob('palletizing/*.lua')]


def test_every_function_has_an_example() -> None:
    used = {call.name.text for file in SHOWN for call in lua_calls(list(lua_tokens(file.read_text())))}
    assert LUA_FUNCTIONS.keys() - used == set()


@pytest.mark.parametrize('program', EXAMPLES, ids=lambda path: path.stem)
def test_examples_run(program: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    header = read_program_header(program)
    run = simulate(
        program,
        robot=header.robot,
        drive='rigid_body',
        scene=header.scene,
        io=header.io,
        points_file=tmp_path / 'points.yaml',
    )
    assert run.ok, run.error
    assert CHECK_PROGRAM.run([str(program)]) == 0, capsys.readouterr().out


def test_the_example_of_guidance_stands_where_nothing_guides(capsys: pytest.CaptureFixture[str]) -> None:
    assert CHECK_PROGRAM.run([str(GUIDED), '--walk']) == 0, capsys.readouterr().out
