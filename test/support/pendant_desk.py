"""An operator's page without a browser: an operator in control of a cell that is made up."""

from __future__ import annotations

from typing import Any

import numpy as np

from robots_controller.pendant.jog.held_button import Sign
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action
from robots_core import load_robot_model
from robots_core.cell_interface.operating_modes import OperatingMode

ME = 'me'
JOG = 'axes 0 +'
READY = PendantState(lost=(), mode=OperatingMode.T1)


class Cell:
    """See `PendantPort`; writes down what is commanded."""

    def __init__(self) -> None:
        self.calls: list[tuple[Any, ...]] = []

    def __getattr__(self, name: str) -> Any:
        def command(*values: Any, **named: Any) -> None:
            self.calls.append((name, *values, *named.values()))

        return command

    @property
    def last(self) -> tuple[Any, ...]:
        return self.calls[-1]

    def commanded(self) -> np.ndarray:
        """The velocities of the last jog."""
        assert self.last[0] in ('jog_axes', 'jog_tool')
        return np.asarray(self.last[1])


class Desk:
    """An operator in control of a cell, on a clock of its own."""

    def __init__(self, state: PendantState = READY) -> None:
        self.time = 0.0
        self.cell = Cell()
        self.robot = load_robot_model('cello_bot')  # its first axis slides
        self.operator = PendantOperator(self.robot, self.cell, lambda: self.time)
        self.operator.state = state
        self.operator.take_control(ME)

    def hold(self, number: int = 1, key: str = JOG, *, after: float = 0.04, **options: Any) -> Action | None:
        self.time += after
        return self.operator.hold(Sign(ME, number, key, **options))
