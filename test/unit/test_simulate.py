"""Programs in a simulated cell: time, motions, inputs and outputs, and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.recording.bag_file import read_bag
from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import (
    CommandStateChanged,
    InputChanged,
    LineReached,
    OutputChanged,
    ProgramStateChanged,
)
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import load_robot_model
from robots_core.blocks.multibody.loaded_robot import loaded_robot
from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_planning.motion_settings import NOTHING

from .simulated_program import PERIOD, PROGRAMS, ROBOT, outputs, run_text


@pytest.fixture(scope='module')
def welding() -> SimulationRun:
    return simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='ideal')


# -- time and samples -------------------------------------------------------------------------------------


def test_the_welding_program_is_the_paper_s(welding: SimulationRun):
    states = [event.state for event in welding.events if isinstance(event, CommandStateChanged)]
    assert states == ['IDLE', 'PTPJOINT_JOINT', 'IDLE'] + 3 * ['PTPCARTESIAN', 'IDLE']
    assert welding.state == 'FINISHED'
    assert welding.printed == ('Welding Program 1',)
    assert [motion.command.line for motion in welding.motions] == [6, 7, 8, 12]
    assert all(motion.ok and motion.message == 'reached' for motion in welding.motions)
    # The gun is on for exactly the second that the program waits, between the third and the fourth motion.
    (on, first), (off, second) = outputs(welding)
    assert (first, second) == (1.0, 0.0)
    assert off - on == pytest.approx(1.0, abs=1e-9)  # waits end at the nanosecond
    assert welding.motions[2].ended <= on < off <= welding.motions[3].started


def test_every_period_is_recorded(welding: SimulationRun):
    assert welding.time[0] == 0.0
    assert np.diff(welding.time) == pytest.approx(PERIOD, abs=1e-9)
    assert welding.duration == pytest.approx(welding.time[-1], abs=PERIOD)
    k, n = welding.time.size, len(welding.axes)
    assert welding.reference.shape == (k, 3, n)
    assert welding.position.shape == welding.velocity.shape == (k, n)
    assert welding.torque is None
    for array in (welding.time, welding.reference, welding.position):
        assert not array.flags.writeable


def test_times_that_are_passed_at_once_are_as_those_passed_one_by_one(tmp_path: Path):
    # Second-order drives creep for longer than the wait takes, so that nothing is passed at once with them.
    still = run_text(tmp_path, 'wait(0.5)')
    crept = run_text(tmp_path, 'wait(0.5)', drive='second_order')
    assert still.time.tolist() == crept.time.tolist()
    assert (still.position == still.position[0]).all()
    assert still.reference.tolist() == crept.reference.tolist()


@pytest.mark.parametrize('times', [(0.0,), (1.0,), (0.0013,), (0.1, 0.2, 0.3), (0.004, 0.004), (1e-12, 7.7)])
def test_waits_take_simulated_time(tmp_path: Path, times: tuple[float, ...]):
    lines = [f'wait({time!r}) setDigitalOutput({i}, 1)' for i, time in enumerate(times, 1)]
    run = run_text(tmp_path, '\n'.join(lines))
    assert run.ok
    # Rounded up to nanoseconds, each.
    ends = [time for time, _ in outputs(run)]
    assert ends == pytest.approx(np.cumsum(times).tolist(), abs=2e-9 * len(times))


def test_computing_takes_no_time(tmp_path: Path):
    run = run_text(tmp_path, 'local x = 0 for i = 1, 300000 do x = x + i end setDigitalOutput(1, 1)')
    assert outputs(run) == [(0.0, 1.0)]


def test_a_loop_that_reads_an_input_lets_time_pass(tmp_path: Path):
    (tmp_path / 'plc.yaml').write_text('rules: [{when: start, after: 0.2, set: {digital_input.1: 1}}]')
    text = 'while not getDigitalInput(1) do end setDigitalOutput(1, 1)'
    run = run_text(tmp_path, text, io=tmp_path / 'plc.yaml')
    assert run.ok
    assert 0.2 <= outputs(run)[0][0] <= 0.2 + 2 * PERIOD


# -- motions ----------------------------------------------------------------------------------------------


def test_drives_stand_at_the_targets_and_references_keep_the_plan(welding: SimulationRun):
    for motion in welding.motions:
        assert motion.plan is not None
        end = welding.position[np.searchsorted(welding.time, motion.ended)]
        assert end == pytest.approx(motion.plan.trajectory.position[-1], abs=1e-5)  # the goal tolerance
        # Smoothing takes the planned duration and its window, settling up to the next two feedbacks.
        late = motion.ended - motion.started - motion.plan.duration
        assert 0.0 <= late <= 0.02 + 4 * PERIOD


def test_rigid_body_drives_know_their_torques():
    run = simulate(PROGRAMS / 'welding.lua', robot=ROBOT, drive='rigid_body')
    assert run.ok
    assert run.torque is not None
    assert np.abs(run.torque).max() > 100.0  # N m: it carries its own weight


def test_elastic_gears_with_stiction_come_to_rest_at_the_target(tmp_path: Path):
    text = 'ptpJointSpaceAngles(60, -70, -35, 45, 110, 45)\nptpJointSpaceAngles(0, 20, 90, 0, 45, 0)\n'
    text += 'linearRelative(0, 0, -0.2, 0, 0, 0)\n'
    run = run_text(tmp_path, text, robot='manutec_r3', drive='rigid_body')
    assert run.ok, run.error
    assert len(run.motions) == 3


def test_settings_hold_as_long_as_the_program_says(tmp_path: Path):
    move = 'ptpJointSpaceAngles({}, -90, 90, 0, 90, 0)\n'
    run = run_text(tmp_path, move.format(0) + move.format(20) + 'setSpeed(0.1)\n' + move.format(0))
    fast, slow = (motion.plan for motion in run.motions[1:])
    assert fast is not None
    assert slow is not None
    assert slow.report.uses['velocity'].ratio == pytest.approx(0.1, rel=1e-3)  # the planner's margin
    assert slow.duration > 2.0 * fast.duration
    assert [motion.settings.speed_fraction for motion in run.motions] == [1.0, 1.0, 0.1]


def test_an_override_slows_the_motion_under_way(tmp_path: Path):
    move = 'ptpJointSpaceAngles(40, -90, 90, 0, 90, 0)'
    full, half = (run_text(tmp_path, f'{before} {move}') for before in ('', 'setOverride(0.5)'))
    assert half.motions[0].plan is not None
    # Twice as long except for smoothing and settling, which the override does not touch.
    assert half.duration == pytest.approx(full.duration + half.motions[0].plan.duration, abs=2 * PERIOD)


def test_blended_motions_run_through(tmp_path: Path):
    text = """
    ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
    linearRelative(0, 0.3, 0, 0, 0, 0, {%s})
    linearRelative(0, 0, -0.3, 0, 0, 0)
    """
    stops, blends = (run_text(tmp_path, text % option) for option in ('', 'blend = 0.05'))
    assert stops.ok
    assert blends.ok
    assert [motion.message for motion in blends.motions] == ['reached', 'passed', 'reached']
    assert blends.motions[1].chain == (blends.motions[1].id, blends.motions[2].id)
    assert blends.motions[1].end_on_plan == blends.motions[2].start_on_plan
    assert blends.duration < stops.duration


def test_outputs_switch_on_the_path(tmp_path: Path):
    run = run_text(
        tmp_path,
        'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
        'local place = {distance_before_end = 0.1, output = 1, value = true}\n'
        'linearRelative(0, 0, -0.4, 0, 0, 0, {on_path = place})',
    )
    (switched,) = outputs(run)
    motion = run.motions[-1]
    assert motion.started < switched[0] < motion.ended
    position = run.position[np.searchsorted(run.time, switched[0])]
    robot = load_robot_model(ROBOT)
    (r, _), (end, _) = (robot.direct_kinematics(q) for q in (position, run.position[-1]))
    # One period at the 0.5 m/s of the tool, and the smoothing's lag of 10 ms before which the plan is.
    assert np.linalg.norm(end - r) == pytest.approx(0.1, abs=0.5 * (PERIOD + 0.012))


def test_a_place_on_a_chain_is_that_of_its_motion_where_the_robot_comes_back(tmp_path: Path):
    run = run_text(
        tmp_path,
        """ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
        local function go(x, z, output)
          linearRelative(x, 0, z, 0, 0, 0,
            {blend = 0.02, on_path = {distance_before_end = 0.1, output = output, value = true}})
        end
        go(0, -0.4, 1) go(0.2, 0, 2) go(-0.2, 0, 3) go(0, 0.2, 4)
        linearRelative(0, 0, 0.1, 0, 0, 0)""",
    )
    assert run.ok
    motions, robot = run.motions[1:], load_robot_model(ROBOT)
    assert all(len(motion.chain) == 5 for motion in motions)
    start = np.array(robot.direct_kinematics(np.radians([0, -90, 90, 0, 90, 0]))[0])
    corners = start + np.cumsum([[0, 0, -0.4], [0.2, 0, 0], [-0.2, 0, 0], [0, 0, 0.2]], axis=0)
    for (time, _), motion, corner in zip(outputs(run), motions, corners, strict=False):
        # Within its own motion, the smoothing's lag behind its plan.
        after = time - motion.started
        assert motion.start_on_plan < after < motion.end_on_plan
        position = run.position[np.searchsorted(run.time, time)]
        distance = np.linalg.norm(corner - robot.direct_kinematics(position)[0])
        # As above; and the blend is shorter than the corner, by less than its zone.
        assert distance == pytest.approx(0.1, abs=0.5 * (PERIOD + 0.012) + 0.02)


# -- inputs and interrupts --------------------------------------------------------------------------------


def test_a_plc_and_the_program_work_together():
    io = PROGRAMS / 'io' / 'press_tending.yaml'
    run = simulate(PROGRAMS / 'press_tending.lua', robot=ROBOT, drive='ideal', io=io)
    assert run.ok
    assert run.printed == ('part 1: 250 kN', 'part 2: 250 kN', '2 parts pressed')
    force = [e for e in run.events if isinstance(e, InputChanged) and (e.kind, e.index) == ('analog', 1)]
    assert [event.value for event in force] == [250.0, 0.0, 250.0, 0.0]
    starts = [e.time for e in run.events if isinstance(e, OutputChanged) and (e.index, e.value) == (1, 1.0)]
    # The press closes 0.8 s after its start; the PLC looks once in a period.
    assert [event.time for event in force[::2]] == pytest.approx([t + 0.8 for t in starts], abs=2 * PERIOD)


def test_a_handler_brakes_the_robot_and_lets_it_go_on(tmp_path: Path):
    (tmp_path / 'plc.yaml').write_text('rules: [{when: start, after: 0.5, set: {digital_input.2: 1}}]')
    text = """
    onDigitalInput(2, true, function() setDigitalOutput(1, 1) wait(1) setDigitalOutput(1, 0) end)
    ptpJointSpaceAngles(90, -90, 90, 0, 90, 0)
    """
    plain = run_text(tmp_path, text)
    handled = run_text(tmp_path, text, io=tmp_path / 'plc.yaml')
    assert handled.ok
    (on, _), (off, _) = outputs(handled)
    assert on == pytest.approx(0.5, abs=PERIOD)
    assert off - on == pytest.approx(1.0, abs=1e-9)
    # It stands before the handler ends: braking takes at least the ramp of 0.2 s.
    standing = (handled.time > on + 0.8) & (handled.time < off)
    assert not handled.reference[standing, 1].any()
    assert handled.motions[0].ok
    assert handled.duration > plain.duration + 1.0


# -- errors -----------------------------------------------------------------------------------------------


def test_an_error_names_the_line_as_in_a_live_cell(tmp_path: Path):
    run = run_text(tmp_path, 'wait(0.1)\nptpJointSpaceAngles(0, 500, 0, 0, 0, 0)')
    assert run.state == 'FAILED'
    assert str(run.error) == (
        'program.lua:2: ptpJointSpaceAngles: A2 = 500 deg is outside its limits [-140, -5] deg'
    )
    assert run.events[-1] == ProgramStateChanged(pytest.approx(0.1), 'FAILED')
    assert not run.motions[0].ok


def test_a_program_can_catch_a_motion_that_fails(tmp_path: Path):
    run = run_text(
        tmp_path,
        'print(pcall(ptpJointSpaceAngles, 0, 500, 0, 0, 0, 0))\nptpJointSpaceAngles(0, -90, 90, 0, 90, 0)',
    )
    assert run.ok
    assert run.printed[0].startswith('false\t')
    assert [motion.ok for motion in run.motions] == [False, True]


def test_motions_that_collide_are_refused():
    scene = PROGRAMS / 'scenes' / 'car_frame.yaml'
    runs = [
        simulate(PROGRAMS / f'{name}.lua', robot=ROBOT, drive='ideal', scene=scene)
        for name in ('welding_collision', 'welding_around_pillar')
    ]
    assert runs[0].state == 'FAILED'
    assert 'welding_collision.lua:11: ptpCartesianSpace: the motion collides' in str(runs[0].error)
    assert runs[1].ok


@pytest.mark.parametrize(
    ('function', 'reason'),
    [
        ('followReference', 'a simulation has no sensor; --references names a recording of one'),
        ('jog', 'a simulation has no teach box; --references names a recording of one'),
    ],
)
def test_a_robot_that_nobody_can_guide_is_an_error(tmp_path: Path, function: str, reason: str):
    run = run_text(tmp_path, f'wait(1)\n{function}(5)')
    assert str(run.error) == f'program.lua:2: {function}: {reason}'
    # And one that a program can expect.
    assert run_text(tmp_path, f'print(pcall({function}, 5))').ok


@pytest.mark.parametrize('drive', ['ideal', 'second_order'])
def test_a_wait_without_end_is_found(tmp_path: Path, drive: str):
    run = run_text(tmp_path, 'wait(1)\nwaitDigitalInput(3, true)', drive=drive)
    assert run.state == 'FAILED'
    assert str(run.error) == 'program.lua:2: it waits for ever: nothing is left that could change'
    assert run.duration == pytest.approx(1.0, abs=2 * PERIOD)


def test_a_robot_that_stands_for_ever_is_found(tmp_path: Path):
    run = run_text(tmp_path, 'setOverride(0)\nptpJointSpaceAngles(0, -90, 90, 0, 90, 0)')
    assert 'the robot stands in the middle of a motion' in str(run.error)


def test_a_program_without_end_is_ended(tmp_path: Path):
    run = run_text(tmp_path, 'while true do wait(1) end', longest=20.0)
    assert str(run.error) == 'program.lua:1: it has not ended after 20 s'
    assert run.time[-1] == pytest.approx(20.0, abs=2 * PERIOD)


@pytest.mark.parametrize(
    ('text', 'line'),
    [
        ('while true do end', 1),
        ('wait(0.1)\nlocal n = 0\nwhile true do\n  n = n + 1 end', 4),
        ('wait(0.1)\ncoroutine.wrap(function()\nwhile true do end end)()', 3),
        ('wait(0.1)\nwhile true do\npcall(function() while true do end end) end', 3),
    ],
)
def test_a_program_that_computes_without_end_is_ended_at_its_line(tmp_path: Path, text: str, line: int):
    run = run_text(tmp_path, text, longest=5.0)
    assert str(run.error) == f'program.lua:{line}: it has not ended after 5 s'
    assert run.time[-1] == pytest.approx(5.0, abs=2 * PERIOD)


def test_a_program_that_computes_while_nothing_can_change_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr('robots_controller.simulation.deadlock_detection.BUSY_TIME', 2.0)
    run = run_text(tmp_path, 'local hit = false\nwhile not hit do end')
    assert str(run.error) == 'program.lua:2: it computes for ever: nothing is left that could change'
    assert run.time[-1] == pytest.approx(2.0, abs=3 * PERIOD)


def test_a_handler_changes_what_the_program_waits_for_busily(tmp_path: Path):
    io = tmp_path / 'plc.yaml'
    io.write_text('rules: [{when: start, after: 1.5, set: {digital_input.1: 1}}]')
    text = """
        local hit = false
        onDigitalInput(1, true, function() hit = true end)
        while not hit do end
        setDigitalOutput(1, 1)"""
    runs = [run_text(tmp_path, text, io=io) for _ in range(2)]
    assert runs[0].ok, runs[0].error
    assert outputs(runs[0]) == [(pytest.approx(1.5, abs=2 * PERIOD), 1.0)]
    assert runs[0].events == runs[1].events


def test_short_computations_take_no_time(tmp_path: Path):
    text = 'for i = 1, 1000 do wait(0.01) for j = 1, 500 do local x = j end end'
    assert run_text(tmp_path, text).duration == pytest.approx(10.0, abs=2 * PERIOD)


@pytest.mark.parametrize(
    ('options', 'reason'),
    [
        ({'robot': 'nobody'}, 'unknown robot'),
        ({'drive': 'magic'}, 'magic'),
        ({'io': 'missing.yaml'}, 'missing.yaml'),
        ({'io_map': 'missing.yaml'}, 'missing.yaml'),
        ({'references': 'missing'}, 'missing does not exist'),
        ({'scene': 'missing.yaml'}, 'missing.yaml'),
        ({'rate': float('nan')}, 'rate'),
        ({'longest': -1.0}, 'longest'),
    ],
)
def test_bad_input_is_said_before_anything_moves(tmp_path: Path, options: dict[str, object], reason: str):
    with pytest.raises(RobotsError, match=reason):
        run_text(tmp_path, 'wait(1)', **options)


def test_a_program_that_is_not_lua_is_refused(tmp_path: Path):
    with pytest.raises(RobotsError, match=r'program\.lua:1'):
        run_text(tmp_path, 'this is no program')


def test_lines_are_those_of_the_program(welding: SimulationRun):
    assert [e.line for e in welding.events if isinstance(e, LineReached)] == [3, 4, 5, 6, 7, 8, 9, 10, 11, 12]


# -- the map of a PLC that is not there -------------------------------------------------------------------


def test_a_map_gives_names_and_fail_safe_values(tmp_path: Path):
    (tmp_path / 'map.yaml').write_text(
        'signals: {door_closed: digital_input.2}\n'
        'inputs:\n'
        '  - {channel: door_closed, topic: a, type: Bool, timeout: 0.5, fail_safe: true}\n'
        '  - {channel: analog_input.1, topic: b, type: Float64, timeout: 0.5, fail_safe: 2.5}\n'
        '  - {channel: digital_input.1, topic: c, type: Bool}\n'
    )
    text = 'print(tostring(getDigitalInput(1)) .. tostring(getDigitalInput(2)) .. getAnalogInput(1))'
    run = run_text(tmp_path, text, io_map=tmp_path / 'map.yaml', bag=tmp_path / 'bag')
    assert run.printed == ('falsetrue2.5',)
    found = read_bag(tmp_path / 'bag').deserialized(['/digital_inputs', '/parameter_events'])
    assert found['/digital_inputs'][0][1].data.tolist() == [0, 1]
    (event,) = (message for _, message in found['/parameter_events'])
    assert event.new_parameters[0].value.string_array_value == ['', 'door_closed']


def test_a_map_and_a_script_that_set_the_same_inputs_are_refused(tmp_path: Path):
    (tmp_path / 'map.yaml').write_text('inputs: [{channel: digital_input.9, topic: a, type: Bool}]')
    io = PROGRAMS / 'io' / 'press_tending.yaml'
    with pytest.raises(RobotsError, match='both set digital_inputs; only one can publish that topic'):
        run_text(tmp_path, 'wait(1)', io=io, io_map=tmp_path / 'map.yaml')


def test_a_motion_begins_at_once_although_the_plc_does_something_later(tmp_path: Path):
    program, rules = tmp_path / 'move.lua', tmp_path / 'plc.yaml'
    program.write_text('ptpJointSpaceAngles(20, -90, 90, 0, 90, 0)')
    rules.write_text('rules: [{when: start, after: 5, set: {digital_input.1: 1}}]')
    alone = simulate(program, robot=ROBOT, drive='ideal')
    beside = simulate(program, robot=ROBOT, drive='ideal', io=rules)
    np.testing.assert_array_equal(beside.reference, alone.reference)
    assert beside.duration == alone.duration


# -- payload ----------------------------------------------------------------------------------------------


def test_drives_carry_the_cells_payload_and_then_that_of_the_program(tmp_path: Path):
    stand = 'ptpJointSpaceAngles(0, -60, 60, 0, 60, 0) wait(1)\n'
    text = stand + 'setPayload(0)\n' + 'ptpJointSpaceAngles(0, -60, 60, 0, 60, 1) wait(1)'
    payload = (80.0, 0.0, 0.0, 0.3)
    run = run_text(tmp_path, text, drive='rigid_body', payload=payload)
    assert run.ok
    assert run.torque is not None
    robot = load_robot_model(ROBOT)
    q, still = np.radians([0, -60, 60, 0, 60, 0]), np.zeros(6)
    empty, loaded = (loaded_robot(robot, p).rigid_dynamics(q, still, still)[0][1] for p in (NOTHING, payload))
    first = np.searchsorted(run.time, run.motions[0].ended + 0.9)
    # Friction holds a part, which is small beside the weight of 80 kg.
    assert run.torque[first, 1] == pytest.approx(loaded, abs=0.2 * abs(loaded - empty))
    assert run.torque[-1, 1] == pytest.approx(empty, abs=0.2 * abs(loaded - empty))


def test_ur_robots_are_programmed_with_rotation_vectors_as_their_maker_s(tmp_path: Path):
    text = """
        ptpJointSpacePosition(-0.45, -0.13, 0.45, 120, -125, 3)
        local p = getCartesianPosition()
        print(string.format('%.3f %.3f %.3f', p[4], p[5], p[6]))
        setOrientationConvention('zyx')
        ptpCartesianSpace(-0.45, -0.13, 0.4, table.unpack(getCartesianPosition(), 4))
    """
    run = run_text(tmp_path, text, robot='ur5e')
    assert run.state == 'FINISHED'
    assert run.printed == ('120.000 -125.000 3.000',)
    robot = load_robot_model('ur5e')
    T = [
        robot.direct_kinematics(run.reference[-1, 0])[1],
        Pose.from_angles(np.zeros(3), np.radians([120.0, -125.0, 3.0]), 'rotation_vector').T,
    ]
    np.testing.assert_allclose(T[0], T[1], atol=1e-6)


def test_equal_switches_of_two_motions_belong_to_their_own_lines(tmp_path: Path):
    text = """ptpJointSpaceAngles(0, -90, 90, 0, 45, 0)
        local on = {distance_after_start = 0.05, output = 1, value = 1}
        local off = {distance_before_end = 0.02, output = 1, value = 0}
        linearRelative(0, 0.2, 0, 0, 0, 0, {blend = 0.01, on_path = {on, off}})
        linearRelative(0, 0, 0.2, 0, 0, 0, {on_path = {on, off}})"""
    run = run_text(tmp_path, text)
    changes = [event for event in run.events if isinstance(event, OutputChanged)]
    assert [(change.value, change.line) for change in changes] == [(1.0, 4), (0.0, 4), (1.0, 5), (0.0, 5)]


def test_a_motion_that_would_take_days_fails_in_its_line(tmp_path: Path):
    run = run_text(tmp_path, 'setSpeed(1e-6)\nptpJointSpaceAngles(10, -80, 90, 0, 60, 0)')
    assert str(run.error).endswith(
        ':2: ptpJointSpaceAngles: the motion takes 348872 s or more; allowed are 3600 s'
    )
