"""SharedZone: mutual exclusion of the robots that share a zone, without an arbiter."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final

from robots_core.errors import InvalidInputError

LARGEST: Final = 2**62
MOST_GRANTS: Final = 64  # robots


@dataclass(frozen=True, order=True)
class Claim:
    """A robot's claim to a zone.

    Attributes:
        number: Above those of all claims that the robot had received; the lower one goes first.
        life: Of the process that claims: a claim from before a restart is another one.
    """

    number: int
    life: int


@dataclass(frozen=True)
class ZoneState:
    """What a robot publishes for the others.

    Attributes:
        claim: Its claim; None for none.
        granted: The newest claims of others that it has granted, by their names.
    """

    claim: Claim | None = None
    granted: Mapping[str, Claim] = field(default_factory=lambda: MappingProxyType({}))

    def text(self) -> str:
        """For a message."""
        granted = {name: [claim.number, claim.life] for name, claim in self.granted.items()}
        claim = None if self.claim is None else [self.claim.number, self.claim.life]
        return json.dumps({'claim': claim, 'granted': granted})


def parse_zone_state(text: str) -> ZoneState:
    """The state in a text of `ZoneState.text`.

    Raises:
        InvalidInputError: another text.
    """
    try:
        found = json.loads(text)
        granted, claim = found['granted'], found['claim']
        if len(granted) <= MOST_GRANTS:
            claims = {str(name): _claim(pair) for name, pair in granted.items()}
            return ZoneState(None if claim is None else _claim(claim), MappingProxyType(claims))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        pass
    raise InvalidInputError(f'{text[:80]!r} is no state of a shared zone')


def _claim(pair: Any) -> Claim:
    number, life = pair
    if not all(type(value) is int and 0 <= value <= LARGEST for value in (number, life)):
        raise ValueError
    return Claim(number, life)


class SharedZone:
    """One robot's part in the mutual exclusion of Ricart and Agrawala (1981), on latched states.

    A robot claims the zone, and has it when all others have granted this claim. It grants the claim of
    another one unless it has the zone or is inside, or has claimed it before: a claim's number is above those
    that its robot had received, and among equal numbers the names decide. As only the newest state of each
    robot counts, states may come late, and some may be skipped. A robot that is silent or has died grants
    nothing, and keeps what it has.

    Args:
        name: Of this robot.
        others: Names of those that share the zone.
        life: Of this process, random.
    """

    def __init__(self, name: str, others: Iterable[str], life: int) -> None:
        self._name, self._others, self._life = name, tuple(others), life
        self._received: dict[str, ZoneState] = {}
        self._number = 0  # the highest known
        self.state = ZoneState()
        """For the others."""
        self.mine = False
        """This robot may be inside."""

    @property
    def missing(self) -> tuple[str, ...]:
        """The robots that have not granted the claim of this one."""
        claim = self.state.claim
        return tuple(name for name in self._others if claim is None or not self._granted_by(name, claim))

    def receive(self, name: str, state: ZoneState) -> None:
        """Take the newest state of another robot."""
        self._received[name] = state
        claims = [*state.granted.values(), *([] if state.claim is None else [state.claim])]
        self._number = max(self._number, *(claim.number for claim in claims), 0)

    def step(self, *, needed: bool, inside: bool | None) -> None:
        """Claim and grant.

        Args:
            needed: The robot comes near the border.
            inside: It is across the border; None if that is unknown.
        """
        claim = self.state.claim
        if claim is None and (needed or inside):
            self._number += 1
            claim = Claim(self._number, self._life)
        elif not needed and inside is False:
            claim, self.mine = None, False
        # In this order: a robot that has granted the claim of this one may have claimed the zone since.
        if claim is not None and all(self._granted_by(name, claim) for name in self._others):
            self.mine = True
        free, granted = inside is False and not self.mine, {}
        for name, state in self._received.items():
            theirs = state.claim
            if theirs is None:
                continue
            yields = free and (claim is None or (theirs.number, name) < (claim.number, self._name))
            if yields or self.state.granted.get(name) == theirs:
                granted[name] = theirs
        if (claim, granted) != (self.state.claim, dict(self.state.granted)):
            self.state = ZoneState(claim, MappingProxyType(granted))

    def _granted_by(self, name: str, claim: Claim) -> bool:
        state = self._received.get(name)
        return state is not None and state.granted.get(self._name) == claim
