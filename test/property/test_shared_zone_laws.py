"""Robots share a zone: never two are inside, whatever is late or restarted, and each gets its turn."""

from __future__ import annotations

from itertools import count

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.control.zones.shared_zone import Claim, SharedZone, ZoneState, parse_zone_state
from robots_core.errors import InvalidInputError

NAMES = ('/a', '/b', '/c')


class Robots:
    """Robots whose states reach each other when the test lets them."""

    def __init__(self, number: int) -> None:
        self.names = NAMES[:number]
        self.lives = count(1)
        self.zones = {name: self.fresh(name) for name in self.names}
        self.inside = dict.fromkeys(self.names, False)
        self.needed = dict.fromkeys(self.names, False)

    def fresh(self, name: str) -> SharedZone:
        return SharedZone(name, [other for other in self.names if other != name], next(self.lives))

    def step(self, name: str, *, known: bool = True) -> None:
        inside = self.inside[name] if known else None
        self.zones[name].step(needed=self.needed[name], inside=inside)

    def deliver(self, sender: str, receiver: str) -> None:
        if sender != receiver:
            self.zones[receiver].receive(sender, parse_zone_state(self.zones[sender].state.text()))

    def move(self, name: str) -> None:
        """Into the zone if the robot may, or out of it."""
        if self.inside[name]:
            self.inside[name] = self.needed[name] = False
        elif self.zones[name].mine:
            self.inside[name] = True

    def check(self) -> None:
        assert sum(self.inside.values()) <= 1
        assert sum(zone.mine for zone in self.zones.values()) <= 1


@given(
    st.integers(2, 3),
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 2), st.integers(0, 2)), max_size=120),
)
def test_never_two_are_inside(number: int, actions: list[tuple[int, int, int]]) -> None:
    robots = Robots(number)
    for action, one, other in actions:
        name, second = robots.names[one % number], robots.names[other % number]
        match action:
            case 0:
                robots.step(name)
            case 1 | 2:
                robots.deliver(name, second)
            case 3:
                robots.needed[name] = not robots.needed[name] or robots.inside[name]
            case 4:
                robots.move(name)
            case 5:  # the process is started again, and does not know at once where its robot is
                robots.zones[name] = robots.fresh(name)
                robots.step(name, known=False)
        robots.check()


@given(st.integers(2, 3), st.randoms(use_true_random=False))
def test_each_gets_its_turn(number: int, random: object) -> None:
    robots = Robots(number)
    waiting = set(robots.names)
    robots.needed = dict.fromkeys(robots.names, True)
    for _ in range(40):
        order = [(a, b) for a in robots.names for b in robots.names]
        random.shuffle(order)  # type: ignore[attr-defined]
        for sender, receiver in order:
            robots.deliver(sender, receiver)
            robots.step(receiver)
            robots.check()
        for name in robots.names:
            robots.move(name)
            if robots.inside[name]:
                waiting.discard(name)
    assert not waiting


def test_a_silent_robot_grants_nothing_and_is_named() -> None:
    zone = SharedZone('/a', ['/b', '/c'], 1)
    zone.step(needed=True, inside=False)
    zone.receive('/c', ZoneState(None, {'/a': zone.state.claim}))  # type: ignore[dict-item]
    zone.step(needed=True, inside=False)
    assert not zone.mine
    assert zone.missing == ('/b',)


def test_a_grant_from_before_a_restart_does_not_count() -> None:
    zone = SharedZone('/a', ['/b'], 2)
    zone.receive('/b', ZoneState(None, {'/a': Claim(1, life=1)}))
    zone.step(needed=True, inside=False)
    assert not zone.mine


def test_a_robot_that_starts_inside_lets_nobody_in() -> None:
    zone = SharedZone('/a', ['/b'], 1)
    for inside in (None, True):
        zone.receive('/b', ZoneState(Claim(1, 7)))
        zone.step(needed=False, inside=inside)
        assert not zone.state.granted
    zone.step(needed=False, inside=False)
    assert zone.state.granted == {'/b': Claim(1, 7)}


@given(st.text() | st.recursive(st.none() | st.integers() | st.text(), st.lists).map(str))
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(InvalidInputError, match='is no state of a shared zone'):
        parse_zone_state(text)


@pytest.mark.parametrize(
    'text',
    [
        '{"claim": [1], "granted": {}}',
        '{"claim": [1, -2], "granted": {}}',
        '{"claim": [true, 2], "granted": {}}',
        '{"claim": [1.5, 2], "granted": {}}',
        '{"claim": null, "granted": []}',
        '{"claim": null, "granted": {"/a": 3}}',
        '{"claim": [1, 1e400], "granted": {}}',
        '[' * 100_000,
    ],
)
def test_states_of_another_form_are_refused(text: str) -> None:
    with pytest.raises(InvalidInputError, match='is no state of a shared zone'):
        parse_zone_state(text)
