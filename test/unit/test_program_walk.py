from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from read_texts import parse_plc_script
from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.program_check.walk import WalkResult, described, input_combinations, walk_program
from robots_controller.simulation.cell_parts import CellSetup

ROBOT = 'kuka_kr210_r2700'
START = 'ptpJointSpaceAngles(0, -90, 90, 0, 30, 0)\n'
SCRIPT = """signals:
  ready: digital_input.1
  choice: digital_input.2
  level: analog_input.1
rules:
  - {when: digital_output.1 rises, after: 0.1, set: {ready: true, level: 2.5}}
"""


def walk(folder: Path, program: str, script: str = '', **options: Any) -> WalkResult:
    (folder / 'p.lua').write_text(program)
    (folder / 'plc.yaml').write_text(script)
    io = folder / 'plc.yaml' if script else ''
    return walk_program(CellSetup(program=folder / 'p.lua', robot=ROBOT, io=io), **options)


def told(result: WalkResult) -> list[str]:
    return [str(problem) for problem in result.problems]


def test_nothing_is_wrong_with_a_good_program(tmp_path: Path):
    result = walk(tmp_path, START + 'wait(1)\nptpJointSpaceAngles(10, -90, 90, 0, 30, 0)\n')
    assert result == WalkResult((), 1, 1)


def test_every_bad_motion_is_reported_with_its_line_not_only_the_first(tmp_path: Path):
    program = (
        START
        + 'ptpCartesianSpace(5, 0, 1, 0, 90, 0)\n'
        + 'ptpJointSpaceAngles(400, -90, 90, 0, 30, 0)\n'
        + 'ptpJointSpaceAngles(0, -90, 90, 0, 0, 0)\n'
        + 'linearRelative(0, 0, -0.1, 0, 0, 0)\n'
    )
    lines = told(walk(tmp_path, program))
    assert len(lines) == 3
    assert lines[0].startswith('p.lua:2: ptpCartesianSpace: unreachable: ')
    assert lines[1].startswith('p.lua:3: ptpJointSpaceAngles: A1 = 400 deg is outside its limits')
    assert lines[2].startswith('p.lua:5: ')
    assert 'singular' in lines[2]


def test_torques_are_those_with_the_payload(tmp_path: Path):
    stretch = 'ptpJointSpaceAngles(0, -30, 40, 0, 30, 0)\nptpJointSpaceAngles(0, -10, 20, 0, 30, 0)\n'
    assert not told(walk(tmp_path, stretch))
    first, second = told(walk(tmp_path, 'setPayload(170, 0.05, 0, 0.3)\n' + stretch))
    assert first.startswith('p.lua:2: ptpJointSpaceAngles: limit: A2 torque')
    assert second.startswith('p.lua:3: ptpJointSpaceAngles: limit: A2 torque')


@pytest.mark.parametrize('function', ['followReference', 'jog'])
def test_a_walk_goes_on_where_others_would_guide_the_robot(tmp_path: Path, function: str):
    (line,) = told(walk(tmp_path, START + f'{function}(60)\nptpJointSpaceAngles(400, -90, 90, 0, 30, 0)\n'))
    assert line.startswith('p.lua:3: ptpJointSpaceAngles: A1')


def test_problems_of_subprograms_are_reported_with_their_file(tmp_path: Path):
    (tmp_path / 'sub.lua').write_text('\nptpJointSpaceAngles(400, -90, 90, 0, 30, 0)\n')
    (line,) = told(walk(tmp_path, START + 'call("sub")\n' + START))
    assert line.startswith('sub.lua:2: ptpJointSpaceAngles: A1')


