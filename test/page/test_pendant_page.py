"""The operator's page in a real browser: what is held, pressed, refused and shown."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from installed_browsers import DEADLINE
from robots_controller.interpreter.debugger import CallStack, Frame, Variable
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import ShownProgram
from robots_controller.program.run_state import RunState
from robots_core import Pose
from robots_core.blocks import CollisionDetection, Scene, SceneObject
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.robot_model.shapes import Capsule
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning

from .browser_page import FORWARDS, SOCKET, open_page, press, take_control, wait
from .made_up_cell import (
    PROGRAMS,
    MadeUpCell,
    made_up_operator,
    ready_state,
    running_program,
    served,
    switched,
)


@pytest.fixture(scope='module')
def served_cell() -> Iterator[tuple[PendantOperator, MadeUpCell, str]]:
    operator, cell = made_up_operator()
    with served(operator) as url:
        yield operator, cell, url


@pytest.fixture
def operator(served_cell: tuple[PendantOperator, MadeUpCell, str]) -> PendantOperator:
    operator, cell, _ = served_cell
    operator.state = ready_state(operator.robot)
    cell.calls.clear()
    cell.refusal = ''
    return operator


@pytest.fixture
def cell(served_cell: tuple[PendantOperator, MadeUpCell, str]) -> MadeUpCell:
    return served_cell[1]


@pytest.fixture
def url(served_cell: tuple[PendantOperator, MadeUpCell, str]) -> str:
    return served_cell[2]


@pytest.fixture(scope='module')
def shared_page(running: Browser, served_cell: tuple[PendantOperator, MadeUpCell, str]) -> Iterator[Page]:
    page = open_page(running, served_cell[2], viewport={'width': 1024, 'height': 768})
    errors: list[str] = []
    page.on('pageerror', lambda error: errors.append(str(error)))
    yield page
    page.close()
    assert errors == []


@pytest.fixture
def page(shared_page: Page, operator: PendantOperator) -> Page:
    """The page, in control."""
    take_control(shared_page)
    assert operator.desk.holder
    return shared_page


def show(page: Page, tab: str) -> None:
    page.get_by_role('tab', name=tab).click()
    page.locator('.q-tab--active', has_text=tab).wait_for()


def jogged(cell: MadeUpCell) -> bool:
    return any(call[0] == 'axes' and any(call[1:]) for call in cell.calls)


@pytest.mark.parametrize('end', ['release', 'blur', 'hidden'])
def test_a_robot_moves_while_its_button_is_held(page: Page, cell: MadeUpCell, end: str) -> None:
    show(page, 'Jog')
    press(page, FORWARDS)
    wait(page, lambda: jogged(cell), 'a jog')
    if end == 'release':
        page.mouse.up()
    elif end == 'blur':
        page.evaluate('() => window.dispatchEvent(new Event("blur"))')
    else:
        page.evaluate('() => document.dispatchEvent(new Event("visibilitychange"))')
    wait(page, lambda: not cell.moving(), 'a stop')
    page.mouse.up()
    assert page.locator('.held').count() == 0


def test_a_held_button_makes_one_step(
    page: Page, cell: MadeUpCell, operator: PendantOperator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(operator.held, '_now', lambda: 0.0)  # no sign of the press comes too late
    show(page, 'Jog')
    steps = page.get_by_label('Step (mm, °)')
    steps.get_by_role('button', name='0.1', exact=True).click()
    press(page, FORWARDS)
    wait(page, lambda: cell.calls.count(('hold', True)) > 2, 'signs')
    page.mouse.up()
    wait(page, lambda: ('end_move',) in cell.calls, 'a stop')
    (command,) = [call[1] for call in cell.calls if call[0] == 'move']
    assert command.q[0] - operator.state.q[0] == pytest.approx(np.radians(0.1))
    steps.get_by_role('button', name='∞').click()


def test_a_target_is_shown_with_its_time_before_the_robot_moves_there(
    page: Page, cell: MadeUpCell, operator: PendantOperator
) -> None:
    show(page, 'Jog')
    panel = page.locator('.jog-panel')
    panel.get_by_role('button', name='Target').click()
    panel.get_by_label('A1', exact=True).fill('500')
    panel.get_by_role('button', name='Show').click()
    panel.get_by_role('alert').get_by_text('A1').wait_for()
    panel.get_by_label('A1', exact=True).fill('10')
    panel.get_by_role('button', name='Show').click()
    panel.get_by_text(re.compile(r'^\d+\.\d s, limited by A1')).wait_for()
    np.testing.assert_allclose(cell.calls[-1][1][0], np.radians(10.0))
    press(page, '[data-press="move"]')
    wait(page, lambda: any(call[0] == 'move' for call in cell.calls), 'the motion')
    page.mouse.up()
    wait(page, lambda: ('end_move',) in cell.calls, 'a stop')
    panel.get_by_role('button', name='Axes').click()
    assert operator.held.failure is None


def test_the_way_around_an_obstacle_is_shown_before_the_robot_moves(
    page: Page, cell: MadeUpCell, operator: PendantOperator, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, state = operator.robot, operator.state
    start, goal = np.radians([[side, -70.0, 90.0, 0.0, 70.0, 0.0] for side in (-30.0, 30.0)])
    post = SceneObject('post', Capsule(0.05, 1.6), Pose(np.array([1.7, 0.0, 1.0]), np.eye(3)))
    planning = PathPlanning(robot, collision=CollisionDetection(robot, scene=Scene((post,))))
    monkeypatch.setattr(operator, '_planner', lambda: planning)
    operator.state = replace(state, q=start, settings=MotionSettings(avoid=True))
    show(page, 'Jog')
    panel = page.locator('.jog-panel')
    panel.get_by_role('button', name='Target').click()
    for name, value in zip(robot.axes_data.names, np.degrees(goal), strict=True):
        panel.get_by_label(name, exact=True).fill(f'{value:.3f}')
    panel.get_by_role('button', name='Show').click()
    found = re.compile(r'It leads around obstacles, .* Smallest distance: \d+\.\d mm between \S+ and post\.')
    panel.get_by_text(found).wait_for()

    def places() -> set[float]:
        return {round(call[1][0], 6) for call in cell.calls if call[0] == 'ghost' and call[1] is not None}

    wait(page, lambda: len(places()) > 3, 'the ghost on its way')
    panel.get_by_role('button', name='Axes').click()
    wait(page, lambda: cell.calls[-1][0] == 'ghost' and cell.calls[-1][1] is None, 'the end of the ghost')
    operator.state = state


def test_what_will_stop_a_jog_is_announced(
    page: Page, operator: PendantOperator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(operator.held, '_now', lambda: 0.0)  # no sign of the press comes too late
    show(page, 'Jog')
    q = np.array(operator.robot.home)
    q[0] = operator.robot.axes_data.upper[0] - 0.02
    operator.state = replace(operator.state, q=q)
    press(page, FORWARDS)
    page.get_by_text(re.compile(r'^In \d\.\d s: upper limit of A1$')).wait_for()
    page.mouse.up()


def test_a_browser_that_goes_away_lets_go(
    running: Browser, operator: PendantOperator, cell: MadeUpCell, url: str, shared_page: Page
) -> None:
    other = open_page(running, url)
    operator.desk.holder = ''
    take_control(other)
    press(other, FORWARDS)
    wait(other, lambda: jogged(cell), 'a jog')
    other.context.close()
    wait(shared_page, lambda: not cell.moving(), 'a stop')
    operator.desk.holder = ''


def test_keys_hold_and_stop(page: Page, cell: MadeUpCell) -> None:
    show(page, 'Jog')
    page.locator(FORWARDS).focus()
    page.keyboard.down(' ')
    wait(page, lambda: jogged(cell), 'a jog')
    page.keyboard.press('Escape')
    wait(page, lambda: ('stop',) in cell.calls, 'a stop')
    page.keyboard.up(' ')
    assert not cell.moving()
    page.locator('.stop').click()
    wait(page, lambda: cell.calls.count(('stop',)) == 2, 'a stop by the button')


def test_the_stop_button_is_the_largest(page: Page) -> None:
    areas = page.evaluate(
        """() => [...document.querySelectorAll('button')].map((one) => {
          const place = one.getBoundingClientRect();
          return [one.classList.contains('stop'), place.width * place.height];
        }).sort((a, b) => b[1] - a[1])"""
    )
    assert areas[0][0]
    assert page.evaluate('() => document.documentElement.scrollWidth <= window.innerWidth')


def test_what_is_refused_says_why_where_it_was_pressed(
    page: Page, operator: PendantOperator, cell: MadeUpCell
) -> None:
    show(page, 'Program')
    panel = page.locator('.program-panel')
    pause = panel.get_by_role('button', name='Pause')
    wait(page, lambda: pause.get_attribute('title') == 'No program runs.', 'the hint of a button')
    pause.click(force=True)  # it is shown as disabled
    panel.get_by_text('No program runs.').first.wait_for()
    assert cell.calls == []
    running_program(operator)
    cell.refusal = 'the interpreter does not answer'
    page.locator('.running').wait_for()
    pause.click()
    panel.get_by_text(cell.refusal).wait_for()
    assert cell.calls == [('lua_program_node/pause',)]


def test_a_program_is_chosen_and_its_line_is_followed(
    page: Page, operator: PendantOperator, cell: MadeUpCell
) -> None:
    show(page, 'Program')
    page.get_by_label('Robot program').click()
    page.get_by_role('option', name='welding.lua', exact=True).click()
    wait(page, lambda: any(call[0] == 'open' for call in cell.calls), 'a program to be opened')
    assert cell.calls[-1][1].endswith('/programs/welding.lua')
    cell.refusal = 'the robot moves'
    page.get_by_label('Robot program').click()
    page.get_by_role('option', name='press_tending.lua', exact=True).click()
    page.locator('.program-panel').get_by_text(cell.refusal).wait_for()
    wait(page, lambda: page.get_by_label('Robot program').input_value() == '', 'no program')
    cell.refusal = ''
    for line in (3, 40):
        running_program(operator, line=line)
        operator.prints.append(f'at {line}')
        page.locator(f'.source .running[data-line="{line}"]').wait_for()
        page.locator('.prints', has_text=f'at {line}').wait_for()
    assert 'line 40' in page.locator('.fact.program').inner_text()


def test_a_program_is_debugged(page: Page, operator: PendantOperator, cell: MadeUpCell) -> None:
    show(page, 'Program')
    path = str(PROGRAMS / 'press_tending.lua')
    paused = ShownProgram(path, RunState.PAUSED, 'press_tending.lua', 13, hold='breakpoint')
    rows = (Variable('place', 'table', 'table', (Variable('1', '1.9', 'number'),)),)
    cell.stack = CallStack((Frame('in the program', 'press_tending.lua', 13, {'Locals': rows}),))
    operator.state = replace(operator.state, program=paused, run_enabled=True)
    panel = page.locator('.program-panel')
    panel.locator('.running[data-line="13"]').click(position={'x': 20, 'y': 5})
    held = 'lua_program_node', {'breakpoints': ['press_tending.lua:13']}
    wait(page, lambda: held in cell.calls, 'a breakpoint')
    operator.state = replace(operator.state, breakpoints={'press_tending.lua': {13}})
    panel.locator('.breakpoint[data-line="13"]').wait_for()
    press(page, '[data-press="step over"]')
    wait(page, lambda: ('lua_program_node', {'step_mode': 'over'}) in cell.calls, 'a step')
    assert ('hold', True) in cell.calls
    page.mouse.up()
    wait(page, lambda: ('hold', False) in cell.calls, 'its release')
    panel.get_by_role('tab', name='Variables').click()
    panel.get_by_text('press_tending.lua:13 in the program').wait_for()
    panel.get_by_text('place = table').wait_for()
    panel.get_by_role('tab', name='Printed').click()


def test_a_program_is_edited_and_its_mistakes_are_at_their_lines(
    page: Page, operator: PendantOperator, cell: MadeUpCell, tmp_path: Path
) -> None:
    path = tmp_path / 'edited.lua'
    path.write_text('setOverride(1)\n')
    show(page, 'Program')
    operator.state = replace(operator.state, program=ShownProgram(str(path), RunState.OPENED))
    panel = page.locator('.program-panel')
    panel.locator('[data-line="1"]', has_text='setOverride').wait_for()
    panel.get_by_role('button', name='Edit').click()
    code = panel.locator('.cm-content')
    code.click()
    page.keyboard.press('Control+End')
    page.keyboard.type('setOverr')
    page.locator('.cm-tooltip-autocomplete', has_text='(value)').wait_for()
    page.locator('.cm-completionInfo', has_text='Scales the speed of all motions').wait_for()
    page.keyboard.type('ide(5)\nsetOutput(1)')
    wait(page, lambda: code.inner_text().endswith('setOutput(1)'), 'the text')
    panel.get_by_role('button', name='Save').click()
    panel.get_by_text('edited.lua:2: setOverride: ').wait_for()
    panel.locator('.found[data-line="3"]').wait_for()
    assert path.read_text() == 'setOverride(1)\nsetOverride(5)\nsetOutput(1)'
    assert cell.calls == [('open', str(path))]
    panel.get_by_role('button', name='Edit').click()
    code.click()
    page.keyboard.type('-- ')
    path.write_text('-- by another one\n')
    panel.get_by_role('button', name='Save').click()
    panel.get_by_role('alert').get_by_text('changed by another one').wait_for()
    assert path.read_text() == '-- by another one\n'
    panel.get_by_role('button', name='Discard').click()
    panel.locator('[data-line="1"]', has_text='by another one').wait_for()


def test_a_program_that_is_replaced_on_disk_is_shown_anew(
    page: Page, operator: PendantOperator, tmp_path: Path
) -> None:
    path = tmp_path / 'replaced.lua'
    path.write_text('wait(1)\n')
    show(page, 'Program')
    operator.state = replace(operator.state, program=ShownProgram(str(path), RunState.OPENED))
    source = page.locator('.source')
    source.get_by_text('wait').wait_for()
    path.write_text('setOverride(0.5)\n')
    os.utime(path, (1.0, 1.0))
    source.get_by_text('setOverride').wait_for()
    path.unlink()
    source.get_by_text('replaced.lua cannot be read').wait_for()


def test_points_and_motions_are_taught_and_taken_back(
    page: Page, operator: PendantOperator, cell: MadeUpCell, tmp_path: Path
) -> None:
    path = tmp_path / 'part.lua'
    path.write_text('setOverride(1)\nsetOverride(0.5)\n')
    points, before = path.with_suffix('.points.yaml'), len(operator.teaching.history)
    show(page, 'Program')
    state = ShownProgram(str(path), RunState.OPENED, points_file=str(points))
    operator.state = replace(operator.state, program=state)
    panel = page.locator('.program-panel')
    panel.get_by_role('tab', name='Teach').click()
    panel.locator('[data-line="1"]', has_text='setOverride').click()
    panel.locator('.cursor[data-line="1"]').wait_for()
    panel.get_by_role('button', name='Line').click()
    panel.get_by_text('Line 2: a motion to P1.').wait_for()
    assert path.read_text() == "setOverride(1)\nptpCartesianSpace(getTaughtPose('P1'))\nsetOverride(0.5)\n"
    assert cell.calls == [('open', str(path))]
    panel.locator('.cursor[data-line="2"]', has_text='getTaughtPose').wait_for()
    panel.get_by_role('button', name='Arc').click()
    panel.get_by_text('The arc passes P2').wait_for()
    panel.get_by_role('button', name='Arc').click()
    panel.locator('[data-line="3"]', has_text='circCartesianSpace').wait_for()
    for left in (2, 1, 0):
        panel.get_by_role('button', name='Undo').click()
        wait(page, lambda: len(operator.teaching.history) == before + left, 'an undone change')  # noqa: B023
    points.write_text('points:\n  P1: {q: [0,\n')
    panel.get_by_role('button', name='Teach here').click()
    panel.get_by_role('alert').get_by_text('part.points.yaml:3:').wait_for()
    assert path.read_text() == 'setOverride(1)\nsetOverride(0.5)\n'


def test_outputs_are_switched_and_shown(page: Page, operator: PendantOperator, cell: MadeUpCell) -> None:
    show(page, 'I/O')
    page.get_by_role('button', name='digital_output.2', exact=True).click()
    wait(page, lambda: cell.calls == [('set', 'digital_output.2', 1.0)], 'a switched output')
    operator.state = switched(operator.state, 'digital_outputs', 2, 1.0)
    row = page.locator('.channel', has_text='gripper')
    row.locator('.lamp.on').wait_for()
    page.get_by_role('button', name='digital_output.2', exact=True).click()
    wait(page, lambda: cell.calls[1:] == [('set', 'digital_output.2', 0.0)], 'an output switched off')
    row.locator('.lamp').evaluate('(lamp) => lamp.classList.remove("on")')  # what the person sees counts
    page.get_by_role('button', name='digital_output.2', exact=True).click()
    wait(page, lambda: cell.calls[2:] == [('set', 'digital_output.2', 1.0)], 'it was seen off')
    page.get_by_label('Name or number').fill('part_pr')
    row.wait_for(state='detached')
    assert page.locator('.channel').count() == 2
    operator.state = replace(operator.state, mode=OperatingMode.AUTOMATIC)
    page.locator('.io-panel').get_by_text('choose T1 or T2').wait_for()
    page.get_by_label('Name or number').fill('')


def test_chosen_signals_are_drawn(page: Page, operator: PendantOperator) -> None:
    operator.trends.add(0.0, operator.state)
    show(page, 'Trends')
    page.get_by_label('Signals').fill('Position A2')
    page.get_by_role('option', name='Position A2', exact=True).click()
    for number in range(1, 20):
        operator.trends.add(0.1 * number, operator.state)
    drawn = """() => [...document.querySelectorAll('.chart')].flatMap((one) =>
        getElement(Number(one.id.slice(1))).chart.getOption().series.map(
            (line) => [line.name, line.data.length]))"""
    wait(page, lambda: page.evaluate(drawn) == [['Tool speed', 20], ['Position A2', 20]], 'two curves')
    page.get_by_text('Report of the last run').wait_for()


def test_a_second_page_looks_on_until_it_takes_control(
    running: Browser, page: Page, cell: MadeUpCell, url: str
) -> None:
    other = open_page(running, url, locale='de-DE', color_scheme='dark')
    assert other.locator('html').get_attribute('lang') == 'de'
    other.get_by_text('Eine andere Seite bedient').first.wait_for()
    press(other, FORWARDS)
    other.get_by_role('alert').get_by_text('Eine andere Seite bedient den Roboter.').wait_for()
    other.mouse.up()
    assert cell.calls == []
    other.get_by_role('button', name='Bedienung übernehmen').click()
    other.get_by_role('dialog').get_by_role('button', name='Übernehmen', exact=True).click()
    other.get_by_text('Sie bedienen').wait_for()
    page.get_by_text('Another page operates: 127.0.0.1').first.wait_for()
    assert other.locator('body.body--dark').count() == 1
    other.get_by_role('button', name='Bedienung abgeben').click()
    page.get_by_text('Nobody operates').wait_for()
    other.context.close()


@pytest.mark.parametrize('origin', ['http://evil.example', None])
def test_a_page_of_another_origin_is_refused(url: str, origin: Any) -> None:
    address = f'{url.replace("http", "ws")}/{SOCKET}'
    with pytest.raises(InvalidStatus, match='403'):
        connect(address, origin=origin, open_timeout=DEADLINE)
    with connect(address, origin=url, open_timeout=DEADLINE) as accepted:
        assert accepted.recv(timeout=DEADLINE)
