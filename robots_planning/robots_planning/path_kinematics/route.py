"""Route: the joint paths that a robot takes one after the other along a path of the tool."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import Knots
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath


@dataclass(frozen=True, eq=False)
class RoutePiece:
    """A joint path along a part of the tool's path.

    Attributes:
        joints: The joint path.
        begin: Where the part begins, in s of the whole path.
        end: Where it ends; at its begin where the tool stands still while the posture changes.
    """

    joints: JointPath
    begin: float
    end: float

    def turned(self, turn: Array) -> RoutePiece:
        """The same with every axis turned by as much, (n,) rad, all the way."""
        joints = self.joints
        return replace(self, joints=JointPath(joints.s, joints.q + turn, joints.q_s, joints.q_ss))

    def tool(self, path: CartesianPath) -> CartesianPath:
        """What the tool does on it, of its whole `path`."""
        return path if (self.begin, self.end) == (0.0, 1.0) else path.part(self.begin, self.end)


Route = tuple[RoutePiece, ...]


@dataclass(frozen=True, eq=False)
class FollowedPart:
    """The part of a path that a posture was followed along, whose knots have an s of their own from 0 to 1.

    Attributes:
        knots: None where it goes nowhere.
        begin: Where it begins, in s of the whole path.
        end: Where it ends; before its begin if it was followed backwards.
        blocked: Whether it ends where no step is possible any more: in a singularity or out of reach.
    """

    knots: Knots | None
    begin: float
    end: float
    blocked: bool = False

    def backwards(self) -> FollowedPart:
        """The same from its end to its begin."""
        assert self.knots is not None
        s, q, q_s, q_ss = (values[::-1] for values in self.knots)
        return FollowedPart((1.0 - s, q, -q_s, q_ss), self.end, self.begin)

    @property
    def first(self) -> Array:
        """Its first posture, (n,)."""
        assert self.knots is not None
        posture: Array = self.knots[1][0]
        return posture


def joined(parts: Sequence[FollowedPart]) -> RoutePiece:
    """One piece of parts that follow each other, each beginning at the posture where the one before ends."""
    begin, end = parts[0].begin, parts[-1].end
    pieces: list[Knots] = []
    for part in parts:
        assert part.knots is not None
        share = (part.end - part.begin) / (end - begin)
        # The first knot of a further part is the last of the one before.
        s, q, q_s, q_ss = (values[1:] if pieces else values for values in part.knots)
        pieces.append(((part.begin - begin) / (end - begin) + share * s, q, q_s / share, q_ss / share**2))
    s, q, q_s, q_ss = (np.concatenate(values) for values in zip(*pieces, strict=True))
    s[0], s[-1] = 0.0, 1.0
    return RoutePiece(JointPath(s, q, q_s, q_ss), begin, end)


def turn_between(begin: Array, onward: RoutePiece, smallest: float) -> Route:
    """The change of posture, straight in joint space, from `begin` (n,) to where a piece begins.

    Nothing if no axis turns by `smallest`, rad.
    """
    end = onward.joints.q[0]
    turn = end - begin
    if float(np.abs(turn).max()) < smallest:
        return ()
    way, still = np.stack([turn, turn]), np.zeros((2, len(turn)))
    joints = JointPath(np.array([0.0, 1.0]), np.stack([begin, end]), way, still)
    return (RoutePiece(joints, onward.begin, onward.begin),)
