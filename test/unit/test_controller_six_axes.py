"""ControllerSixAxes: the cell of `simulate`, stepped from outside, with physics and PLC of the caller."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from robots_controller.control.stops.faults import Fault, StopCategory
from robots_controller.controller_six_axes import ControllerSixAxes, ControllerStep
from robots_controller.io.plc_script import read_plc_script
from robots_controller.io.scripted_plc import ScriptedPlc
from robots_controller.program.run_state import RunState
from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import TextPrinted
from robots_core import load_robot_model
from robots_core.errors import RobotsError
from robots_core.validation import Array

from .simulated_program import PERIOD, PROGRAMS, ROBOT

MOVE = 'ptpJointSpaceAngles(20, -80, 80, 0, 60, 0)\n'
LONGEST = 60.0  # s of simulated time; a run that takes longer does not end


@pytest.fixture
def controller_of(tmp_path: Path) -> Iterator[Callable[..., ControllerSixAxes]]:
    """Makes controllers of program texts, which are closed at the end."""
    made: list[ControllerSixAxes] = []

    def make(text: str, **options: object) -> ControllerSixAxes:
        program = tmp_path / 'program.lua'
        program.write_text(text)
        made.append(ControllerSixAxes(ROBOT, program=program, **options))  # type: ignore[arg-type]
        return made[-1]

    yield make
    for controller in made:
        controller.close()


def on_the_reference(controller: ControllerSixAxes) -> list[ControllerStep]:
    """All steps with a robot that follows exactly."""
    steps = [controller.step(controller.robot.home)]
    while steps[-1].running and steps[-1].time < LONGEST:
        steps.append(controller.step(steps[-1].references[0]))
    return steps


def references(steps: list[ControllerStep]) -> Array:
    return np.array([step.references for step in steps])


def printed(steps: list[ControllerStep]) -> list[str]:
    return [event.text for step in steps for event in step.events if isinstance(event, TextPrinted)]


# -- one cell ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('robot', 'program', 'axes'),
    [
        ('debris_arm', 'language/three_axes', 3),
        (ROBOT, 'welding', 6),
        ('bello_bot', 'bello_bot_tour', 7),
    ],
)
def test_the_references_are_those_of_a_simulation(robot: str, program: str, axes: int):
    path = PROGRAMS / f'{program}.lua'
    run = simulate(path, robot=robot, drive='ideal')
    with ControllerSixAxes(load_robot_model(robot), program=path) as controller:
        steps = on_the_reference(controller)
    assert steps[-1].run_state is RunState.FINISHED
    assert steps[-1].references.shape == (3, axes)
    k = run.time.size
    assert len(steps) == k + 1  # a block makes each step that it has begun
    assert np.array_equal(references(steps)[:k], run.reference)
    assert [step.time for step in steps[:k]] == run.time.tolist()
    assert tuple(printed(steps)) == run.printed
    assert [(m.id, m.started, m.ended) for m in controller.motions] == [
        (m.id, m.started, m.ended) for m in run.motions
    ]


def test_a_plc_of_the_caller_is_that_of_a_simulation(
    controller_of: Callable[..., ControllerSixAxes], tmp_path: Path
):
    io = tmp_path / 'io.yaml'
    io.write_text(
        'signals: {go: digital_output.3, ready: digital_input.2}\n'
        'rules:\n'
        '  - {when: go rises, after: 0.5, set: {ready: on}}\n'
        '  - {when: go falls, set: {ready: off}}\n'
    )
    text = f"""{MOVE}
        setDigitalOutput(3, 1)
        while not getDigitalInput(2) do wait(0.01) end
        setDigitalOutput(3, 0)
        ptpJointSpaceAngles(0, -90, 90, 0, 0, 0)"""
    controller = controller_of(text, io=io)
    plc = ScriptedPlc(read_plc_script(io))
    step, steps, inputs = controller.step(controller.robot.home), [], {}
    while step.running and step.time < LONGEST:
        steps.append(step)
        plc.output('digital_output.3', step.outputs['go'])
        inputs = {change.channel.name: change.value for change in plc.step(step.time)}
        step = controller.step(step.references[0], inputs)
    run = simulate(tmp_path / 'program.lua', robot=ROBOT, drive='ideal', io=io)
    assert run.ok
    assert np.array_equal(references(steps), run.reference)
    assert {step.outputs['digital_output.3'] for step in steps} == {0.0, 1.0}


def test_a_motion_that_collides_is_refused_as_in_a_simulation():
    program, scene = PROGRAMS / 'welding_collision.lua', PROGRAMS / 'scenes' / 'car_frame.yaml'
    run = simulate(program, robot=ROBOT, drive='ideal', scene=scene)
    with ControllerSixAxes(ROBOT, program=program, scene=scene) as controller:
        steps = on_the_reference(controller)
    assert steps[-1].run_state is RunState.FAILED
    assert str(steps[-1].error) == str(run.error)
    assert 'collides' in str(run.error)


def test_periods_may_be_of_any_length(controller_of: Callable[..., ControllerSixAxes]):
    steps = on_the_reference(controller_of(MOVE, period=0.01))
    assert steps[-1].run_state is RunState.FINISHED
    assert np.diff([step.time for step in steps]) == pytest.approx(0.01, abs=1e-9)  # whole nanoseconds


def test_what_is_measured_reaches_the_program(controller_of: Callable[..., ControllerSixAxes]):
    text = 'wait(0.1)\nprint(getJointAngles()[1], getJointSpeeds()[1], getJointTorques()[1])'
    controller = controller_of(text)
    q, ones = np.array(controller.robot.home), np.ones(6)
    steps = [controller.step(q, velocities=0.0 * ones, torques=2.0 * ones)]
    while steps[-1].running and steps[-1].time < LONGEST:
        steps.append(controller.step(q, velocities=0.0 * ones, torques=2.0 * ones))
    assert steps[-1].error is None
    assert [float(word) for word in printed(steps)[0].split()] == [0.0, 0.0, 2.0]


# -- input that is not valid ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ('arguments', 'options', 'message'),
    [
        (([0.0] * 5,), {}, r'positions must have shape \(6,\), got \(5,\)'),
        (([0.0] * 5 + [np.nan],), {}, r'positions\[5\] is nan'),
        (('home',), {}, 'positions must be 6 numbers'),
        ((np.zeros(6), {'digital_input.99': 1.0}), {}, "no channel is named 'digital_input.99'"),
        ((np.zeros(6), {'digital_output.1': 1.0}), {}, 'digital_output.1 is an output'),
        ((np.zeros(6), {'digital_input.1': 2.0}), {}, 'valid are 0 and 1'),
        ((np.zeros(6), {'analog_input.1': np.inf}), {}, 'finite number'),
        ((np.zeros(6), {'analog_input.1': 'high'}), {}, 'must be 1 numbers'),
        ((np.zeros(6),), {'velocities': [1.0]}, 'velocities must have shape'),
        ((np.zeros(6),), {'torques': [np.inf] * 6}, r'torques\[0\] is inf'),
    ],
)
def test_a_refused_step_changes_nothing(
    controller_of: Callable[..., ControllerSixAxes],
    arguments: tuple[object, ...],
    options: dict[str, object],
    message: str,
):
    undisturbed = references(on_the_reference(controller_of(MOVE)))[:200]
    controller = controller_of(MOVE)
    step = controller.step(controller.robot.home)
    for reference in undisturbed[1:]:
        if step.time == 50 * PERIOD:
            with pytest.raises(RobotsError, match=message):
                controller.step(*arguments, **options)  # type: ignore[arg-type]
        step = controller.step(step.references[0])
        assert np.array_equal(step.references, reference)


def test_the_first_step_needs_positions(controller_of: Callable[..., ControllerSixAxes]):
    controller = controller_of(MOVE)
    with pytest.raises(RobotsError, match='positions are needed in the first step'):
        controller.step(None)
    assert controller.step(controller.robot.home).time == 0.0


def test_what_cannot_be_run_is_refused(tmp_path: Path):
    program = tmp_path / 'program.lua'
    program.write_text('while')
    with pytest.raises(RobotsError, match="unknown robot 'nobody'"):
        ControllerSixAxes('nobody', program=program)
    with pytest.raises(RobotsError, match=r'program\.lua:1'):
        ControllerSixAxes(ROBOT, program=program)
    with pytest.raises(RobotsError, match='missing'):
        ControllerSixAxes(ROBOT, program=tmp_path / 'missing.lua')
    with pytest.raises(RobotsError, match='period = 0'):
        ControllerSixAxes(ROBOT, program=PROGRAMS / 'welding.lua', period=0.0)


# -- faults -----------------------------------------------------------------------------------------------


def test_positions_that_jump_stop_the_robot(controller_of: Callable[..., ControllerSixAxes]):
    controller = controller_of(MOVE)
    step = controller.step(controller.robot.home)
    while step.time < 0.5:
        step = controller.step(step.references[0])
    elsewhere = step.references[0] + 0.5
    while step.running and step.time < LONGEST:
        step = controller.step(elsewhere)
    assert step.stop.fault is Fault.FEEDBACK_JUMPED
    assert step.stop.fault.category is StopCategory.ZERO
    assert not step.stop.drives_on
    assert step.run_state is RunState.FAILED
    assert str(step.error) == f'program.lua:1: {step.stop.reason}'
    # A controller whose drives are off continues from where the robot stands.
    for _ in range(50):
        step = controller.step(elsewhere)
    assert np.array_equal(step.references, [elsewhere, 0.0 * elsewhere, 0.0 * elsewhere])


def test_positions_that_stop_coming_stop_the_robot(controller_of: Callable[..., ControllerSixAxes]):
    controller = controller_of(MOVE)
    step = controller.step(controller.robot.home)
    while step.time < 0.5:
        step = controller.step(step.references[0])
    while step.running and step.time < LONGEST:
        step = controller.step(None)
    assert step.stop.fault is Fault.FEEDBACK_LOST
    assert step.run_state is RunState.FAILED
    assert not step.references[1:].any()


def test_an_input_stops_the_robot(controller_of: Callable[..., ControllerSixAxes], tmp_path: Path):
    io = tmp_path / 'io.yaml'
    io.write_text(
        'signals: {e_stop: digital_input.4, gun: digital_output.1}\n'
        'initial: {e_stop: on}\nemergency_stop: {e_stop: off}\nfail_safe: {gun: off}\n'
    )
    controller = controller_of(f'setDigitalOutput(1, 1)\n{MOVE}', io=io)
    step = controller.step(controller.robot.home)
    while step.time < 0.5:
        step = controller.step(step.references[0])
    assert step.outputs['gun'] == 1.0
    assert step.references[1].any()
    while step.running and step.time < LONGEST:
        step = controller.step(step.references[0], {'e_stop': 0})
    assert 'emergency stop by digital_input.4' in str(step.error)
    assert step.outputs['gun'] == 0.0


def test_a_program_that_fails_has_its_line(controller_of: Callable[..., ControllerSixAxes]):
    steps = on_the_reference(controller_of('wait(0.1)\nerror("no part")'))
    assert steps[-1].run_state is RunState.FAILED
    assert str(steps[-1].error) == 'program.lua:2: no part'


# -- the end ----------------------------------------------------------------------------------------------


def test_closing_ends_a_program_that_runs(controller_of: Callable[..., ControllerSixAxes]):
    controller = controller_of('while true do wait(1) end')
    for _ in range(3):
        step = controller.step(controller.robot.home)
    assert step.running
    controller.close()
    assert not [thread for thread in threading.enumerate() if thread.name == 'lua program.lua']
    with pytest.raises(RobotsError, match='closed'):
        controller.step(controller.robot.home)


def test_a_robot_is_held_after_the_program(controller_of: Callable[..., ControllerSixAxes]):
    controller = controller_of('setDigitalOutput(2, 1)')
    steps = on_the_reference(controller)
    for _ in range(500):
        steps.append(controller.step(steps[-1].references[0]))
    assert np.array_equal(steps[-1].references[0], controller.robot.home)
    assert steps[-1].outputs['digital_output.2'] == 1.0
    assert not steps[-1].running
