"""Traffic: which messages between participants are still on their way."""

from collections import defaultdict
from collections.abc import Sequence
from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.ros.lockstep.protocol import Endpoint

CLOSED: Final = -1
"""Count of a subscription that has ended."""

_Place = tuple[str, int]  # participant and number of its endpoint


class Traffic:
    """Compares what was sent with what was received, by counts that only grow.

    A subscription waits until it has received as many messages as the participants that it matches have
    sent; more than that come from publishers that do not take part.
    """

    def __init__(self) -> None:
        self._endpoints: dict[str, tuple[Endpoint, ...]] = {}
        self._counts: dict[_Place, int] = {}
        self._sent: dict[tuple[str, bool], int] = defaultdict(int)  # by topic; latched alone
        self._requests: dict[str, int] = defaultdict(int)
        self._receivers: dict[str, list[_Place]] = defaultdict(list)
        self._servers: set[str] = set()
        self.publishers: dict[str, list[str]] = defaultdict(list)
        """The participants that publish a topic; one that has two publishers of it twice."""
        self.polled: dict[str, None] = {}
        """Topics that are polled, in the order in which they were announced."""
        self._late: set[_Place] = set()
        self._early: dict[_Place, int] = {}  # counts of endpoints that have not joined yet

    def join(self, participant: str, endpoints: Sequence[Endpoint]) -> None:
        """Count a participant's endpoints; called again, those that were added.

        Raises:
            InvalidInputError: a polled topic has a second publisher.
        """
        known = len(self._endpoints.get(participant, ()))
        if known == len(endpoints):
            return
        self._endpoints[participant] = tuple(endpoints)
        for index, endpoint in enumerate(endpoints[known:], known):
            place = (participant, index)
            self._counts[place] = 0
            if endpoint.kind == 'service':
                self._servers.add(endpoint.name)
            elif endpoint.kind == 'publisher':
                self.publishers[endpoint.name].append(participant)
            elif endpoint.kind == 'polled':
                self.polled[endpoint.name] = None
            if endpoint.kind in {'subscription', 'service'}:
                self._receivers[endpoint.name].append(place)
        for topic in self.polled:
            publishers = self.publishers.get(topic, ())
            if len(publishers) > 1:
                raise InvalidInputError(
                    f'{topic} is published by {" and by ".join(publishers)}; in lock-step a topic whose '
                    'newest message is polled has one publisher'
                )
        for place in [one for one in self._early if one[0] == participant and one[1] < len(endpoints)]:
            self.count(*place, self._early.pop(place))

    def sent(self, topic: str) -> int:
        """Messages that participants have sent on a topic."""
        return self._sent[topic, False]

    def count(self, participant: str, index: int, count: int) -> None:
        """Take a participant's new count of an endpoint."""
        place, endpoints = (participant, index), self._endpoints.get(participant, ())
        if index >= len(endpoints):
            self._early[place] = count
            return
        endpoint = endpoints[index]
        more = count - self._counts[place]
        self._counts[place] = count
        if endpoint.kind == 'publisher':
            self._sent[endpoint.name, False] += more
            if endpoint.latched:
                self._sent[endpoint.name, True] += more
            for receiver in self._receivers[endpoint.name]:
                self._compare(receiver)
        elif endpoint.kind == 'requests':
            self._requests[endpoint.name] += more
            self._compare((participant, index + 1))
            for receiver in self._receivers[endpoint.name]:
                self._compare(receiver)
        elif endpoint.kind != 'polled':
            self._compare(place)

    @property
    def quiet(self) -> bool:
        """Everything sent has been received and handled."""
        return not (self._late or self._early)

    def on_the_way(self) -> list[str]:
        """Each endpoint that has not received everything, as text for a person."""
        return [
            f'{participant} has received {self._counts[participant, index]} of {self._wanted(place)} '
            f'{"requests" if endpoint.kind == "service" else "messages"} on {endpoint.name}'
            for place in sorted(self._late)
            for participant, index in [place]
            for endpoint in [self._endpoints[participant][index]]
        ]

    def _compare(self, place: _Place) -> None:
        count = self._counts[place]
        if count == CLOSED or count >= self._wanted(place):
            self._late.discard(place)
        else:
            self._late.add(place)

    def _wanted(self, place: _Place) -> int:
        participant, index = place
        endpoint = self._endpoints[participant][index]
        if endpoint.kind == 'service':
            return self._requests[endpoint.name]
        if endpoint.kind == 'replies':
            return self._counts[participant, index - 1] if endpoint.name in self._servers else 0
        return self._sent[endpoint.name, endpoint.latched]
