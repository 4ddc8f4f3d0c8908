"""HeldButton: the button that a viewer holds, and what it moves while it is held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from robots_controller.pendant.jog.jog_command import JogCommand
from robots_controller.pendant.jog.pendant_motion import Preview, step_command
from robots_controller.pendant.pendant_port import JogPort
from robots_controller.pendant.pendant_state import STARTABLE, PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError
from robots_controller.program.motions.motion_command import MotionCommand
from robots_controller.program.run_state import RunState
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
DEADLINE: Final = 0.2  # s between two signs of one press, after which it has ended


@dataclass(frozen=True, eq=False)
class Sign:
    """A sign that a viewer holds a button.

    Attributes:
        viewer: Who.
        number: Of the press: each of a viewer has a higher one than that before.
        key: Of the button, see `JogCommand.from_key`, RUN_KEY, MOVE_KEY or STEP_KEY.
        speed: Part of the highest jog speed, 0..1.
        step: Size of a step, rad or m; 0 jogs as long as the button is held.
        taught: Orientation of the taught frame to jog in, in the robot's base, (3, 3).
    """

    viewer: str
    number: int
    key: str
    speed: float = 1.0
    step: float = 0.0
    taught: Array | None = None

    @property
    def action(self) -> Action:
        """What the button does."""
        if self.key == RUN_KEY:
            return Action.HOLD_RUN
        if self.key.startswith(STEP_KEY):
            return Action.STEP
        return Action.MOVE if self.key == MOVE_KEY or self.step != 0.0 else Action.JOG


@dataclass
class _Held:
    """One press of a viewer, as a stream of signs that the button is still held.

    Nothing is repeated for the browser: without its signs no command is sent, and the planner's timeout stops
    the robot. A press whose stream was interrupted has ended for good: what arrives late does not move the
    robot again.

    Attributes:
        viewer: Who presses.
        number: Counts the presses of a page.
        last: Time of the last sign, s.
        start: What RUN_KEY does to the program that was there when it was pressed; None: only lets it run.
        over: It has ended.
        stop: Stops at once what would stop by itself after its timeout; None: nothing was commanded.
        started: The program was started, resumed or stepped, or a motion begun; that happens once.
        paused: The program was paused before its step.
    """

    viewer: str
    number: int
    last: float
    start: Action | None
    over: bool = False
    stop: Callable[[], None] | None = None
    started: bool = False
    paused: bool = False

    def hold(self, now: float) -> bool:
        """Take a sign that the button is held, at a time (s); False once the press has ended."""
        self.over = self.over or now - self.last > DEADLINE
        self.last = now
        return not self.over


class HeldButton:
    """One button of one viewer at a time: jogs, steps, moves to a target, or lets a program run.

    Presses are taken in one thread. `check` raises a NotPermittedError if a viewer may not do something now.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        port: JogPort,
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

    def hold(self, sign: Sign, state: PendantState, preview: Preview | None = None) -> Action | None:
        """Take a sign that a viewer holds a button; `preview` is the motion of MOVE_KEY.

        Signs that arrive after the release of their press, or after the begin of a newer one, do nothing.

        Returns:
            The action to do now: what is held starts the program.

        Raises:
            NotPermittedError: when the press begins, or because of what has happened since.
            InvalidInputError: no such button or step.
        """
        now, held, action = self._now(), self._held, sign.action
        if held is None or (held.viewer, held.number) != (sign.viewer, sign.number):
            held = self._begin(_Held(sign.viewer, sign.number, now, _start(state)), action)
        if held is None or held.over:
            return None
        if not held.hold(now):
            self._stop(held)
            return None
        try:
            self._check(sign.viewer, action)
            if action is Action.HOLD_RUN:
                self._hold_run(held)
                return held.start if _first_enabled(held, state) else None
            if action is Action.STEP:
                return self._step(held, state)
            if action is Action.JOG:
                self._jog(held, self._jog_command(sign), state)
                return None
            if not held.started:
                self._move(held, self._motion(sign, state, preview))
            self._port.hold_run(held=True)
        except RobotsError:
            held.over = True
            self._stop(held)
            raise
        return None

    def release(self) -> None:
        """The button was released, or the connection to its viewer is lost."""
        held, self._held = self._held, None
        if held is not None and not held.over:
            self._stop(held)

    def _begin(self, held: _Held, action: Action) -> _Held | None:
        """Begin a press; None if this is a late sign of a press before."""
        if held.viewer == self._newest[0] and held.number <= self._newest[1]:
            return None
        self._check(held.viewer, action)
        self.release()
        self._held, self._newest = held, (held.viewer, held.number)
        self.failure = None
        return held

    def _stop(self, held: _Held) -> None:
        stop, held.stop, self.jog = held.stop, None, None
        if stop is not None:
            stop()

    def _hold_run(self, held: _Held) -> None:
        held.stop = partial(self._port.hold_run, held=False)
        self._port.hold_run(held=True)

    def _step(self, held: _Held, state: PendantState) -> Action | None:
        if state.program.waits_for_run:  # it would run, and not step, as soon as run is held
            first, held.paused = not held.paused, True
            return Action.PAUSE if first else None
        if state.run_is_held:
            self._hold_run(held)
        return Action.STEP if _first_enabled(held, state) else None

    def _jog(self, held: _Held, command: JogCommand, state: PendantState) -> None:
        self.jog, speeds = command, state.jog_speeds
        if command.frame == 'axes':
            held.stop = partial(self._port.jog_axes, np.zeros(self._robot.num_axes))
            self._port.jog_axes(command.velocity(self._robot.axes_data, speeds))
        else:
            held.stop = partial(self._port.jog_tool, np.zeros(6), 'base')
            self._port.jog_tool(command.twist(speeds), command.tool_frame)

    def _move(self, held: _Held, command: MotionCommand) -> None:
        held.started, held.stop = True, self._end_move
        self._port.begin_move(command, partial(self._moved, held))

    def _end_move(self) -> None:
        self._port.hold_run(held=False)
        self._port.end_move()

    def _jog_command(self, sign: Sign) -> JogCommand:
        return JogCommand.from_key(sign.key, sign.speed, self._robot.num_axes, sign.taught)

    def _motion(self, sign: Sign, state: PendantState, preview: Preview | None) -> MotionCommand:
        if sign.key == MOVE_KEY:
            if preview is None:
                raise NotPermittedError('no_preview')
            return preview.command
        jog, step = self._jog_command(sign), sign.step
        if not 0.0 < step <= LARGEST_STEP:
            raise InvalidInputError(f'step = {step:g} must be above 0, at most {LARGEST_STEP:g} (rad or m)')
        return step_command(self._robot, jog, step, standing(self._port, state), state)

    def _moved(self, held: _Held, error: RobotsError | None) -> None:
        """The motion has ended, in any thread; the rest of the press moves nothing."""
        if held.over or held.stop is None:
            return
        held.over = True
        if error is not None:
            self.failure = held.viewer, error
        self._stop(held)


def standing(port: JogPort, state: PendantState) -> Array:
    """Where the robot stands, (n,), rad (m): its reference, so that steps add up.

    Raises:
        NotPermittedError: its position is not known yet.
    """
    q = port.reference()
    if q is None:
        q = state.q
    if q is None:
        raise NotPermittedError('no_position')
    return q


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
