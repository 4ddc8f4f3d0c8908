"""SpeedControl: how fast the robot may move now."""

from __future__ import annotations

from typing import TYPE_CHECKING

from robots_controller.control.command_authority import CommandAuthority
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import Border, FollowedMotion
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.streamed_reference import StreamedReference
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array, fraction
from robots_planning.timing.path_speed_cap import PathSpeedCap
from robots_planning.trajectory import Trajectory

if TYPE_CHECKING:  # it loads the reading of meshes, which a controller without zones does not need
    from robots_controller.control.zones.zone_guard import ZoneGuard


class SpeedControl:
    """Override, pause, run that is held, the speed limit of the frames, and the borders of zones.

    Args:
        axes: The robot's limits.
        settings: See `ControllerSettings`.
        frame_limit: How fast tool and frames may move; without a limit by default.
        authority: Operating mode and commander; automatic mode by default.
        zones: Whose borders the robot does not cross while they are closed; none by default.
    """

    def __init__(
        self,
        axes: AxesData,
        settings: ControllerSettings,
        *,
        frame_limit: FrameSpeedLimit | None = None,
        authority: CommandAuthority | None = None,
        zones: ZoneGuard | None = None,
    ) -> None:
        self._acceleration, self._ramp_time = axes.acceleration, settings.ramp_time
        self._frame_limit = frame_limit
        self.authority = authority or CommandAuthority()
        """The commander of the robot, and whether its motions may continue."""
        self.zones = zones
        """Whose borders the robot does not cross while they are closed."""
        self.override = 1.0
        self.scaling = 1.0
        self.paused = False

    def set_override(self, override: float) -> None:
        """Scale the path speed.

        Raises:
            InvalidInputError: outside [0, 1] or not finite; the override stays as it was.
        """
        self.override = fraction(override, 'override')

    def set_scaling(self, scaling: float) -> None:
        """Scale the path speed besides: the part at which the drives follow.

        Raises:
            InvalidInputError: outside [0, 1] or not finite; the scaling stays as it was.
        """
        self.scaling = fraction(scaling, 'speed_scaling')

    def set_tool(self, position: Array) -> None:
        """Watch another tool centre point, by its position in tool0, (3,) m."""
        for part in (self._frame_limit, self.zones):
            if part is not None:
                part.set_tool(position)

    def cap(self, trajectory: Trajectory) -> PathSpeedCap | None:
        """How fast the frames may follow a trajectory; takes milliseconds; from any thread."""
        cap = None
        if self._frame_limit is not None:
            cap = self._frame_limit.cap(trajectory, self._acceleration, self._ramp_time)
        if cap is None and self.zones is not None:
            return PathSpeedCap.of(trajectory, self._acceleration, self._ramp_time)
        return cap

    def borders(self, trajectory: Trajectory) -> tuple[Border, ...]:
        """Where a trajectory crosses the borders of zones; takes milliseconds; from one thread."""
        return () if self.zones is None else self.zones.borders(trajectory)

    def of_motion(self, motion: FollowedMotion, now: float) -> float:
        """The path speed that a motion may have, 0..1, by override, pause and run; its cap holds besides.

        Args:
            motion: The motion, which is held at closed borders.
            now: Time, s.
        """
        if self.zones is not None:
            self.zones.hold(motion)
        return self._target(enabled=motion.failure is None and self.authority.enabled(now))

    def step_stream(self, stream: StreamedReference, now: float, before: Array) -> tuple[Array, bool]:
        """Next reference (3, n) of a stream, and whether it is over; see `StreamedReference.step`."""
        speed = self._target(enabled=self.authority.stream_enabled(now))
        if self._frame_limit is not None:
            speed = min(speed, self._frame_limit.stream_share(before[0]))
        reference, over = stream.step(now, before, speed)
        if self.zones is not None and not over:
            reference = self.zones.hold_before_borders(
                before, reference, lambda slower: stream.step(now, before, min(slower, speed))[0]
            )
        return reference, over

    def _target(self, *, enabled: bool) -> float:
        return self.override * self.scaling if enabled and not self.paused else 0.0
