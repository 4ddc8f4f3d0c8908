"""Route: the sequence of joint paths by which a robot follows a path of the tool."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robots_core.validation import Array
from robots_planning.path_kinematics.path_following_kernel import JointSamples
from robots_planning.paths.cartesian_path import CartesianPath
from robots_planning.paths.joint_path import JointPath


@dataclass(frozen=True, eq=False)
class RoutePiece:
    """A joint path along a part of the tool's path.

    Attributes:
        joints: The joint path.
        begin: s of the whole path where the part starts.
        end: s where it ends; equal to `begin` if the tool stands still while the configuration changes, less
            than it if the part was followed backwards.
    """

    joints: JointPath
    begin: float
    end: float

    def backwards(self) -> RoutePiece:
        """The same piece, traversed from its end to its start."""
        s, q, q_s, q_ss = (values[::-1] for values in self.joints.samples)
        return RoutePiece(JointPath(1.0 - s, q, -q_s, q_ss), self.end, self.begin)

    def turned(self, turn: Array) -> RoutePiece:
        """The same piece with a constant `turn`, (n,) rad, added to the joint positions."""
        joints = self.joints
        return replace(self, joints=JointPath(joints.s, joints.q + turn, joints.q_s, joints.q_ss))

    def tool(self, path: CartesianPath) -> CartesianPath:
        """The part of the tool's whole `path` that belongs to this piece."""
        return path if (self.begin, self.end) == (0.0, 1.0) else path.part(self.begin, self.end)


Route = tuple[RoutePiece, ...]


def joined(parts: Sequence[RoutePiece]) -> RoutePiece:
    """One piece made of consecutive parts; each starts at the joint positions where the one before ends."""
    begin, end = parts[0].begin, parts[-1].end
    pieces: list[JointSamples] = []
    for part in parts:
        share = (part.end - part.begin) / (end - begin)
        # The first sample of a later part is the last one of the part before.
        s, q, q_s, q_ss = (values[1:] if pieces else values for values in part.joints.samples)
        pieces.append(((part.begin - begin) / (end - begin) + share * s, q, q_s / share, q_ss / share**2))
    s, q, q_s, q_ss = (np.concatenate(values) for values in zip(*pieces, strict=True))
    s[0], s[-1] = 0.0, 1.0
    return RoutePiece(JointPath(s, q, q_s, q_ss), begin, end)


def turn_between(begin: Array, onward: RoutePiece, smallest: float) -> Route:
    """The change of configuration, straight in joint space, from `begin` (n,) to the start of a piece.

    Empty if no axis turns by `smallest`, rad.
    """
    end = onward.joints.q[0]
    turn = end - begin
    if float(np.abs(turn).max()) < smallest:
        return ()
    velocity, still = np.stack([turn, turn]), np.zeros((2, len(turn)))
    joints = JointPath(np.array([0.0, 1.0]), np.stack([begin, end]), velocity, still)
    return (RoutePiece(joints, onward.begin, onward.begin),)
