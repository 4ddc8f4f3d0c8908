"""PlantConnection: a port of an I/O map whose partner is reached by a link, in a thread of its own."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from threading import Condition, Thread
from typing import Any, Final

from robots_controller.io.bridge.io_port import Arrival, Number, Place
from robots_controller.io.io_map import IoRow
from robots_controller.io.plant.plant_link import LinkError, PlantLink
from robots_controller.io.plant.protocols import PlantServer
from robots_core.errors import InvalidInputError

FIRST_PAUSE: Final = 0.2  # s, before the second attempt to connect; doubled from one to the next
LONGEST_PAUSE: Final = 5.0  # s
RETRY_PERIOD: Final = 1.0  # s, of what the partner refuses
MOST_ARRIVALS: Final = 20_000
"""Values that wait for the loop; beyond it the oldest are lost."""
MOST_TAKEN: Final = 1000
"""Values that the loop takes before its other work has its turn."""
LONGEST_QUEUE: Final = 100
"""Images of the outputs, beyond which older ones are overtaken."""
FINISH_TIMEOUT: Final = 1.0  # s, for the thread to end


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


class PlantConnection:
    """See `IoPort`. Keeps a link open: reads, writes in order, and opens it again after ever longer pauses.

    `wake` is called in another thread when values have arrived or the state has changed.
    """

    def __init__(self, name: str, link: PlantLink, wake: Callable[[], None]) -> None:
        self._name, self._link, self._wake = name, link, wake
        self._changed = Condition()
        self._ended = False
        self._down = f'{name}: not connected yet'
        self._busy = False
        self._waiting = WaitingWrites()
        self._arrivals: deque[Arrival] = deque()
        self._lost_arrivals = 0
        self._news: list[str] = []
        # Another problem than that of a connection that fails, whose reason is logged then.
        self._problems: dict[str, str] = {'start': self._down}
        self._thread = Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    # -- the loop's side --------------------------------------------------------------------------

    def kind(self, place: Any) -> str:
        """Type of the number at a place."""
        return str(place.kind)

    def arrivals(self) -> Sequence[Arrival]:
        """What came since the last call, as much as the loop may take at once."""
        with self._changed:
            count = min(len(self._arrivals), MOST_TAKEN)
            arrivals = [self._arrivals.popleft() for _ in range(count)]
            more = bool(self._arrivals)
        if more:
            self._notify()
        return arrivals

    def lost(self) -> int:
        """Values since the last call that came faster than they could be sent or taken, at least."""
        with self._changed:
            lost, self._lost_arrivals = self._lost_arrivals, 0
        return lost

    def send(self, values: Mapping[Place, Number]) -> None:
        """Write values after those of earlier calls."""
        with self._changed:
            self._waiting.add(values)
            self._changed.notify_all()

    def problems(self) -> Mapping[str, str]:
        """What is wrong now; replaced, never changed."""
        return self._problems

    def news(self) -> Sequence[str]:
        """What is to be logged once."""
        with self._changed:
            news, self._news = self._news, []
        return news

    def finish(self, end: float) -> None:
        """Wait until all is written, if there is a connection."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._down or not (self._waiting or self._busy), max(0.0, end - time.monotonic())
            )

    def close(self) -> None:
        """End the thread; what is not written yet is not written any more."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join(FINISH_TIMEOUT)

    # -- the thread's side ------------------------------------------------------------------------

    def _run(self) -> None:
        pause = FIRST_PAUSE
        while not self._ended:
            began = time.monotonic()
            try:
                self._link.open(self._receive)
                due = self._link.read(began)  # one that takes connections may still not answer
                self._set_up()
                self._serve(due)
            except LinkError as error:
                self._set_down(error.message)
            except Exception as error:  # noqa: BLE001  # a partner can make its library raise anything
                self._set_down(repr(error))
            self._link.close()
            if time.monotonic() - began > LONGEST_PAUSE:
                pause = FIRST_PAUSE
            with self._changed:
                self._changed.wait_for(lambda: self._ended, pause)
            pause = min(2.0 * pause, LONGEST_PAUSE)

    def _serve(self, due: float) -> None:
        retry = time.monotonic()
        while True:
            now = time.monotonic()
            if now >= due:
                due = self._link.read(now)
            if now >= retry:
                retry = now + RETRY_PERIOD
                with self._changed:
                    self._waiting.retry_refused()
            with self._changed:
                wait = min(due, retry) - time.monotonic()
                self._changed.wait_for(lambda: self._ended or self._waiting, max(0.0, wait))
                if self._ended:
                    return
                values = self._waiting.take() if self._waiting else {}
                self._busy = bool(values)
            if values:
                self._write(values)

    def _write(self, values: Mapping[Place, Number]) -> None:
        refused = self._link.write(values)
        with self._changed:
            before = len(self._waiting.refused)
            self._waiting.confirm(values, refused)
            self._busy = False
            overtaken = '' if self._waiting else self._overtaken()
            if overtaken:
                self._news.append(f'{self._name}: {overtaken}')
            self._changed.notify_all()
            if refused or before:
                self._state_problems()
        if refused or before or overtaken:
            self._notify()

    def _receive(self, arrivals: Iterable[Arrival]) -> None:
        with self._changed:
            quiet = not self._arrivals
            for arrival in arrivals:
                self._arrivals.append(arrival)
                self._lost_arrivals += arrival.lost
            while len(self._arrivals) > MOST_ARRIVALS:
                self._arrivals.popleft()
                self._lost_arrivals += 1
        if quiet:
            self._notify()

    def _set_up(self) -> None:
        with self._changed:
            self._down = ''
            self._waiting.start_again()
            overtaken = self._overtaken()
            self._news.append(f'{self._name}: connected{"; " if overtaken else ""}{overtaken}')
            self._state_problems()
        self._notify()

    def _overtaken(self) -> str:
        count, self._waiting.overtaken = self._waiting.overtaken, 0
        return f'{count} values of outputs were overtaken by newer ones' if count else ''

    def _set_down(self, reason: str) -> None:
        with self._changed:
            self._down = f'{self._name}: {reason}; connecting again and again'
            self._busy = False
            self._state_problems()
            self._changed.notify_all()
        self._notify()

    def _notify(self) -> None:
        if not self._ended:
            self._wake()

    def _state_problems(self) -> None:
        problems = {'connection': self._down} if self._down else {}
        refused = self._waiting.refused
        if refused and not self._down:
            place, why = next(iter(refused.items()))
            others = f' and {len(refused) - 1} more outputs' if len(refused) > 1 else ''
            problems['refused'] = f'{self._name}: refuses {place.text}{others}, tried again and again: {why}'
        self._problems = problems


def connect(server: PlantServer, rows: Sequence[IoRow], wake: Callable[[], None]) -> PlantConnection:
    """The connection of a server, which has the places of some rows; it connects by itself.

    Raises:
        InvalidInputError: the protocol's library is not installed.
    """
    inputs: dict[Place, float] = {}
    outputs: dict[Place, None] = {}
    for row in rows:
        if row.channel.direction == 'output':
            outputs[row.place] = None
        else:
            inputs[row.place] = min(row.period, inputs.get(row.place, row.period))
    try:
        link = server.link(inputs, outputs)
    except InvalidInputError as error:
        raise rows[0].error(error.message) from None
    return PlantConnection(server.port, link, wake)
