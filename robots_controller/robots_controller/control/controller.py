"""Controller: follows trajectories on time, on the path, inside the limits."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from robots_controller.control.blocked_motion import BlockedMotion
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.motion_queue import MotionQueue
from robots_controller.control.path_following import PathFollowing
from robots_controller.control.span import Span
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.stops.brake import Brake
from robots_controller.control.stops.faults import Fault, StopCategory
from robots_controller.control.stops.feedback_watch import FeedbackWatch, Finding
from robots_controller.control.stops.limit_guard import LimitGuard
from robots_controller.control.stops.stop_latch import StopLatch
from robots_controller.control.streamed_reference import StreamedReference, StreamPoint
from robots_core.cell_interface.motion_result import BLOCKED, PASSED, MotionResult
from robots_core.errors import NotNowError, TrajectoryRefusedError
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

if TYPE_CHECKING:  # it loads the reading of meshes, which a controller without zones does not need
    from robots_controller.control.zones.zone_guard import ZoneGuard

NO_FEEDBACK = 'no feedback from the robot: is its drive publishing joint_states?'


class ControllerState(StrEnum):
    """What the controller does."""

    WAITING = 'waiting for feedback'
    HOLDING = 'holding'
    FOLLOWING = 'following'
    SETTLING = 'settling'
    BRAKING = 'braking'
    STREAMING = 'following a stream'
    STOPPED = 'stopped by a fault'


class Controller:
    """The robot controller's loop body: sampling, override, smoothing, guard.

    Has no clock and no thread: `step` is handed the time and is called once per period by one thread,
    which also makes all other calls.

    Args:
        axes: The robot's limits.
        settings: See `ControllerSettings`.
        speed: How fast the robot may move; as fast as planned by default.
        processor_share: See `Watchdog`.
    """

    def __init__(
        self,
        axes: AxesData,
        settings: ControllerSettings | None = None,
        *,
        speed: SpeedControl | None = None,
        processor_share: Callable[[], float] = lambda: 1.0,
    ) -> None:
        self.settings = settings or ControllerSettings()
        self.outcomes: deque[MotionResult] = deque()
        """Ends of motions, oldest first; the caller takes them out."""
        self.speed = speed or SpeedControl(axes, self.settings)
        """How fast the robot may move."""
        self._axes = axes
        period = self.settings.period
        self._following = PathFollowing(axes, self.settings)
        self._guard = LimitGuard(axes, period=period)
        self.reference: Array | None = None
        """Last one, (3, n): position, velocity, acceleration; None before the first feedback."""
        self._motions = MotionQueue(axes)
        self._stream = StreamedReference(axes, period=period, timeout=self.settings.stream_timeout)
        self._brake: Brake | None = None
        self._feedback = FeedbackWatch(axes, self.settings, processor_share)
        self._found: Finding | None = None  # in the period that is to come
        self._taken: Array | None = None  # feedback for it
        self.stops = StopLatch()
        """What stopped the robot, until `reset`."""
        self.blocked = BlockedMotion(self.speed.authority, self.stops)
        """The motion that was stopped before an obstacle."""
        self.awaited = ''
        """What no motion starts without and is not there yet, for a person; '' if nothing is missing."""

    @property
    def state(self) -> ControllerState:
        """What the controller does now; from any thread."""
        if self.reference is None:
            return ControllerState.WAITING
        if self._brake is not None:
            return ControllerState.BRAKING
        if self._stream.active:
            return ControllerState.STREAMING
        motion = self._motion  # which may end meanwhile
        if motion is None:
            return ControllerState.STOPPED if self.stops.latched else ControllerState.HOLDING
        return ControllerState.FOLLOWING if motion.settling_since is None else ControllerState.SETTLING

    @property
    def progress(self) -> float:
        """Done part of the current path, 0..1; 1 when none is followed."""
        motion = self._motions.current
        return 1.0 if motion is None else motion.progress

    @property
    def obstacle(self) -> str:
        """Before what border the robot is held, for a person; '' for none; from any thread."""
        zones = self.speed.zones
        return '' if zones is None or self.standing else zones.obstacle

    @property
    def _motion(self) -> FollowedMotion | None:
        return self._motions.current

    @property
    def motions(self) -> list[FollowedMotion]:
        """The motion that is followed and those after it; from any thread."""
        return self._motions.all

    def follow(self, motion: FollowedMotion, now: float, *, join_time: float = 0.0) -> None:
        """Follow a motion: now, after those before it, or in the place of the running one.

        Args:
            motion: Starts at rest where the reference stands or where the last motion ends.
            now: Time, s.
            join_time: If above 0, the motion starts on the running one instead, at this path time (s) and
                moving as that one does there, and takes its place. If below 0, it starts on the last motion,
                so long before its end (s), and carries it on: that one ends there as passed.

        Raises:
            TrajectoryRefusedError: it starts elsewhere, the robot is being stopped or follows a stream,
                there is no feedback, a fault is not reset, something is awaited, another number of axes, or
                it crosses a border that is always closed.
        """
        self._refuse_stopped()
        n = motion.trajectory.num_axes
        if n != self._axes.num_axes:
            raise TrajectoryRefusedError(f'the trajectory has {n} axes, the robot has {self._axes.num_axes}')
        if self.state in (ControllerState.BRAKING, ControllerState.STREAMING):
            raise TrajectoryRefusedError('the robot is still moving; stop it first or wait for motion_result')
        for border in motion.borders:
            if border.zone.always_closed:
                raise TrajectoryRefusedError(
                    f'the trajectory crosses the border of zone {border.zone.name!r} at {border.start:.3f} s'
                )
        self.blocked.check(motion.id)
        standing = self._motion is None
        assert self.reference is not None
        motion.start = now
        self._motions.put(motion, self.reference, join_time)
        self.blocked.begin(motion.id)
        if standing:
            self._following.begin(motion, self.speed.of_motion(motion, now))

    def stream(self, point: StreamPoint, id_: str, now: float) -> None:
        """Follow a point, the next of a stream or the first of one.

        The reference stays inside the limits whatever the points are; when they stop coming it brakes.

        Args:
            point: The newest point.
            id_: Of the stream, if this is its first point: comes back in the outcome.
            now: Time, s.

        Raises:
            TrajectoryRefusedError: a motion is still running, there is no feedback, a fault is not reset,
                something is awaited, or the stream was stopped and has not paused since.
            InvalidInputError: the point breaks a limit or is due too far ahead.
        """
        self._refuse_stopped()
        point.check(self._axes, now)
        self._stream.refuse_stopped(now)
        if self._motion is not None or self._brake is not None:
            raise TrajectoryRefusedError('the robot is still moving; stop it first or wait for motion_result')
        if not self._stream.active:
            self.blocked.check(id_)
            self._stream.begin(id_, now)
        self._stream.put(point, now)

    def _refuse_stopped(self) -> None:
        if self.stops.latched:
            raise TrajectoryRefusedError(f'{self.stops.state.reason}; ~/reset lets the robot move again')
        if self._feedback.lost:
            raise TrajectoryRefusedError(NO_FEEDBACK)
        if self.awaited:
            raise TrajectoryRefusedError(self.awaited)

    def cancel(self, reason: str) -> None:
        """Stop on the path and give up the motion; without one, nothing happens."""
        self._stream.stop(reason)
        motion = self._motion
        if self.blocked.waiting or (motion is not None and motion.failure == BLOCKED):
            self.blocked.stay(reason)
        if motion is not None and motion.failure in (None, BLOCKED):
            motion.failure = reason

    def stop_before_collision(self, now: float) -> None:
        """Stop before an obstacle until `reset`; a motion may go on around it under its id."""
        if self._stream.active:
            self.trip(Fault.OBSTACLE, BLOCKED, now)
        elif self._motion is not None and self._motion.failure is None:
            self._motion.failure = BLOCKED

    def trip(self, fault: Fault, reason: str, now: float, *, stands: bool = False) -> None:
        """Stop by a fault, in its category; the robot does not move again before `reset`.

        If its cause stands, it stays until `stops.clear`.
        """
        if fault.moving_only and self.standing and not self.blocked.waiting:
            return
        if not self.stops.trip(fault, reason, stands=stands):
            return
        self.cancel(reason)
        self._following.fast_stop = fault.category < StopCategory.TWO
        if fault.category is StopCategory.ZERO:  # the drives are switched off at once
            self.stops.stands()
            self._end_moving(now, reason)

    def check_reset(self, excluding: Fault | None = None) -> None:
        """Check that the robot stands and nothing is there any more that stopped it.

        Args:
            excluding: A fault whose cause goes with the reset.

        Raises:
            RobotsError: it moves, or something is.
        """
        if not self.standing:
            raise NotNowError('cannot reset: the robot is still moving')
        if self._feedback.lost:
            raise NotNowError(f'cannot reset: {NO_FEEDBACK}')
        self.stops.check_reset(excluding)

    def reset(self) -> None:
        """Let the robot move again after a fault; it starts from where it stands.

        Raises:
            RobotsError: as `check_reset`.
        """
        self.check_reset()
        self.stops.reset()
        self._following.fast_stop = False

    def step(self, now: float, feedback: Array | None) -> Array | None:
        """One period: returns the next reference.

        Args:
            now: Time, s.
            feedback: Newest joint positions, (n,), or None if none came since the last call or since `take`.

        Returns:
            (3, n): position, velocity, acceleration; None before the first feedback.
        """
        finding, self._found = self._found or self._feedback.check(now, feedback, self.reference), None
        taken, self._taken = self._taken, None
        feedback = taken if feedback is None else feedback
        if self.reference is None:
            if feedback is not None:
                self._stand_at(feedback)
            return self.reference
        if finding is not None:
            self.trip(*finding, now)
        if self.speed.zones is not None:
            self._check_zones(self.speed.zones, now)
        if self._brake is not None:
            self._step_brake(now)
        elif self._stream.active:
            self._step_stream(now)
        elif self._motion is not None:
            self._step_motion(self._motion, now)
        if self.stops.latched and self.standing:
            if not self.stops.state.drives_on and feedback is not None:
                self._stand_at(feedback)
            self.stops.stands()
        return self.reference

    def ahead(self, now: float, periods: int) -> Span:
        """What `step` will return as long as nothing is called and `check` finds nothing.

        Args:
            now: Time, s.
            periods: At most so many.

        Returns:
            The periods until something else happens; none of a robot that brakes, settles, follows a stream
            or may be held by zones, and of a motion whose speed changes.
        """
        motion, state, reference = self._motion, self.state, self.reference
        assert reference is not None
        if periods <= 0 or self.speed.zones is not None or self.stops.latched:
            return Span.standing(reference, 0)
        if state is ControllerState.HOLDING:
            return Span.standing(reference, periods)
        if state is not ControllerState.FOLLOWING or motion is None or motion.failure is not None:
            return Span.standing(reference, 0)
        span = self._following.ahead(motion, self.speed.of_motion(motion, now), periods)
        return span.first(self._guard.passing(span.references)) if len(span) else span

    def take(self, now: float, feedback: Array) -> None:
        """Look at the feedback of the next period ahead of it: its `step` takes less time.

        Args:
            now: Time, s.
            feedback: Joint positions, (n,).
        """
        self._found = self._feedback.check(now, feedback, self.reference)
        self._taken = feedback

    def check(self, now: float, feedback: Array | None, reference: Array) -> bool:
        """Look at the feedback of a period of a span; False if the next `step`, of this period, acts on it.

        Args:
            now: Time, s.
            feedback: As for `step`.
            reference: Of the period before, (3, n).
        """
        self._found = self._feedback.check(now, feedback, reference)
        return self._found is None

    def pass_over(self, span: Span) -> None:
        """The periods of a span have passed."""
        self.reference = span.references[-1].copy()
        if self._motion is not None:
            self._following.pass_over(self._motion, span)
            self._guard.pass_over(span.references)

    def _check_zones(self, zones: ZoneGuard, now: float) -> None:
        assert self.reference is not None
        if reason := zones.check(self.reference[0]):
            self.trip(Fault.ZONE_VIOLATED, reason, now)
        measured = self._feedback.position
        places = [self.reference[0], *([] if measured is None else [measured])]
        motion = None if self._motion is None or self._motion.failure else self._motion
        zones.share(places, motion, streaming=self._stream.active)

    @property
    def standing(self) -> bool:
        """Nothing moves the robot: no motion, no stream, no brake."""
        return self._motion is None and self._brake is None and not self._stream.active

    def _stand_at(self, position: Array) -> None:
        self.reference = self._following.stand_at(position)
        self._guard.reset(position)
        self._feedback.restart()

    def _step_motion(self, motion: FollowedMotion, now: float) -> None:
        if motion.settling_since is not None:
            self._settle(motion, now)
            return
        if not self._guarded(self._following.step(motion, self.speed.of_motion(motion, now))):
            self._step_brake(now)
            return
        if not self._following.standing:
            self._join(now)
            return
        if motion.failure is not None:
            self._finish(motion, now, motion.failure, ok=False)
        elif motion.path_time >= motion.trajectory.duration:
            if self._motions.waiting:
                # The next motion was sent already: it does not wait for the drives to settle.
                self._finish(motion, now, 'reached', ok=True)
                return
            motion.settling_since = now
            self._settle(motion, now)

    def _join(self, now: float) -> None:
        replaced = self._motions.join(now)
        if replaced is not None:
            assert self._motion is not None
            message = PASSED if replaced.passes else f'replaced by motion {self._motion.id}'
            self.outcomes.append(replaced.outcome(now, message, ok=replaced.passes))

    def _step_stream(self, now: float) -> None:
        before = self.reference
        assert before is not None
        reference, over = self.speed.step_stream(self._stream, now, before)
        if over:
            self._end_stream(now, self._stream.failure or '')
            self._stand_at(before[0])
        elif not self._guarded(reference):
            self._step_brake(now)

    def _end_stream(self, now: float, failure: str) -> None:
        self.outcomes.append(self._stream.end(now, failure))

    def _guarded(self, reference: Array) -> bool:
        """Take a reference if it breaks no limit; otherwise start to brake."""
        broken = self._guard.check(reference)
        if broken is None:
            self.reference = reference
            return True
        reason = f'reference refused by the limit guard: {broken}'
        assert self.reference is not None
        self._brake = Brake(self._axes, self.reference, self.settings.period, reason)
        self.stops.trip(Fault.REFERENCE_REFUSED, reason)
        return False

    def _settle(self, motion: FollowedMotion, now: float) -> None:
        assert motion.settling_since is not None
        assert self._feedback.position is not None
        target = motion.trajectory.position[-1]
        error = np.abs(self._feedback.position - target)
        fresh = self._feedback.time >= motion.settling_since
        if motion.failure is not None:
            self._finish(motion, now, motion.failure, ok=False)
        elif fresh and error.max() <= self.settings.goal_tolerance:
            self._finish(motion, now, 'reached', ok=True)
        elif now - motion.settling_since > self.settings.settling_time:
            worst = int(error.argmax())
            unit = self._axes.unit(worst)
            self._finish(
                motion,
                now,
                f'{self._axes.names[worst]} stands {error[worst]:.3g} {unit} from its '
                f'target after {self.settings.settling_time:g} s, '
                f'allowed is {self.settings.goal_tolerance:g} {unit}',
                ok=False,
            )

    def _step_brake(self, now: float) -> None:
        brake = self._brake
        assert brake is not None
        self.reference, standing = brake.step()
        if standing:
            self._end_moving(now, brake.reason)

    def _end_moving(self, now: float, reason: str) -> None:
        """Stand where the reference is, and give up what has moved the robot."""
        assert self.reference is not None
        self._brake = None
        self._stand_at(self.reference[0])
        if self._stream.active:
            self._end_stream(now, reason)
        if self._motion is not None:
            self._finish(self._motion, now, reason, ok=False)

    def _finish(self, motion: FollowedMotion, now: float, message: str, *, ok: bool) -> None:
        blocked = message == BLOCKED
        self.outcomes.append(motion.outcome(now, message, ok=ok, blocked=blocked))
        if ok:
            self._motions.start_next(now)
            if self._motion is not None:
                self._following.begin(self._motion, self.speed.of_motion(self._motion, now))
            return
        if blocked:
            self.blocked.put(motion.id)
        for unbegun in self._motions.clear():
            unbegun.start = now
            reason = f'given up with the motion before it: {message}'
            self.outcomes.append(unbegun.outcome(now, reason, ok=False, blocked=blocked))
