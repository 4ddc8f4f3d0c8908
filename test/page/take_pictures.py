"""Pictures of the operator's page for the documentation: `make screenshots-pendant`."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO
from itertools import product
from pathlib import Path

import numpy as np
from browser_page import open_page
from made_up_cell import made_up_operator, ready_state, running_program, served, some_messages, switched
from PIL import Image
from playwright.sync_api import Browser, Locator, Page

from installed_browsers import browser
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import ShownPlc
from robots_controller.pendant.trends import PERIOD
from robots_core.blocks.visualizer import Visualizer
from robots_core.orientation import rotation_from_vector

FOLDER = Path('docs/how_to/pictures')
SIZES = {'desktop': (1440, 900), 'tablet': (1024, 768)}
VIEWS = ('jog', 'program', 'io', 'trends', 'frames', 'messages')
TRENDS = ('Position A1', 'Position A3', 'Digital output 2 gripper')
"""Beside the speed of the tool."""
SCENE_TIME = 15_000.0  # ms, for the 3D view to be drawn by the processor
QUALITY = 60  # of WebP
TAB_TIME = 4000.0  # ms, for a panel to be in front
WITHOUT_GPU = ('--use-angle=swiftshader', '--enable-unsafe-swiftshader')


def show(operator: PendantOperator, view: str, url: str) -> None:
    """Let the cell be in a state that is worth a picture of a view."""
    state = replace(ready_state(operator.robot), scene_url=url)
    for image, index in (('digital_inputs', 1), ('digital_inputs', 3), ('digital_outputs', 2)):
        state = switched(state, image, index, 1.0)
    state = switched(state, 'analog_inputs', 1, 41.5)
    operator.state = replace(state, override=0.6, tool_speed=0.148)
    if view == 'io':
        io = replace(state.io, forced=frozenset({'digital_input.3'}))
        due = (operator.now() + 4.4, 43, {'digital_input.1': 1.0, 'digital_input.4': 1.0})
        operator.state = replace(operator.state, io=io, plc=ShownPlc('press_tending.yaml', pending=(due,)))
    if view == 'program':
        running_program(operator, line=37)
    if view == 'frames' and not operator.measuring.points['tool']:
        touch_tip(operator)


def touch_tip(operator: PendantOperator) -> None:
    """Points of a tool, each touched some tenths of a millimetre off."""
    rng = np.random.default_rng(0)
    for turn in ([0.5, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.3, 0.6]):
        T = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) @ rotation_from_vector(
            np.array(turn)
        )
        r = [1.6, 0.1, 1.0] - T @ [0.02, -0.01, 0.24] + rng.normal(size=3) * 2e-4
        operator.measuring.touch('tool', operator.robot.inverse_kinematics_analytic(r, T)[0])


def some_trends(operator: PendantOperator) -> None:
    """A minute of a robot that moves to and fro."""
    state = ready_state(operator.robot)
    home, effort = np.array(operator.robot.home), np.array(operator.robot.axes_data.effort)
    ways = np.array([1.0, 0.3, -0.4, 0.2, 0.5, 0.1])
    for time in np.arange(0.0, 60.0, PERIOD):
        part = switched(state, 'digital_outputs', 2, float(time % 9.0 > 4.5))
        speed = float(np.cos(0.7 * time))
        operator.trends.add(
            time,
            replace(
                part,
                q=home + 0.5 * np.sin(0.7 * time) * ways,
                q_dot=0.35 * speed * ways,
                torque=effort * (0.3 + 0.2 * speed),
                tool_speed=0.6 * abs(speed),
                distance=0.4 + 0.1 * speed,
            ),
        )


def click(element: Locator) -> None:
    """Click at once: where the processor draws the 3D view, frames to look for a still place are rare."""
    element.evaluate('(one) => one.click()')


def take(page: Page, operator: PendantOperator, url: str, view: str, path: Path) -> None:
    """One picture."""
    show(operator, view, url)
    click(page.get_by_role('tab').nth(VIEWS.index(view)))
    if view == 'trends':
        for name in TRENDS:
            page.get_by_label('Signals').fill(name)
            click(page.get_by_role('option', name=name, exact=True))
        page.keyboard.press('Escape')
    page.mouse.move(0, 0)
    page.wait_for_timeout(TAB_TIME)
    with Image.open(BytesIO(page.screenshot())) as picture:
        picture.save(path, quality=QUALITY, method=6)
    print(path)


def hide_warning(page: Page) -> None:
    """Close what the 3D view says of a machine without a graphics processor."""
    click(page.frame_locator('.scene iframe').locator('[role=alert] button'))


def take_all(running: Browser, operator: PendantOperator, scene_url: str) -> None:
    """Pictures of every view, each named by view, size and theme."""
    with served(operator) as url:
        for (size, (width, height)), theme in product(SIZES.items(), ('light', 'dark')):
            viewport = {'width': width, 'height': height}
            page = open_page(running, url, viewport=viewport, color_scheme=theme)
            operator.desk.holder = ''  # the page before is kept for a while
            click(page.get_by_role('button', name='Take control'))
            hide_warning(page)
            page.wait_for_timeout(SCENE_TIME)
            for view in VIEWS:
                take(page, operator, scene_url, view, FOLDER / f'pendant_{view}_{size}_{theme}.webp')
            page.context.close()


def main() -> None:
    """Take the pictures."""
    operator, _ = made_up_operator()
    for text in ('Press tending of 2 parts', 'part 1: pressed with 41.5 kN', 'part 1: placed'):
        operator.prints.append(text)
    some_messages(operator)
    some_trends(operator)
    visualizer = Visualizer(operator.robot, port=0)
    home = np.array(operator.robot.home)
    for part in np.linspace(-0.6, 0.0, 60):  # a path of the tool
        visualizer.update(home + part * np.array([1.0, 0.2, -0.3, 0.0, 0.4, 0.0]))
    show(operator, 'jog', visualizer.url)
    try:
        with browser(*WITHOUT_GPU) as running:
            take_all(running, operator, visualizer.url)
    finally:
        visualizer.close()


if __name__ == '__main__':
    main()
