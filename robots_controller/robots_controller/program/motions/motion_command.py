"""MotionCommand: one motion as a robot program commands it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

from robots_core.message_builder import MessageBuilder
from robots_core.pose import Pose
from robots_core.validation import Array
from robots_planning.motion_kinds import MotionKind

Kind = Literal['digital', 'analog']
Anchor = Literal['distance_before_end', 'distance_after_start', 'time_before_end', 'time_after_start']


@dataclass(frozen=True)
class PathSwitch:
    """An output that is switched while the robot moves.

    Attributes:
        anchor: What `at` is measured from.
        at: Distance of the tool along its path (m), or time of the planned motion (s), from the anchor.
        kind: 'digital' or 'analog'.
        index: The output, counted from 1.
        value: 0 or 1, or the analog value.
        line: The program's line that asked for it; 0 until its motion is sent.
    """

    anchor: Anchor
    at: float
    kind: Kind
    index: int
    value: float
    line: int = 0


@dataclass(frozen=True, eq=False)
class MotionCommand:
    """One motion as the program commands it.

    Attributes:
        kind: What kind of motion it is.
        line: The program's line, counted from 1.
        function: The Lua function's name.
        q: Target in joint space (n,), rad (m), read-only; None for a target pose.
        pose: Target of the tool, seen from the base that was set; None for a joint target.
        path: Poses of a path with more than its end: via point and end of an arc, or the points of a
            spline; () for all others. Its last is `pose`.
        settings: Modal settings that the program has changed, by the name of their parameter, SI.
        blend: Zone in which the corner to the next motion may be cut: m for Cartesian motions, rad (m) for
            joint motions; 0 stops at the target.
        switches: Outputs that are switched on the way.
    """

    kind: MotionKind
    line: int
    function: str
    q: Array | None = None
    pose: Pose | None = None
    path: tuple[Pose, ...] = ()
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    blend: float = 0.0
    switches: tuple[PathSwitch, ...] = ()

    @property
    def target(self) -> Array | Pose | tuple[Pose, ...]:
        """What the kind of motion needs, see `PathPlanning.plan`."""
        if self.q is not None:
            return self.q
        if self.path:
            return self.path
        assert self.pose is not None
        return self.pose

    def message(self, build: MessageBuilder, stamp: Any, joints: Sequence[str]) -> Any:
        """The message of the command, see `MotionKind`; its id is the stamp."""
        if self.q is not None:
            return build.joint_state(stamp, joints, self.q)
        if self.path:
            return build.path(stamp, self.path)
        assert self.pose is not None
        return build.pose_stamped(stamp, self.pose)


@dataclass(frozen=True)
class OutputChange:
    """One output that the program switched.

    Attributes:
        kind: 'digital' or 'analog'.
        index: Counted from 1.
        value: 0 or 1, or the analog value.
        line: The program's line.
    """

    kind: Kind
    index: int
    value: float
    line: int
