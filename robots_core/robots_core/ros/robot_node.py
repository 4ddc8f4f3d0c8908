"""RobotNode: what every node of the suite has: a robot, a health report, checked parameters."""

import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, ClassVar, Final

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.clock import Clock
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.parameter import Parameter
from rclpy.serialization import deserialize_message
from std_srvs.srv import SetBool, Trigger

from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.cell_interface.parameter_changes import CHANGES, Change, change_of
from robots_core.cell_interface.topic_writers import CHECK_PERIOD, WRITERS, WriterWatch
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.robot_choice import load_robot_model
from robots_core.ros.lockstep.counted_endpoints import NeverExecuted
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.messages import ENCAPSULATION_SIZE, LITTLE_ENDIAN, STAMP_END, diagnostic_status
from robots_core.ros.peers.identified_messages import identify, publishers_are_identified
from robots_core.ros.peers.presence import PublisherNames, Sender, publishers_of
from robots_core.ros.qos import COMMAND, make_publisher
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.timed_node import TimedNode

HEALTH_PERIOD = 1.0  # s
# A subscriber that is matched while a node starts has missed its first reports.
START_PERIOD: Final = 0.1  # s
STARTING: Final = 3.0  # s
REPEAT_PERIOD = 5.0  # s
STRANGER_SHOWN = 2.0  # s
PORTS: Final = (0, 65535)
"""Of this machine; 0 leaves the choice to the system, or stands for none."""


