"""controller_node: the real-time loop around the `Controller` block."""

from __future__ import annotations

import gc
import math
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64

from robots_controller.control.control_loop import CANCELED, ControlLoop
from robots_controller.control.control_period import ControlPeriod
from robots_controller.control.controller import Controller
from robots_controller.control.controller_condition import REFUSAL_SHOWN, ControllerCondition
from robots_controller.control.controller_rates import ControllerRates, cycles, idle_latency_for
from robots_controller.control.controller_settings import checked_speed_limit
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.stops.faults import Fault
from robots_controller.control.stops.stop_latch import StopState
from robots_controller.nodes.controller.commander_services import CommanderServices, authority_by_parameters
from robots_controller.nodes.controller.controller_parameters import earlier_start, settings_by_parameters
from robots_controller.nodes.controller.controller_rest import ControllerRest
from robots_controller.nodes.controller.watched_nodes import ForeignWriterWatch, WatchedNodes
from robots_controller.nodes.controller.watched_zones import WatchedZones
from robots_controller.nodes.ports.trajectory_intake import TrajectoryIntake
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import RobotsError
from robots_core.nodes.shared_parameters import realtime_priority_parameter, resting_rate_parameter
from robots_core.periodic.realtime import ask_for_realtime, processor_share, processor_share_in_silence
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.managed_node import INACTIVE, ManagedNode
from robots_core.ros.messages import (
    BUILD,
    NANOSECONDS,
    diagnostic_values,
    motion_result_from_message,
    motion_result_message,
)
from robots_core.ros.peers.heartbeat import FreshCommands, watchdog_parameter
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.running.run import run
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.streams.serialized_readers import JointStateReader
from robots_core.ros.streams.serialized_streams import ReferenceStream
from robots_core.status import Level, Status
from robots_core.validation import Array, fraction
from robots_core.wording.safety_note import NOT_CERTIFIED
from robots_planning.motion_settings import settings_from_text

HEALTH_RATE = 10.0  # Hz
# A callback may hold the interpreter for this long before the loop gets its turn.
SWITCH_INTERVAL = 1e-4  # s


