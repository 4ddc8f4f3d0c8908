"""MessageLog: what happened in the cell, newest first."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final

LONGEST: Final = 500


class Level(IntEnum):
    """How bad it is."""

    INFO = 0
    WARNING = 1
    ERROR = 2


@dataclass(frozen=True)
class LoggedMessage:
    """One message, however often it came.

    Attributes:
        time: When it came last, s since 1970.
        level: How bad it is.
        node: Who said it.
        text: For a person.
        place: Where the program was when it came last, such as 'welding.lua:12'; '' while none ran.
        count: How often it came since it was acknowledged.
        acknowledged: A person has taken note of it.
    """

    time: float
    level: Level
    node: str
    text: str
    place: str = ''
    count: int = 1
    acknowledged: bool = False


class MessageLog:
    """Keeps the newest messages; those that repeat are counted. Safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._messages: OrderedDict[tuple[str, str, Level], LoggedMessage] = OrderedDict()
        self.version = 0
        """Another one after each change."""

    def add(self, time: float, level: Level, node: str, text: str, place: str = '') -> None:
        """Add a message."""
        key = node, text, level
        with self._lock:
            before = self._messages.pop(key, None)
            again = before is not None and not before.acknowledged
            count = before.count + 1 if before is not None and again else 1
            self._messages[key] = LoggedMessage(time, level, node, text, place, count)
            while len(self._messages) > LONGEST:
                self._messages.popitem(last=False)
            self.version += 1

    def acknowledge(self, messages: Iterable[LoggedMessage]) -> None:
        """Acknowledge messages that `shown` has returned, except those that have come again since."""
        with self._lock:
            for message in messages:
                key = message.node, message.text, message.level
                if self._messages.get(key) is message:
                    self._messages[key] = replace(message, acknowledged=True)
            self.version += 1

    def shown(self, lowest: Level = Level.INFO, part: str = '') -> list[LoggedMessage]:
        """Messages of at least a level whose text, node or place contains a part, newest first."""
        wanted = part.casefold()
        with self._lock:
            messages = [*self._messages.values()]
        return [
            message
            for message in reversed(messages)
            if message.level >= lowest
            and wanted in f'{message.node} {message.place} {message.text}'.casefold()
        ]

    @property
    def pending(self) -> int:
        """Number of warnings and errors that nobody has acknowledged."""
        with self._lock:
            return sum(one.level >= Level.WARNING and not one.acknowledged for one in self._messages.values())
