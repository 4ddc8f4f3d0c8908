"""RendezvousMessages: what is published of bodies in orbit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

from robots_core.blocks.floating_base.rendezvous import WORLD_FRAME, Rendezvous
from robots_core.message_builder import MessageBuilder
from robots_core.pose import Pose
from robots_core.validation import Array

POSE, TWIST = 'reference_pose', 'reference_twist'
TYPES: Final[Mapping[str, str]] = {
    POSE: 'geometry_msgs/msg/PoseStamped',
    TWIST: 'geometry_msgs/msg/TwistStamped',
    'grasp_status': 'diagnostic_msgs/msg/DiagnosticStatus',
    'base_pose': 'geometry_msgs/msg/PoseStamped',
    'target_pose': 'geometry_msgs/msg/PoseStamped',
    'momentum': 'std_msgs/msg/Float64MultiArray',
}
"""The topics, and the types of their messages."""


class RendezvousMessages:
    """What the camera measures, what becomes of a grasp, and poses and momentum."""

    def __init__(self, rendezvous: Rendezvous, build: MessageBuilder, robot: str) -> None:
        self._rendezvous, self._build, self._robot = rendezvous, build, robot
        self._report: str | None = None

    def after_step(self, stamp: Any, reference: tuple[Pose, Array] | None) -> Iterator[tuple[str, Any]]:
        """The messages after a step that led to this reference of the bodies, each with its topic."""
        bodies, build = self._rendezvous, self._build
        if reference is not None:
            yield POSE, build.pose_stamped(stamp, reference[0])
            yield TWIST, build.twist_stamped(stamp, reference[1])
        if bodies.report != self._report:
            self._report = bodies.report
            yield 'grasp_status', build.status(bodies.status, self._robot)
        if bodies.shown:
            yield 'base_pose', build.pose_stamped(stamp, bodies.base.pose, WORLD_FRAME)
            yield 'target_pose', build.pose_stamped(stamp, bodies.target.pose, WORLD_FRAME)
            yield 'momentum', build.matrix(bodies.momentum, 'part', 'momentum')