class ControllerNode(ManagedNode):
    """Follows `joint_trajectory` and publishes `joint_reference` on absolute deadlines.

    The loop has its own thread, unless time is simulated. Callbacks validate what comes in and put it into a
    mailbox that the loop empties once per period.
    """

    diagnostics_group = 'motion'
    phase = Phase.CONTROL

    def __init__(self, **options: Any) -> None:
        super().__init__('controller_node', **options)
        settings = settings_by_parameters(self)
        rate = 1.0 / settings.period
        priority = realtime_priority_parameter(self)
        latency = self.parameter(
            'idle_latency',
            idle_latency_for(rate),
            'longest time that idle processors may take to wake up, s, where the system permits to ask; '
            'at 0 (the default from 500 Hz on) none sleeps, which takes power and keeps time best; '
            'negative: not asked',
            bounds=(-1.0, 1.0),
        )
        watchdog = watchdog_parameter(self)
        share = {} if self.simulated_time else {'processor_share': processor_share}
        limit = self.parameter(
            'tool_speed_limit',
            0.0,
            'highest speed of the tool and of the frames of all axes, on every motion, m/s; 0 for none; '
            f'{NOT_CERTIFIED}',
            bounds=(0.0, 100.0),
            read=checked_speed_limit,
        )
        authority = authority_by_parameters(self)
        self._frame_limit = FrameSpeedLimit(self.robot, authority.speed_limit(limit))
        self._zones = WatchedZones(self)
        axes = self.robot.axes_data
        speed = SpeedControl(
            axes, settings, frame_limit=self._frame_limit, authority=authority, zones=self._zones.guard
        )
        self._controller = Controller(axes, settings, speed=speed, **share)
        self._names = list(self.robot.axes_data.names)
        self._condition = ControllerCondition(self._controller)
        rates = ControllerRates(rate, self._controller.settings.feedback_timeout)
        self._control = ControlLoop(
            self._controller,
            rates,
            self,
            # In simulated time in every period: outputs are switched on the path by it.
            progress_every=1 if self.simulated_time else rates.progress_every,
            watchdog=math.inf if self.simulated_time or not watchdog else watchdog,
            processor_share=processor_share_in_silence,
        )
        self._zones.watch(self._control)
        self._health_every = cycles(rate, HEALTH_RATE)
        self._last_condition: object = None

        self._references = ReferenceStream(
            self,
            'joint_reference',
            self._names,
            time_from_start=1.0 / rate,
            resting=resting_rate_parameter(self, 'joint_reference', rate),
        )
        self._progress_publisher = make_publisher(self, Float64, 'motion_progress')
        self._result_publisher = make_publisher(self, DiagnosticStatus, 'motion_result')
        self._drives_publisher = make_publisher(self, Bool, 'drives_on')
        self._stop_publisher = make_publisher(self, DiagnosticStatus, 'stop_status')
        self._feedback = PolledSubscription(self, JointState, 'joint_states', raw=True)
        self._joint_states = JointStateReader(self._names)
        self._period = ControlPeriod(
            self._control,
            feedback=self._take_feedback,
            send=self._references.publish,
            claim=self._zones.publish_claims,
            ahead=not self.simulated_time,
        )
        self._fresh = FreshCommands(self, watchdog)
        intake = TrajectoryIntake(
            self, self._control, self._fresh, self._publish_result, self._report_cancellation
        )
        self._commanders = CommanderServices(
            self, self._control, self._change_caps, intake.lose_commander, watched=watchdog > 0.0
        )
        subscribe(self, Float64, 'override', self._on_override)
        subscribe(self, Float64, 'speed_scaling', self._on_scaling)
        subscribe(self, DiagnosticStatus, 'motion_settings', self._on_settings)
        self.on_change('tool_speed_limit', lambda _: self._change_caps())
        changed = {
            'lua_program_node': self._commanders.program_changed,
            'planning_node': intake.planner_changed,
        }
        self.watch = WatchedNodes(self, self._control, watchdog, self._zones.inputs, changed).heartbeats
        self._offer_stops()
        self._take_over()
        if not self.active:
            self.give_up()
        self._watches = self._commanders.watch, self.watch
        self._foreign = None if self.participant is not None else ForeignWriterWatch(self, self._control)
        self._report_due = self.create_guard_condition(self.update_health)
        self._executor_priority = priority - 1

        sys.setswitchinterval(SWITCH_INTERVAL)
        gc.freeze()
        self._loop = self.start_loop(
            self._step,
            period=1.0 / rate,
            name='controller',
            realtime_priority=priority,
            idle_latency=latency if latency >= 0.0 else None,
            rest=ControllerRest(self._control, self._references, self._health_every, self._watches),
        )

    def held_up(self, silence: float) -> None:
        """The others have missed this node, and have given up the motions that it was sent."""
        self._fresh.held_up(silence)

    def _take_over(self) -> None:
        """A controller that has taken the place of an earlier one lets nothing move before a reset."""
        text = 'what ended an earlier process of this node: the robot stays stopped until ~/reset'
        interrupted = self.parameter('interrupted', '', text) or earlier_start(self)
        if interrupted:
            self._control.trip(Fault.CONTROLLER_LOST, interrupted)

    def _offer_stops(self) -> None:
        self._stopped_by = ''  # the reason that was logged
        self._reporting_stop = threading.Lock()
        control = self._control
        emergency_stop = partial(control.trip, Fault.EMERGENCY_STOP, 'emergency stop by ~/emergency_stop')
        requests: dict[str, tuple[Callable[[], object], str]] = {
            'pause': (partial(control.request, 'pause'), 'stopping on the path'),
            'resume': (partial(control.request, 'resume'), 'moving on'),
            'cancel': (self._cancel, 'stopping on the path, the motion is given up'),
            'stop': (partial(control.stop, 'stop by ~/stop'), 'stopping on the path, until ~/reset'),
            'stop_before_collision': (
                control.stop_before_collision,
                'stopping on the path before an obstacle',
            ),
            'emergency_stop': (emergency_stop, 'stopping, then switching the drives off, until ~/reset'),
            'reset': (control.reset, 'the robot may move again'),
        }
        for name, (request, answer) in requests.items():
            self.serve(name, partial(_answer, request, answer))
        subscribe(self, Bool, 'emergency_stop', self._on_emergency_stop)
        subscribe(self, Bool, 'robot_running', self._on_robot_running)
        subscribe(self, DiagnosticStatus, 'contact_status', self._on_contact)
        subscribe(self, DiagnosticStatus, 'motion_result', self._on_motion_result)

    # -- the loop ------------------------------------------------------------------------------------

    def _step(self, now: float) -> None:
        self._period.run(now, active=self.active)
        for watch in self._watches:
            if now >= watch.due:
                watch.poll(now)
        if self._control.cycle % self._health_every == 0:
            self._watch_health()
            if self._foreign is not None:
                self._foreign.poll()

    def _take_feedback(self) -> Array | None:
        raw = self._feedback.take()
        if raw is None:
            return None
        try:
            return self._joint_states.position(raw)
        except RobotsError as error:
            self.refuse('joint_states', error, stream=True)
            return None

    def result(self, result: MotionResult) -> None:
        """See `ControlPort`."""
        # Compared with the stamp of a motion that was commanded meanwhile.
        self._publish_result(result.ended_at(self.get_clock().now().nanoseconds / NANOSECONDS))
        if not result.ok:
            self.journal.warning(f'motion stopped: {result.message}')

    def progress(self, progress: float) -> None:
        """See `ControlPort`."""
        self._progress_publisher.publish(Float64(data=progress))

    def stream_refused(self, error: RobotsError, now: float) -> None:
        """See `ControlPort`."""
        # A refused stream continues at its rate: one line a second says enough.
        self.journal.error(f'joint_trajectory: {error}', throttle_duration_sec=REFUSAL_SHOWN)
        self._condition.stream_refused(error, now)

    def stop_changed(self, state: StopState) -> None:
        """See `ControlPort`."""
        self._references.resting.restart()  # brakes open for a reference that stands, and a motion may follow
        self._drives_publisher.publish(Bool(data=state.drives_on))
        with self._reporting_stop:
            self._publish_stop(state.status)
        # Of a robot that stands, the drives are off at once; one that moves is stopped before.
        if state.fault not in (None, Fault.DEACTIVATED) and state.reason != self._stopped_by:
            self.journal.error(f'stopped: {state.reason}')
        self._stopped_by = state.reason

    def _publish_stop(self, status: Status) -> None:
        self._stop_publisher.publish(BUILD.status(status, self.robot_name))

    def run_enabled(self, *, enabled: bool) -> None:
        """See `ControlPort`."""
        self._commanders.run_enabled(enabled=enabled)

    def _publish_result(self, result: MotionResult) -> None:
        self._result_publisher.publish(motion_result_message(result, self.robot_name))

    def _watch_health(self) -> None:
        """Have a change of health reported: waking the executor is expensive."""
        condition = self._current_condition()
        if condition != self._last_condition:
            self._last_condition = condition
            if self.simulated_time:
                self.update_health()
            else:
                self._report_due.trigger()

    def _current_condition(self) -> tuple[Level, str]:
        return self._condition.at(self.now(), '' if self.active else INACTIVE)

    # -- the executor's thread -----------------------------------------------------------------------

    def _on_override(self, message: Float64) -> None:
        self._control.set_override(fraction(message.data, 'override'))

    def _on_scaling(self, message: Float64) -> None:
        self._control.set_scaling(fraction(message.data, 'speed_scaling'))

    def _on_settings(self, message: DiagnosticStatus) -> None:
        self._controller.speed.set_tool(settings_from_text(diagnostic_values(message)).tool_pose.r)

    @property
    def moving(self) -> bool:
        """A motion, a stream or a brake moves the robot."""
        return not self._control.at_rest

    @property
    def mode(self) -> OperatingMode:
        """See `RobotNode`."""
        return self._controller.speed.authority.mode

    def _change_caps(self) -> None:
        limit = self.get_parameter('tool_speed_limit').value
        self._frame_limit.limit = self._controller.speed.authority.speed_limit(limit)
        self._control.search_paths()

    def _on_emergency_stop(self, message: Bool) -> None:
        self._control.watch(
            Fault.EMERGENCY_STOP, 'emergency stop by topic emergency_stop' if message.data else ''
        )

    def _on_robot_running(self, message: Bool) -> None:
        stopped = '' if message.data else 'the robot has stopped by itself: its driver does not follow'
        self._control.watch(Fault.ROBOT_STOPPED, stopped)

    def _on_contact(self, message: DiagnosticStatus) -> None:
        if message.level != DiagnosticStatus.OK:
            self._control.trip(Fault.CONTACT, message.message)

    def _on_motion_result(self, message: DiagnosticStatus) -> None:
        self._control.ended(motion_result_from_message(message))

    def activate(self) -> None:
        """See `ManagedNode`."""
        self._control.release(Fault.DEACTIVATED)

    def give_up(self) -> None:
        """See `ManagedNode`."""
        self._control.watch(Fault.DEACTIVATED, f'{self.get_name()} is not active')

    def _cancel(self) -> None:
        self._control.request('cancel')
        self._report_cancellation(CANCELED)

    def _report_cancellation(self, reason: str) -> None:
        """Publish a cancellation: motions that are still being planned are given up too."""
        until = self.get_clock().now().nanoseconds / NANOSECONDS
        status = StopState(reason=reason).status
        with self._reporting_stop:  # never after a stop that came meanwhile: its loop has another thread
            if not self._controller.stops.latched:
                self._publish_stop(replace(status, values={**status.values, 'until': f'{until:.9f}'}))

    def update_health(self) -> None:
        """Report it, with the loop's figures."""
        if self._executor_priority > 0 and not self.simulated_time:
            # This thread shares the interpreter with the loop: preempted while it holds it, it would hold
            # up the loop too.
            ask_for_realtime(self._executor_priority)
            self._executor_priority = 0
        level, text = self._current_condition()
        self.report_health(
            bytes([level]),
            text,
            state=self._controller.state.value,
            missed_deadlines=self._loop.missed,
            realtime=self._loop.realtime,
            idle_latency_kept=self._loop.idle_latency_kept,
        )


def _answer(request: Callable[[], object], answer: str) -> str:
    request()
    return answer


main: Final = partial(run, ControllerNode)
