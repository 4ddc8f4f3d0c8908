"""HeldButton: the button that a viewer holds, and what it moves while it is held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from robots_controller.pendant.jog.jog_command import JogCommand
from robots_controller.pendant.jog.pendant_motion import JogBasis, Preview, step_command
from robots_controller.pendant.jog.press import Press
from robots_controller.pendant.pendant_port import PendantPort
from robots_controller.pendant.pendant_state import STARTABLE, PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError, Reason
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.program.run_state import RunState
from robots_core.cell_interface.operating_modes import MODES
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

RUN_KEY: Final = 'run'
"""Of the button that is held while a program runs."""
MOVE_KEY: Final = 'move'
"""Of the button that is held while the robot moves to the target that was previewed."""
STEP_KEY: Final = 'step '
"""Before 'over', 'in', 'out' or 'motion': of the buttons that let a held program make a step."""
LARGEST_STEP: Final = 0.5  # rad, m


@dataclass
class _Held:
    """The press of a viewer.

    Attributes:
        viewer: Who presses.
        press: What.
        start: What RUN_KEY does to the program that was there when it was pressed; None: only lets it run.
        sent: Something was commanded that ends with the press.
        started: The program was started, resumed or stepped; that happens once.
        paused: The program was paused before its step.
    """

    viewer: str
    press: Press
    start: Action | None
    sent: bool = False
    started: bool = False
    paused: bool = False


class HeldButton:
    """One button of one viewer at a time: jogs, steps, moves to a target, or lets a program run.

    Presses are taken in one thread.

    Args:
        robot: The robot.
        port: The cell.
        now: Time, s.
        check: Raises a NotPermittedError if a viewer may not do something now.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        port: PendantPort,
        now: Callable[[], float],
        check: Callable[[str, Action], None],
    ) -> None:
        self._robot, self._port, self._now, self._check = robot, port, now, check
        self._held: _Held | None = None
        self._newest = ('', 0)  # viewer and number of the newest press
        self.failure: tuple[str, RobotsError] | None = None
        """Why the last motion ended before its target, and whose it was."""
        self.jog: JogCommand | None = None
        """What is jogged now."""

    @property
    def viewer(self) -> str:
        """Who holds it; '' for nobody."""
        return '' if self._held is None else self._held.viewer

    def hold(
        self,
        viewer: str,
        number: int,
        key: str,
        state: PendantState,
        *,
        speed: float = 1.0,
        step: float = 0.0,
        preview: Preview | None = None,
        taught: Array | None = None,
    ) -> Action | None:
        """Take a sign that a viewer holds a button.

        Signs that arrive after the release of their press, or after the begin of a newer one, do nothing.

        Args:
            viewer: Who.
            number: Of the press: each of a viewer has a higher one than that before.
            key: Of the button, see `JogCommand.from_key`, RUN_KEY, MOVE_KEY or STEP_KEY.
            state: The newest of the cell.
            speed: Part of the highest jog speed, 0..1.
            step: Size of a step, rad or m; 0 jogs as long as the button is held.
            preview: The motion of MOVE_KEY.
            taught: Orientation of the taught frame to jog in, in the robot's base, (3, 3).

        Returns:
            The action to do now: what is held starts the program.

        Raises:
            NotPermittedError: when the press begins, or because of what has happened since.
            InvalidInputError: no such button or step.
        """
        now, held = self._now(), self._held
        if held is None or (held.viewer, held.press.number) != (viewer, number):
            held = self._begin(viewer, Press(number, key, now), _action(key, step), state)
        if held is None or held.press.over:
            return None
        if not held.press.hold(now):
            self._stop(held)
            return None
        action = _action(key, step)
        try:
            self._check(viewer, action)
            jog = _jog_of(key, action, speed, self._robot.num_axes, taught)
            if action is Action.STEP:
                return self._step(held, state)
            if action is Action.MOVE:
                if not held.press.moves:
                    command = self._command(jog, state, step, preview)
                    held.press.moves = held.sent = True
                    self._port.begin_move(command, partial(self._moved, held))
                self._port.hold_run(held=True)
            elif jog is not None:
                self._jog(held, jog, state)
        except RobotsError:
            held.press.over = True
            self._stop(held)
            raise
        if action is not Action.HOLD_RUN:
            return None
        held.sent = True
        self._port.hold_run(held=True)
        return held.start if _first_enabled(held, state) else None

    def release(self) -> None:
        """The button was released, or the connection to its viewer is lost."""
        held, self._held = self._held, None
        if held is not None and not held.press.over:
            self._stop(held)

    def _begin(self, viewer: str, press: Press, action: Action, state: PendantState) -> _Held | None:
        """Begin a press; None if this is a late sign of a press before."""
        if viewer == self._newest[0] and press.number <= self._newest[1]:
            return None
        self._check(viewer, action)
        self.release()
        self._held, self._newest = _Held(viewer, press, _start(state)), (viewer, press.number)
        self.failure = None
        return self._held

    def _stop(self, held: _Held) -> None:
        """Stop at once what would stop by itself after its timeout."""
        self.jog = None
        if not held.sent:
            return
        held.sent = False
        key = held.press.key
        if key == RUN_KEY or key.startswith(STEP_KEY):
            self._port.hold_run(held=False)
        elif held.press.moves:
            self._port.hold_run(held=False)
            self._port.end_move()
        elif key.startswith('axes'):
            self._port.jog_axes(np.zeros(self._robot.num_axes))
        else:
            self._port.jog_tool(np.zeros(6), 'base')

    def _step(self, held: _Held, state: PendantState) -> Action | None:
        if state.program.waits_for_run:  # it would run, and not step, as soon as run is held
            first, held.paused = not held.paused, True
            return Action.PAUSE if first else None
        if state.mode is not None and MODES[state.mode].held:
            held.sent = True
            self._port.hold_run(held=True)
        return Action.STEP if _first_enabled(held, state) else None

    def _jog(self, held: _Held, command: JogCommand, state: PendantState) -> None:
        held.sent, self.jog = True, command
        speeds = state.jog_speeds
        if command.frame == 'axes':
            self._port.jog_axes(command.velocity(self._robot.axes_data, speeds))
        else:
            self._port.jog_tool(command.twist(speeds), command.tool_frame)

    def _command(
        self, jog: JogCommand | None, state: PendantState, step: float, preview: Preview | None
    ) -> MotionCommand:
        if jog is None:
            if preview is None:
                raise NotPermittedError(Reason('no_preview'))
            return preview.command
        if not 0.0 < step <= LARGEST_STEP:
            raise InvalidInputError(f'step = {step:g} must be above 0, at most {LARGEST_STEP:g} (rad or m)')
        basis = JogBasis(state.jog_speeds, state.settings)
        return step_command(self._robot, jog, step, standing(self._port, state), basis)

    def _moved(self, held: _Held, error: RobotsError | None) -> None:
        """The motion has ended, in any thread; the rest of the press moves nothing."""
        if held.press.over or not held.sent:
            return
        held.press.over, held.sent = True, False
        if error is not None:
            self.failure = held.viewer, error
        self._port.hold_run(held=False)
        self._port.end_move()


