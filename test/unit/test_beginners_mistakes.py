"""Messages of beginners' mistakes: the line, the mistake, and what to write instead.

A row is a mistake in line 2 of its file, and a part of the message.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.io.io_map import read_io_map
from robots_controller.io.plc_script import read_plc_script
from robots_controller.program.files.program_header import read_program_header
from robots_controller.program_check.program_check import check_program
from robots_controller.simulate import simulate
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.errors import FileContentError, ProgramError

DEADLINE = 240.0  # s, for a machine that is slow and busy


@pytest.mark.parametrize(
    ('line', 'remedy'),
    [
        ('if getDigitalInput(1) != true then wait(1) end', 'not equal is ~='),
        ('local i = 1; i++', 'write i = i + 1'),
        ('i = 1; i += 2', 'write i = i + ...'),
        ('if x = 3 then wait(1) end', 'compare with =='),
        ("if 'a' = 'b' then wait(1) end", 'compare with =='),
        ('x = 3 && 4', 'write and'),
        ('if a == 1 || b == 2 then end', 'write or'),
        ('x = !true', 'write not'),
        ('if true { wait(1) }', 'a block has no braces'),
        ('for i = 1, 3 {', 'a block has no braces'),
        ('wait(1) }', 'a block ends with end'),
        ('for i = 1; i < 3; i++ do end', 'for i = 1, 3 do'),
        ('for i in 1..3 do end', 'for i = 1, 3 do'),
        ('if true then wait(1) elif false then end', 'write elseif'),
        ('int x = 3', 'write local x = ...'),
        ('def f(): wait(1)', 'write function f(...) ... end'),
        ('if x == 3: wait(1)', 'without a colon'),
        ('import math', "call('name')"),
        ('try wait(1) end', 'pcall'),
        ('wait 1', 'arguments are in parentheses: wait(...)'),
        ('/* remark */ wait(1)', 'a comment is written --'),
        ('wait(1) # remark', 'a comment is written --'),
        ('if true wait(1) end', 'write if ... then ... end'),
        ('x = "abc', 'close it with the quotation mark'),
        ('wait(1', 'a parenthesis is not closed'),
        ('while true do wait(1)', 'needs an end of its own'),
        ('x = null', "did you mean 'nil'?"),
        ('x = True', "did you mean 'true'?"),
        ('if getDigitalInput(1) <> true then wait(1) end', 'not equal is ~='),
        ('local x = getDigitalInput(1) ? 1 : 2', 'condition and a or b'),
        ('for i = 1 to 3 do wait(1) end', 'for i = 1, 3 do'),
        ('for i in range(3) do wait(1) end', 'robot programs have for i = 1, 3 do'),
        ('for i in 1, 3 do wait(1) end', 'for i = 1, 3 do'),
        ('while (true) { wait(1) }', 'a block has no braces'),
        ('i--', 'write i = i - 1'),
        ('if true and then wait(1) end', 'a value is missing before it'),
        ('local x = 5 %', 'a value is missing before it'),
        ('local t = [1, 2, 3]', 'a list is written with braces: {1, 2, 3}'),
        ('local t = {1, 2, 3', 'a brace is not closed'),
        ('local p = {x: 1, y: 2}', 'fields are written with ='),
        ('function f(int a) end', 'parameters have no types'),
        ('x := 3', 'a value is given with ='),
        ('IF true THEN wait(1) END', 'lower case'),
        ('PTP HOME', 'ptpJointSpaceAngles'),
        ('LIN P1', 'ptpCartesianSpace'),
        ("local s = 'a' + 'b'", 'texts are joined by ..'),
        ("print('a' + 1)", 'texts are joined by ..'),
        ('goto nowhere', '::name::'),
        ('break', 'break ends a loop'),
        ('getDigitalInput[1]', 'a statement is a call, name(...)'),
        ('// remark', "write '--'"),
        ('sleep(1)', 'robot programs have wait(seconds)'),
        ('moveL(1, 2, 3)', 'robot programs have ptpCartesianSpace'),
        ("printf('x')", 'robot programs have print'),
        ("require('socket')", "call('name')"),
        ("os.execute('ls')", 'not available'),
        ("call('nosuch')", 'there is no program'),
        ('ptpcartesianspace(1.5, 0, 1.2, 0, 90, 0)', "did you mean 'ptpCartesianSpace'?"),
        ('ptpCartesianSpace(1500, 0, 1200, 0, 90, 0)', 'lengths are metres: 1.5?'),
        ('circCartesianSpace({1500, 0, 1, 0, 90, 0}, {1, 0, 1, 0, 90, 0})', 'lengths are metres: 1.5?'),
        ('setTool(0, 0, 250, 0, 0, 0)', 'lengths are metres: 0.25?'),
        ('ptpCartesianSpace(1.5, 0, 1.2, 0, 3.1416, 0)', 'angles are degrees: (0, 180, 0)?'),
        ('ptpCartesianSpace(1.5, 0, 1.2, 0, -math.pi / 2, 0)', 'angles are degrees: (0, -90, 0)?'),
        ('ptpJointSpaceAngles(0, -1.57, 1.57, 0, 1.57, 0)', 'angles are degrees: (0, -90, 90, 0, 90, 0)?'),
        ('ptpCartesianSpace(1.5, 0, 1.2)', 'got 3 arguments, needed are 6'),
        ("ptpCartesianSpace('1.5', 0, 1.2, 0, 90, 0)", 'valid is a finite number'),
        ('ptpCartesianSpace({1, 0, 1, 0, 90, 0}, {blnd = 0.1})', "did you mean 'blend'?"),
        ('ptpCartesianSpace({1, 0, 1, 0, 90, 0, blend = 0.1})', 'a table of their own'),
        ('ptpJointSpaceAngles(0, -90, 90, 0, 90)', 'the robot has 6 axes'),
        ('setDigitalOutput(0, true)', 'the first is 1'),
        ("setDigitalOutput(1, 'on')", 'valid is 0, 1, true or false'),
        ('setDigitalOutput(33, true)', 'a whole number in 1..32'),
        ('if getDigitalInput(1) == 1 then wait(1) end', 'returns true or false'),
        ('wait(-1)', 'at least 0'),
        ('wait()', 'needed are 1: time (s)'),
        ('wait(nil)', 'nothing gives it a value'),
        ('setSpeed(50)', '50 % is 0.5'),
        ("waitDigitalInput(1, true, 'forever')", 'a finite number'),
        ('onDigitalInput(1, true)', 'needed are 3 to 4: index, value, handler'),
        ("setOrientationConvention('euler')", "valid is 'zyx'"),
    ],
)
def test_the_message_of_the_check_has_line_mistake_and_remedy(tmp_path: Path, line: str, remedy: str):
    program = tmp_path / 'test.lua'
    program.write_text(f'wait(1)\n{line}\n')
    problem = check_program(program, Sizes(6, 32, 8))[0]
    assert problem.line == 2
    assert remedy in problem.reason


def test_what_no_remedy_explains_is_left_as_lua_says_it(tmp_path: Path):
    program = tmp_path / 'test.lua'
    program.write_text("'!= in a text'\n")
    (problem,) = check_program(program, Sizes(6, 32, 8))
    assert problem.reason.startswith('unexpected symbol near')
    assert ';' not in problem.reason


@pytest.mark.parametrize(
    ('line', 'remedy'),
    [
        ('local t = {1, 2, 3} wait(t[0])', 'an index that is not there: the first is 1'),
        ('local t = {} wait(t.delay)', 'nothing gives it a value'),
        ('local t = nil wait(t.x)', 'nothing gives it a value before'),
        ('local x = 3 x()', 'it is no function'),
        ('local x = #5', '# counts the entries of a table'),
        ('for i = 0, 2 do setDigitalOutput(i, true) end', 'the first is 1'),
        ('for i in {1, 2} do wait(i) end', 'ipairs(t)'),
        ("local x = 1 < 'a'", 'only numbers are compared with numbers'),
        ('local x = {} .. 1', 'tostring(value)'),
        ('ptpJointSpaceAngles(0, -500, 90, 0, 90, 0)', 'outside its limits [-140, -5] deg'),
        (
            'local z = 1500 ptpCartesianSpace(1500 + z - z, 0, z, 0, 90, 0)',
            'lengths are metres: (1.5, 0, 1.5)?',
        ),
        ('local q = -1.57 ptpJointSpaceAngles(0, q, 90, 0, 90, 0)', 'angles are degrees: -89.95?'),
        ('while true do end', 'not ended within'),
    ],
)
def test_the_message_of_a_run_has_line_mistake_and_remedy(tmp_path: Path, line: str, remedy: str):
    program = tmp_path / 'test.lua'
    program.write_text(f'wait(0)\n{line}\n')
    patience = 0.5 if remedy == 'not ended within' else DEADLINE
    run = simulate(program, robot='kuka_kr210_r2700', drive='ideal', patience=patience)
    assert run.error is not None
    assert run.error.line == 2
    assert remedy in run.error.reason


@pytest.mark.parametrize(
    ('line', 'remedy'),
    [
        ('-- Robto: ur5e', "did you mean '-- Robot: ur5e'?"),
        ('-- robot: ur5e', "did you mean '-- Robot: ur5e'?"),
        ('-- Robot = ur5e', "did you mean '-- Robot: ur5e'?"),
        ('-- Robot: ur5', "did you mean 'ur5e'?"),
        ('-- Robot: urdf:/nowhere.urdf', 'there is no URDF file'),
        ('-- Robot: ur5e  Scene: nowhere.yaml', 'it is looked for from the folder of the program'),
        (f'-- Robot: ur5e  Scene: {5000 * "s"}.yaml', 'it is looked for from the folder of the program'),
        (f'-- Robot: urdf:{5000 * "u"}.urdf', 'cannot be read: File name too long'),
    ],
)
def test_the_message_about_a_header_has_line_mistake_and_remedy(tmp_path: Path, line: str, remedy: str):
    program = tmp_path / 'test.lua'
    program.write_text(f'-- A program.\n{line}\nwait(1)\n')
    with pytest.raises(ProgramError) as raised:
        read_program_header(program).check_files()
    assert raised.value.line == 2
    assert remedy in raised.value.reason


SCENE = 'objects:\n- {name: table, box: {size: [1, 1, 1]}, pose: {position: [1, 0, 0]}}\n'
PLC = 'rules:\n- {when: digital_output.1 rises, set: {digital_input.1: true}}\n'
IO_MAP = 'inputs:\n- {channel: digital_input.1, topic: plc/ready, type: Bool}\n'


@pytest.mark.parametrize(
    ('text', 'old', 'new', 'remedy'),
    [
        (SCENE, 'box', 'boxx', "did you mean 'box'?"),
        (SCENE, 'position', 'positoin', "did you mean 'position'?"),
        (SCENE, '[1, 0, 0]', '[1500, 0, 0]', 'lengths are metres: 1.5?'),
        (SCENE, '[1, 0, 0]', '[1, 0, 0], angles: [0, 90, 0]', 'angles of this file are radians: 1.571?'),
        (SCENE, '- {', '\t- {', 'indent by spaces'),
        (SCENE, '[1, 0, 0]}', '[1, 0, 0}', 'a bracket is not closed'),
        (PLC, 'set', 'sett', "did you mean 'set'?"),
        (PLC, 'digital_output.1', 'digital_output.0', 'digital_output.0'),
        (PLC, 'digital_input', 'digital_inptu', 'digital_inptu'),
        (PLC, 'rises', 'rise', 'rises'),
        (IO_MAP, 'topic', 'topik', "did you mean 'topic'?"),
        (IO_MAP, 'Bool', 'Boolean', 'Boolean'),
        (IO_MAP, 'channel', 'chanel', "did you mean 'channel'?"),
    ],
)
def test_the_message_about_a_file_has_line_mistake_and_remedy(
    tmp_path: Path, text: str, old: str, new: str, remedy: str
):
    file = tmp_path / 'file.yaml'
    file.write_text(text.replace(old, new, 1))
    read: Callable[[Path], object] = {SCENE: read_scene, PLC: read_plc_script, IO_MAP: read_io_map}[text]
    with pytest.raises(FileContentError) as raised:
        read(file)
    assert raised.value.details['line'] == 2
    assert remedy in raised.value.message
