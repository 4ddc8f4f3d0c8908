"""ControlLoop: one period of the controller after the other, whatever the transport is."""

import contextlib
import math
import threading
from collections import deque
from collections.abc import Callable, Collection, Mapping
from functools import partial
from typing import Protocol

from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.controller_request import ControllerRequest
from robots_controller.control.followed_motion import Border, FollowedMotion
from robots_controller.control.span import Span
from robots_controller.control.stops.faults import PERSISTENT, Fault
from robots_controller.control.stops.stop_latch import StopState
from robots_controller.control.streamed_reference import StreamPoint
from robots_controller.control.zones.shared_zone import ZoneState
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import RobotsError
from robots_core.validation import Array
from robots_planning.timing.path_speed_cap import PathSpeedCap
from robots_planning.trajectory import Trajectory

CANCELED = 'canceled by ~/cancel'


class ControlPort(Protocol):
    """What a transport provides to the control loop; called from the loop's thread."""

    def result(self, result: MotionResult) -> None:
        """A motion or a stream has ended."""

    def progress(self, progress: float) -> None:
        """Done part of the current path, 0..1."""

    def stream_refused(self, error: RobotsError, now: float) -> None:  # noqa: ARG002
        """A streamed point was refused."""
        return

    def stop_changed(self, state: StopState) -> None:
        """A fault holds the robot, the drives are switched, or the robot may move; also at the start."""

    def run_enabled(self, *, enabled: bool) -> None:
        """Motions of programs may continue, or wait until a person holds run; also at the start."""