def standing(port: PendantPort, state: PendantState) -> Array:
    """Where the robot stands, (n,), rad (m): its reference, so that steps add up.

    Raises:
        NotPermittedError: its position is not known yet.
    """
    q = port.reference()
    if q is None:
        q = state.q
    if q is None:
        raise NotPermittedError(Reason('no_position'))
    return q


def _action(key: str, step: float) -> Action:
    if key == RUN_KEY:
        return Action.HOLD_RUN
    if key.startswith(STEP_KEY):
        return Action.STEP
    return Action.MOVE if key == MOVE_KEY or step != 0.0 else Action.JOG


def _jog_of(key: str, action: Action, speed: float, num_axes: int, taught: Array | None) -> JogCommand | None:
    """What a button jogs or steps; None for other buttons."""
    if action not in (Action.JOG, Action.MOVE) or key == MOVE_KEY:
        return None
    return JogCommand.from_key(key, speed, num_axes, taught)


def _first_enabled(held: _Held, state: PendantState) -> bool:
    """Programs may run, for the first time during this press."""
    if held.started or not state.run_enabled:
        return False
    held.started = True
    return True


def _start(state: PendantState) -> Action | None:
    """What lets the program run; None for one that runs, or waits for nothing but RUN_KEY."""
    if state.program.state in STARTABLE:
        return Action.RUN
    paused = state.program.state is RunState.PAUSED and not state.program.waits_for_run
    return Action.RESUME if paused else None
