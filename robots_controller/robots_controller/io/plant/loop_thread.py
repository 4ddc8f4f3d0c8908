"""LoopThread: an asyncio loop in a thread of its own, for servers."""

from __future__ import annotations

import asyncio
import concurrent.futures
import threading
from collections.abc import Coroutine
from typing import Any, Final, TypeVar

Result = TypeVar('Result')

CLOSE_TIMEOUT: Final = 5.0  # s


class LoopThread:
    """Runs coroutines of other threads, until it is closed."""

    def __init__(self, name: str) -> None:
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=name, daemon=True)
        self._thread.start()

    @property
    def closed(self) -> bool:
        """It has ended."""
        return self._loop.is_closed()

    def post(self, work: Coroutine[Any, Any, Result]) -> concurrent.futures.Future[Result]:
        """Begin some work."""
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    def wait(self, work: Coroutine[Any, Any, Result], timeout: float | None = None) -> Result:
        """Do some work, within a time, s."""
        return self.post(work).result(timeout)

    def close(self) -> None:
        """End what still runs, and the thread."""
        if not self.closed:
            self.wait(_cancel_others(), CLOSE_TIMEOUT)
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join(CLOSE_TIMEOUT)
            self._loop.close()


async def _cancel_others() -> None:
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
