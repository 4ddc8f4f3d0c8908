"""PendantOperator: takes what viewers press, and commands what is permitted."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_controller.io.io_image import Channel
from robots_controller.pendant.control_desk import ControlDesk
from robots_controller.pendant.jog_command import JogCommand
from robots_controller.pendant.message_log import MessageLog
from robots_controller.pendant.pendant_port import PendantPort
from robots_controller.pendant.pendant_state import STARTABLE, PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError, refusal
from robots_controller.pendant.press import Press
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError
from robots_core.operating_modes import OperatingMode
from robots_core.robot_model.base_robot_model import BaseRobotModel

HOLD_KEY: Final = 'run'
"""Of the button that is held while a program runs."""
MOST_PRINTS: Final = 500

SERVICES: Final[Mapping[Action, str]] = {
    Action.RUN: 'lua_program_node/run',
    Action.PAUSE: 'lua_program_node/pause',
    Action.RESUME: 'lua_program_node/resume',
    Action.END: 'lua_program_node/stop',
    Action.REWIND: 'lua_program_node/reset',
    Action.RESET: 'controller_node/reset',
}


@dataclass
class _Held:
    """The press of a viewer, whether it has commanded something, and whether it has started the program."""

    viewer: str
    press: Press
    sent: bool = False
    started: bool = False


class PendantOperator:
    """What all pages of a pendant share: the state, who operates, and the button that is held.

    `state` may be replaced from any thread; presses are taken in one thread. All commands raise a
    NotPermittedError if the viewer is not in control or the state does not permit them.

    Args:
        robot: The robot.
        port: The cell.
        now: Time, s.
    """

    def __init__(self, robot: BaseRobotModel, port: PendantPort, now: Callable[[], float]) -> None:
        self.robot: Final = robot
        self.desk: Final = ControlDesk()
        self.messages: Final = MessageLog()
        self.prints: deque[tuple[int, str]] = deque(maxlen=MOST_PRINTS)
        """What programs have printed, numbered, oldest first."""
        self.state = PendantState()
        self._port, self._now = port, now
        self._held: _Held | None = None
        self._printed = 0

    def print(self, text: str) -> None:
        """A program has printed a text."""
        self._printed += 1
        self.prints.append((self._printed, text))

    # -- viewers ------------------------------------------------------------------------------------------

    def take_control(self, viewer: str, *, from_other: bool = False) -> None:
        """See `ControlDesk.take`; what the other viewer holds is released."""
        self.desk.take(viewer, from_other=from_other)
        if self._held is not None and self._held.viewer != viewer:
            self._release()

    def give_back_control(self, viewer: str) -> None:
        """Release what the viewer holds, and give control back; called too when a viewer is gone."""
        self.release(viewer)
        self.desk.give_back(viewer)

    # -- what is held -------------------------------------------------------------------------------------

    def hold(self, viewer: str, number: int, key: str, speed: float = 1.0) -> Action | None:
        """Take a sign that a viewer holds a button.

        Args:
            viewer: Who.
            number: Of the press, each with another one.
            key: Of the button, see `JogCommand.from_key`, or HOLD_KEY.
            speed: Part of the highest jog speed, 0..1.

        Returns:
            The action to `act` on now: what is held starts the program.

        Raises:
            NotPermittedError: when the press begins, or because of what has happened since.
            InvalidInputError: no such button.
        """
        now, held = self._now(), self._held
        if held is None or (held.viewer, held.press.number) != (viewer, number):
            self.desk.check(viewer)
            self._release()
            held = self._held = _Held(viewer, Press(number, key, now))
        if held.press.over:
            return None
        if not held.press.hold(now):
            self._stop_held(held)
            return None
        try:
            self._check(viewer, Action.HOLD_RUN if key == HOLD_KEY else Action.JOG)
            jog = None if key == HOLD_KEY else JogCommand.from_key(key, speed, self.robot.num_axes)
        except (NotPermittedError, InvalidInputError):
            held.press.over = True
            self._stop_held(held)
            raise
        held.sent = True
        if jog is not None:
            self._jog(jog)
            return None
        self._port.hold_run(held=True)
        return self._start(held)

    def release(self, viewer: str) -> None:
        """A viewer has released what it held, or the connection to it is lost."""
        if self._held is not None and self._held.viewer == viewer:
            self._release()

    def _release(self) -> None:
        held, self._held = self._held, None
        if held is not None and not held.press.over:
            self._stop_held(held)

    def _stop_held(self, held: _Held) -> None:
        """Stop at once what would stop by itself after its timeout."""
        if not held.sent:
            return
        if held.press.key == HOLD_KEY:
            self._port.hold_run(held=False)
        elif held.press.key.startswith('axes'):
            self._port.jog_axes(np.zeros(self.robot.num_axes))
        else:
            self._port.jog_tool(np.zeros(6), 'base')

    def _jog(self, command: JogCommand) -> None:
        speeds = self.state.jog_speeds
        if command.frame == 'axes':
            self._port.jog_axes(command.velocity(self.robot.axes_data, speeds))
        else:
            self._port.jog_tool(command.twist(speeds), command.frame)

    def _start(self, held: _Held) -> Action | None:
        if held.started or not self.state.run_enabled:
            return None
        held.started = True
        program = self.state.program
        if program.state in STARTABLE:
            return Action.RUN
        paused = program.state is RunState.PAUSED and program.hold != 'release'
        return Action.RESUME if paused else None

    # -- what is pressed once -----------------------------------------------------------------------------

    def stop(self) -> None:
        """Stop the program and the robot: any viewer may."""
        self._release()
        self._port.stop()

    def act(self, viewer: str, action: Action) -> None:
        """Do one of `SERVICES`; so this and what follows waits for the answer of the cell.

        Raises:
            RobotsError: a node refuses, or does not answer.
        """
        self._check(viewer, action)
        self._port.call(SERVICES[action])

    def open_program(self, viewer: str, path: str) -> None:
        """Open a robot program."""
        self._check(viewer, Action.OPEN)
        self._port.open_program(path)

    def set_mode(self, viewer: str, mode: str) -> None:
        """Set the operating mode."""
        self._check(viewer, Action.MODE)
        self._port.set_mode(OperatingMode(mode))

    def set_override(self, viewer: str, value: float) -> None:
        """Set the speed override, 0..1."""
        self._check(viewer, Action.OVERRIDE)
        if not 0.0 <= value <= 1.0:
            raise InvalidInputError(f'override = {value:g} must be in [0, 1]')
        self._port.set_override(value)

    def set_output(self, viewer: str, channel: Channel, value: float) -> None:
        """Give an output a value."""
        self._check(viewer, Action.SWITCH)
        self._port.set_io(channel, channel.checked(value))

    def force_input(self, viewer: str, channel: Channel, value: float | None) -> None:
        """Force an input to a value; None releases it."""
        self._check(viewer, Action.SWITCH)
        self._port.force(channel, None if value is None else channel.checked(value))

    def _check(self, viewer: str, action: Action) -> None:
        self.desk.check(viewer)
        if (reason := refusal(action, self.state)) is not None:
            raise NotPermittedError(reason)
