"""The check of a program without running it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.lua_tokens import lua_tokens
from robots_controller.program_check.program_check import check_program
from robots_core import load_robot_model
from robots_core.exit_codes import ExitCode

PROGRAMS = Path(__file__).parents[2] / 'programs'
ROBOTS = {
    'bello_bot_tour.lua': 'bello_bot',
    'wheel_laboratory.lua': 'kuka_kr210_r3100',
    'debris_removal.lua': 'debris_arm',
    'rover_placement.lua': 'rover_jaco',
}
SIZES = Sizes(6, 32, 8)


def check(folder: Path, text: str) -> list[str]:
    path = folder / 'test.lua'
    path.write_text(text)
    return [str(problem) for problem in check_program(path, SIZES)]


@pytest.mark.parametrize('path', sorted(PROGRAMS.glob('*.lua')), ids=lambda path: path.name)
def test_our_programs_pass(path: Path, capsys: pytest.CaptureFixture[str]):
    robot = ROBOTS.get(path.name, 'kuka_kr210_r2700')
    assert CHECK_PROGRAM.run([str(path), '--robot', robot]) == 0, capsys.readouterr().out
    assert load_robot_model(robot)


@pytest.mark.parametrize(
    ('text', 'problem'),
    [
        ('wait(1)\nthen', "test.lua:2: unexpected symbol near 'then': then"),
        ('\nwelding()', 'test.lua:2: there is no function welding'),
        ('ptpcartesianspace(1)', "no function ptpcartesianspace; did you mean 'ptpCartesianSpace'?"),
        ('os.execute("x")', 'test.lua:1: os is not available in robot programs'),
        ('local f = load', 'load is not available in robot programs'),
        ('ptpJointSpaceAngles(1, 2, 3)', 'ptpJointSpaceAngles: got 3 joint angles, the robot has 6 axes'),
        ('ptpJointSpaceAngles {1, 2, 3, 4, 5, 6, 7}', 'got 7 joint angles, the robot has 6 axes'),
        (
            'setDigitalOutput(1)',
            'setDigitalOutput: got 1 arguments, needed are 2 to 3: index, value, [moment]',
        ),
        ('setDigitalOutput(33, 1)', 'setDigitalOutput: index = 33; valid is a whole number in 1..32'),
        ('getAnalogInput(0)', 'getAnalogInput: index = 0; valid is a whole number in 1..8'),
        ("waitAnalogInput(1, '=', 2)", "comparison = the string '='; valid is '<', '<='"),
        (
            "linearRelative(0, 0, 0, 0, 0, 0, 'world')",
            "frame = the string 'world'; valid is 'base' or 'tool'",
        ),
        ("setDigitalOutput('1', 1)", "index = the string '1'; valid is a whole number in 1..32"),
        ("call('missing')", 'test.lua:1: call: missing.lua: there is no program'),
        ("call '../x'", "'../x' leads out of the folder"),
        ('setSpeed(0.5, 1, 90, 4)', 'setSpeed: got 4 arguments, needed are 0 to 3'),
        (
            'if getDigitalInput(1) == 1 then wait(1) end',
            'getDigitalInput == 1 is always false: getDigitalInput returns true or false',
        ),
        ("while 'on' ~= getDigitalInput(1) do wait(1) end", "getDigitalInput ~= 'on' is always true"),
        ('local ready = waitDigitalInput(1, 1, 2) if ready == 0 then wait(1) end', 'ready, from waitDigit'),
        ('if getAnalogInput(1) == true then wait(1) end', 'getAnalogInput == true is always false'),
        ('if getJointAngles() == 90 then wait(1) end', 'getJointAngles returns a table'),
        (
            "setOrientationConvention('abc')",
            "convention = the string 'abc'; valid is 'zyx', 'xyz', 'zyz', 'XYZ'",
        ),
        ('if #getJointAngles() == nil then wait(tiem) end', 'tiem has no value: nothing gives it one'),
        (
            'moveUntil({input = 1}, linearRelative, 0, 0)',
            'linearRelative: got 2 arguments, needed are 6 to 7',
        ),
        ('moveUntil({input = 1, below = 2}, linearRelative, 0, 0, 0, 0, 0, 0)', 'condition has below, input'),
        ('circCartesianSpace({1, 2, 3}, x)\nx = 1', 'via = a table with 3 values; valid is a table {x, y'),
        ('moveUntil({input = 40}, linearRelative, ...)', 'condition.input = 40; valid is a whole number in'),
        (
            'moveUntil({joint_torque = 7, above = 1}, linearRelative, ...)',
            'joint_torque = 7; the robot has 6',
        ),
        (
            'ptpCartesianSpace(x, {on_path = {time_before_end = 1, output = 99, value = 1}})\nx = 1',
            'options.on_path.output = 99; valid is a whole number in 1..32',
        ),
        ("setPlanner('limited')", "joint = the string 'limited'; valid is 'collision_free', 'linear_joint'"),
        ("setConfiguration('left')", "configuration = the string 'left'; valid is 'front/up/no_flip'"),
        ("setHold('all')", "hold = the string 'all'; valid is 'pose', 'directions', 'position'"),
        ('wait(tiem)', 'tiem has no value: nothing gives it one'),
        (
            'local speed = 1 setSpeed(speeed)',
            "nothing gives it one; did you mean 'speed'",
        ),
        ('local t = {f = function() x = 1 end, y = 2} wait(x) wait(y)', 'y has no value'),
        (
            'ptpCartesianSpace({1, 2, 3, 4, 5, 6}, {blnd = 0.1})',
            "options has no blnd; did you mean 'blend'?; valid are blend (m), avoid and on_path",
        ),
        (
            'ptpJointSpaceAngles(1, 2, 3, 4, 5, 6, {blend = 1})',
            'valid are jointBlend (deg), avoid, on_blocked and on_path',
        ),
        (
            'ptpCartesianSpace({1, 2, 3, 4, 5, 6}, {blend = 0})',
            'options.blend = 0 m; valid is a finite number above 0',
        ),
        (
            'ptpCartesianSpace({1, 2, 3, 4, 5, 6}, {on_path = {{time_before_end = 1, output = 1}}})',
            'options.on_path[1] has output, time_before_end; valid is {distance_before_end (m)',
        ),
        (
            'ptpCartesianSpace({1, 2, 3, 4, 5, 6}, {on_path = {time_before_end=1, output="lamp", value=1}})',
            "options.on_path.output = 'lamp': no I/O map names it; valid is its number",
        ),
        (
            'ptpCartesianSpace({1, 2, 3, 4, 5, 6}, {on_path = {before_end = 1, output = 1, value = 1}})',
            'options.on_path has before_end, output, value',
        ),
    ],
)
def test_problems_name_file_line_and_what_is_valid(tmp_path: Path, text: str, problem: str):
    (found,) = check(tmp_path, text)
    assert found.startswith('test.lua:')
    assert problem in found


@pytest.mark.parametrize(
    'text',
    [
        'local function f(...) ptpCartesianSpace(...) end f(1)',
        'ptpCartesianSpace(getCartesianPosition())',
        'ptpCartesianSpace(...) ptpCartesianSpace(1, ...) inverseKinematics(getTool(), {1, 2, 3, 4, 5, 6})',
        'local p, o = {}, {} ptpCartesianSpace(p, o) linearRelative(p, "tool") linearRelative(p, "tool", o)',
        'local m, x = linearRelative, {} moveUntil({input = 1}, m, x) moveUntil(x, linearRelative, x)',
        'moveUntil({analog_input = 1, above = getAnalogInput(1)}, linearRelative, ...) setPayload(...)',
        'local x = 1 pose(x, x, 0, 0, 0, x) pose {x, 0, 0, getJointAngles()} setPayload(x) grid(x, x, x)',
        'local x = {} ptpCartesianSpace(x, {on_path = x}) ptpCartesianSpace(x, {on_path = {x}, blend = x.b})',
        'local p = {1, 2, 3, 4, 5, 6} ptpCartesianSpace(p) ptpCartesianSpace(p, {blend = 0.1})',
        'local o = {blend = 0.1} ptpCartesianSpace({1, 2, 3, 4, 5, 6}, o)',
        'local o = {blend = 0.1} ptpCartesianSpace(1, 2, 3, 4, 5, 6, o)',
        'ptpCartesianSpace({1, 2, 3; 4, 5, 6}, {on_path = {time_before_end = 1, output = 1, value = 1}})',
        'onDigitalInput(1, true, function(a, b) local x, y = 1, 2 return nil end)',
        'local t = {} function t.f() end function t:g(h) h() end t.f() t:g(print) string.format("%d", 1)',
        'a, b = print, 1 a(b) for i, f in ipairs {print} do f(i) end',
        "print 'x' print [[os.execute()]] -- load()",
        'local wait = print wait(1, 2, 3)',
        'goto done ::done:: local x <const> = 1',
        'setSpeed(nil, 0.1) setSpeed()',
        'circCartesianSpace({1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6})',
        'splineCartesianSpace({1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, {blend = 0.1})',
        'wait(1 - 2)',  # computed, though simply
        'local v = getAnalogInput(1) if v == 1 or getDigitalInput(1) == getDigitalInput(2) then wait(1) end',
        'local on = getDigitalInput(1) on = 1 if on == 1 then wait(1) end',
        'if 1 == getCartesianPosition()[1] and getDigitalInput(1) == true then wait(1) end',
        'local function getDigitalInput() return 1 end if getDigitalInput() == 1 then wait(1) end',
        '_G.x = 1 wait(x)',
        'for name, value in pairs {y = 1} do _G[name] = value end wait(y)',
        'local o = {blend = 0.1, f = function(a) z = a return z end} wait(o.f(o.blend))',
    ],
)
def test_what_is_right_or_computed_is_left_alone(tmp_path: Path, text: str):
    assert check(tmp_path, text) == []


def test_subprograms_are_checked_with_the_globals_of_all(tmp_path: Path):
    (tmp_path / 'part.lua').write_text('helper() setDigitalOutput(99, 1)\nunknown()\ncall("part")')
    found = check(tmp_path, 'function helper() end call("part") call("part.lua")')
    assert found == [
        'part.lua:1: setDigitalOutput: index = 99; valid is a whole number in 1..32',
        'part.lua:2: there is no function unknown',
    ]


def test_command_line_says_what_is_wrong(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / 'test.lua'
    path.write_text('ptpJointSpaceAngles(1, 2, 3, 4, 5, 6)')
    assert CHECK_PROGRAM.run([str(path)]) == 0
    assert CHECK_PROGRAM.run([str(path), '--robot', 'bello_bot']) == 1
    assert 'got 6 joint angles, the robot has 7 axes' in capsys.readouterr().out
    assert CHECK_PROGRAM.run([str(path), '--robot', 'nobody']) == 2
    assert CHECK_PROGRAM.run([str(tmp_path / 'missing.lua')]) == 1


def test_every_program_is_judged_though_the_header_of_one_is_bad(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    texts = {
        'robot.lua': '-- Robot: no_robot\nwait(1)',
        'scene.lua': '-- Robot: ur5e\n-- Scene: no.yaml\nwait(1)',
        'call.lua': 'wiat(1)',
        'good.lua': 'wait(1)',
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    programs = [str(tmp_path / name) for name in texts]
    assert CHECK_PROGRAM.run(programs) == ExitCode.FAILED
    *lines, last = capsys.readouterr().out.splitlines()
    assert "robot.lua:1: unknown robot 'no_robot'" in lines[0]
    assert lines[1].startswith(f'scene.lua:2: there is no scene {tmp_path}/no.yaml')
    assert lines[2].startswith('call.lua:1: there is no function wiat')
    assert last == '4 programs, 3 findings in 3 of them'
    assert CHECK_PROGRAM.run([*programs, '--json']) == ExitCode.FAILED
    found = json.loads(capsys.readouterr().out)['problems']
    assert [problem['line'] for problem in found] == [1, 2, 1]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=150)
@given(
    st.one_of(
        st.text(max_size=60),
        st.lists(
            st.sampled_from(
                [
                    'local',
                    'function',
                    'end',
                    '(',
                    ')',
                    '{',
                    '}',
                    ',',
                    '=',
                    'x',
                    'wait',
                    'call',
                    '"a"',
                    '1',
                    'for',
                    'in',
                    '...',
                    'ptpCartesianSpace',
                    'setDigitalOutput',
                    '[[',
                    ']]',
                    '--',
                    '\n',
                    'do',
                    'if',
                    'then',
                    'nil',
                ]
            ),
            max_size=30,
        ).map(' '.join),
    )
)
def test_any_text_is_checked(tmp_path: Path, text: str):
    path = tmp_path / 'test.lua'
    path.write_bytes(text.encode(errors='replace'))
    for problem in check_program(path, SIZES):
        assert problem.file
    assert sum(token.text.count('\n') for token in lua_tokens(text)) <= text.count('\n')


def test_tasks_do_not_move_the_robot(tmp_path: Path):
    (tmp_path / 'watch.lua').write_text('waitDigitalInput(1, true)\nlinearRelative(0, 0, 1, 0, 0, 0)')
    (found,) = check(tmp_path, "startTask('watch')")
    assert found == 'watch.lua:2: linearRelative: not in a task; the main program alone may call it'
