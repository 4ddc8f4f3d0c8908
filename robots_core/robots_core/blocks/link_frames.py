"""LinkFrames: the tree of a robot's frames, each seen from its parent, as transforms of ROS have them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from lxml import etree

from robots_core.base_frames import BASE_FRAME, BASE_LINK
from robots_core.pose import Pose
from robots_core.robot_model.urdf.urdf_tree import MOVING_JOINTS, LinkTree, link_of
from robots_core.validation import Array

FLANGE: Final = Pose(np.zeros(3), np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]))
"""The flange in tool0: its x axis points where the z axis of tool0 does (REP-199)."""


@dataclass(frozen=True)
class FramePose:
    """A frame, seen from the frame before it.

    Attributes:
        parent: Name of the frame before it.
        child: Its name.
        pose: Its pose there.
    """

    parent: str
    child: str
    pose: Pose


class LinkFrames:
    """All links of a robot, in the order of its tree, and the frames that REP-199 adds.

    These are `base_link` and `base` at the root, and `flange` at `tool0`, where the description has no such
    links. `base_link` is the root, also where a description has it fixed to its root `base`. The base of a
    maker's controller may be turned against ours: that is not known.

    Args:
        description: The robot as URDF, `tool0` its tip, see `BaseRobotModel.description`.
    """

    def __init__(self, description: str) -> None:
        root = etree.fromstring(description.encode())
        tree = LinkTree(root)
        base = tree.base(None)
        self._moving: list[_MovingJoint] = []
        fixed = []
        for joint in root.findall('joint'):
            origin = FramePose(link_of(joint, 'parent'), link_of(joint, 'child'), _origin(joint))
            if joint.get('type') in MOVING_JOINTS:
                self._moving.append(_MovingJoint(joint, origin))
            elif (base, origin.parent, origin.child) == (BASE_FRAME, BASE_FRAME, BASE_LINK):
                fixed.append(FramePose(BASE_LINK, BASE_FRAME, origin.pose.inverse()))
            else:
                fixed.append(origin)
        for parent, child, pose in (
            (base, BASE_LINK, Pose.identity()),
            (base, BASE_FRAME, Pose.identity()),
            ('tool0', 'flange', FLANGE),
        ):
            if child not in tree.links:
                fixed.append(FramePose(parent, child, pose))
        self.fixed: Final = tuple(fixed)
        """Frames that never move."""

    def moving(self, positions: Mapping[str, float]) -> Iterator[FramePose]:
        """The frames behind joints that move.

        Args:
            positions: Of the joints, rad (m). A joint that is missing follows the one that it mimics, or
                stands where it does in the robot's own model: at 0, or as near as its limits allow.
        """
        for joint in self._moving:
            yield joint.at(positions)


class _MovingJoint:
    def __init__(self, joint: etree._Element, origin: FramePose) -> None:
        self._name, self._origin = str(joint.get('name')), origin
        axis = joint.find('axis')
        vector = _numbers(None if axis is None else axis.get('xyz'), (1.0, 0.0, 0.0))
        self._axis = vector / np.linalg.norm(vector)
        self._slides = joint.get('type') == 'prismatic'
        self._mimic = joint.find('mimic')
        limit = None if joint.get('type') == 'continuous' else joint.find('limit')
        low, high = (
            (0.0, 0.0) if limit is None else (float(limit.get(key, 0.0)) for key in ('lower', 'upper'))
        )
        self._rest = min(max(0.0, low), high)

    def at(self, positions: Mapping[str, float]) -> FramePose:
        q = self._position(positions)
        if self._slides:
            moved = Pose(q * self._axis, np.eye(3))
        else:
            turned = [*(math.sin(0.5 * q) * self._axis), math.cos(0.5 * q)]
            moved = Pose.from_quaternion(np.zeros(3), turned)
        return FramePose(self._origin.parent, self._origin.child, self._origin.pose @ moved)

    def _position(self, positions: Mapping[str, float]) -> float:
        if self._name in positions:
            return positions[self._name]
        if self._mimic is not None and (leader := str(self._mimic.get('joint'))) in positions:
            factor, offset = float(self._mimic.get('multiplier', 1.0)), float(self._mimic.get('offset', 0.0))
            return factor * positions[leader] + offset
        return self._rest


def _origin(joint: etree._Element) -> Pose:
    origin = joint.find('origin')
    if origin is None:
        return Pose.identity()
    roll, pitch, yaw = _numbers(origin.get('rpy'), (0.0, 0.0, 0.0))
    return Pose.from_angles(_numbers(origin.get('xyz'), (0.0, 0.0, 0.0)), (yaw, pitch, roll))


def _numbers(text: str | None, default: tuple[float, float, float]) -> Array:
    return np.array(default if text is None else [float(word) for word in text.split()])
