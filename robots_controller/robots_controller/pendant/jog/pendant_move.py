"""PendantMove: a motion of the pendant, for which it takes the robot and then gives it back."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final, Protocol

from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import CommandRefusedError, RobotsError

STANDING_TIME: Final = 1.0  # s, in which a jog before has ended
Done = Callable[[RobotsError | None], None]


class MovePort(Protocol):
    """What a transport provides to the motions of a pendant."""

    def take(self, answered: Callable[[str], None]) -> None:
        """Take the robot; the answer is why that was refused, '' if it was not."""

    def give_back(self) -> None:
        """Give the robot back."""

    def send(self, command: MotionCommand) -> None:
        """Send a motion."""

    def cancel(self) -> None:
        """Give up the motion that was sent."""


class PendantMove:
    """One motion at a time; safe from any thread.

    The robot is taken for the motion and given back after it: a motion that is left behind by a pendant that
    has died continues with no program. A robot that still moves from a jog before is asked for again until
    it stands.
    """

    def __init__(self, port: MovePort, now: Callable[[], float]) -> None:
        self._port, self._now = port, now
        # Entered again where a motion has failed as soon as it is sent.
        self._lock = threading.RLock()
        self._running: tuple[MotionCommand, Done] | None = None
        self._begun = 0.0
        self._waiting = False  # for the robot to stand, so that it can be taken

    def begin(self, command: MotionCommand, done: Done) -> None:
        """Take the robot, and command a motion; `done` gets None, or why it has failed."""
        with self._lock:
            self._running = command, done
        self._begun, self._waiting = self._now(), False
        self._take(command)

    def end(self) -> None:
        """Give up the motion, if it runs, and give the robot back."""
        with self._lock:
            running, self._running = self._running, None
        if running is not None:
            self._port.cancel()
        self._port.give_back()

    def check(self) -> None:
        """Called now and then: ask again for a robot that did not stand."""
        running = self._running
        if self._waiting and running is not None:
            self._waiting = False
            self._take(running[0])

    def ended(self, command: MotionCommand, error: RobotsError | None) -> None:
        """A motion has ended."""
        with self._lock:
            running = self._running
            if running is None or running[0] is not command:
                return
            self._running = None
        running[1](error)

    def _take(self, command: MotionCommand) -> None:
        self._port.take(lambda refusal: self._taken(command, refusal))

    def _taken(self, command: MotionCommand, refusal: str) -> None:
        with self._lock:
            if self._running is None or self._running[0] is not command:  # released meanwhile
                return
            if not refusal:  # a release from now on cancels what was sent
                self._port.send(command)
                return
        if self._now() - self._begun < STANDING_TIME:
            self._waiting = True
        else:
            self.ended(command, CommandRefusedError(refusal))
