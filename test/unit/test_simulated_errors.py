"""Programs in a simulated cell that fail, never end or cannot begin."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import ProgramStateChanged
from robots_core.errors import RobotsError

from .simulated_program import PERIOD, PROGRAMS, ROBOT, outputs, run_text


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
    run = run_text(tmp_path, text, longest=2.0)
    assert str(run.error) == f'program.lua:{line}: it has not ended after 2 s'
    assert run.time[-1] == pytest.approx(2.0, abs=2 * PERIOD)


def test_a_program_that_computes_while_nothing_can_change_is_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr('robots_controller.simulation.simulated_cell.BUSY_TIME', 1.0)
    run = run_text(tmp_path, 'local hit = false\nwhile not hit do end')
    assert str(run.error) == 'program.lua:2: it computes for ever: nothing is left that could change'
    assert run.time[-1] == pytest.approx(1.0, abs=3 * PERIOD)


def test_a_handler_changes_what_the_program_waits_for_busily(tmp_path: Path):
    io = tmp_path / 'plc.yaml'
    io.write_text('rules: [{when: start, after: 0.5, set: {digital_input.1: 1}}]')
    text = """
        local hit = false
        onDigitalInput(1, true, function() hit = true end)
        while not hit do end
        setDigitalOutput(1, 1)"""
    runs = [run_text(tmp_path, text, io=io) for _ in range(2)]
    assert runs[0].ok, runs[0].error
    assert outputs(runs[0]) == [(pytest.approx(0.5, abs=2 * PERIOD), 1.0)]
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
