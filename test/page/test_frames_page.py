"""Tools, bases and payloads measured on the operator's page, in a real browser."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page

from robots_controller.pendant.motion_recording import MeasuredMotion
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.program.files.cell_frames import CellFrames, Tool, read_frames, write_frames
from robots_core import Pose
from robots_core.blocks import NumericalDynamics, Payload
from robots_core.validation import Array

from .browser_page import open_page, take_control, wait
from .made_up_cell import MadeUpCell, made_up_operator, ready_state, served
from .touched_tip import TIP, TOOL, TURNS, guide, save, touching

ROBOT = 'kuka_kr210_r2700'


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp('cell')


@pytest.fixture(scope='module')
def served_cell(folder: Path) -> Iterator[tuple[PendantOperator, MadeUpCell, str]]:
    operator, cell = made_up_operator(ROBOT)
    with served(operator, folder) as url:
        yield operator, cell, url


@pytest.fixture(scope='module')
def shared_page(running: Browser, served_cell: tuple[PendantOperator, MadeUpCell, str]) -> Iterator[Page]:
    page = open_page(running, served_cell[2], viewport={'width': 1024, 'height': 768})
    errors: list[str] = []
    page.on('pageerror', lambda error: errors.append(str(error)))
    take_control(page)
    page.get_by_role('tab', name='Tools').click()
    page.locator('.tool-guide').wait_for()
    yield page
    page.close()
    assert errors == []


@pytest.fixture
def operator(served_cell: tuple[PendantOperator, MadeUpCell, str]) -> PendantOperator:
    operator = served_cell[0]
    operator.state = ready_state(operator.robot)
    operator.measuring.clear('tool', 'orientation', 'base')
    return operator


def touch(operator: PendantOperator, shown: Locator, *positions: Array) -> None:
    """Press the button for each position, and wait until it is taken."""
    button = shown.get_by_role('button', name='Touch here').first
    for number, q in enumerate(positions, 1):
        operator.state = replace(operator.state, q=q)
        button.click()
        shown.locator('.touched-point.touched').nth(number - 1).wait_for()


def test_a_bad_touch_is_named_touched_again_and_the_tool_saved(
    shared_page: Page, operator: PendantOperator, folder: Path
) -> None:
    shown = guide(shared_page, 'Tool')
    good = [touching(operator.robot, turn) for turn in TURNS]
    bad = touching(operator.robot, TURNS[2], TIP + 0.01 * np.eye(3)[1])
    touch(operator, shown, *good[:2], bad, good[3])
    shown.locator('.found.wrong', has_text='point 3 fits the others least').wait_for()
    assert shown.locator('.touched-point', has_text='mm off').count() == 4
    save(shown, 'gripper')
    shared_page.get_by_role('alert').get_by_text('point 3 fits the others least').wait_for()
    assert not (folder / 'frames.yaml').exists()
    shown.get_by_role('button', name='Remove Point 3').click()
    shown.locator('.touched-point.touched').nth(3).wait_for(state='detached')
    operator.state = replace(operator.state, q=good[2])
    shown.get_by_role('button', name='Touch here').first.click()
    shown.get_by_text('X 20.00 Y -10.00 Z 240.00 mm').wait_for()
    shown.get_by_role('button', name='Save').click()
    # What is saved has left the list when that is confirmed: no button moves afterwards.
    left = '.tool-guide .touched-point.touched'
    confirmed = shared_page.wait_for_function(
        """([text, left]) => document.querySelector('.tool-guide').innerText.includes(text)
        && {left: document.querySelectorAll(left).length}""",
        arg=['gripper is saved in frames.yaml.', left],
    )
    assert confirmed.json_value() == {'left': 0}
    np.testing.assert_allclose(read_frames(folder / 'frames.yaml').tools['gripper'].pose.r, TOOL, atol=1e-6)
    shown.get_by_role('button', name='Undo').click()
    shown.get_by_text('The last change is undone.').wait_for()
    assert not (folder / 'frames.yaml').exists()


def test_a_base_is_touched_with_a_tool_of_the_file(
    shared_page: Page, operator: PendantOperator, folder: Path
) -> None:
    write_frames(folder / 'frames.yaml', CellFrames({'pen': Tool(Pose(TOOL, np.eye(3)))}))
    shown = guide(shared_page, 'Base')
    shown.get_by_label('Touching tool').click()
    shared_page.get_by_role('option', name='pen').click()
    ways = np.array([[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.05, 0.2, 0.0]])
    touch(operator, shown, *(touching(operator.robot, TURNS[0], TIP + way) for way in ways))
    shown.get_by_text('X 1600.00 Y 100.00 Z 1000.00 mm').wait_for()
    save(shown, 'table')
    shown.get_by_text('table is saved in frames.yaml.').wait_for()
    base = read_frames(folder / 'frames.yaml').bases['table']
    assert base.distance_to(Pose(TIP, np.eye(3))) == pytest.approx((0.0, 0.0), abs=1e-6)


def test_a_payload_is_recorded_evaluated_and_saved(
    shared_page: Page,
    operator: PendantOperator,
    served_cell: tuple[PendantOperator, MadeUpCell, str],
    folder: Path,
) -> None:
    cell, robot = served_cell[1], operator.robot
    shown = guide(shared_page, 'Payload')
    shown.get_by_role('button', name='Record').click()
    shared_page.get_by_role('alert').get_by_text('The drives report no torques').wait_for()
    dynamics = NumericalDynamics(robot, payload=Payload(60.0, np.array([0.05, -0.1, 0.25])))
    speed, swing = np.array([0.5, 0.6, 0.7, 1.0, 1.3, 1.6]), np.array([0.1, 0.1, 0.1, 0.6, 0.6, 0.6])
    for t in np.arange(0.0, 8.0, 0.02):
        q, q_dot, q_ddot = (swing * speed**k * np.sin(speed * t + k * np.pi / 2) for k in (0, 1, 2))
        q = q + robot.home
        cell.motion.append(MeasuredMotion(float(t), q, dynamics.torques(q, q_dot, q_ddot)))
    operator.state = replace(operator.state, torque=np.zeros(robot.num_axes))
    shown.get_by_role('button', name='Record').click()
    wait(shared_page, lambda: not cell.motion, 'the recording')
    shown.get_by_role('button', name='Evaluate').click()
    shown.get_by_text('Mass 60.').wait_for()
    save(shown, 'gripper')
    shown.get_by_text('gripper is saved in frames.yaml.').wait_for()
    mass, *center = read_frames(folder / 'frames.yaml').tools['gripper'].payload
    assert mass == pytest.approx(60.0, abs=0.3)
    np.testing.assert_allclose(center, [0.05, -0.1, 0.25], atol=2e-3)
