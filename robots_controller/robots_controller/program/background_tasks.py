"""BackgroundTasks: programs that run beside a robot program, in its thread, whenever they can continue."""

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass

from robots_controller.program.clock import Clock

# So many calls without a wait, then a period: a task that only looks must let the program work.
CALLS_PER_PERIOD = 100
CALLS_PERIOD = 0.004  # s


@dataclass
class _Task:
    ready: Callable[[], bool]
    end: float = math.inf
    calls: int = 0


class BackgroundTasks:
    """What each task waits for. Not safe by itself: the program's state guards it."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._tasks: dict[int, _Task] = {}
        self._added = 0
        self.current: int | None = None
        """The task that runs now."""

    @property
    def next_time(self) -> float:
        """When a task continues at the latest, s; infinite for never."""
        return min((task.end for task in self._tasks.values()), default=math.inf)

    def add(self) -> int:
        """A new task, which has not begun; its number, from 1."""
        self._added += 1
        self._tasks[self._added] = _Task(lambda: False)
        return self._added

    def begin(self, number: int) -> None:
        """A task can continue for the first time."""
        self._tasks[number].ready = lambda: True

    def end(self, number: int) -> None:
        """A task has ended."""
        self._tasks.pop(number, None)

    def next(self) -> int | None:
        """A task that can continue, the one that started first before the others; None if there is none."""
        now = self._clock.now() if self._tasks else 0.0
        return next((n for n, task in self._tasks.items() if now >= task.end or task.ready()), None)

    def run(self, number: int) -> None:
        """A task continues; without a wait it continues again after a period."""
        self.current = number
        task = self._tasks[number]
        task.ready, task.end, task.calls = lambda: False, self._clock.now() + CALLS_PERIOD, 0

    # -- how the task that runs waits -----------------------------------------------------------------

    def called(self) -> Generator[None, None, None]:
        """Let a period pass for a task that calls functions without waiting."""
        assert self.current is not None
        task = self._tasks[self.current]
        task.calls += 1
        if task.calls > CALLS_PER_PERIOD:
            yield from self.waiting(lambda: False, CALLS_PERIOD)

    def standstill(self) -> Generator[None, None, None]:
        """Nothing: a task does not wait for the robot."""
        yield from ()

    def waiting(
        self, ready: Callable[[], bool], duration: float | None = None
    ) -> Generator[None, None, bool]:
        """Wait for a condition, as `ProgramState.waiting`; yields where others shall continue."""
        assert self.current is not None
        task = self._tasks[self.current]
        end = math.inf if duration is None else self._clock.now() + duration
        while not ready():
            if self._clock.now() >= end:
                return False
            task.ready, task.end = ready, end
            yield
        return True
