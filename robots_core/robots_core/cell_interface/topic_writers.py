"""Which nodes publish what moves a robot: what others publish there is dropped."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

SILENCE: Final = 0.5  # s after which the writer of a stream has lost its place
CHECK_PERIOD: Final = 0.1  # s between lookups of a publisher's name


@dataclass(frozen=True)
class Writers:
    """The nodes that may write to a topic.

    Attributes:
        nodes: Names of the suite's nodes that write to it.
        places: As long as fewer nodes write, another one may, in the place of one of the suite.
        stream: There is a single writer, whose messages follow each other closely.
        state: Each message is sent once: one that comes before the name of its publisher waits for it.
    """

    nodes: tuple[str, ...]
    places: int = 1
    stream: bool = False
    state: bool = False

    def foreign(self, names: set[str], namespace: str, *, places: bool) -> set[str]:
        """The nodes that have no place here, of all that publish the topic.

        What a restart has left behind has the name of one of the suite.

        Args:
            names: Full names of nodes.
            namespace: Where the suite's nodes are.
            places: Other nodes may take the places that are free.
        """
        suite = names & {f'{namespace.rstrip("/")}/{name}' for name in self.nodes}
        others, free = names - suite, max(0, self.places - len(suite)) if places else 0
        return others if len(others) > free else set()


WRITERS: Final[Mapping[str, Writers]] = {
    'joint_reference': Writers(('controller_node',), stream=True),
    'joint_states': Writers(('drive_node',), stream=True),
    'drives_on': Writers(('controller_node',), state=True),
    'joint_trajectory': Writers(('planning_node', 'inverse_kinematics_node')),
    'motion_result': Writers(('controller_node', 'planning_node'), places=2),
    'commander': Writers(('controller_node',), state=True),
    'operating_mode': Writers(('controller_node',), state=True),
    'run_enabled': Writers(('controller_node',), state=True),
    'guide': Writers(('lua_program_node',), state=True),
}
"""By topic. In the place of `drive_node` stands any driver; in that of the others a user's own node may."""


@dataclass
class WriterWatch:
    """Decides by the identity of its publisher whether a message of a topic is accepted.

    The first writer of a stream keeps its place until it is silent for `SILENCE`, or until the suite's own
    node comes: a restarted node takes the place of the one before. On other topics a node of
    the suite may always write, and another one as long as a place is free, until the suite's own write.

    Args:
        topic: Its name in `WRITERS`.
        namespace: Where the suite's nodes are, ending with a slash.
        publishers: Full node names by identity, of all publishers that are known.
        on_stranger: Called with a line of text when messages are dropped.
    """

    topic: str
    namespace: str
    publishers: Callable[[], Mapping[bytes, str]]
    on_stranger: Callable[[str], None]
    _writers: dict[bytes, str] = field(default_factory=dict)  # with their nodes' names
    _strangers: dict[bytes, float] = field(default_factory=dict)  # with the time of the last check
    _unnamed: set[bytes] = field(default_factory=set)  # of a state
    _last: float = -math.inf  # of a stream

    def accepts(self, identity: bytes, now: float) -> bool:
        """A message at `now`, s, is of a writer, by its publisher's identity."""
        if identity in self._writers:
            self._last = now
            return True
        if now - self._strangers.get(identity, -math.inf) < CHECK_PERIOD:
            return False
        names = self.publishers()
        self._unnamed.discard(identity)
        if not self._has_place(identity, names, now):
            self._strangers[identity] = now
            if WRITERS[self.topic].state and identity not in names:
                self._unnamed.add(identity)
                return False
            self.on_stranger(self._described(names.get(identity, 'an unknown node')))
            return False
        if WRITERS[self.topic].stream:
            self._writers.clear()
        self._writers[identity] = names.get(identity, '')
        self._strangers.pop(identity, None)
        self._last = now
        self._make_room()
        return True

    def waits(self, identity: bytes) -> bool:
        """A message that was not accepted is to be offered again: its publisher has no name yet."""
        return identity in self._unnamed

    def _make_room(self) -> None:
        """Others lose their places when the suite's own nodes have taken all of them."""
        own = {one: name for one, name in self._writers.items() if name in self._own}
        if len({*own.values()}) >= WRITERS[self.topic].places:
            self._writers = own

    @property
    def _own(self) -> set[str]:
        return {self.namespace + name for name in WRITERS[self.topic].nodes}

    def _has_place(self, identity: bytes, names: Mapping[bytes, str], now: float) -> bool:
        writers = WRITERS[self.topic]
        own = self._own
        name = names.get(identity, '')
        if writers.stream:
            (present,) = self._writers or [b'']
            outranks = name in own and names.get(present, name) not in own
            return not self._writers or outranks or now - self._last > SILENCE
        others = {one for one in names.values() if one != name}
        taken = others & (own | {*self._writers.values()})
        return name in own or len(taken) < writers.places

    def _described(self, stranger: str) -> str:
        writers = ' and '.join(sorted({*self._writers.values()} - {''}) or WRITERS[self.topic].nodes)
        return f'{stranger} publishes {self.topic} beside {writers}; its messages are dropped'
