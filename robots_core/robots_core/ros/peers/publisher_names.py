"""PublisherNames: full node names of a topic's publishers."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

PATIENCE: Final = 0.1  # s: a message may come before the name of its publisher's node
CHECK_PERIOD: Final = 0.005  # s

UNKNOWN: Final = 'an unknown node'


@dataclass(frozen=True)
class Sender:
    """Where a message comes from.

    Attributes:
        name: The node's full name; '' where the middleware does not identify publishers, and in lock-step.
        time: When it was sent, ns on the clock of the sender's system; 0 where that is not known.
    """

    name: str = ''
    time: int = 0


class PublisherNames:
    """Looks up by a publisher's identity which node it belongs to.

    Args:
        publishers: Full node names by identity, of all publishers that are known.
    """

    def __init__(self, publishers: Callable[[], Mapping[bytes, str]]) -> None:
        self._publishers = publishers
        self._names: dict[bytes, str] = {}

    def name(self, identity: bytes) -> str:
        """The node's full name; for the first message of a publisher this may take `PATIENCE`."""
        deadline = time.monotonic() + PATIENCE
        while identity not in self._names:
            self._names = dict(self._publishers())
            if identity in self._names:
                break
            if time.monotonic() >= deadline:
                return UNKNOWN
            time.sleep(CHECK_PERIOD)
        return self._names[identity]