class RobotNode(TimedNode):
    """A node with parameter `robot_model` and a diagnostic status of its own.

    The status is published on `/diagnostics` at every change and once a second, in the first seconds more
    often. A node is ready when its status is OK.

    Args:
        name: Default node name.
        options: Passed on to `TimedNode`.

    Raises:
        UnknownRobotError: the parameter names no robot.
    """

    diagnostics_group: ClassVar = 'robot'
    """Group in which `diagnostic_aggregator` shows the node."""

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._checks: dict[str, Callable[[Any], object]] = {}
        self._kind = name
        self._uses: dict[str, Callable[[Any], object]] = {}
        self.add_on_set_parameters_callback(self._check_parameters)
        self.add_post_set_parameters_callback(self._use_parameters)
        self.robot_name: str = self.parameter(
            'robot_model', 'bello_bot', "the robot's name, or urdf:/path/to/robot.urdf"
        )
        self.robot = load_robot_model(self.robot_name)
        self._health = (DiagnosticStatus.STALE, 'starting')
        self._health_values: dict[str, object] = {}
        self._was_ready = False
        self._problem: str | None = None  # not reported yet
        self._bad_streams: dict[str, float] = {}
        self._strangers: dict[str, tuple[float, str]] = {}  # by topic: when, and what was said
        self._diagnostics = make_publisher(self, DiagnosticArray, '/diagnostics')
        self._started = self.now()
        period = HEALTH_PERIOD if self.simulated_time else START_PERIOD
        self._health_timer = self.create_timer(period, self._repeat_health, phase=Phase.OBSERVE)

    def parameter(
        self,
        name: str,
        default: Any,
        description: str,
        *,
        bounds: tuple[float, float] | None = None,
        read: Callable[[Any], object] | None = None,
    ) -> Any:
        """Declare a parameter and return what its value means; only those of `CHANGES` can change later.

        Args:
            name: The parameter's name.
            default: Its default; it also fixes the type.
            description: One line with the unit, shown by `ros2 param describe`.
            bounds: Lowest and highest valid number; of each in a list.
            read: What a value means; raises a RobotsError for one that is not valid, now and at every change.
                By default the value itself.

        Raises:
            InvalidInputError: the value given at start is of another type or not valid.
        """
        fixed = change_of(self._kind, name, None) is None
        descriptor = ParameterDescriptor(description=description, read_only=fixed)
        if bounds is not None:
            low, high = bounds
            if isinstance(default, int):
                descriptor.integer_range = [IntegerRange(from_value=int(low), to_value=int(high), step=1)]
            else:
                descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
            if isinstance(default, list):  # rclpy checks single numbers alone
                read = partial(_within, bounds)
        try:
            value = self.declare_parameter(name, default, descriptor).value
            meaning = value if read is None else read(value)
        except (InvalidParameterTypeException, InvalidParameterValueException, RobotsError) as error:
            raise InvalidInputError(f'parameter {name}: {error}') from error
        if read is not None:
            self._checks[name] = read
        return meaning

    def on_change(self, name: str, use: Callable[[Any], object]) -> None:
        """Call back with what a new value of a parameter means, once it holds."""
        self._uses[name] = use

    def _use_parameters(self, parameters: list[Parameter]) -> None:
        for name, value in ((one.name, one.value) for one in parameters if one.name in self._uses):
            self._uses[name](self._checks[name](value) if name in self._checks else value)

    @property
    def moving(self) -> bool:
        """The robot moves, as far as this node has to do with it."""
        return False

    @property
    def mode(self) -> OperatingMode | None:
        """The operating mode; None where this node has nothing to do with it."""
        return None

    def _check_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        for parameter in parameters:
            if self.is_changed(parameter) and (reason := self._refused_change(parameter.name)):
                return SetParametersResult(successful=False, reason=reason)
            check = self._checks.get(parameter.name)
            if check is None:
                continue
            try:
                check(parameter.value)
            except RobotsError as error:
                return SetParametersResult(successful=False, reason=f'{parameter.name}: {error}')
        return SetParametersResult(successful=True)

    def _refused_change(self, name: str) -> str:
        if change_of(self._kind, name, self.mode) is not Change.STANDING or not self.moving:
            return ''
        always = CHANGES[self._kind][name] is Change.STANDING
        where = '' if always else f' in operating mode {self.mode}'
        return f'{name} may change only {Change.STANDING}{where}'

    def ready(self, message: str = 'ready', **values: object) -> None:
        """Report that all is well; once it was, a warning does not mean that the node is still starting."""
        self._was_ready = True
        self.report_health(DiagnosticStatus.OK, message, **values)

    def report_health(self, level: bytes, message: str, **values: object) -> None:
        """Set the node's health; a change is published at once."""
        changed = (level, message) != self._health
        self._health, self._health_values = (level, message), values
        if changed:
            self._publish_health()

    def report_problem(self, problem: str, **values: Any) -> None:
        """Report a problem, or with '' that all is well, if it is another one than before."""
        if problem == self._problem:
            return
        self._problem = problem
        if problem:
            self.report_health(DiagnosticStatus.WARN, problem, **values)
            self.journal.warning(problem)
        else:
            self.ready(**values)

    def update_health(self) -> None:
        """Called before health is published again: nodes whose health has values that change set it here."""

    def _repeat_health(self) -> None:
        if self.now() - self._started > STARTING:
            self._health_timer.timer_period_ns = round(1e9 * HEALTH_PERIOD)
        self.update_health()
        self._publish_health()

    def _publish_health(self) -> None:
        level, message = self._health
        now = self.now()
        # A copy: other threads than this one take messages too.
        found = list(self._strangers.values())
        strangers = [text for since, text in found if now - since <= STRANGER_SHOWN]
        if strangers:
            message = '; '.join(strangers if level == DiagnosticStatus.OK else [message, *strangers])
            level = max(level, DiagnosticStatus.WARN)
        status = diagnostic_status(
            self.get_fully_qualified_name(),
            message,
            level=level,
            hardware_id=self.robot_name,
            pid=os.getpid(),
            was_ready=self._was_ready,
            **self._health_values,
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)

    def thread_failed(self, error: BaseException) -> None:
        """Report that a thread of this node ended by itself, and end the node."""
        if self.context.ok():
            self.report_health(DiagnosticStatus.ERROR, f'internal error: {error!r}')
        super().thread_failed(error)

    def serve(self, name: str, answer: Callable[..., str], srv_type: Any = Trigger) -> None:
        """Serve `~/name`; a RobotsError of the answer refuses the request.

        Args:
            name: Below the node's.
            answer: Does what is asked for and says so; gets the value of a SetBool.
            srv_type: Trigger or SetBool.
        """

        def serve(request: Any, response: Any) -> Any:
            try:
                response.message = answer(request.data) if srv_type is SetBool else answer()
                response.success = True
            except RobotsError as error:
                response.success, response.message = False, str(error)
            return response

        self.create_service(srv_type, f'~/{name}', serve)

    def create_subscription(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], None],
        qos_profile: Any,
        *,
        from_anyone: Callable[[Any], bool] = lambda _: False,
        **options: Any,
    ) -> Any:
        """As `Node.create_subscription`; a RobotsError of the callback refuses the message, see `refuse`.

        Messages on a topic of `WRITERS` are dropped and reported where another node has sent them, but for
        those that are taken `from_anyone`.
        """

        def take(message: Any) -> None:
            with self.refusing(topic, stream=qos_profile is not COMMAND):
                callback(message)

        def take_of_writers(message: Any, identity: bytes) -> None:
            assert watch is not None
            if watch.accepts(identity, self.now()) or from_anyone(message):
                take(message)
            elif watch.waits(identity):
                self._offer_again(partial(take_of_writers, message, identity))

        watch = self.writer_watch(topic)
        if watch is None or isinstance(options.get('callback_group'), NeverExecuted):
            return super().create_subscription(msg_type, topic, take, qos_profile, **options)
        return identify(super().create_subscription(msg_type, topic, take_of_writers, qos_profile, **options))

    def poll(
        self,
        msg_type: Any,
        topic: str,
        callback: Callable[[Any], None],
        *,
        rate: float,
        clock: Clock | None = None,
        again: Callable[[bytes], bool] | None = None,
    ) -> None:
        """Look for the newest message of a stream at a rate, and hand it on; a RobotsError refuses it.

        Args:
            msg_type: The topic's type, with a header.
            topic: Its name.
            callback: Gets the message.
            rate: Hz.
            clock: Of the rate; that of the node by default.
            again: Takes the serialized stamp of a message in which nothing else is new; False to have the
                callback take the message too. On a wall clock such messages are taken at half the rate.
        """
        subscription = PolledSubscription(self, msg_type, topic, raw=True)
        content = b''

        def check() -> None:
            nonlocal content
            data = subscription.take()
            if data is None:
                return
            same = data[STAMP_END:] == content and data.startswith(LITTLE_ENDIAN)
            with self.refusing(topic):
                if not (same and again is not None and again(data[ENCAPSULATION_SIZE:STAMP_END])):
                    content = b''
                    callback(deserialize_message(data, msg_type))
                    content = data[STAMP_END:]
            if seldom and timer.timer_period_ns != periods[same]:
                timer.timer_period_ns = periods[same]

        timer = self.create_timer(1.0 / rate, check, clock=clock)
        periods = timer.timer_period_ns, 2 * timer.timer_period_ns
        seldom = again is not None and (clock is not None or not self.simulated_time)

    def create_subscription_with_sender(
        self, msg_type: Any, topic: str, callback: Callable[[Any, Sender], None]
    ) -> Any:
        """Subscribe to commands of the suite; the callback gets the sender too."""

        def take(message: Any, sender: Sender) -> None:
            with self.refusing(topic, stream=False):
                callback(message, sender)

        if self.participant is not None or not publishers_are_identified():
            return super().create_subscription(
                msg_type, topic, lambda message: take(message, Sender()), COMMAND
            )
        senders = PublisherNames(partial(publishers_of, self, topic))

        def take_identified(message: Any, identity: bytes) -> None:
            take(message, Sender(senders.name(identity), subscription.identified.sent))

        subscription: Any = super().create_subscription(msg_type, topic, take_identified, COMMAND)
        return identify(subscription)

    def _offer_again(self, take: Callable[[], None]) -> None:
        def once() -> None:
            self.destroy_timer(timer)
            take()

        timer = self.create_timer(CHECK_PERIOD, once)

    def writer_watch(self, topic: str) -> WriterWatch | None:
        """Separates writers of a topic from others; None where none are dropped."""
        if topic not in WRITERS or self.participant is not None or not publishers_are_identified():
            return None
        namespace = self.get_namespace().rstrip('/') + '/'
        return WriterWatch(
            topic, namespace, partial(publishers_of, self, topic), partial(self._on_stranger, topic)
        )

    def _on_stranger(self, topic: str, text: str) -> None:
        now, (since, before) = self.now(), self._strangers.get(topic, (-math.inf, ''))
        self._strangers[topic] = now, text
        if text != before or now - since > STRANGER_SHOWN:
            self.journal.error(text)
            self._publish_health()

    @contextmanager
    def refusing(self, topic: str, *, stream: bool = True) -> Iterator[None]:
        """Refuse, see `refuse`, what a topic has brought if reading or using it raises a RobotsError."""
        try:
            yield
        except RobotsError as error:
            self.refuse(topic, error, stream=stream)

    def refuse(self, topic: str, error: RobotsError, *, stream: bool = False) -> None:
        """Log and report bad input on a topic; the node continues.

        Args:
            topic: Where it came from.
            error: What is wrong with it.
            stream: The topic is a stream: as long as it stays bad it is logged once in `REPEAT_PERIOD`.
        """
        now = self.now()
        if not stream or now - self._bad_streams.get(topic, -REPEAT_PERIOD) >= REPEAT_PERIOD:
            self._bad_streams[topic] = now
            self.journal.error(f'{topic}: {error}')
        self.report_health(DiagnosticStatus.WARN, f'{topic}: {error}')


def _within(bounds: tuple[float, float], values: Any) -> Any:
    low, high = bounds
    for value in values:
        if not low <= value <= high:
            raise InvalidInputError(f'{value:g} must be in [{low:g}, {high:g}]')
    return values
