"""An executor whose callbacks do not return is noticed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from robots_core.ros.running.lean_executor import ExecutorWatch

TIMEOUT = 2.0  # s
BEAT = 0.04  # s


class Executor:
    """Calls its tasks in `turn` alone."""

    def __init__(self) -> None:
        self.tasks: list[Callable[[], None]] = []

    def create_task(self, callback: Callable[[], None], /) -> None:
        self.tasks.append(callback)

    def turn(self) -> None:
        while self.tasks:
            self.tasks.pop()()


class Rig:
    """Looks at an executor as a heartbeat does."""

    def __init__(self, share: float = 1.0) -> None:
        self.executor, self.hung, self.now = Executor(), 0, 100.0
        self.watch = ExecutorWatch(self.executor, self._note, timeout=TIMEOUT, share=lambda: share)

    def _note(self) -> None:
        self.hung += 1

    def check(self, duration: float, *, turning: bool) -> list[bool]:
        found = []
        for _ in np.arange(0.0, duration, BEAT):
            self.now += BEAT
            found.append(self.watch.check(self.now))
            if turning:
                self.executor.turn()
        return found


def test_an_executor_that_turns_is_alive_and_has_one_task_at_a_time() -> None:
    rig = Rig()
    assert all(rig.check(20.0, turning=True))
    assert rig.hung == 0
    assert all(rig.check(0.5 * TIMEOUT, turning=False))
    assert len(rig.executor.tasks) == 1


def test_a_callback_that_does_not_return_is_noticed_once_until_it_does() -> None:
    rig = Rig()
    rig.check(1.0, turning=True)
    alive = rig.check(4.0 * TIMEOUT, turning=False)
    silent = (alive.index(False) + 1) * BEAT
    assert TIMEOUT < silent < 1.5 * TIMEOUT
    assert not any(alive[alive.index(False) :])
    assert rig.hung == 1
    rig.executor.turn()
    assert rig.check(1.0, turning=True)[-1]
    rig.check(4.0 * TIMEOUT, turning=False)
    assert rig.hung == 2


def test_a_callback_may_take_longer_where_processes_share_processors() -> None:
    rig = Rig(share=0.25)
    rig.check(1.0, turning=True)
    assert all(rig.check(2.0 * TIMEOUT, turning=False))
    assert not rig.check(4.0 * TIMEOUT, turning=False)[-1]


def test_a_process_that_was_frozen_itself_is_not_hung() -> None:
    rig = Rig()
    rig.check(1.0, turning=True)
    rig.now += 60.0
    assert all(rig.check(1.0, turning=True))
    assert rig.hung == 0