def test_collisions_are_reported_and_the_rest_is_walked(tmp_path: Path):
    scene = tmp_path / 'scene.yaml'
    scene.write_text(
        'objects:\n  - name: post\n    box: {size: [0.1, 0.1, 4.0]}\n    pose: {position: [1.2, -0.7, 0.0]}\n'
    )
    (tmp_path / 'p.lua').write_text(
        'ptpJointSpaceAngles(0, -60, 90, 0, 30, 0)\nptpJointSpaceAngles(60, -60, 90, 0, 30, 0)\n'
        'ptpJointSpaceAngles(61, -60, 90, 0, 30, 0)\nptpJointSpaceAngles(400, -90, 90, 0, 30, 0)\n'
    )
    lines = told(walk_program(CellSetup(program=tmp_path / 'p.lua', robot=ROBOT, scene=scene)))
    assert len(lines) == 2
    assert lines[0].startswith('p.lua:2: ptpJointSpaceAngles: the motion collides: ')
    assert 'post' in lines[0]
    assert lines[1].startswith('p.lua:4: ')


def test_a_wait_without_end_is_reported(tmp_path: Path):
    (line,) = told(walk(tmp_path, 'waitDigitalInput(7, true)\n'))
    assert line.startswith('p.lua:1: ')
    assert 'waits for ever' in line


def test_combinations_are_all_states_of_the_inputs_the_own_start_first():
    script = parse_plc_script(SCRIPT + 'initial: {choice: true}\n')
    found = [described(inputs, script) for inputs in input_combinations(script)]
    assert len(found) == len(set(found)) == 8
    assert found[0] == 'level 0, ready off, choice on'


def test_what_goes_wrong_with_some_inputs_is_reported_with_them(tmp_path: Path):
    program = (
        'setDigitalOutput(1, true)\nwaitDigitalInput(1, true)\n'  # the PLC answers
        'if getDigitalInput(2) then\n  ptpJointSpaceAngles(400, -90, 90, 0, 30, 0)\nend\n'
    )
    result = walk(tmp_path, program, SCRIPT)
    (line,) = told(result)
    assert result.walked == result.possible == 8
    assert line.startswith('p.lua:4: ')
    assert 'with 4 of 8 combinations of inputs: ' in line
    assert 'choice on' in line


def test_in_processes_as_in_this_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr('robots_controller.program_check.walk.START_OF_PROCESSES', 0.0)
    program = 'if getDigitalInput(1) and not getDigitalInput(2) then waitDigitalInput(2, true) end\n'
    assert walk(tmp_path, program, SCRIPT, workers=2) == walk(tmp_path, program, SCRIPT)


def test_what_was_left_out_is_reported(tmp_path: Path):
    result = walk(tmp_path, 'wait(0.1)\n', SCRIPT, most=3)
    assert (result.walked, result.possible) == (3, 8)


def test_the_command_walks_when_it_is_asked_to(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    program = tmp_path / 'p.lua'
    program.write_text('ptpJointSpaceAngles(400, -90, 90, 0, 30, 0)\n')
    assert CHECK_PROGRAM.run([str(program)]) == 0
    assert capsys.readouterr().out == '1 program, no findings\n'
    assert CHECK_PROGRAM.run([str(program), '--walk']) == 1
    shown = capsys.readouterr()
    assert shown.out.startswith('p.lua:1: ptpJointSpaceAngles: A1 = 400 deg')
    assert 'walked with 1 combination of inputs' in shown.err
    assert CHECK_PROGRAM.run([str(program), '--scene', str(tmp_path / 'none.yaml')]) == 2


def test_a_walk_ends_with_the_patience_of_who_asked_for_it(tmp_path: Path):
    line, *others = told(walk(tmp_path, START + 'while true do wait(0.01) end\n', patience=0.5, longest=1e6))
    assert 'within the patience of ' in line  # a slow machine may not come to line 2
    assert not others


@pytest.mark.parametrize(
    ('target', 'hint'),
    [
        ('ptpCartesianSpace(1500, 0, 1200, 0, 90, 0)', '; lengths are metres: (1.5, 0, 1.2)?'),
        ('ptpCartesianSpace(5000, 0, 1200, 0, 90, 0)', '; lengths are metres'),
        ('ptpJointSpaceAngles(0, -1.57, 1.57, 0, 0.5, 0)', '; angles are degrees: -89.95?'),
    ],
)
def test_targets_in_other_units_are_recognised(tmp_path: Path, target: str, hint: str):
    (problem,) = told(walk(tmp_path, START + target))
    assert problem.endswith(hint)
