"""ProgramState: what the program's thread and the robot's side share."""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np
import pytest

from robots_controller.program.clock import Clock
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.program.program_state import ProgramState
from robots_controller.program.run_state import ProgramStopped, RunState
from robots_core.errors import InvalidInputError, PlanningError, ProgramError
from robots_core.pose import Pose
from robots_planning.motion_kinds import LINE
from robots_planning.robot_command_state import RobotCommandState

DEADLINE = 120.0  # s, for threads that should need milliseconds


class SteppedClock:
    """Time that advances only when the test sets it; `waits` is set when a thread waits."""

    def __init__(self) -> None:
        self.time = 0.0
        self.deadlines: list[float | None] = []
        self.waiting = threading.Semaphore(0)

    def now(self) -> float:
        return self.time

    def wait(self, condition: threading.Condition, deadline: float | None) -> None:
        self.deadlines.append(deadline)
        self.waiting.release()
        condition.wait()

    def wait_for_waiter(self) -> None:
        assert self.waiting.acquire(timeout=DEADLINE)


def running_state(clock: Clock | None = None, num_axes: int = 6) -> ProgramState:
    state = ProgramState(num_axes, digital=4, analog=2, clock=clock or Clock())
    state.set_run_state(RunState.RUNNING)
    return state


def command(line: int = 1) -> MotionCommand:
    return MotionCommand(LINE, line, 'ptpCartesianSpace', pose=Pose.identity())


def wait(state: ProgramState, ready: Callable[[], bool], duration: float | None = None) -> bool:
    """Wait as a program does that holds whenever it must attend to something."""
    waiting = state.waiting(ready, duration)
    while True:
        try:
            next(waiting)
        except StopIteration as end:
            return bool(end.value)
        state.hold()


def wait_for_motion(state: ProgramState) -> None:
    wait(state, lambda: not state.motions)
    if failure := state.take_motion_error():
        raise failure[1]


def sleep(state: ProgramState, duration: float) -> None:
    assert not wait(state, lambda: False, duration)


class Caller:
    """Calls a function in a thread and keeps how it ended."""

    def __init__(self, function: object, *arguments: object) -> None:
        self.error: BaseException | None = None
        self._thread = threading.Thread(target=self._call, args=(function, arguments), daemon=True)
        self._thread.start()

    def _call(self, function: object, arguments: tuple[object, ...]) -> None:
        try:
            function(*arguments)  # type: ignore[operator]
        except BaseException as error:  # noqa: BLE001  # judged by the test
            self.error = error

    def ended(self) -> BaseException | None:
        self._thread.join(DEADLINE)
        assert not self._thread.is_alive()
        return self.error


def advance(state: ProgramState, clock: SteppedClock, seconds: float) -> None:
    with state.condition:
        clock.time += seconds
        state.condition.notify_all()


def test_finished_motion_is_idle_and_lets_the_program_go_on():
    clock = SteppedClock()
    state = running_state(clock)
    state.command_motion(command())
    assert state.command_state is RobotCommandState.PTPCARTESIAN
    waiter = Caller(wait_for_motion, state)
    clock.wait_for_waiter()
    state.finish_motion()
    assert waiter.ended() is None
    assert state.command_state is RobotCommandState.IDLE
    assert state.motion is None


def test_setting_idle_finishes_the_motion():
    state = running_state()
    state.command_motion(command())
    state.command_state = 'IDLE'
    wait_for_motion(state)
    assert state.motion is None


def test_failed_motion_raises_its_error_once():
    state = running_state()
    state.command_motion(command())
    error = PlanningError('no way')
    state.finish_motion(error)
    with pytest.raises(PlanningError, match='no way'):
        wait_for_motion(state)
    wait_for_motion(state)


def test_result_without_motion_does_not_fail_the_next_one():
    state = running_state()
    state.finish_motion(PlanningError('late'))
    state.command_motion(command())
    state.finish_motion()
    wait_for_motion(state)


def test_second_motion_before_the_end_of_the_first_is_refused():
    state = running_state()
    state.command_motion(command(3))
    with pytest.raises(ProgramError, match='line 3'):
        state.command_motion(command(4))


@pytest.mark.parametrize('wait', ['motion', 'sleep', 'hold'])
def test_stop_interrupts_every_wait(wait: str):
    clock = SteppedClock()
    state = running_state(clock)
    if wait == 'motion':
        state.command_motion(command())
        waiter = Caller(wait_for_motion, state)
    elif wait == 'sleep':
        waiter = Caller(sleep, state, 1e9)
    else:
        assert state.change_run_state(RunState.RUNNING, RunState.PAUSED)
        waiter = Caller(state.hold)
    clock.wait_for_waiter()
    assert state.stop()
    assert isinstance(waiter.ended(), ProgramStopped)


