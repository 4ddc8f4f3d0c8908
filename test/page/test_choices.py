"""Lists on the operator's page that change while a person chooses, and states while they are shown."""

from __future__ import annotations

from dataclasses import replace
from itertools import cycle
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import ShownProgram
from robots_controller.program.run_state import RunState
from robots_core import load_robot_model
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.validation import Array

from .browser_page import press, shown, take_control, wait
from .made_up_cell import MadeUpCell, made_up_operator, ready_state, served

PROGRAMS = '.program-panel .q-select input'
# The component of the list that a selector finds sends a choice, with an index and the text of the entry.
CHOOSE = """([selector, index, label]) => {
    const place = document.querySelector(selector);
    getElement(Number(place.id.slice(1))).$emit('update:model-value', {value: index, label: label});
}"""


def choose(page: Page, selector: str, index: int, label: str) -> None:
    page.evaluate(CHOOSE, [selector, index, label])


def names(page: Page, label: str) -> list[str]:
    """Entries of a list, which is opened."""
    page.get_by_label(label, exact=True).click()
    return page.get_by_role('option').all_inner_texts()


def test_the_entry_that_was_shown_is_chosen_however_the_list_has_changed(
    window: Page, tmp_path: Path
) -> None:
    operator, cell = made_up_operator()
    with served(operator, tmp_path) as url, shown(window, url) as page:
        take_control(page)
        page.get_by_role('tab', name='Program').click()
        assert names(page, 'Robot program') == []
        for name in ('b.lua', 'c.lua'):
            (tmp_path / name).write_text('wait(1)\n')
        wait(page, lambda: names(page, 'Robot program') == ['b.lua', 'c.lua'], 'two programs')
        (tmp_path / 'a.lua').write_text('wait(1)\n')
        wait(page, lambda: 'a.lua' in names(page, 'Robot program'), 'the new program')
        choose(page, PROGRAMS, 0, 'b.lua')  # as it stood before
        wait(page, lambda: cell.calls, 'a program')
        assert cell.calls == [('open', str(tmp_path / 'b.lua'))]
        (tmp_path / 'c.lua').unlink()
        page.keyboard.press('Tab')
        wait(page, lambda: names(page, 'Robot program') == ['a.lua', 'b.lua'], 'two programs')
        choose(page, PROGRAMS, 2, 'c.lua')
        choose(page, PROGRAMS, 0, 'a.lua')
        wait(page, lambda: len(cell.calls) > 1, 'another program')
        assert cell.calls[1:] == [('open', str(tmp_path / 'a.lua'))]


def test_a_robot_is_jogged_along_a_taught_point_as_it_is_now(window: Page, tmp_path: Path) -> None:
    operator, cell = made_up_operator()
    points = tmp_path / 'a.points.yaml'
    program = ShownProgram(str(tmp_path / 'a.lua'), RunState.OPENED, 'a.lua', points_file=str(points))
    operator.state = replace(operator.state, program=program)

    def teach(*degrees: float) -> Array:
        q = np.radians(degrees)
        operator.teaching.teach(points, 'P1', q)
        _, T = operator.robot.direct_kinematics(q)
        return T[:, 0]

    places = [(0.0, -90.0, 90.0, 0.0, 60.0, 0.0), (30.0, -80.0, 80.0, 40.0, 60.0, 0.0)]
    teach(*places[0])
    with served(operator, tmp_path) as url, shown(window, url) as page:
        take_control(page)
        page.get_by_role('button', name='Frame').click()
        page.get_by_label('Axes along').click()
        page.get_by_role('option', name='P1', exact=True).click()
        for place in places:
            direction = teach(*place)
            cell.calls.clear()
            press(page, '[data-press="taught 0 +"]')
            wait(page, cell.moving, 'a jog')
            page.mouse.up()
            wait(page, lambda: not cell.moving(), 'a stop')
            twist = np.array(cell.calls[0][1:4])
            np.testing.assert_allclose(twist / np.linalg.norm(twist), direction, atol=1e-9)


def test_what_the_page_shows_commands_nothing(window: Page, tmp_path: Path) -> None:
    robot = load_robot_model('kuka_kr210_r2700')
    cell = MadeUpCell()
    ready = ready_state(robot)
    states = []
    for name, mode in (('a.lua', OperatingMode.T1), ('b.lua', OperatingMode.T2), ('c.lua', OperatingMode.T1)):
        (tmp_path / name).write_text('wait(1)\n')
        program = ShownProgram(str(tmp_path / name), RunState.OPENED, name)
        states.append(replace(ready, program=program, mode=mode, override=0.3 if mode == 'T1' else 0.6))
    turns = cycle(states)

    class ChangingOperator(PendantOperator):
        """Its cell is in another state whenever it is looked at."""

        state = property(lambda _: next(turns), lambda *_: None)  # type: ignore[assignment]

    operator = ChangingOperator(robot, cell, lambda: 0.0)
    with served(operator, tmp_path) as url, shown(window, url) as page:
        take_control(page)
        page.get_by_role('tab', name='Program').click()
        for name in ('a.lua', 'b.lua', 'c.lua', 'a.lua'):
            page.locator('.bar').get_by_text(f'{name}: ready').wait_for()
    assert {call[0] for call in cell.calls} == set()
