"""Problems: what is wrong now, each logged once however often it occurs."""

from collections.abc import Callable, Mapping
from typing import Final

LOG_AGAIN: Final = 5.0  # s


class Problems:
    """What is wrong now, by keys; a problem that comes and goes is logged at most once in `LOG_AGAIN`.

    Args:
        log: Logs a warning.
    """

    def __init__(self, log: Callable[[str], None]) -> None:
        self._log = log
        self._now: dict[str, str] = {}
        self._logged: dict[str, tuple[float, int]] = {}  # when (s), and how often since
        self.count = 0
        """Values that were lost."""

    def __str__(self) -> str:
        return '; '.join(self._now.values())

    def set(self, key: str, problem: str, now: float, *, lost: int = 0) -> None:
        """Set or, with '', clear a problem.

        Args:
            key: The same for the same problem.
            problem: What is wrong.
            now: s.
            lost: Values that were lost by it.
        """
        if not problem:
            self._now.pop(key, None)
            return
        self.count += lost
        fresh = key not in self._now
        self._now[key] = problem
        last, times = self._logged.get(key, (-LOG_AGAIN, 0))
        if fresh and now - last >= LOG_AGAIN:
            self._log(f'{problem} ({times} times more before)' if times else problem)
            self._logged[key] = now, 0
        elif lost or fresh:
            self._logged[key] = last, times + (lost or 1)

    def replace(self, prefix: str, problems: Mapping[str, str], now: float) -> None:
        """Set all problems of one origin; those that it has no more are cleared.

        Args:
            prefix: Of the origin's keys.
            problems: What is wrong, by the rest of the key.
            now: s.
        """
        for key in [key for key in self._now if key.startswith(prefix)]:
            if key.removeprefix(prefix) not in problems:
                self.set(key, '', now)
        for key, problem in problems.items():
            self.set(prefix + key, problem, now)
