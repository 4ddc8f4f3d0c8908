"""Counts: how many messages the endpoints of a participant have sent or handled."""

import threading
from typing import Any

from robots_core.ros.lockstep.protocol import Endpoint
from robots_core.ros.lockstep.traffic import CLOSED


class Counts:
    """The endpoints of a participant, with a count that grows each; from any thread."""

    def __init__(self) -> None:
        self.endpoints: list[Endpoint] = []
        """In the order of their numbers."""
        self.entities: list[Any] = []
        """Publishers, subscriptions, services and clients, one for each endpoint."""
        self._counts: list[int] = []
        self._reported: list[int] = []
        self._lock = threading.Lock()

    def add(self, endpoint: Endpoint, entity: Any) -> int:
        """Count an endpoint too; returns its number."""
        with self._lock:
            self.endpoints.append(endpoint)
            self.entities.append(entity)
            self._counts.append(0)
            return len(self._counts) - 1

    def sent(self, index: int) -> None:
        """A message is being sent."""
        with self._lock:
            self._counts[index] += 1

    def received(self, index: int) -> None:
        """A message was handled, of a subscription that is still there."""
        with self._lock:
            if self._counts[index] != CLOSED:
                self._counts[index] += 1

    def close(self, entity: Any) -> None:
        """A subscription ends: nothing waits for what it has not received."""
        for index, one in enumerate(self.entities):
            if one is entity and self.endpoints[index].kind == 'subscription':
                self._counts[index] = CLOSED

    def changes(self) -> list[int]:
        """Endpoints whose counts have changed since the last call, each followed by its count."""
        with self._lock:
            found: list[int] = []
            if self._counts != self._reported:
                for index, count in enumerate(self._counts):
                    if index >= len(self._reported) or count != self._reported[index]:
                        found += (index, count)
                self._reported = list(self._counts)
            return found

    def forget(self) -> None:
        """Have all counts among the next changes."""
        self._reported = []
