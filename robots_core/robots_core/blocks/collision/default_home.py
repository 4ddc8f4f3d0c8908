"""Joint positions to start from, for a robot whose maker states none: no singularity, no contact."""

from collections.abc import Iterator
from itertools import combinations, product
from math import pi
from typing import Final

import numpy as np

from robots_core.blocks.collision.allowed_pair_sampling import always_in_contact, distant_pairs
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array

# In the order in which they are tried; axes that slide move by the same parts of their range.
TURNS: Final = tuple(sign * angle for angle in (pi / 6, pi / 3, pi / 2) for sign in (1.0, -1.0))
MOST_TURNED: Final = 3  # axes
SAMPLES: Final = 200
# m, to itself, where there are such joint positions: what planners keep clear, and room to move besides.
GAP: Final = 5e-3
WIDE_GAP: Final = 0.02
MORE: Final = 200  # joint positions that are tried for the wide gap after one with the other
# The smallest singular value of the Jacobian must reach this part of its median over the range.
REGULAR: Final = 0.3
RANK: Final = 1e-6  # relative to the largest singular value


def default_home(robot: BaseRobotModel, start: Array) -> Array:
    """`start`, if it is neither near a singularity nor in contact with itself; else the nearest that is not.

    Up to three axes are turned by multiples of 30 degrees; where nothing of that is valid, it is `start`,
    (n,) rad (m). The robot's own `home` is not asked for.
    """
    free = _Contacts(robot)
    regular = _Regularity(robot)
    good: list[Array] = []
    near: Array | None = None
    left = MORE
    # The first of thousands of candidates are usually enough.
    for q in _candidates(robot, start):
        if not regular.holds(q):
            continue
        if free.holds(q, WIDE_GAP):
            return q
        if near is None:
            near = q if free.holds(q, GAP) else None
            good.append(q)
        else:
            left -= 1
            if not left:
                break
    if near is not None:
        return near
    return next((q for q in good if free.holds(q, 0.0)), start)


def _candidates(robot: BaseRobotModel, start: Array) -> Iterator[Array]:
    yield start
    axes = robot.axes_data
    low, high = axes.one_turn
    step = np.where(axes.prismatic, (high - low) / (2.0 * pi), 1.0)
    for count in range(1, min(MOST_TURNED, robot.num_axes) + 1):
        found = []
        for chosen in combinations(range(robot.num_axes), count):
            for turns in product(TURNS, repeat=count):
                q = start.copy()
                q[list(chosen)] += np.array(turns) * step[list(chosen)]
                if ((q >= low) & (q <= high)).all():
                    found.append((sum(map(abs, turns)), q))
        yield from (q for _, q in sorted(found, key=lambda item: item[0]))


class _Regularity:
    """Whether the tool can move in all directions in which it can move elsewhere."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self._robot = robot
        low, high = robot.axes_data.one_turn
        samples = np.random.default_rng(0).uniform(low, high, (SAMPLES, robot.num_axes))
        J = np.array([robot.jacobian(q) for q in samples])
        # Metres per radian, so that lengths count as turns do.
        self._length = max(float(np.linalg.norm(J[:, :3], axis=1).max()), RANK)
        values = np.array([self._values(one) for one in J])
        self._last = int(np.median((values > RANK * values[:, :1]).sum(axis=1))) - 1
        self._least = REGULAR * float(np.median(values[:, self._last]))

    def _values(self, J: Array) -> Array:
        scaled = np.vstack([J[:3] / self._length, J[3:]])
        return np.asarray(np.linalg.svd(scaled, compute_uv=False), dtype=np.float64)

    def holds(self, q: Array) -> bool:
        return bool(self._values(self._robot.jacobian(q))[self._last] >= self._least)


class _Contacts:
    """Whether shapes that are not always in contact are apart."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self._solids, names = distant_pairs(robot)
        stored = robot.collision_model.allowed_pairs
        if stored is None:
            allowed = always_in_contact(self._solids, robot, names, SAMPLES)
        else:
            allowed = {name for name in names if stored.allows(*name)}
        self._checked = np.array([k for k, name in enumerate(names) if name not in allowed], dtype=np.int64)

    def holds(self, q: Array, gap: float) -> bool:
        self._solids.place(q)
        return bool((self._solids.distances(self._checked, np.full(self._checked.size, gap)) > gap).all())
