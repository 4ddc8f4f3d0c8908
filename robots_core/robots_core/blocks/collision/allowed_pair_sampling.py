"""Pairs of a robot's shapes that need no collision check, found by sampling joint positions."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from robots_core.blocks.collision.pair_kernels import Indices
from robots_core.blocks.collision.robot_solids import robot_solids
from robots_core.blocks.collision.solid_set import SolidSet
from robots_core.robot_model.allowed_pairs import AllowedPairs, Pair, ordered_pair
from robots_core.robot_model.base_robot_model import BaseRobotModel

SAMPLES = 1000
# Joint positions evaluated for a proof; a pair that needs more stays checked.
BUDGET = 2000
# Boxes over more axes are too many; proofs there get a tenth of the budget.
FEW_AXES = 3
NEVER_GAP = 1e-3  # m


def find_allowed_pairs(robot: BaseRobotModel) -> AllowedPairs:
    """The pairs of a robot's shapes that need no check.

    Pairs that are in contact at all of many random joint positions count as always in contact. Other pairs
    are proven to be always apart, within a budget: the range of the axes between them is bisected into boxes
    until in each one the distance at its centre exceeds the largest approach within the box.

    Args:
        robot: The robot.
    """
    solids = robot_solids(robot)
    frames = {solid.name: solid.frame for solid in solids}
    reasons: dict[Pair, str] = {
        ordered_pair(a, b): 'adjacent' for a, b in combinations(frames, 2) if abs(frames[a] - frames[b]) == 1
    }
    pairs = np.array(
        [
            (i, j)
            for i, j in combinations(range(len(solids)), 2)
            if abs(solids[i].frame - solids[j].frame) > 1
        ],
        dtype=np.int64,
    ).reshape(-1, 2)
    checked = SolidSet(robot, solids, pairs)
    names = [
        ordered_pair(solids[i].name, solids[j].name)
        for i, j in zip(checked.first, checked.second, strict=True)
    ]
    touching = _touching(checked, robot)
    for pair in set(names):
        mine = np.array([name == pair for name in names])
        if touching[:, mine].any(axis=1).all():
            reasons[pair] = 'always'
    reasons.update((pair, 'never') for pair in proven_apart(checked, robot, names, BUDGET))
    return AllowedPairs(reasons)


def _touching(solids: SolidSet, robot: BaseRobotModel) -> NDArray[np.bool_]:
    """Whether each pair is in contact at home and at random joint positions, (SAMPLES + 1, p) bool."""
    low, high = robot.axes_data.one_turn
    every = np.arange(solids.first.size)
    none = np.zeros(every.size)
    random = np.random.default_rng(0).uniform(low, high, (SAMPLES, robot.num_axes))
    result = np.empty((SAMPLES + 1, every.size), dtype=bool)
    for row, q in enumerate((robot.home, *random)):
        solids.place(q)
        result[row] = solids.distances(every, none) <= 0.0
    return result


def proven_apart(solids: SolidSet, robot: BaseRobotModel, names: Sequence[Pair], budget: int) -> set[Pair]:
    """The named pairs that are proven to be apart at all joint positions inside the limits.

    Args:
        solids: Solids with their pairs.
        robot: The robot.
        names: Shapes that the pairs of solids belong to; several may have the same name.
        budget: Joint positions evaluated for the proofs of the pairs between two frames.
    """
    frame = np.array([solid.frame for solid in solids.solids])
    between = np.stack([frame[solids.first], frame[solids.second]], axis=1)
    open_: set[Pair] = set()
    for low, high in np.unique(between, axis=0):
        mine = np.flatnonzero((between == (low, high)).all(axis=1))
        spent = budget if high - low <= FEW_AXES else budget // 10
        open_ |= {names[pair] for pair in _unproven(solids, robot, mine, slice(low, high), spent)}
    return set(names) - open_


def _unproven(solids: SolidSet, robot: BaseRobotModel, pairs: Indices, axes: slice, budget: int) -> set[int]:
    """The pairs that may be closer than the gap for some positions of the axes between them."""
    low, high = robot.axes_data.one_turn
    middle, half = robot.home.copy(), np.zeros(robot.num_axes)
    middle[axes], half[axes] = 0.5 * (low + high)[axes], 0.5 * (high - low)[axes]
    waiting = [(middle, half, pairs)]
    failed: set[int] = set()
    while waiting and budget > 0:
        middle, half, mine = waiting.pop()
        mine = np.array([pair for pair in mine if pair not in failed], dtype=np.int64)
        if mine.size == 0:
            continue
        budget -= 1
        solids.place(middle)
        approach = solids.travels(mine, half)
        lower = solids.distances(mine, approach + NEVER_GAP)
        failed |= {int(pair) for pair in mine[lower <= NEVER_GAP]}
        mine = mine[(lower - approach <= NEVER_GAP) & (lower > NEVER_GAP)]
        if mine.size == 0:
            continue
        # The axis with the largest approach is bisected.
        approaches = [
            solids.travels(mine, np.where(np.arange(half.size) == k, half, 0.0)).max()
            for k in range(half.size)
        ]
        cut = int(np.argmax(approaches))
        half = half.copy()
        half[cut] *= 0.5
        for sign in (-1.0, 1.0):
            centre = middle.copy()
            centre[cut] += sign * half[cut]
            waiting.append((centre, half, mine))
    return failed | {int(pair) for _, _, mine in waiting for pair in mine}
