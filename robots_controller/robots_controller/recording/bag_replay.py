"""ReplayPlan: what of a bag is published when."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from robots_controller.recording.bag_file import Bag, BagTopic
from robots_core.errors import BagError


@dataclass(frozen=True)
class ReplayPlan:
    """Messages of a bag and their times.

    Attributes:
        topics: By the names under which they are published.
        state: Last messages of latched topics before the beginning: (topic, serialized message).
        timeline: (s from the beginning, topic, serialized message), in order.
    """

    topics: Mapping[str, BagTopic]
    state: tuple[tuple[str, bytes], ...] = field(repr=False)
    timeline: tuple[tuple[float, str, bytes], ...] = field(repr=False)

    @property
    def duration(self) -> float:
        """Time from the beginning to the last message, s."""
        return self.timeline[-1][0] if self.timeline else 0.0


def replay_plan(
    bag: Bag,
    *,
    rate: float = 1.0,
    start: float = 0.0,
    topics: Collection[str] = (),
    remaps: Mapping[str, str] = MappingProxyType({}),
) -> ReplayPlan:
    """Plan to publish a bag.

    Args:
        bag: The bag.
        rate: Times faster than recorded.
        start: Where to begin, s after the first message. The last messages of latched topics before it are
            their state. At 0 the beginning is the first message that is not latched.
        topics: Those to publish; all by default.
        remaps: New names of topics.

    Raises:
        RobotsError: a topic that the bag does not have, two topics under one name, or nothing to publish.
    """
    for name in [*topics, *remaps]:
        if name not in bag.topics:
            raise BagError(
                f'{bag.path} has no topic {name!r}; its topics are {", ".join(sorted(bag.topics))}'
            )
    chosen = {name: topic for name, topic in bag.topics.items() if not topics or name in topics}
    names = {name: remaps.get(name, name) for name in chosen}
    if len(set(names.values())) < len(names):
        twice = next(name for name in names.values() if list(names.values()).count(name) > 1)
        raise BagError(f'two topics would be published as {twice}')
    messages = [message for message in bag.messages if message[0] in chosen]
    if not messages:
        raise BagError(f'{bag.path} has no message to publish')
    moving = [stamp for name, stamp, _ in messages if not chosen[name].latched]
    zero = messages[0][1] + round(1e9 * start) if start else (moving or [messages[0][1]])[0]
    state: dict[str, bytes] = {}
    timeline = []
    for name, stamp, data in messages:
        if stamp >= zero:
            timeline.append((1e-9 * (stamp - zero) / rate, names[name], data))
        elif chosen[name].latched:
            state[names[name]] = data
    return ReplayPlan(
        MappingProxyType({names[name]: topic for name, topic in chosen.items()}),
        tuple(state.items()),
        tuple(timeline),
    )
