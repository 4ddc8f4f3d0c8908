"""DriveFaults: simulated failures of drives and encoders, for tests of the rest of the system."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robots_core.errors import InvalidInputError
from robots_core.validation import Array


@dataclass(frozen=True)
class DriveFaults:
    """The active faults; none by default.

    Attributes:
        stopped: Axes whose drives stop following and hold the reference of that moment.
        frozen: Axes whose encoders report the same position from now on, at rest.
        lost: Axes that are missing in the feedback.
        noise: Standard deviation of the reported positions, rad (m).

    Raises:
        InvalidInputError: noise below zero or not finite.
    """

    stopped: frozenset[str] = frozenset()
    frozen: frozenset[str] = frozenset()
    lost: frozenset[str] = frozenset()
    noise: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.noise < np.inf:
            raise InvalidInputError(f'noise = {self.noise!r} rad must be a finite number, 0 or above')


def known_axes(names: Sequence[str], chosen: Iterable[str]) -> frozenset[str]:
    """The axes chosen, without empty names.

    Raises:
        InvalidInputError: one that does not exist.
    """
    axes = frozenset(axis for axis in chosen if axis)
    unknown = sorted(axes - set(names))
    if unknown:
        raise InvalidInputError(f'no axis is called {unknown[0]!r}; axes are {", ".join(names)}')
    return axes


class FaultInjection:
    """Applies faults to references and to the feedback of the drives.

    Args:
        names: Names of the axes, n of them.
        seed: Of the noise.
    """

    def __init__(self, names: Sequence[str], *, seed: int = 0) -> None:
        self._names = tuple(names)
        self._rng = np.random.default_rng(seed)
        self.faults = DriveFaults()
        """The active faults; may be set at any time."""
        self._held: dict[int, float] = {}
        self._seen: dict[int, float] = {}

    def reference(self, q_ref: Array, q_dot_ref: Array) -> tuple[Array, Array]:
        """The reference (n,) and its velocity (n,) that reach the drives."""
        self._held = self._kept(self.faults.stopped, self._held, q_ref)
        if not self._held:
            return q_ref, q_dot_ref
        return _replaced(q_ref, self._held), _replaced(q_dot_ref, dict.fromkeys(self._held, 0.0))

    def feedback(self, q: Array, q_dot: Array) -> tuple[Array, Array, list[int]]:
        """Positions and velocities (n,) that the encoders report, and indices of the axes that do report."""
        if self.faults.noise > 0.0:
            q = q + self._rng.normal(0.0, self.faults.noise, q.size)
        self._seen = self._kept(self.faults.frozen, self._seen, q)
        if self._seen:
            q, q_dot = _replaced(q, self._seen), _replaced(q_dot, dict.fromkeys(self._seen, 0.0))
        return q, q_dot, [i for i, name in enumerate(self._names) if name not in self.faults.lost]

    def _kept(self, axes: frozenset[str], before: dict[int, float], values: Array) -> dict[int, float]:
        if not axes:
            return {}
        return {i: before.get(i, float(values[i])) for i, name in enumerate(self._names) if name in axes}


def _replaced(values: Array, others: dict[int, float]) -> Array:
    changed = np.array(values)
    changed[list(others)] = list(others.values())
    return changed
