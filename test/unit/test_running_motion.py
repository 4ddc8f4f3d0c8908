"""Whether a motion of a cell runs, as the command `cell` follows its events."""

from __future__ import annotations

from robots_controller.live_cell.cell_events import MotionPlanned
from robots_controller.live_cell.running_cell import RunningMotion
from robots_core.cell_interface.motion_result import MotionResult


def planned(id_: str, *, streamed: bool = False) -> MotionPlanned:
    return MotionPlanned(id_, 1.0, streamed)


def result(id_: str, ended: float, *, blocked: bool = False) -> MotionResult:
    return MotionResult(id_, not blocked, '', details={'ended': f'{ended:.9f}'}, blocked=blocked)


def runs_after(*events: MotionPlanned | MotionResult) -> list[bool]:
    motion, found = RunningMotion(), []
    for event in events:
        motion.note(event)
        found.append(motion.runs)
    return found


def test_a_motion_runs_from_its_plan_to_its_result():
    assert runs_after(planned('1.0'), result('1.0', 2.0), planned('3.0')) == [True, False, True]


def test_a_motion_that_was_commanded_ahead_runs_until_its_own_result():
    events = planned('1.0'), planned('1.1'), result('1.0', 2.0), result('1.1', 3.0)
    assert runs_after(*events) == [True, True, True, False]


def test_a_result_that_overtakes_its_plan_ends_the_motion():
    assert runs_after(result('1.0', 2.0), planned('1.0')) == [False, False]
    # Commanded before the end of the one before it.
    events = planned('1.0'), result('1.0', 2.0), result('1.5', 3.0), planned('1.5'), planned('2.5')
    assert runs_after(*events) == [True, False, False, False, True]


def test_a_result_ends_a_stream_whose_last_points_it_overtakes():
    points = [planned(f'1.{k}', streamed=True) for k in range(4)]
    events = *points[:3], result('1.0', 1.35), points[3], planned('1.4', streamed=True)
    assert runs_after(*events) == [True, True, True, False, False, True]


def test_a_robot_that_is_led_around_an_obstacle_moves_on():
    events = planned('1.0'), result('1.0', 2.0, blocked=True), planned('1.0'), result('1.0', 4.0)
    assert runs_after(*events) == [True, True, True, False]
