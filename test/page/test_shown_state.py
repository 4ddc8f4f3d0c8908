"""What the operator's page shows in a real browser: bar, messages, forced inputs, languages and themes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from robots_controller.pendant.message_log import Level
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import ShownPlc
from robots_core.cell_interface.operating_modes import Commander

from .browser_page import open_page, shown, take_control, wait
from .made_up_cell import MadeUpCell, made_up_operator, ready_state, running_program, served


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
    return operator


@pytest.fixture
def cell(served_cell: tuple[PendantOperator, MadeUpCell, str]) -> MadeUpCell:
    return served_cell[1]


@pytest.fixture
def url(served_cell: tuple[PendantOperator, MadeUpCell, str]) -> str:
    return served_cell[2]


@pytest.fixture(scope='module')
def shared_page(window: Page, served_cell: tuple[PendantOperator, MadeUpCell, str]) -> Iterator[Page]:
    with shown(window, served_cell[2]) as page:
        yield page


@pytest.fixture
def page(shared_page: Page, operator: PendantOperator) -> Page:
    """The page, in control."""
    own = shared_page.locator('.control.own')
    wait(shared_page, lambda: bool(own.count()) == bool(operator.desk.holder), 'what a test before has left')
    take_control(shared_page)
    assert operator.desk.holder
    return shared_page


def test_messages_are_filtered_acknowledged_exported_and_kept(
    page: Page, operator: PendantOperator, tmp_path: Path
) -> None:
    said = ((1.0, Level.INFO, 'planned'), (2.0, Level.ERROR, 'lost'), (3.0, Level.ERROR, 'lost'))
    for time, level, text in said:
        operator.messages.add(time, level, 'planning_node', text, 'weld.lua:12')
    page.get_by_role('tab', name='Messages').get_by_text('1', exact=True).wait_for()
    page.reload()
    page.get_by_role('tab', name='Messages').click()
    panel = page.locator('.message-panel')
    panel.locator('.message').nth(1).wait_for()
    newest = panel.locator('.message').first.inner_text()
    assert all(part in newest for part in ('planning_node', 'weld.lua:12', '\u00d72', 'lost'))
    panel.get_by_role('button', name='Errors', exact=True).click()
    panel.get_by_text('planned').wait_for(state='detached')
    with page.expect_download() as download:
        panel.get_by_role('button', name='Export').click()
    download.value.save_as(tmp_path / 'messages.tsv')
    _, *cells = (tmp_path / 'messages.tsv').read_text().rstrip().split('\t')
    assert cells == ['error', 'planning_node', 'weld.lua:12', '2', 'lost']
    panel.get_by_role('button', name='All').click()
    panel.get_by_label('Search').fill('plann')
    wait(page, lambda: panel.locator('.message').count() == 2, 'both, by the node')
    panel.get_by_role('button', name='Acknowledge').click()
    panel.locator('.message.seen').nth(1).wait_for()
    assert operator.messages.pending == 0


def test_the_bar_shows_the_cell_and_sets_mode_and_override(
    page: Page, operator: PendantOperator, cell: MadeUpCell
) -> None:
    operator.state = replace(operator.state, override=0.5, tool_speed=0.148)
    bar = page.locator('.bar')
    for text in (operator.robot.name, 'connected', 'nobody', 'no program', '148 mm/s', '50 %'):
        bar.get_by_text(text, exact=True).wait_for()
    assert cell.calls == []  # who looks on, and who takes control, changes nothing
    bar.get_by_role('button', name='Faster').click()
    wait(page, lambda: cell.calls == [('override', 0.55)], 'another override')
    page.get_by_label('Mode').click()
    page.get_by_role('option', name='AUTOMATIC', exact=True).click()
    automatic = 'controller_node', {'operating_mode': 'AUTOMATIC'}
    wait(page, lambda: cell.calls[-1] == automatic, 'another mode')
    running_program(operator, line=12)
    bar.get_by_text('press_tending.lua: running, line 12').wait_for()
    assert operator.state.commander is Commander.PROGRAM
    bar.get_by_text('program', exact=True).wait_for()
    operator.state = replace(operator.state, lost=('planning_node',))
    bar.get_by_text('no sign of life: planning_node').wait_for()


def test_what_stops_robot_and_jog_is_said_in_the_language_of_the_page(
    running: Browser, operator: PendantOperator, url: str
) -> None:
    other = open_page(running, url, locale='de-DE')
    operator.desk.holder = ''
    other.get_by_role('button', name='Bedienung übernehmen').click()
    operator.state = replace(operator.state, hindrance='jogging is limited', limits=('A2 position upper',))
    other.get_by_text('Das Handfahren ist begrenzt: obere Grenze von A2').wait_for()
    operator.state = replace(operator.state, fault='pressed', fault_kind='emergency stop')
    other.locator('.strip').get_by_text('angehalten: Not-Halt (pressed)').wait_for()
    other.context.close()
    operator.desk.holder = ''


def test_the_3d_view_has_the_theme_of_the_page(page: Page, operator: PendantOperator) -> None:
    operator.state = replace(operator.state, scene_url='http://127.0.0.1:9')
    page.emulate_media(color_scheme='dark')
    page.reload()
    for source in ('http://localhost:9?darkMode', 'http://localhost:9'):
        page.locator(f'.scene iframe[src="{source}"]').wait_for()
        page.get_by_role('button', name='Dark or light').click()
    page.emulate_media(color_scheme='light')
    page.reload()


def test_a_value_that_is_typed_stays_while_another_input_is_forced(
    page: Page, operator: PendantOperator
) -> None:
    page.get_by_role('tab', name='I/O').click()
    page.get_by_role('button', name='analog_input.1', exact=True).click()
    entry = page.locator('.q-menu .entry input')
    entry.fill('12.5')
    forced = replace(operator.state.io, forced=frozenset({'digital_input.3'}))
    operator.state = replace(operator.state, io=forced)
    page.locator('.io-panel .channel .forced:visible').wait_for()
    assert entry.input_value() == '12.5'
    page.keyboard.press('Escape')


def test_forced_inputs_and_the_plc_cannot_be_overlooked(page: Page, operator: PendantOperator) -> None:
    page.get_by_role('tab', name='Program').click()
    forced = replace(operator.state.io, forced=frozenset({'digital_input.3', 'digital_input.60'}))
    due = operator.now() + 100.0
    plc = ShownPlc('press.yaml', pending=((due, 12, {'digital_input.4': 1.0}),))
    operator.state = replace(operator.state, io=forced, plc=plc)
    page.get_by_text('Forced: part_present, digital_input.60').wait_for()
    page.get_by_role('tab', name='I/O').click()
    panel = page.locator('.io-panel')
    panel.get_by_text(re.compile(r'^PLC press\.yaml: in \d+\.\d s part_pressed = 1 \(line 12\)$')).wait_for()
    panel.locator('.channel .forced:visible').nth(1).wait_for()  # beyond the first 16 too
    operator.state = replace(operator.state, plc=replace(plc, pending=()))
    panel.get_by_text('PLC press.yaml: waits').wait_for()
    operator.state = replace(operator.state, plc=replace(plc, error='rules without end'))
    panel.locator('.plc.wrong').get_by_text('PLC press.yaml: ended: rules without end').wait_for()
    operator.state = replace(operator.state, plc=replace(plc, lost=True))
    panel.get_by_text('PLC press.yaml: no sign of life').wait_for()
