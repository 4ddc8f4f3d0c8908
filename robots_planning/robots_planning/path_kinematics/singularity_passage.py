"""SingularityPassage: routes of six axes through a singularity, where the configuration may change."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import stand_still, stays_inside
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.path_kinematics.route import Route, RoutePiece, joined, turn_between
from robots_planning.paths.cartesian_path import CartesianPath

BESIDE = 0.02  # of the path after a singularity, where branches are sampled and followed back towards it
# Distances after the singularity, m and rad, at which following back ends, tried in turn. Closer, some
# branches only turn ever faster; for others the tool can stand still only in the singularity itself.
NEAR = (3e-7, 0.0)
LARGEST_GAP = 1e-5  # of the path, between two branches at a singularity
SMALLEST_TURN = 1e-7  # rad; less is rounding


@dataclass(frozen=True, eq=False)
class _Branch:
    """A branch of the inverse kinematics after a singularity, with all full turns of it.

    Attributes:
        q: Joint positions of the first one, after the singularity, (n,).
        turns: Full turns from there to each of them, (k, n).
        back: Followed pieces from next to the singularity to `q`.
    """

    q: Array
    turns: Array
    back: tuple[RoutePiece, ...]


class SingularityPassage:
    """Routes through a singularity: up to it, a change of configuration while the tool stands still, and on.

    After the singularity every branch of the inverse kinematics is followed back towards it. A branch is
    usable if the axes can turn to its joint positions there while the tool stands still.

    Args:
        kinematics: Inverse kinematics along paths, of a robot of six axes or less.
        analytic: All joint positions for a pose of the tool.
    """

    def __init__(self, kinematics: PathInverseKinematics, analytic: AnalyticalInverseKinematic) -> None:
        self._kinematics, self._analytic = kinematics, analytic

    def routes(self, path: CartesianPath, start: Array, before: RoutePiece | None) -> list[Route]:
        """Routes along a path on which following from `start` ends in a singularity.

        Args:
            path: The path.
            start: Joint positions at its start, (n,).
            before: The part of the path up to the singularity; None if it starts there.
        """
        first: Route = () if before is None else (before,)
        place, turning = (0.0, start) if before is None else (before.end, before.joints.q[-1])
        middle = place + BESIDE * (1.0 - place)
        branches = [_Branch(*alike, ()) for alike in self._full_turns_apart(path.pose(middle))]
        ahead = path.part(middle, 1.0)
        for near in NEAR:
            end = min(place + near / (path.length + path.angle), 0.5 * (place + middle))
            branches = list(self._followed_back(path, branches, middle, end))
            onward = [
                piece for branch in branches for piece in self._onward(path, place, turning, branch, ahead)
            ]
            if onward:
                return [(*first, *turn_between(turning, piece, SMALLEST_TURN), piece) for piece in onward]
        return []

    def _full_turns_apart(self, pose: Pose) -> Iterator[tuple[Array, Array]]:
        """Joint positions (n,) for a pose, each with the full turns that keep it, 0 included, (k, n)."""
        solutions = np.array(self._analytic.solve_all(pose, turns=True))
        while len(solutions):
            displacements = solutions - solutions[0]
            turns = displacements / (2.0 * np.pi)
            alike = np.abs(turns - np.round(turns)).max(axis=1) < SMALLEST_TURN
            yield solutions[0], displacements[alike]
            solutions = solutions[~alike]

    def _followed_back(
        self, path: CartesianPath, branches: list[_Branch], middle: float, end: float
    ) -> Iterator[_Branch]:
        """Branches followed further back, from `middle` or where they ended, as near to `end` as possible.

        Branches that do not get close to it are left out.
        """
        parts: dict[float, CartesianPath] = {}
        for branch in branches:
            begin = branch.back[0].begin if branch.back else middle
            q = branch.back[0].joints.q[0] if branch.back else branch.q
            if begin not in parts:
                parts[begin] = path.part(begin, end)
            further, _ = self._kinematics.follow_far(parts[begin], q)
            back = branch.back
            if further is not None:
                reached = begin + further.end * (end - begin)
                back = (replace(further, begin=begin, end=reached).backwards(), *back)
            if back and back[0].begin - end <= LARGEST_GAP:
                yield _Branch(branch.q, branch.turns, back)

    def _onward(
        self, path: CartesianPath, place: float, turning: Array, branch: _Branch, ahead: CartesianPath
    ) -> Iterator[RoutePiece]:
        """Pieces to the end of a path, on a branch, that the axes turn to while the tool stands still.

        They turn from the joint positions `turning`, (n,), at s = `place`; `ahead` is the path after it.
        """
        still = np.empty(len(branch.turns), dtype=np.bool_)
        ends = branch.back[0].joints.q[0] + branch.turns
        begin = np.array(turning)  # read-only arrays would be compiled for once more
        limits = self._kinematics.limits
        stand_still(self._kinematics.chain.arrays, limits, path.arrays, place, begin, ends, still)
        if not still.any():
            return
        rest, _ = self._kinematics.follow_far(ahead, branch.q)
        if rest is None or rest.end < 1.0:
            return
        onward = joined([*branch.back, replace(rest, begin=branch.back[-1].end)])
        for turn in branch.turns[still]:
            piece = onward.turned(turn)
            if stays_inside(limits, piece.joints.samples):
                yield piece