def test_stop_of_a_program_that_does_not_run_is_none():
    state = ProgramState(6, digital=1, analog=1, clock=Clock())
    assert not state.stop()
    state.set_run_state(RunState.RUNNING)
    state.hold()


def test_next_run_forgets_the_stop_of_the_last():
    state = running_state()
    state.stop()
    state.set_run_state(RunState.STOPPED)
    state.set_run_state(RunState.RUNNING)
    state.hold()


def test_sleep_takes_the_clocks_time():
    clock = SteppedClock()
    state = running_state(clock)
    waiter = Caller(sleep, state, 2.0)
    clock.wait_for_waiter()
    advance(state, clock, 1.5)
    clock.wait_for_waiter()
    advance(state, clock, 0.5)
    assert waiter.ended() is None
    assert clock.deadlines == [2.0, 2.0]


def test_time_of_a_pause_does_not_count_as_slept():
    clock = SteppedClock()
    state = running_state(clock)
    waiter = Caller(sleep, state, 2.0)
    clock.wait_for_waiter()
    with state.condition:
        clock.time += 0.5
        assert state.change_run_state(RunState.RUNNING, RunState.PAUSED)
    clock.wait_for_waiter()
    with state.condition:
        clock.time += 100.0
        assert state.change_run_state(RunState.PAUSED, RunState.RUNNING)
    clock.wait_for_waiter()
    assert clock.deadlines == [2.0, None, 102.0]
    advance(state, clock, 1.5)
    assert waiter.ended() is None


def test_sleep_of_the_wall_clock_is_not_shorter_than_asked():
    state = running_state(Clock())
    start = state.clock.now()
    sleep(state, 0.02)
    assert state.clock.now() - start >= 0.02


def test_paused_program_cannot_be_resumed_after_its_stop():
    state = running_state()
    assert state.change_run_state(RunState.RUNNING, RunState.PAUSED)
    state.stop()
    assert not state.change_run_state(RunState.PAUSED, RunState.RUNNING)


def test_inputs_beyond_those_given_keep_their_values():
    state = running_state()
    state.io.set_inputs('digital', [1, 0, 1, 1])
    state.io.set_inputs('digital', [0, 1])
    assert state.io.bits('digital_inputs').tolist() == [False, True, True, True]
    state.io.set_inputs('analog', [1.5, -2.0])
    state.io.set_inputs('analog', [0.5])
    assert state.io.numbers('analog_inputs').tolist() == [0.5, -2.0]


@pytest.mark.parametrize(
    ('kind', 'values', 'message'),
    [
        ('digital', [0] * 5, 'digital_inputs has 5 values; the program has 4'),
        ('digital', [0, 2], 'digital input 2 is 2; valid are 0 and 1'),
        ('digital', 7, 'digital_inputs must be a list of up to 4 values'),
        ('analog', [0.0, float('nan')], 'analog_inputs'),
        ('analog', [0.0] * 3, 'analog_inputs has 3 values; the program has 2'),
        ('analog', ['a'], 'analog_inputs'),
    ],
)
def test_wrong_inputs_are_refused_and_change_nothing(kind: str, values: object, message: str):
    state = running_state()
    with pytest.raises(InvalidInputError, match=message):
        state.io.set_inputs(kind, values)  # type: ignore[arg-type]
    assert not state.io.numbers(f'{kind}_inputs').any()


def test_images_are_copies():
    state = running_state()
    state.io.bits('digital_inputs')[0] = True
    state.io.numbers('analog_outputs')[0] = 1.0
    assert not state.io.bits('digital_inputs').any()
    assert not state.io.numbers('analog_outputs').any()


def test_output_returns_whether_it_changed():
    state = running_state()
    assert state.set_output('digital', 4, 1)
    assert not state.set_output('digital', 4, 1)
    assert state.io.bits('digital_outputs').tolist() == [False, False, False, True]
    assert state.set_output('analog', 2, 0.5)
    assert state.io.numbers('analog_outputs').tolist() == [0.0, 0.5]


def test_number_of_axes_is_fixed_while_running():
    state = running_state()
    with pytest.raises(ProgramError, match='while a program runs'):
        state.num_axes = 7
    state.set_run_state(RunState.FINISHED)
    state.num_axes = 7
    np.testing.assert_array_equal(state.overrides, np.ones(7))


@pytest.mark.parametrize('size', [0, -1, 2.0, True])
def test_sizes_are_whole_numbers_from_one(size: object):
    with pytest.raises(InvalidInputError, match='num_axes'):
        ProgramState(size, digital=1, analog=1, clock=Clock())  # type: ignore[arg-type]


def test_unknown_command_state_names_the_valid_ones():
    with pytest.raises(InvalidInputError, match='PTPJOINT_JOINT'):
        running_state().command_state = 'DANCE'
