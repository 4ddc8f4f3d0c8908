"""A tip that a known tool touches, and the page on which that is measured."""

from __future__ import annotations

import numpy as np
from playwright.sync_api import Locator, Page

from robots_core import BaseRobotModel
from robots_core.orientation import rotation_from_vector
from robots_core.validation import Array

TOOL = np.array([0.02, -0.01, 0.24])
TIP = np.array([1.6, 0.1, 1.0])
MIDDLE = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
TURNS = ([0.5, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.3, 0.6])


def touching(robot: BaseRobotModel, turn: list[float], point: Array = TIP) -> Array:
    """Joint positions (n,) with the tip of the tool at a point."""
    T = MIDDLE @ rotation_from_vector(np.array(turn))
    solutions: Array = robot.inverse_kinematics_analytic(point - T @ TOOL, T)
    return solutions[0]


def guide(page: Page, name: str) -> Locator:
    page.locator('.frames-panel').get_by_role('button', name=name, exact=True).click()
    shown = page.locator(f'.{name.lower()}-guide')
    shown.wait_for()
    return shown


def save(shown: Locator, name: str) -> None:
    shown.get_by_label('Name', exact=True).fill(name)
    shown.get_by_role('button', name='Save').click()