class ControlLoop:
    """The controller with its mailbox, which is emptied once per period.

    Requests may come from any thread; `step` is called by one.

    Args:
        controller: The controller.
        rates: How often what is due.
        port: The transport.
        progress_every: Progress is reported each so many cycles, and always at its ends.
        watchdog: Longest time from one period to the next of a robot that moves, s.
        processor_share: Times this, see `Watchdog`.
    """

    def __init__(
        self,
        controller: Controller,
        rates: ControllerRates,
        port: ControlPort,
        *,
        progress_every: int,
        watchdog: float = math.inf,
        processor_share: Callable[[], float] = lambda: 1.0,
    ) -> None:
        self.controller, self._rates, self._port = controller, rates, port
        self._progress_every = progress_every
        self._watchdog, self._processor_share = watchdog, processor_share
        self._mailbox: deque[Callable[[float], None]] = deque()
        self._came = threading.Event()
        self._coming: list[FollowedMotion] = []  # in the mailbox
        self.cycle = 0
        """Number of the next cycle."""
        self.feedback_due = True
        """The next cycle takes feedback."""
        self._reported = -1.0
        self._stop_state: StopState | None = None
        self._enabled: bool | None = None
        self.now = 0.0
        """Time of the last step, s."""

    @property
    def pending(self) -> bool:
        """A request waits for the next cycle."""
        return bool(self._mailbox)

    @property
    def at_rest(self) -> bool:
        """Nothing moves the robot, and no motion waits for the next cycle."""
        return self.controller.standing and not self._coming

    # -- rest -----------------------------------------------------------------------------------------

    @property
    def idle_cycles(self) -> int:
        """So many cycles from the next one on have nothing to do if nothing comes."""
        controller, rates = self.controller, self._rates
        if (
            self._mailbox
            or controller.speed.zones is not None
            or controller.state is not ControllerState.HOLDING
        ):
            return 0
        return min(-self.cycle % rates.holding_every, rates.look_every - 1)

    def wait(self, timeout: float) -> bool:
        """Wait until something comes, at most for `timeout`, s; whether it has come."""
        came = self._came.wait(timeout)
        self._came.clear()
        return came

    def wake(self) -> None:
        """Let the next cycle come soon: something has come that is not in the mailbox."""
        self._came.set()

    def _put(self, request: Callable[[float], None]) -> None:
        self._mailbox.append(request)
        self._came.set()

    # -- requests -------------------------------------------------------------------------------------

    def follow(self, trajectory: Trajectory, id_: str, *, join_time: float = 0.0) -> None:
        """Follow a trajectory, see `Controller.follow`.

        Raises:
            InvalidInputError: it is too long to be searched for the borders of zones, see `JointPath`.
        """
        speed = self.controller.speed
        motion = FollowedMotion(trajectory, id_, speed.cap(trajectory), speed.borders(trajectory))
        self._coming.append(motion)
        self._put(partial(self._follow, motion, join_time))

    def stream(self, point: StreamPoint, id_: str) -> None:
        """Follow a point of a stream, see `Controller.stream`."""
        self._put(partial(self._stream, point, id_))

    def set_override(self, value: float) -> None:
        """Scale the speed of all motions, 0..1."""
        self._put(lambda _: self.controller.speed.set_override(value))

    def set_scaling(self, value: float) -> None:
        """The part of their speed at which the drives follow, 0..1."""
        self._put(lambda _: self.controller.speed.set_scaling(value))

    def search_paths(self) -> None:
        """Search the paths of the motions that there are anew, for their caps and the borders of zones."""
        speed = self.controller.speed
        for coming in list(self._coming):
            coming.cap, coming.borders = speed.cap(coming.trajectory), speed.borders(coming.trajectory)
        found = [
            (motion, speed.cap(motion.trajectory), speed.borders(motion.trajectory))
            for motion in self.controller.motions
        ]
        self._put(lambda _: _set_found(found))

    def close_zones(self, closed: Collection[str]) -> None:
        """Close the borders of these zones, and open those of all others that can be opened."""
        zones = self.controller.speed.zones
        if zones is not None:
            self._put(lambda _: zones.close(closed))

    def receive_zones(self, robot: str, states: Mapping[str, ZoneState]) -> None:
        """Take the states that another robot has published of the zones shared with it."""
        zones = self.controller.speed.zones
        if zones is not None:
            self._put(lambda _: zones.receive(robot, states))

    def request(self, request: ControllerRequest) -> None:
        """Pause on the path, resume, or stop on the path and give up all motions; the next one may move."""
        if request == 'cancel':
            self.cancel(CANCELED)
        self._put(partial(self._pause, paused=request == 'pause'))

    def cancel(self, reason: str) -> None:
        """Stop on the path and give up all motions for this reason; a pause stays."""
        self._put(lambda _: self.controller.cancel(reason))

    def stop(self, reason: str) -> None:
        """Stop on the path until `reset`, and end a pause."""
        self.trip(Fault.STOP, reason)
        self._put(partial(self._pause, paused=False))

    def stop_before_collision(self) -> None:
        """Stop before an obstacle, see `Controller.stop_before_collision`; a pause stays."""
        self._put(self.controller.stop_before_collision)

    def ended(self, result: MotionResult) -> None:
        """Take the end of a motion, its planner's too, see `BlockedMotion.end`."""
        if not (result.ok or result.blocked):
            self._put(lambda _: self.controller.blocked.end(result.id, result.message))

    def trip(self, fault: Fault, reason: str, *, stands: bool = False) -> None:
        """Stop by a fault, see `Controller.trip`."""
        self._put(partial(self.controller.trip, fault, reason, stands=stands))

    def watch(self, fault: Fault, reason: str) -> None:
        """Stop by a fault whose reason stays; '' says that it is gone, and the stop stays until `reset`."""
        if reason:
            self.trip(fault, reason, stands=True)
        else:
            self._put(lambda _: self.controller.stops.clear(fault))

    def node_changed(self, fault: Fault, reason: str) -> None:
        """A node is lost, whose loss is this fault, or is back: ''."""
        if fault in PERSISTENT:
            self.watch(fault, reason)
        elif reason:
            self.trip(fault, reason)

    def take(self, commander: Commander) -> None:
        """A commander takes the robot, which stands.

        Raises:
            CommandRefusedError: as `CommandAuthority.take`.
        """
        self.controller.speed.authority.take(commander, standing=self.at_rest)

    def take_over(self, commander: Commander) -> None:
        """A commander takes the robot from any other one, whose motions end on their path.

        Raises:
            CommandRefusedError: as `CommandAuthority.take_over`.
        """
        authority = self.controller.speed.authority
        before = authority.commander
        authority.take_over(commander)
        if before is not commander:
            self.cancel(f'{commander} took the robot over')

    def lose_commander(self, commander: Commander, reason: str) -> bool:
        """A commander is gone; returns whether it had the robot, which is free then.

        A robot that a pendant had stops on its path; that of a program is stopped by `Fault.PROGRAM_LOST`.
        """
        authority = self.controller.speed.authority
        had = authority.commander is commander
        if had or authority.commander is Commander.NOBODY:
            authority.give_back(commander)
        if had and commander is Commander.PENDANT:
            self.cancel(reason)
        return had

    def wait_for(self, awaited: str) -> None:
        """Let no motion start without this, see `Controller.awaited`; '' if nothing is missing."""
        self._put(partial(self._wait_for, awaited))

    def release(self, fault: Fault) -> None:
        """End the cause of a fault; the robot may move again unless another fault holds it.

        Raises:
            RobotsError: it moves, or another cause is still there.
        """
        self.controller.check_reset(excluding=fault)
        self._put(partial(self._release, fault))

    def reset(self) -> None:
        """Let the robot move again after a fault.

        Raises:
            RobotsError: it moves, or the cause is still there.
        """
        self.controller.check_reset()
        self._put(self._reset)

    # -- the loop -------------------------------------------------------------------------------------

    def step(self, now: float, position: Array | None) -> Array | None:
        """One period; `report` follows when the reference is out.

        Args:
            now: Time, s.
            position: Feedback, (n,), rad (m); None if none is due, came or was taken ahead.

        Returns:
            The reference (3, n), None before the first feedback.
        """
        controller, mailbox = self.controller, self._mailbox
        silence, self.now = now - self.now, now
        late = silence > self._watchdog and not controller.standing
        if late and silence * self._processor_share() > self._watchdog:
            # The drives have braked meanwhile, off the path: the motion does not continue.
            reason = f'the controller was held up for {silence:.3g} s'
            controller.trip(Fault.CONTROLLER_HELD_UP, reason, now)
        while mailbox:
            mailbox.popleft()(now)
        return controller.step(now, position)

    def take_feedback(self, position: Array) -> None:
        """Take the feedback (n,), rad (m), of the next period ahead of it, after `report`."""
        self.controller.take(self.now, position)

    def report(self) -> None:
        """Report what the period has brought."""
        controller = self.controller
        while controller.outcomes:
            self._port.result(controller.outcomes.popleft())
        self.report_stop()
        enabled = controller.speed.authority.enabled(self.now)
        if enabled is not self._enabled:
            self._enabled = enabled
            self._port.run_enabled(enabled=enabled)
        self._report_progress()
        self.cycle += 1
        self.feedback_due = self._rates.feedback_due(self.cycle, controller)

    def report_stop(self) -> None:
        """Report a change of the stop; `report` does so too."""
        if self.controller.stops.state is not self._stop_state:
            self._stop_state = self.controller.stops.state
            self._port.stop_changed(self._stop_state)

    def ahead(self, now: float, periods: int) -> Span:
        """See `Controller.ahead`; none if something waits for the next cycle."""
        return self.controller.ahead(now, 0 if self._mailbox else periods)

    def follow_span(self, span: Span, now: float) -> None:
        """The periods of a span have passed, the last one at `now`, s."""
        self.controller.pass_over(span)
        self.now, self._reported = now, self.controller.progress
        self.pass_over(len(span))

    def pass_over(self, cycles: int) -> None:
        """Leave out cycles of a robot that stands."""
        self.cycle += cycles
        self.feedback_due = self._rates.feedback_due(self.cycle, self.controller)

    def _report_progress(self) -> None:
        progress = self.controller.progress
        ends = progress in (0.0, 1.0)  # both are reported, whatever the rate
        if progress != self._reported and (ends or self.cycle % self._progress_every == 0):
            self._reported = progress
            self._port.progress(progress)

    def _follow(self, motion: FollowedMotion, join_time: float, now: float) -> None:
        try:
            self.controller.follow(motion, now, join_time=join_time)
        except RobotsError as error:
            self._port.result(MotionResult.refused(motion.id, error))
            return
        finally:
            self._coming.remove(motion)
        self._report_progress()

    def _stream(self, point: StreamPoint, id_: str, now: float) -> None:
        try:
            self.controller.stream(point, id_, now)
        except RobotsError as error:
            self._port.stream_refused(error, now)

    def _reset(self, _now: float) -> None:
        with contextlib.suppress(RobotsError):  # something has come up since it was asked for
            self.controller.reset()

    def _release(self, fault: Fault, now: float) -> None:
        stops = self.controller.stops
        stops.clear(fault)
        if stops.state.fault is fault:
            self._reset(now)

    def _wait_for(self, awaited: str, _now: float) -> None:
        self.controller.awaited = awaited

    def _pause(self, _now: float, *, paused: bool) -> None:
        self.controller.speed.paused = paused


def _set_found(found: list[tuple[FollowedMotion, PathSpeedCap | None, tuple[Border, ...]]]) -> None:
    for motion, cap, borders in reversed(found):  # what a motion leads to comes behind it
        motion.set_cap(cap)
        motion.borders = borders
