"""The robot functions of table 2, as a program uses them."""

from __future__ import annotations

import inspect
from pathlib import Path

import numpy as np
import pytest

from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.run_state import RunState
from robots_core import load_robot_model
from robots_core.errors import JointLimitError, PlanningError
from robots_core.orientation import ORIENTATION_CONVENTIONS
from robots_core.pose import Pose
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, KIND_OF_FUNCTION, LINE, MotionKind

from .lua_host import DEADLINE, LuaHost, wait_until

PAPER_FUNCTIONS = {  # of its table 2
    *('ptpCartesianSpace', 'ptpJointSpaceAngles', 'ptpJointSpacePosition', 'setDigitalOutput'),
    *('getDigitalInput', 'setAnalogOutput', 'getAnalogInput', 'wait', 'print'),
}


def test_functions_are_those_of_the_paper():
    assert set(LUA_FUNCTIONS) >= PAPER_FUNCTIONS
    for name, function in LUA_FUNCTIONS.items():
        assert function.name == name
        assert function.doc.endswith('.')
        assert inspect.cleandoc(function.doc) == function.doc
    assert LUA_FUNCTIONS['ptpJointSpaceAngles'].signature == 'ptpJointSpaceAngles(q1, ..., qn, [options])'
    assert (
        LUA_FUNCTIONS['ptpCartesianSpace'].signature
        == 'ptpCartesianSpace(x, y, z, phi1, phi2, phi3, [options])'
    )
    assert LUA_FUNCTIONS['waitDigitalInput'].signature == 'waitDigitalInput(index, value, [timeout])'


def test_every_function_that_moves_the_robot_is_there_and_takes_options():
    assert {name for name, function in LUA_FUNCTIONS.items() if function.options} == set(KIND_OF_FUNCTION)


