"""SeldomReady: waits in a thread of its own for what is seldom ready."""

import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rclpy.context import Context
from rclpy.guard_condition import GuardCondition

from robots_core.ros.running.held_wait_set import HeldWaitSet

WITHOUT_END = -1


class SeldomReady:
    """Takes what is seldom ready out of the wait set that an executor fills and looks through in each round.

    The thread waits until anything is ready, or until `pause`; then it rests until `resume`. All methods are
    called in the executor's thread.

    Args:
        context: Of the entities.
        on_rest: Called in the thread whenever it begins to rest.
    """

    def __init__(self, context: Context, on_rest: Callable[[], None]) -> None:
        self._context, self._on_rest = context, on_rest
        self._guard = GuardCondition(None, None, context)
        self._wait_set = HeldWaitSet(context, {})
        self._error: BaseException | None = None
        self._closed = False
        self._going, self._resting = threading.Event(), threading.Event()
        self._resting.set()
        self._thread = threading.Thread(target=self._run, name='seldom ready', daemon=True)
        self._thread.start()

    @property
    def rests(self) -> bool:
        """The thread rests."""
        return self._resting.is_set()

    @property
    def wait_set(self) -> HeldWaitSet:
        """What the thread has waited for before it rested.

        Raises:
            Exception: what the thread has raised.
        """
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        return self._wait_set

    def resume(self) -> None:
        """Let the thread wait again."""
        self._resting.clear()
        self._going.set()

    def pause(self) -> None:
        """Let the thread rest; what is ready stays so."""
        if not self._resting.is_set():
            self._guard.trigger()
            self._resting.wait()

    def replace(self, entities: Mapping[str, Sequence[Any]], waitables: Sequence[Any]) -> None:
        """Wait for these from now on, see `HeldWaitSet`."""
        self.pause()
        self._wait_set.close()
        self._wait_set = HeldWaitSet(self._context, {**entities, 'guard_condition': [self._guard]}, waitables)
        self.resume()

    def close(self) -> None:
        """End the thread and let go of all entities."""
        self.pause()
        self._closed = True
        self.resume()
        self._thread.join()
        self._wait_set.close()
        self._guard.destroy()

    def _run(self) -> None:
        while True:
            self._going.wait()
            self._going.clear()
            if self._closed:
                return
            try:
                self._wait_set.wait(WITHOUT_END)
            except BaseException as error:  # noqa: BLE001  # raised again in the executor's thread
                self._error = error
            self._resting.set()
            self._on_rest()
