"""TimedNode: a node that takes its time from its clock, in lock-step with others if asked."""

import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any, ClassVar, Final

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_service import ParameterService

from robots_core.errors import InvalidInputError
from robots_core.periodic.periodic_thread import PeriodicThread, Rest
from robots_core.ros.lockstep.participant import Participant
from robots_core.ros.lockstep.phases import NANOSECONDS, Phase
from robots_core.ros.lockstep.timed_work import Loop, ScheduledLoop
from robots_core.ros.running.clocks import on_clock_set
from robots_core.ros.running.held_wait_set import LatchedGuardCondition

OFTEN: Final = 0.04
"""s between two signs of life of a node whose loss others notice within `watchdog`."""
SELDOM: Final = 0.2
"""s between two signs of life of a node that only `cell` watches."""


class TimedNode(Node):
    """A node whose timers and loops follow the wall clock, `/clock`, or a lock-step coordinator.

    Args:
        name: Default node name.
        options: Passed on to `rclpy.node.Node`.

    Parameters:
        lockstep: Take part in a lock-step run: time advances when all nodes have done what was due.
        use_sim_time: Follow `/clock`.

    Raises:
        InvalidInputError: both are set.
    """

    phase: ClassVar = Phase.OBSERVE
    """When in an instant of a lock-step run the loops and timers have their turn."""
    takes_part: ClassVar = True
    """Parameter `lockstep` has an effect."""
    heartbeat_period: ClassVar = OFTEN
    """s."""
    alone: ClassVar = False
    """Where another node has its name already, `run` ends it."""
    participant: Participant | None = None
    """The part in a lock-step run; None without."""

    def __init__(self, name: str, **options: Any) -> None:
        parameter_services = options.pop('start_parameter_services', True)
        super().__init__(name, start_parameter_services=False, **options)
        self.journal: Final[Any] = self.get_logger()  # type: ignore[no-untyped-call]
        self.declare_parameter(
            'lockstep',
            value=False,
            descriptor=ParameterDescriptor(
                description='time advances when all nodes have done what was due', read_only=True
            ),
        )
        lockstep = self.get_parameter('lockstep').value and self.takes_part
        follows_clock = self.get_parameter('use_sim_time').value
        if lockstep and follows_clock:
            raise InvalidInputError('lockstep sets the clock itself; use_sim_time must be false with it')
        self.simulated_time = bool(lockstep or follows_clock)
        """Time is not the wall clock's; fixed at the start."""
        if lockstep:
            self.participant = Participant(self)
        if parameter_services:
            self._parameter_service = ParameterService(self)  # its services are counted
        self._running: list[Loop] = []
        self.closing = ExitStack()
        """What the node has opened: `destroy_node` closes it, the last first, before the node itself."""
        self.closing.callback(super().destroy_node)
        self.closing.callback(self._stop_loops)
        self.silence: Callable[[], float] = lambda: 0.0
        """How long the process has given no sign of life, s: after it was frozen, until the next one."""
        if follows_clock:
            self._clock_advanced = self.create_guard_condition(self._run_loops)
            self._jumps = on_clock_set(self.get_clock(), self._clock_advanced.trigger)
        self.add_on_set_parameters_callback(self._keep_clock)

    def _keep_clock(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == 'use_sim_time' and self.is_changed(parameter):
                reason = 'use_sim_time is chosen at the start: loops and timers keep the clock that they have'
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def is_changed(self, parameter: Parameter) -> bool:
        """A declared parameter would get another value."""
        name = parameter.name
        return bool(self.has_parameter(name) and self.get_parameter(name).value != parameter.value)

    def now(self) -> float:
        """Time in s: of the node's clock if it is simulated, otherwise of `time.monotonic`."""
        if self.participant is not None:
            return self.participant.time / NANOSECONDS
        if self.simulated_time:
            return float(self.get_clock().now().nanoseconds / NANOSECONDS)
        return time.monotonic()

    def thread_failed(self, error: BaseException) -> None:
        """A loop's thread has ended with an error: end the node."""
        if self.context.ok():  # otherwise shut down from outside: the thread only noticed it first
            self.journal.fatal(f'internal error: {error!r}')
            self.context.try_shutdown()

    def create_guard_condition(
        self, callback: Callable[[], object], callback_group: CallbackGroup | None = None
    ) -> LatchedGuardCondition:
        """As `Node.create_guard_condition`, but no trigger is lost."""
        group = callback_group or self.default_callback_group
        guard_condition = LatchedGuardCondition(callback, group, context=self.context)
        group.add_entity(guard_condition)
        self._guards.append(guard_condition)
        self._wake_executor()  # type: ignore[no-untyped-call]
        return guard_condition

    def held_up(self, silence: float) -> None:
        """The process gave no sign of life for so long (s), and runs again; from the heartbeat's thread."""

    def start_loop(
        self,
        work: Callable[[float], None],
        *,
        period: float,
        name: str,
        realtime_priority: int = 0,
        idle_latency: float | None = None,
        phase: Phase | None = None,
        next_time: Callable[[], float] | None = None,
        rest: Rest | None = None,
    ) -> Loop:
        """Call `work(now)` in each period.

        On the wall clock it has a thread of its own (see `PeriodicThread`). In simulated time it is called in
        the executor's thread at the multiples of the period.

        Args:
            work: Called with the time at which it was due, s on the clock of `now()`.
            period: s.
            name: Of the thread.
            realtime_priority: Of the thread (see `PeriodicThread`).
            idle_latency: Asked of the system by the thread, s (see `PeriodicThread`).
            phase: When in an instant of a lock-step run; the node's own by default.
            next_time: When the work has something to do, as far as is known before the next message, s: a
                lock-step run leaves out earlier periods.
            rest: Periods that the thread may leave out (see `PeriodicThread`); in simulated time none is.
        """
        loop: Loop
        if self.participant is not None:
            phase = self.phase if phase is None else phase
            loop = self.participant.start_loop(work, period=period, phase=phase, next_time=next_time)
        elif self.simulated_time:
            loop = ScheduledLoop(work, period=round(period * NANOSECONDS))
        else:
            loop = thread = PeriodicThread(
                work,
                period=period,
                name=name,
                realtime_priority=realtime_priority,
                idle_latency=idle_latency,
                on_error=self.thread_failed,
                rest=rest,
            )
            thread.start()
        self._running = [one for one in self._running if one.alive] + [loop]
        return loop

    def _run_loops(self) -> None:
        now = self.get_clock().now().nanoseconds
        for loop in self._running:
            if isinstance(loop, ScheduledLoop):
                loop.run(now)

    def _stop_loops(self) -> None:
        for loop in self._running:
            loop.stop()

    def destroy_node(self) -> None:
        """End the node, its loops before what they use."""
        self.closing.close()

    # -- what a participant counts -------------------------------------------------------------------

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], object],
        callback_group: Any = None,
        clock: Clock | None = None,
        autostart: bool = True,  # noqa: FBT001, FBT002  # rclpy's
        *,
        phase: Phase | None = None,
    ) -> Any:
        """As `Node.create_timer`; in lock-step the timer is the participant's, unless it has its own clock.

        `phase` is when in an instant it has its turn; the node's own by default.
        """
        if self.participant is None or clock is not None:
            return super().create_timer(timer_period_sec, callback, callback_group, clock, autostart)
        return self.participant.create_timer(
            timer_period_sec, callback, phase=self.phase if phase is None else phase, autostart=autostart
        )

    @property
    def _maker(self) -> Any:
        """Makes endpoints: the participant, which counts their messages, or rclpy's node alone."""
        return super() if self.participant is None else self.participant

    def create_publisher(self, msg_type: Any, topic: str, qos_profile: Any, **options: Any) -> Any:
        """As `Node.create_publisher`."""
        return self._maker.create_publisher(msg_type, topic, qos_profile, **options)

    def create_subscription(
        self, msg_type: Any, topic: str, callback: Any, qos_profile: Any, **options: Any
    ) -> Any:
        """As `Node.create_subscription`."""
        return self._maker.create_subscription(msg_type, topic, callback, qos_profile, **options)

    def create_service(self, srv_type: Any, srv_name: str, callback: Any, **options: Any) -> Any:
        """As `Node.create_service`."""
        return self._maker.create_service(srv_type, srv_name, callback, **options)

    def create_client(self, srv_type: Any, srv_name: str, **options: Any) -> Any:
        """As `Node.create_client`."""
        return self._maker.create_client(srv_type, srv_name, **options)

    def destroy_timer(self, timer: Any) -> bool:
        """As `Node.destroy_timer`."""
        if self.participant is None or timer in self._timers:
            return bool(super().destroy_timer(timer))
        timer.cancel()
        return True

    def destroy_subscription(self, subscription: Any) -> bool:
        """As `Node.destroy_subscription`."""
        if self.participant is not None:
            self.participant.counts.close(subscription)
        return bool(super().destroy_subscription(subscription))
