"""Motions that a client has commanded, and what becomes of them after one that has failed."""

import threading
from collections.abc import Callable, Iterator
from typing import Final

from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.errors import PlanningError, RobotsError

UPDATE_PERIOD: Final = 0.1  # s


class Motion:
    """A motion on its way.

    Args:
        number: Grows from motion to motion.
        flush: Called before waiting: no motion follows that it could blend into.
        raised: Called with the number before an error is raised.
    """

    def __init__(self, number: int, flush: Callable[[], None], raised: Callable[[int], None]) -> None:
        self.number = number
        self._flush, self._raised = flush, raised
        self._ended = threading.Event()
        self._error: RobotsError | None = None
        self._progress = 0.0

    @property
    def done(self) -> bool:
        """It has ended, at its target or not."""
        return self._ended.is_set()

    @property
    def progress(self) -> float:
        """Fraction that is done, 0..1; of motions that blend, the fraction of all of them."""
        return self._progress

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until the robot is at the target.

        Args:
            timeout: Longest wait, s; without end by default.

        Returns:
            False if the motion is still under way.

        Raises:
            RobotsError: why the robot is not at the target.
        """
        self._flush()
        ended = self._ended.wait(timeout)
        if self._error is not None:
            self._raised(self.number)
            raise self._error
        return ended

    def updates(self, period: float = UPDATE_PERIOD) -> Iterator[float]:
        """The progress, once in each period (s), until the motion has ended.

        Raises:
            RobotsError: why the robot is not at the target.
        """
        while not self.wait(period):
            yield self._progress
        yield self._progress

    def advance(self, progress: float) -> None:
        """The controller reports progress."""
        self._progress = progress

    def end(self, error: RobotsError | None) -> None:
        """The motion has ended: None, or why the robot is not at the target."""
        self._error = error
        if error is None:
            self._progress = 1.0
        self._ended.set()


class MotionsUnderWay:
    """The motions of a client that have not ended, in their order; safe from any thread.

    A motion that fails takes with it those commanded for after it, as the robot is not where they were to
    start: the robot is stopped, and the client hears of all these failures when the last of them has ended.
    No other motion is commanded before it has heard of one.

    Args:
        cancel: Stops the robot and gives up all motions.
        flush: No motion follows that the last one could blend into.
        patience: Longest wait for the robot to stop, s.
    """

    def __init__(self, cancel: Callable[[], object], flush: Callable[[], None], patience: float) -> None:
        self._cancel, self._flush, self._patience = cancel, flush, patience
        self._changed = threading.Condition()
        self._motions: dict[MotionCommand, Motion] = {}
        self._held_back: list[tuple[Motion, RobotsError | None]] = []  # a failed one first
        self._newest = self._heard = 0  # numbers of motions
        self._error: RobotsError | None = None  # that the client has not heard of

    def begin(self, command: MotionCommand) -> Motion:
        """A motion that is to be sent; then call `sent`.

        Raises:
            PlanningError: a motion before it has failed, and the client has not heard of it; now it has.
        """
        with self._changed:
            self._changed.wait_for(lambda: not self._held_back, self._patience)
            error, self._error = self._error, None
            if error is not None:
                self._heard = self._newest
                raise PlanningError(f'not commanded, as a motion before it has failed: {error}')
            self._newest += 1
            motion = self._motions[command] = Motion(self._newest, self._flush, self._raised)
            return motion

    def sent(self, motion: Motion) -> None:
        """The motion was sent; it stops, too, if one before it has failed meanwhile."""
        with self._changed:
            void = self._is_behind(motion)
        if void:
            self._cancel()

    def advance(self, progress: float) -> None:
        """The controller reports the progress of the oldest motion, 0..1."""
        for motion in [*self._motions.values()][:1]:
            motion.advance(progress)

    def end(self, command: MotionCommand, error: RobotsError | None) -> None:
        """A motion has ended: None, or why the robot is not at the target."""
        with self._changed:
            motion = self._motions.pop(command)
            expected = motion.number <= self._heard
            if error is not None and self._error is None and not expected:
                self._error = error
            if expected or (error is None and not self._is_behind(motion)):
                motion.end(error)
            else:
                self._held_back.append((motion, error))
            stops = bool(self._held_back) and self._held_back[0][0] is motion and self._any_after(motion)
            if self._held_back and not self._any_after(self._held_back[0][0]):
                for one, reason in self._held_back:
                    one.end(reason)
                self._held_back.clear()
                self._changed.notify_all()
        if stops:
            self._cancel()

    def expect_failures(self) -> None:
        """The client ends all motions itself, and knows what became of those that have ended."""
        with self._changed:
            self._heard, self._error = self._newest, None

    def _is_behind(self, motion: Motion) -> bool:
        return bool(self._held_back) and motion.number > self._held_back[0][0].number

    def _any_after(self, motion: Motion) -> bool:
        return any(one.number > motion.number for one in self._motions.values())

    def _raised(self, number: int) -> None:
        with self._changed:
            if number > self._heard:
                self._heard, self._error = self._newest, None
