"""The operator's page for robots that are unusual."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page

from .browser_page import press, shown, take_control, wait
from .made_up_cell import made_up_operator, served

AXES = 100
INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    '<visual><geometry><mesh filename="missing.stl"/></geometry></visual>'
)


def urdf(path: Path, axes: int) -> str:
    """A chain of axes whose links have a mesh that does not exist; its name for `load_robot_model`."""
    links = ''.join(f'<link name="l{i}">{INERTIAL}</link>' for i in range(axes + 1))
    joints = ''.join(
        f'<joint name="a{i + 1}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>'
        f'<origin xyz="0 0 0.1"/><axis xyz="{i % 2} {1 - i % 2} 0"/>'
        '<limit lower="-1" upper="1" velocity="1" effort="100"/></joint>'
        for i in range(axes)
    )
    path.write_text(f'<robot name="chain">{links}{joints}</robot>')
    return f'urdf:{path}'


@pytest.mark.parametrize('axes', [3, AXES])
def test_every_axis_is_jogged(window: Page, tmp_path: Path, axes: int) -> None:
    operator, cell = made_up_operator(urdf(tmp_path / 'chain.urdf', axes))
    with served(operator) as url, shown(window, url) as page:
        take_control(page)
        assert page.locator('.jog-row').count() == axes
        press(page, f'[data-press="axes {axes - 1} +"]')
        wait(page, cell.moving, 'a jog')
        page.mouse.up()
        wait(page, lambda: not cell.moving(), 'a stop')
        stop = page.locator('.stop').bounding_box()
        assert stop is not None
        assert stop['y'] >= 0.0  # scrolling leaves the stop button where it is
        assert page.evaluate('() => document.documentElement.scrollHeight <= window.innerHeight')
        page.screenshot(path=tmp_path / 'page.png')
