"""OperatedCell: nodes of a cell, and the operator of their pendant."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from robots_controller.control.stops.faults import Fault
from robots_controller.nodes.pendant_node import PendantNode
from robots_controller.pendant.jog.held_button import STEP_KEY, Sign
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.permissions import Action, NotPermittedError
from robots_controller.program.run_state import RunState
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import InvalidInputError, NotNowError

from .program_cell import ROBOT, ProgramCell

ME = 'me'
JOGGED = ('the stream ended', 'no streamed point for')  # the result of a jog; that of a busy machine


class OperatedCell(ProgramCell):
    """A cell with a pendant, in mode T1."""

    def __init__(self, runner: Any, folder: Path) -> None:
        super().__init__(runner, folder, operating_mode='T1')
        self.node = self.start_node(PendantNode, robot_model=ROBOT, port=0, programs=str(folder))
        self.operator: PendantOperator = self.node.operator
        self.operator.held._now = lambda: 0.0  # no sign of a press comes too late
        self.operator.take_control(ME)
        self.wait(lambda: not self.state.lost and self.state.mode is not None, 'the nodes')
        self.presses = 0

    @property
    def state(self) -> Any:
        return self.operator.state

    def hold(self, key: str, condition: Any, what: str, *, step: float = 0.0) -> None:
        """Hold a button until a condition is true."""
        self.presses += 1
        actions: list[Action] = []

        def held() -> Any:
            action = self.operator.hold(Sign(ME, self.presses, key, step=step))
            actions.extend([] if action is None else [action])
            return action or condition()

        self.wait(held, what)
        if actions:  # not in the condition, which holds up the nodes
            self.until_done(
                lambda: self.operator.act(ME, actions[0]),
                again=lambda: self.wait(lambda: held() or self.state.run_enabled, 'run is held'),
            )
            self.wait(held, what)

    def step(self, key: str, size: float) -> None:
        """Hold a button until its step has ended."""
        self.until_standing()
        count = len(self.results)

        def ended() -> list[MotionResult]:
            return [one for one in self.results[count:] if not one.message.startswith(JOGGED)]

        self.hold(key, ended, 'a step', step=size)
        assert ended()[-1].ok, ended()

    def step_program(self, step: str) -> None:
        """Hold the button of a step until the program makes it."""
        self.presses += 1
        number, key = self.presses, f'{STEP_KEY}{step}'

        def held() -> Action | None:
            return self.operator.hold(Sign(ME, number, key))

        if self.wait(held, 'a step') is Action.PAUSE:
            self.operator.act(ME, Action.PAUSE)
            self.wait(held, 'a step of the paused program')
        self.until_done(lambda: self.operator.step(ME, step), again=held)

    def stop(self) -> None:
        """Stop program and robot, and permit motion again."""
        self.operator.stop()
        self.wait(lambda: self.state.fault_kind == Fault.STOP.label, 'the stop')
        # Both nodes are asked at once: the program has failed if the robot is stopped first.
        self.wait(lambda: self.state.program.state in (RunState.STOPPED, RunState.FAILED), 'its end')
        self.until_done(lambda: self.operator.act(ME, Action.RESET))
        self.wait(lambda: not self.state.fault, 'a robot that may move')

    def until_done(self, do: Callable[[], object], again: Callable[[], object] = lambda: None) -> None:
        """Do what nodes refuse for now: the robot moves, or the sign that a button is held is too old.

        Args:
            do: Raises NotNowError, or that run is not held, while it is refused.
            again: What to do after a refusal: another sign that the button is held.
        """
        while True:
            try:
                do()
            except NotNowError:
                again()
            except NotPermittedError as error:
                if error.reason.key != 'hold_needed':
                    raise
                again()
            else:
                return

    def set_mode(self, mode: OperatingMode) -> None:
        """Set the mode as soon as the robot stands."""
        self.until_standing()
        while self.state.mode is not mode:
            with contextlib.suppress(InvalidInputError):
                self.operator.set_mode(ME, mode)
