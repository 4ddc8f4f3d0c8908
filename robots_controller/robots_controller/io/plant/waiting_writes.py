"""WaitingWrites: what a partner has not confirmed yet, in the order in which it was to be written."""

from collections import deque
from collections.abc import Mapping
from typing import Final

from robots_controller.io.bridge.io_port import Number
from robots_controller.io.bridge.place import Place

LONGEST_QUEUE: Final = 100
"""Images of the outputs, beyond which older ones are overtaken."""


class WaitingWrites:
    """Writes that wait; each place's newest value is never lost, older ones are where they pile up."""

    def __init__(self) -> None:
        self._newest: dict[Place, Number] = {}
        self._queue: deque[dict[Place, Number]] = deque()
        self.refused: dict[Place, str] = {}
        """Places that the partner refuses, and why."""
        self.overtaken = 0
        """Values that were replaced by newer ones before they could be written."""

    def __bool__(self) -> bool:
        return bool(self._queue)

    def add(self, values: Mapping[Place, Number]) -> None:
        """Add what is to be written together."""
        for place, value in values.items():
            self._newest.pop(place, None)  # to stand behind the others
            self._newest[place] = value
        self._queue.append(dict(values))
        if len(self._queue) > LONGEST_QUEUE:
            self._merge(set().union(*self._queue))

    def take(self) -> dict[Place, Number]:
        """The next that are to be written."""
        return self._queue.popleft()

    def confirm(self, written: Mapping[Place, Number], refused: Mapping[Place, str]) -> None:
        """Take the partner's answer to what was taken."""
        for place in written:
            self.refused.pop(place, None)
        self.refused.update(refused)

    def start_again(self) -> None:
        """After a break: write the newest value of every place, in the order of their last changes."""
        self.refused.clear()
        self._merge(set(self._newest))

    def retry_refused(self) -> None:
        """Write again what was refused."""
        if self.refused and not self._queue:
            self._queue_newest(set(self.refused))

    def _merge(self, places: set[Place]) -> None:
        waiting = [place for values in self._queue for place in values]
        self.overtaken += len(waiting) - len(set(waiting))
        self._queue.clear()
        if places:
            self._queue_newest(places)

    def _queue_newest(self, places: set[Place]) -> None:
        self._queue.append({place: value for place, value in self._newest.items() if place in places})