def test_all_functions_exist_in_a_program(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert host.run(f'for _, f in ipairs {{{", ".join(LUA_FUNCTIONS)}}} do print(type(f)) end') is None
    assert host.printed == ['function'] * len(LUA_FUNCTIONS)


@pytest.mark.parametrize('arguments', ['0, -90, 45, 0, 45, 0', '{0, -90, 45, 0, 45, 0}'])
def test_joint_angles_are_degrees(tmp_path: Path, arguments: str):
    host = LuaHost(tmp_path)
    assert host.run(f'\nptpJointSpaceAngles({arguments})') is None
    (command,) = host.commands
    assert (command.kind, command.line, command.function, command.pose) == (
        JOINT,
        2,
        'ptpJointSpaceAngles',
        None,
    )
    np.testing.assert_array_equal(command.q, np.radians([0.0, -90.0, 45.0, 0.0, 45.0, 0.0]))
    assert not command.q.flags.writeable


def test_sliding_axes_are_metres(tmp_path: Path):
    host = LuaHost(tmp_path, 3, prismatic=(False, True, False))
    assert host.run('ptpJointSpaceAngles(90, 0.25, -180)') is None
    np.testing.assert_array_equal(host.commands[0].q, [np.pi / 2, 0.25, -np.pi])


@pytest.mark.parametrize('convention', ORIENTATION_CONVENTIONS)
@pytest.mark.parametrize(
    ('function', 'kind'),
    [
        ('ptpCartesianSpace', LINE),
        ('ptpJointSpacePosition', JOINT_TO_POSE),
    ],
)
def test_poses_are_metres_and_degrees_of_the_convention(
    tmp_path: Path, function: str, kind: MotionKind, convention: str
):
    call = f'{function}(0.37, -1.78, 1.21, -42.03, 117.47, -35.89)'
    by_option = LuaHost(tmp_path, orientation_convention=convention)
    assert by_option.run(call) is None
    host = LuaHost(tmp_path)
    assert host.run(f"setOrientationConvention('{convention}') {call}") is None
    (command,) = host.commands
    assert by_option.commands[0].pose is not None
    np.testing.assert_array_equal(by_option.commands[0].pose.T, command.pose.T)
    expected = Pose.from_angles(
        [0.37, -1.78, 1.21], np.radians([-42.03, 117.47, -35.89]), convention=convention
    )
    assert command.kind is kind
    assert command.q is None
    assert command.pose is not None
    np.testing.assert_array_equal(command.pose.r, expected.r)
    np.testing.assert_array_equal(command.pose.T, expected.T)
    assert host.program.reference_cartesian_position is command.pose


def test_a_convention_ends_with_its_program_and_must_exist(tmp_path: Path):
    flange = Pose.from_angles([1.0, 0.0, 1.0], [0.3, -0.7, 1.9], 'rotation_vector')
    host = LuaHost(tmp_path, joint_feedback=lambda: JointFeedback(np.zeros(6)), direct=lambda _: flange)
    read = "print(string.format('%.6f %.6f %.6f', table.unpack(getCartesianPosition(), 4)))"
    assert host.run(read) is None
    assert host.run(f"setOrientationConvention('rotation_vector') {read}") is None
    assert host.run(read) is None
    as_vector = ' '.join(f'{angle:.6f}' for angle in np.degrees([0.3, -0.7, 1.9]))
    assert host.printed[1] == as_vector
    assert host.printed[2] == host.printed[0] != as_vector
    host.refuses(
        "setOrientationConvention('euler')", "valid is 'zyx', 'xyz', 'zyz', 'XYZ', 'rotation_vector'"
    )


def test_a_joint_motion_has_a_reference_pose_of_its_tool_and_base(tmp_path: Path):
    robot = load_robot_model('kuka_kr210_r2700')
    host = LuaHost(tmp_path, direct=robot.pose)
    text = """
        ptpCartesianSpace(1, 0, 1, 0, 90, 0)
        setTool(0, 0, 0.3, 0, 0, 0) setBase(1, 0, 0, 0, 0, 90)
        ptpJointSpaceAngles(10, -90, 90, 0, 45, 0)"""
    assert host.run(text) is None
    reference = host.program.reference_cartesian_position
    assert reference is not None
    r, T = robot.direct_kinematics(np.radians([10.0, -90.0, 90.0, 0.0, 45.0, 0.0]))
    seen = Pose(r + T @ [0.0, 0.0, 0.3] - [1.0, 0.0, 0.0], T)
    base = Pose.from_angles([0.0, 0.0, 0.0], np.radians([0.0, 0.0, 90.0]))
    assert max(reference.distance_to(base.inverse() @ seen)) < 1e-12


def test_outputs_change_and_are_reported_once(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert (
        host.run(
            'setDigitalOutput(1, 0)\nsetDigitalOutput(1, 1)\nsetDigitalOutput(1, true)\n'
            'setDigitalOutput(2, 1.0)\nsetDigitalOutput(1, false)\nsetAnalogOutput(8, -0.5)'
        )
        is None
    )
    assert [(c.kind, c.index, c.value, c.line) for c in host.outputs] == [
        ('digital', 1, 1.0, 2),
        ('digital', 2, 1.0, 4),
        ('digital', 1, 0.0, 5),
        ('analog', 8, -0.5, 6),
    ]
    assert np.flatnonzero(host.program.digital_outputs).tolist() == [1]
    assert host.program.analog_outputs.tolist() == [0.0] * 7 + [-0.5]


def test_inputs_are_booleans_and_numbers(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.program.digital_inputs = [0, 1]
    host.program.analog_inputs = [2.5]
    assert (
        host.run('print(getDigitalInput(1), getDigitalInput(2), getAnalogInput(1), getAnalogInput(2))')
        is None
    )
    assert host.run("if getDigitalInput(1) then print('on') else print('off') end") is None
    assert host.printed == ['false\ttrue\t2.5\t0.0', 'off']


UP = 'linearRelative, 0, 0, 1, 0, 0, 0'
NAMES = {'digital_inputs': ['', 'ready'], 'digital_outputs': ['gripper'], 'analog_outputs': ['valve']}


def test_inputs_and_outputs_have_names(tmp_path: Path):
    host = LuaHost(tmp_path, io_labels=NAMES)
    host.program.digital_inputs = [0, 1]
    text = """
        setDigitalOutput('gripper', true) setAnalogOutput('valve', 1.5)
        print(getDigitalInput('ready'), getDigitalOutput('gripper'), getDigitalOutput(2))
        print(getAnalogOutput(1))"""
    assert host.run(text) is None
    assert host.printed == ['true\ttrue\tfalse', '1.5']
    assert [(change.kind, change.index) for change in host.outputs] == [('digital', 1), ('analog', 1)]


def test_names_are_those_of_their_kind(tmp_path: Path):
    host = LuaHost(tmp_path, io_labels=NAMES)
    host.refuses(
        "getDigitalInput('gripper')", "the string 'gripper'; valid is a whole number in 1..32 or 'ready'"
    )


def test_time_passes_from_the_start_of_the_program(tmp_path: Path):
    host = LuaHost(tmp_path)
    text = """
        local before, elapsed = getTime(), timer()
        wait(0.01)
        local took = elapsed()
        assert(before >= 0 and took >= 0.01 and getTime() >= before + took)"""
    assert host.run(text) is None


def test_poses_multiply_and_have_names(tmp_path: Path):
    host = LuaHost(tmp_path)
    text = """
        local a, b = pose(1, 2, 3, 90, 0, 0), pose({1, 0, 0, 0, 0, 0})
        print(a * b, a * b * inverse(b), {0, 0, 1, 0, 0, 0} * a)
        print(offset(a, 1, 0, 0), offset(a, 1, 0, 0, nil, nil, nil, 'tool'))
        a.z = a.z + 1
        print(a, a.z, a[3], #a, a.w)"""
    assert host.run(text) is None
    assert host.printed == [
        '{1, 3, 3, 90, 0, 0}\t{1, 2, 3, 90, 0, 0}\t{1, 2, 4, 90, 0, 0}',
        '{2, 2, 3, 90, 0, 0}\t{1, 3, 3, 90, 0, 0}',
        '{1, 2, 4, 90, 0, 0}\t4.0\t4.0\t6\tnil',
    ]


def test_a_grid_goes_row_by_row_and_layer_by_layer(tmp_path: Path):
    host = LuaHost(tmp_path)
    text = """
        local first = pose(0, 0, 0, 0, 90, 0)
        local places = grid(first, offset(first, 2, 0, 0), 3, offset(first, 0, 1, 0), 2)
        for _, place in ipairs(places) do print(place.x, place.y) end
        print(#grid(first, offset(first, 1, 0, 0), 2, nil, nil, offset(first, 0, 0, 1), 4))"""
    assert host.run(text) is None
    assert host.printed[:6] == [f'{x}.0\t{y}.0' for y in (0, 1) for x in (0, 1, 2)]
    assert host.printed[6] == '8'


def test_halt_holds_the_program_until_it_is_let_go_on(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.start("halt('parts are missing') print('on')")
    host.wait_for_print()
    wait_until(lambda: host.program.run_state is RunState.PAUSED)
    assert host.program.resume()
    assert host.program.join(DEADLINE)
    assert host.printed == ['halt: parts are missing', 'on']


def test_print_is_that_of_lua(tmp_path: Path):
    host = LuaHost(tmp_path)
    assert host.run("print() print('a', 1, 1.5, nil, true) print('ü')") is None
    assert host.printed == ['', 'a\t1\t1.5\tnil\ttrue', 'ü']


@pytest.mark.parametrize(
    ('call', 'message'),
    [
        ('ptpJointSpaceAngles(1, 2, 3, 4, 5)', 'got 5 joint angles, the robot has 6 axes'),
        ('ptpJointSpaceAngles()', 'got 0 joint angles, the robot has 6 axes'),
        ('ptpJointSpaceAngles({1, 2, 3, 4, 5, 6, 7})', 'got 7 joint angles, the robot has 6 axes'),
        ('ptpJointSpaceAngles({1, 2}, 3, 4, 5, 6, 7)', 'q1 = a table; valid is a finite number'),
        ("ptpJointSpaceAngles(1, '2', 3, 4, 5, 6)", "q2 = the string '2'; valid is a finite number"),
        ('ptpJointSpaceAngles(1, 2, 0/0, 4, 5, 6)', 'nan deg (m); valid is a finite number'),
        ('ptpCartesianSpace(1, 2, 3)', 'got 3 arguments, needed are 6: x (m), y (m), z (m), phi1 (deg)'),
        ('ptpCartesianSpace(1, 2, 3, 4, 5, 1/0)', 'phi3 = inf deg; valid is a finite number'),
        ('ptpJointSpacePosition(1, nil, 3, 4, 5, 6)', 'y = nil; valid is a finite number'),
        ('setDigitalOutput(0, 1)', 'index = 0; valid is a whole number in 1..32'),
        ('setDigitalOutput(33, 1)', 'index = 33; valid is a whole number in 1..32'),
        ('setDigitalOutput(1.5, 1)', 'index = 1.5; valid is a whole number in 1..32'),
        ('setDigitalOutput(1, 2)', 'value = 2; valid is 0, 1, true or false'),
        ('setDigitalOutput(1)', 'got 1 arguments, needed are 2 to 3: index, value, [moment]'),
        ('getDigitalInput(true)', 'index = true; valid is a whole number in 1..32'),
        ('getAnalogInput(9)', 'index = 9; valid is a whole number in 1..8'),
        ('setAnalogOutput(1, -1/0)', 'value = -inf; valid is a finite number'),
        ("pose(1, 2, 3, 4, 5, 'x')", "phi3 = the string 'x'; valid is a finite number"),
        ('inverse({1, 2, 3})', 'pose = a table with 3 values; valid is a table {x, y, z, phi1, phi2, phi3}'),
        (
            "offset({1, 2, 3, 4, 5, 6}, 0, 0, 0, 0, 0, 0, 'world')",
            "'world'; valid is 'base' or 'tool'",
        ),
        (
            'grid({1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, 0)',
            'columns = 0; valid is a whole number of at',
        ),
        ('grid({1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, 2, nil, 3)', 'rows need both a number and the pose'),
        ('grid({1, 2, 3, 4, 5, 6}, {1, 2, 3, 4, 5, 6}, 1001)', '1001 places; valid are at most 1000'),
        (
            'isReachable(1, 2, 3, 4, 5, 6, {1, 2})',
            'a table with 2 values; valid is a table with a',
        ),
        ("setDigitalOutput(1, 1, 'later')", "moment = the string 'later'; valid is 'now' or 'arrival'"),
        (
            'moveUntil({input = 1, above = 2}, wait, 1)',
            "the string 'wait'; valid is a function that moves",
        ),
        (f'moveUntil({{input = 1, above = 2}}, {UP})', 'condition has above, input; valid is {input = index'),
        (f'moveUntil({{joint_torque = 7, above = 2}}, {UP})', 'joint_torque = 7; the robot has 6 axes'),
        (f'moveUntil({{input = 1}}, {UP}, {{blend = 1}})', 'linearRelative has a blend; a search ends where'),
        ('removeInterrupt(1)', 'there is no interrupt 1'),
        ("onAnalogInput(1, '=', 2, print)", "comparison = the string '='; valid is '<'"),
        ('onDigitalInput(1, 1, print, 0)', 'priority = 0; valid is a whole number of at least 1'),
        ("setPlanner('limited')", "joint = the string 'limited'; valid is 'collision_free', 'linear_joint'"),
        ('getJointTorques()', 'nothing is measured here'),
        ('wait(-1)', 'time = -1 s; valid is a finite number of at least 0'),
        ('wait(print)', 'time = a function; valid is a finite number of at least 0'),
        ('setAnalogOutput(table.unpack({}, 1, 200))', '200 arguments are too many'),
    ],
)
def test_wrong_arguments_are_explained(tmp_path: Path, call: str, message: str):
    LuaHost(tmp_path).refuses(call, message)


def test_motion_error_is_reported_in_degrees_with_its_line(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.errors[0] = JointLimitError('A2', *np.radians([10.0, -140.0, -5.0]).tolist())
    error = host.fails('\nptpJointSpaceAngles(0, 10, 0, 0, 0, 0)')
    assert str(error) == ('test.lua:2: ptpJointSpaceAngles: A2 = 10 deg is outside its limits [-140, -5] deg')
    assert error.details['joint'] == 'A2'
    assert error.details['value'] == np.radians(10.0)


def test_motion_error_can_be_caught(tmp_path: Path):
    host = LuaHost(tmp_path)
    host.errors[0] = PlanningError('no way')
    assert (
        host.run('print(pcall(ptpJointSpaceAngles, 0, 0, 0, 0, 0, 0)) ptpJointSpaceAngles(0,0,0,0,0,1)')
        is None
    )
    assert host.printed == ['false\ttest.lua:1: ptpJointSpaceAngles: no way']
    assert len(host.commands) == 2
