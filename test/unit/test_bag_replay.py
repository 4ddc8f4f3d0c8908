"""What of a bag is published when."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.recording.bag_file import Bag, BagTopic, read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_core.errors import RobotsError
from written_bags import BAG_TYPES, write_bag

T = BAG_TYPES.types


def number(value: float) -> Any:
    return T['std_msgs/msg/Float64'](value)


def text(value: str) -> Any:
    return T['std_msgs/msg/String'](value)


ROWS = [
    *[(0.0, '/mode', text('a')), (0.5, '/mode', text('b')), (1.0, '/level', number(1.0))],
    *[(2.0, '/mode', text('c')), (3.0, '/level', number(3.0)), (4.0, '/other', number(4.0))],
]


@pytest.fixture
def bag(tmp_path: Path) -> Bag:
    return read_bag(write_bag(tmp_path / 'bag', ROWS, latched=['/mode']))


def said(data: bytes) -> str:
    return str(BAG_TYPES.deserialize_cdr(data, 'std_msgs/msg/String').data)


def test_the_state_of_latched_topics_comes_first(bag: Bag):
    plan = replay_plan(bag)
    assert [(topic, said(data)) for topic, data in plan.state] == [('/mode', 'b')]
    assert [(due, topic) for due, topic, _ in plan.timeline] == [
        *[(0.0, '/level'), (1.0, '/mode'), (2.0, '/level'), (3.0, '/other')]
    ]
    assert plan.duration == 3.0


def test_a_later_start_has_a_later_state(bag: Bag):
    plan = replay_plan(bag, start=2.5)
    assert [said(data) for _, data in plan.state] == ['c']
    assert [(due, topic) for due, topic, _ in plan.timeline] == [(0.5, '/level'), (1.5, '/other')]


def test_topics_are_chosen_and_renamed(bag: Bag):
    plan = replay_plan(bag, topics=['/level'], remaps={'/level': '/press/level'})
    assert set(plan.topics) == {'/press/level'}
    assert [topic for _, topic, _ in plan.timeline] == ['/press/level'] * 2
    assert plan.state == ()


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        ({'topics': ['/no']}, "has no topic '/no'; its topics are /level, /mode, /other"),
        ({'remaps': {'/no': '/a'}}, "has no topic '/no'"),
        ({'remaps': {'/level': '/other'}}, 'two topics would be published as /other'),
    ],
)
def test_what_does_not_fit_is_reported(bag: Bag, options: dict[str, Any], message: str):
    with pytest.raises(RobotsError, match=message):
        replay_plan(bag, **options)


TOPICS = {
    name: BagTopic(name, 'std_msgs/msg/Empty', latched) for name, latched in (('/s', True), ('/m', False))
}
MESSAGES = st.lists(
    st.tuples(st.sampled_from(sorted(TOPICS)), st.integers(0, 10**10)), min_size=1, max_size=20
)


@given(MESSAGES, st.floats(0.1, 10.0), st.one_of(st.just(0.0), st.floats(0.01, 8.0)))
def test_every_message_is_in_the_timeline_or_before_the_start(
    messages: list[tuple[str, int]], rate: float, start: float
):
    messages.sort(key=lambda message: message[1])
    rows = tuple((topic, stamp, str(index).encode()) for index, (topic, stamp) in enumerate(messages))
    plan = replay_plan(Bag(Path('bag'), TOPICS, rows), rate=rate, start=start)
    kept = [(due, data) for due, _, data in plan.timeline]
    earlier = rows[: len(rows) - len(kept)]
    assert [data for _, data in kept] == [data for _, _, data in rows[len(earlier) :]]
    state = [data for topic, _, data in earlier if topic == '/s']
    assert [data for _, data in plan.state] == state[-1:]
    for (due, _), (_, stamp, _) in zip(kept, rows[len(earlier) :], strict=True):
        # Differences of the recorded times, divided by the rate; to the rounding of the start to ns.
        assert (due - kept[0][0]) * rate == pytest.approx(1e-9 * (stamp - rows[len(earlier)][1]), abs=1e-6)
        assert due >= 0.0
