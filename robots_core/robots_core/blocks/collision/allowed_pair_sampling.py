"""Pairs of a robot's shapes that need no collision check, found by sampling joint positions."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from robots_core.blocks.collision.distances.nearest_points import Indices
from robots_core.blocks.collision.distances.solid_set import SolidSet
from robots_core.blocks.collision.robot_solids import is_large, robot_solids
from robots_core.blocks.collision.solids import Solid
from robots_core.files.content_cache import Arrays, cache_folder, content_of, kept
from robots_core.robot_model.allowed_pairs import AllowedPairs, Pair, ordered_pair
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Mesh

SAMPLES = 1000
# Joint positions evaluated for a proof; a pair that needs more stays checked.
BUDGET = 2000
# Boxes over more axes are too many; proofs there get a tenth of the budget.
FEW_AXES = 3
NEVER_GAP = 1e-3  # m
# What is never farther apart counts as always in contact: planners that keep 5 mm would refuse all motions.
ALWAYS_GAP = 6e-3  # m


def allowed_pairs_of(robot: BaseRobotModel) -> AllowedPairs:
    """The pairs stored with the robot. If there are none, they are sampled, and cached for large meshes."""
    stored = robot.collision_model.allowed_pairs
    if stored is not None:
        return stored
    solids = robot_solids(robot)
    meshes = [solid.geometry for solid in solids if isinstance(solid.geometry, Mesh)]
    if not is_large(meshes):
        return find_allowed_pairs(robot)

    def found() -> Arrays:
        reasons = find_allowed_pairs(robot).reasons
        return {'reasons': np.array([(*pair, reason) for pair, reason in reasons.items()]).reshape(-1, 3)}

    announce = f'{robot.name}: finding the links that can collide (once; kept in {cache_folder()})'
    rows = kept('allowed_pairs', _content(robot, solids), found, announce=announce)['reasons']
    return AllowedPairs({(str(a), str(b)): str(reason) for a, b, reason in rows})


def _content(robot: BaseRobotModel, solids: Sequence[Solid]) -> str:
    parts: list[object] = [SAMPLES, BUDGET, FEW_AXES, NEVER_GAP, ALWAYS_GAP, robot.axes_data.prismatic]
    zero = np.zeros(robot.num_axes)
    parts += [*robot.axes_data.one_turn, *robot.kinematic_model.frame_axes(zero), robot.jacobian(zero)]
    for solid in solids:
        shape = solid.geometry
        parts += [solid.name, solid.frame, solid.convex, solid.pose.r, solid.pose.T]
        parts += [shape.vertices, shape.faces] if isinstance(shape, Mesh) else [shape]
    return content_of(parts)


def find_allowed_pairs(robot: BaseRobotModel) -> AllowedPairs:
    """The pairs of a robot's shapes that need no check.

    Pairs that are in contact, or nearly so, at all of many random joint positions count as always in
    contact. Other pairs are proven to be always apart, within a budget: the range of the axes between them
    is bisected into boxes until in each one the distance at its centre exceeds the largest approach within
    the box.
    """
    frames = {solid.name: solid.frame for solid in robot_solids(robot)}
    reasons: dict[Pair, str] = {
        ordered_pair(a, b): 'adjacent' for a, b in combinations(frames, 2) if abs(frames[a] - frames[b]) == 1
    }
    checked, names = distant_pairs(robot)
    reasons.update((pair, 'always') for pair in always_in_contact(checked, robot, names, SAMPLES))
    reasons.update((pair, 'never') for pair in proven_apart(checked, robot, names, BUDGET))
    return AllowedPairs(reasons)


def distant_pairs(robot: BaseRobotModel) -> tuple[SolidSet, list[Pair]]:
    """The robot's solids with the pairs that have more than one axis between them, and their names."""
    solids = robot_solids(robot)
    numbers = combinations(range(len(solids)), 2)
    pairs = [(i, j) for i, j in numbers if abs(solids[i].frame - solids[j].frame) > 1]
    checked = SolidSet(robot, solids, np.array(pairs, dtype=np.int64).reshape(-1, 2))
    names = [
        ordered_pair(solids[i].name, solids[j].name)
        for i, j in zip(checked.first, checked.second, strict=True)
    ]
    return checked, names


def always_in_contact(
    solids: SolidSet, robot: BaseRobotModel, names: Sequence[Pair], samples: int
) -> set[Pair]:
    """The pairs that are at most `ALWAYS_GAP` apart in mid-range and at so many random joint positions.

    The names are those of the shapes that the pairs of solids belong to; several may have the same name.
    """
    low, high = robot.axes_data.one_turn
    random = np.random.default_rng(0).uniform(low, high, (samples, robot.num_axes))
    always = set(names)
    for q in (0.5 * (low + high), *random):
        mine = np.array([pair for pair, name in enumerate(names) if name in always], dtype=np.int64)
        if mine.size == 0:
            break
        solids.place(q)
        touching = solids.distances(mine, np.full(mine.size, ALWAYS_GAP)) <= ALWAYS_GAP
        always = {names[pair] for pair in mine[touching].tolist()}
    return always


def proven_apart(solids: SolidSet, robot: BaseRobotModel, names: Sequence[Pair], budget: int) -> set[Pair]:
    """The pairs that are proven to be apart at all joint positions inside the limits.

    The names are as for `always_in_contact`; `budget` is the number of joint positions for the proofs of the
    pairs between two frames.
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
    middle, half = 0.5 * (low + high), np.zeros(robot.num_axes)
    half[axes] = 0.5 * (high - low)[axes]
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
        approaches = [solids.travels(mine, row).max() for row in np.diag(half)[axes]]
        cut = axes.start + int(np.argmax(approaches))
        half = half.copy()
        half[cut] *= 0.5
        for sign in (-1.0, 1.0):
            centre = middle.copy()
            centre[cut] += sign * half[cut]
            waiting.append((centre, half, mine))
    return failed | {int(pair) for _, _, mine in waiting for pair in mine}
