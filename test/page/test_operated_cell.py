"""A cell that is operated in a real browser: points taught, programs built and run, inputs forced."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page

from installed_browsers import browser
from robots_controller.nodes.pendant_node import PendantNode
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.program.run_state import RunState

from .browser_page import open_page, press, take_control, wait
from .page_cell import PAGE, Cell

FAR = 0.015  # rad between two taught points


@pytest.fixture(scope='module')
def cell(module_ros_nodes: Any, tmp_path_factory: pytest.TempPathFactory) -> Cell:
    return Cell(module_ros_nodes, tmp_path_factory.mktemp('programs'))


@pytest.fixture(scope='module')
def pendant(cell: Cell) -> PendantNode:
    runner = cell.runner
    node: PendantNode = runner.add(PendantNode(**runner.options(programs=str(cell.folder), **PAGE)))
    node.operator.held._now = lambda: 0.0  # no sign of a press comes too late
    return node


@pytest.fixture
def operator(pendant: PendantNode) -> PendantOperator:
    return pendant.operator


@pytest.fixture(scope='module')
def page(pendant: PendantNode) -> Iterator[Page]:
    with browser('--disable-gpu') as running:
        page = open_page(running, pendant.url)
        page.get_by_text('connected', exact=True).wait_for()
        take_control(page)
        yield page
        page.context.close()


def show(page: Page, tab: str) -> None:
    page.get_by_role('tab', name=tab).click()
    page.locator('.q-tab--active', has_text=tab).wait_for()


def jog(page: Page, cell: Cell, axis: int) -> None:
    """Hold the button of an axis until the robot is somewhere else, and let go."""
    show(page, 'Jog')
    start = cell.q[axis]
    press(page, f'[data-press="axes {axis} +"]')
    wait(page, lambda: cell.q[axis] > start + FAR, 'another position')
    page.mouse.up()
    wait(page, lambda: not cell.moving, 'the robot stands')


def choose(page: Page, operator: PendantOperator, name: str) -> None:
    """Choose a program of the folder."""
    show(page, 'Program')
    page.get_by_label('Robot program').click()
    page.get_by_role('option', name=name, exact=True).click()
    wait(page, lambda: operator.state.program.path.endswith(name), f'{name} is open')
    wait(page, lambda: operator.state.program.state is RunState.OPENED, 'a program that can run')


def hold_run(page: Page, operator: PendantOperator, done: Callable[[], Any]) -> None:
    """Hold the program's button until something is so; press again where its sign reached a node too late."""
    late = page.get_by_role('alert').filter(has_text=re.compile('run is held|run must be held'))
    wait(page, lambda: not operator.state.fault, 'no fault')
    while not done():
        press(page, '[data-press="run"]')
        wait(page, lambda: done() or late.count(), 'what a held program is to do')
        page.mouse.up()


def test_points_are_taught_and_the_program_of_them_reaches_them(
    page: Page, cell: Cell, operator: PendantOperator
) -> None:
    path = cell.folder / 'built.lua'
    path.write_text('-- built on the page\n')
    wait(page, lambda: cell.references and operator.state.q is not None, 'the robot')
    choose(page, operator, 'built.lua')
    panel = page.locator('.program-panel')
    for line, (axis, motion) in enumerate(((4, 'PTP'), (0, 'PTP'), (2, 'Line')), 2):
        jog(page, cell, axis)
        show(page, 'Program')
        panel.get_by_role('tab', name='Teach').click()
        panel.get_by_role('button', name=motion).click()
        panel.get_by_text(f'Line {line}: a motion to P{line - 1}.').wait_for()
    taught = operator.teaching.points(path.with_suffix('.points.yaml'))
    assert list(taught) == ['P1', 'P2', 'P3']
    assert path.read_text().count('getTaughtPo') == 3
    begun, motions = len(cell.references), len(cell.results)
    hold_run(page, operator, lambda: operator.state.program.state is RunState.FINISHED)
    assert [one.ok for one in cell.results[motions:]] == [True] * 3
    reached = np.array([point.positions for point in cell.references[begun:]])
    for point in taught.values():
        assert np.abs(reached - point.q).max(axis=1).min() < 1e-3


def test_a_program_waits_for_an_input_that_is_forced(
    page: Page, cell: Cell, operator: PendantOperator
) -> None:
    (cell.folder / 'waiting.lua').write_text("waitDigitalInput(1, 1)\nprint('it is on')\n")
    choose(page, operator, 'waiting.lua')
    hold_run(page, operator, page.locator('.source .running[data-line="1"]').count)
    wait(page, lambda: operator.state.program.state is RunState.PAUSED, 'a held program')
    show(page, 'I/O')
    page.get_by_role('button', name='digital_input.1', exact=True).click()
    page.get_by_text('Force on').click()
    page.get_by_text('Forced: digital_input.1').wait_for()
    show(page, 'Program')
    hold_run(page, operator, lambda: operator.state.program.state is RunState.FINISHED)
    page.locator('.program-panel').get_by_role('tab', name='Printed').click()
    page.locator('.prints', has_text='it is on').wait_for()
    show(page, 'I/O')
    page.get_by_role('button', name='digital_input.1', exact=True).click()
    page.get_by_text('Release', exact=True).click()
    wait(page, lambda: not operator.state.io.forced, 'no forced input')


def test_a_new_program_is_listed_where_the_list_has_been_used_before(
    page: Page, cell: Cell, operator: PendantOperator
) -> None:
    (cell.folder / 'first.lua').write_text('wait(1)\n')
    choose(page, operator, 'first.lua')
    (cell.folder / 'second.lua').write_text('wait(1)\n')
    choose(page, operator, 'second.lua')


def test_a_wrong_program_shows_its_line(page: Page, cell: Cell, operator: PendantOperator) -> None:
    (cell.folder / 'wrong.lua').write_text(
        'setDigitalOutput(1, 1)\nptpJointSpaceAngles(500, 0, 0, 0, 0, 0)\n'
    )
    choose(page, operator, 'wrong.lua')
    hold_run(page, operator, lambda: operator.state.program.state is RunState.FAILED)
    page.locator('.source .failed[data-line="2"]').wait_for()
    page.locator('.program-panel .refusal', has_text='wrong.lua:2: ').wait_for()
    (cell.folder / 'broken.lua').write_text('setDigitalOutput(1, 1)\nfor\n')
    page.get_by_label('Robot program').click()
    page.get_by_role('option', name='broken.lua', exact=True).click()
    page.locator('.program-panel').get_by_text('broken.lua:2: ').first.wait_for()
    page.locator('.bar').get_by_text('broken.lua: not open').wait_for()
    page.locator('.source [data-line="2"]', has_text='for').wait_for()
    (cell.folder / 'broken.lua').write_text('setDigitalOutput(1, 1)\n')
    choose(page, operator, 'broken.lua')
    page.locator('.bar').get_by_text('broken.lua: ready').wait_for()
    again = page.get_by_role('button', name='Open again')
    again.wait_for(state='hidden')
    (cell.folder / 'broken.lua').write_text('setDigitalOutput(1, 0)\nwait(0)\n')
    page.locator('.program-panel').get_by_text('broken.lua has changed since it was opened.').wait_for()
    again.click()
    again.wait_for(state='hidden')
