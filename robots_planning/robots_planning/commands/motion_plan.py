"""MotionPlan: from motions as they were commanded, one or a chain, to the plan that is sent."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from robots_core.status import Status
from robots_core.validation import Array
from robots_planning.motion_kinds import MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PlannedMotion
from robots_planning.paths.joint_path import JointPath
from robots_planning.timing.timed_path import Smoothing
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.trajectory_generator import Target


@dataclass(frozen=True, eq=False)
class QueuedCommand:
    """A motion as it was commanded.

    Attributes:
        id: Its command.
        kind: What kind of motion it is.
        target: Joint positions (n,), a pose, or the poses of an arc or a spline.
        settings: The modal settings of that instant.
        received: When it came, s.
        replans: How often it was led around an obstacle that came into its path.
    """

    id: str
    kind: MotionKind
    target: Target
    settings: MotionSettings
    received: float
    replans: int = 0

    @property
    def may_replan(self) -> bool:
        """It may be led around another obstacle."""
        wanted = self.settings.replans and not self.kind.cartesian
        return wanted and self.replans < self.settings.most_replans


@dataclass(frozen=True, eq=False)
class CommandChain:
    """Commands to plan.

    Attributes:
        commands: One or several that blend, in their order.
        goes_on: More are there that the last one blends into; their plan continues from this one.
        blocked: The trajectory on which an obstacle has stopped the first one, to go on around it, and where
            the robot stands on that, s; None for a new one.
    """

    commands: tuple[QueuedCommand, ...]
    goes_on: bool = False
    blocked: tuple[Trajectory, float] | None = None


@dataclass(frozen=True, eq=False)
class OpenEnd:
    """The part of a plan that the next one replaces: a stop for the case that nothing comes in time.

    Attributes:
        commands: Those in this part; it begins at the middle of the blend before them.
        time: Its start, s of the plan.
        state: Joint positions, velocities and accelerations there, (n,) each.
        smoothing: Of the plan's time law.
        before: The command before them, and its path.
        paths: Of the commands.
    """

    commands: tuple[QueuedCommand, ...]
    time: float
    state: tuple[Array, Array, Array]
    smoothing: Smoothing
    before: tuple[QueuedCommand, JointPath]
    paths: tuple[JointPath, ...]


@dataclass(frozen=True, eq=False)
class MotionPlan:
    """The plan of a command, of a chain of blended ones, or a given trajectory.

    Attributes:
        id: Its own: that of its last command before another plan may carry it on.
        motion: The motion.
        ends: When each of its commands is done with, s of the plan, by id and in order.
        title: Its kinds, and why its chain stops before it, for a person.
        open_end: Where another plan may carry it on; None if none does.
        join_time: Path time of the running motion at which it takes its place, s. Below 0 it carries the last
            motion on, so long before that one's end; 0: after its end.
    """

    id: str
    motion: PlannedMotion
    ends: Mapping[str, float]
    title: str
    open_end: OpenEnd | None = None
    join_time: float = 0.0

    @property
    def trajectory(self) -> Trajectory:
        """What the controller follows."""
        return self.motion.trajectory

    @property
    def open_time(self) -> float:
        """When another plan may carry it on, s of the plan; its duration where none does."""
        return self.motion.duration if self.open_end is None else self.open_end.time

    @property
    def status(self) -> Status:
        """The plan as it travels on `motion_plan`."""
        return Status('motion plan', values={'id': self.id, **self.ends})

    def passed(self, progress: float) -> Iterator[tuple[str, bool]]:
        """Each command but the motion's own, and whether it was done with at that part of the plan."""
        done = progress * self.trajectory.duration
        for id_, end in self.ends.items():
            if id_ != self.id:
                yield id_, progress == 1.0 or end <= done

    def left(self, progress: float) -> list[str]:
        """Ids of the commands that are not done with at that part of the plan: its own always."""
        done = {id_ for id_, passed in self.passed(progress) if passed}
        return [id_ for id_ in self.ends if id_ not in done] or [self.id]

    def without(self, ids: Mapping[str, float]) -> MotionPlan:
        """The plan without commands that another one carries on."""
        return replace(self, ends={id_: end for id_, end in self.ends.items() if id_ not in ids})
