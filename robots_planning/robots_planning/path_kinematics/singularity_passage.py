"""SingularityPassage: ways of six axes through a singularity, where the posture may change."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.serial_chain import SerialChain
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import stand_still, stays_inside
from robots_planning.path_kinematics.path_inverse_kinematics import PathInverseKinematics
from robots_planning.path_kinematics.route import FollowedPart, Route, RoutePiece, joined, turn_between
from robots_planning.paths.cartesian_path import CartesianPath

BESIDE = 0.02  # of the path behind a singularity: where postures are looked for from which to go back into it
# m and rad behind the singularity where the ways back end, tried in turn: closer by some turn ever faster to
# no use, and others come to where the tool can stand still only there.
NEAR = (3e-7, 0.0)
LARGEST_GAP = 1e-5  # of the path, that lies between two branches at a singularity
SMALLEST_TURN = 1e-7  # rad; less is rounding


@dataclass(frozen=True, eq=False)
class _Branch:
    """Ways from close behind a singularity that are whole turns apart, and share what is followed.

    Attributes:
        posture: Of the first one, behind the singularity, (n,).
        turns: From there to each of them, (k, n).
        back: From next to the singularity to there, in parts.
    """

    posture: Array
    turns: Array
    back: tuple[FollowedPart, ...]


class SingularityPassage:
    """Ways through a singularity: to it, a change of posture while the tool stands still, and on.

    Behind the singularity every branch of the inverse kinematics is followed back into it. Those whose
    posture there the axes can turn to while the tool stands still lead on.

    Args:
        robot: The robot, of six axes or less.
        kinematics: Of the tool along paths.
        analytic: All postures of a pose of the tool.
        tool: Pose of the tool centre point in tool0.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        kinematics: PathInverseKinematics,
        analytic: AnalyticalInverseKinematic,
        tool: Pose | None,
    ) -> None:
        self._kinematics, self._analytic = kinematics, analytic
        self._chain = SerialChain.of(robot, tool).arrays
        self._limits = np.array([robot.axes_data.lower, robot.axes_data.upper])

    def routes(self, path: CartesianPath, start: Array, before: FollowedPart) -> list[Route]:
        """Ways along a path that a posture can follow up to a singularity only.

        Args:
            path: The path.
            start: Joint positions at its begin, (n,).
            before: Its part up to there.
        """
        place = before.end
        first = (joined([before]),) if before.samples is not None else ()
        turning = first[0].joints.q[-1] if first else start
        middle = place + BESIDE * (1.0 - place)
        branches = [_Branch(*alike, ()) for alike in self._whole_turns_apart(path.pose(middle))]
        ahead = path.part(middle, 1.0)
        for near in NEAR:
            end = min(place + near / (path.length + path.angle), 0.5 * (place + middle))
            branches = list(self._nearer(path, branches, middle, end))
            onward = [
                piece for branch in branches for piece in self._onward(path, place, turning, branch, ahead)
            ]
            if onward:
                return [(*first, *turn_between(turning, piece, SMALLEST_TURN), piece) for piece in onward]
        return []

    def _whole_turns_apart(self, pose: Pose) -> Iterator[tuple[Array, Array]]:
        """Postures at a pose, (n,), each with the turns to those whole turns apart and to itself, (k, n)."""
        postures = np.array(self._analytic.solve_all(pose, turns=True))
        while len(postures):
            ways = postures - postures[0]
            turns = ways / (2.0 * np.pi)
            alike = np.abs(turns - np.round(turns)).max(axis=1) < SMALLEST_TURN
            yield postures[0], ways[alike]
            postures = postures[~alike]

    def _nearer(
        self, path: CartesianPath, branches: list[_Branch], middle: float, end: float
    ) -> Iterator[_Branch]:
        """Branches followed further back, from `middle` or where they came to, as near to `end` as they go.

        Those that do not come close to it are left out.
        """
        parts: dict[float, CartesianPath] = {}
        for branch in branches:
            begin = branch.back[0].begin if branch.back else middle
            posture = branch.back[0].first if branch.back else branch.posture
            if begin not in parts:
                parts[begin] = path.part(begin, end)
            further = self._kinematics.follow_far(parts[begin], posture)
            back = branch.back
            if further.samples is not None:
                reached = begin + further.end * (end - begin)
                back = (FollowedPart(further.samples, begin, reached).backwards(), *back)
            if back and back[0].begin - end <= LARGEST_GAP:
                yield _Branch(branch.posture, branch.turns, back)

    def _onward(
        self, path: CartesianPath, place: float, turning: Array, branch: _Branch, ahead: CartesianPath
    ) -> Iterator[RoutePiece]:
        """Pieces to the end of a path, to whose begin the axes turn while the tool stands still.

        Args:
            path: The path.
            place: Where the tool stands still, in s.
            turning: Joint positions from which they turn, (n,).
            branch: What to go on with.
            ahead: From behind the singularity on.
        """
        still = np.empty(len(branch.turns), dtype=np.bool_)
        ends = branch.back[0].first + branch.turns
        stand_still(self._chain, self._limits, path.arrays, place, turning, ends, still)
        if not still.any():
            return
        rest = self._kinematics.follow_far(ahead, branch.posture)
        if rest.end < 1.0:
            return
        onward = joined([*branch.back, FollowedPart(rest.samples, branch.back[-1].end, 1.0)])
        for turn in branch.turns[still]:
            piece = onward.turned(turn)
            if stays_inside(self._limits, piece.joints.samples):
                yield piece
