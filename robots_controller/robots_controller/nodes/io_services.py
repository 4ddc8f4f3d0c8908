"""IoServices: the topics and services of an IoImage."""

import threading
from collections.abc import Callable
from functools import partial
from typing import Any, Final, get_args

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import ParameterDescriptor, ParameterType, ParameterValue, SetParametersResult
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from rclpy.duration import Duration
from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from std_srvs.srv import SetBool

from robots_controller.io.io_image import IMAGES, Channel, IoImage, Kind, forced_status
from robots_controller.nodes.ports.io_images import ImagePublisher, image_message
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import BUILD
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode

OUTPUT_PERIOD: Final = 0.1  # s between repetitions of the output images
FINISH_TIMEOUT: Final = Duration(seconds=0.25)  # of each image
OUTPUTS: Final = tuple(name for name in IMAGES if name.endswith('outputs'))
FORCE: Final = 'force'
_GROUPS: Final = tuple(name.removesuffix('s') for name in IMAGES)
_TYPE_NAMES: Final = {
    ParameterType.PARAMETER_NOT_SET: 'no value',
    ParameterType.PARAMETER_BOOL: 'a bool',
    ParameterType.PARAMETER_STRING: 'a string',
    ParameterType.PARAMETER_DOUBLE: 'a double',
}
_WANTED: Final[dict[Kind, str]] = {
    'digital': 'a bool, or an integer 0 or 1',
    'analog': 'a double or an integer',
}


class IoServices:
    """Publishes an image at every change, takes inputs from topics, and serves all channels by name.

    Outputs are repeated every `OUTPUT_PERIOD`: their age shows whether the robot program's node works.

    Topics: `digital_inputs`, `analog_inputs` in; `digital_outputs`, `analog_outputs`, the inputs as the
    program reads them below the node's name, and `forced_inputs` out, all latched.
    Services: `~/get_io`, `~/set_io`, `~/list_io`, `~/describe_io` with the types of parameter services. A
    channel's name with `.force` behind it stands for its forced value; set to no value it releases the input.

    Args:
        on_inputs: Inputs came on a topic: the error, or None.
        channel_services: Serve each digital channel too, as `~/digital_input_1/set`; the executor waits for
            every service at each wake-up.
    """

    def __init__(
        self,
        node: RobotNode,
        image: IoImage,
        on_inputs: Callable[[str, InvalidInputError | None], None],
        *,
        channel_services: bool,
    ) -> None:
        self._image = image
        self._on_inputs = on_inputs
        self._owner = node.get_fully_qualified_name()
        self._lock = threading.Lock()
        self._forced: dict[Channel, float] | None = None
        self._publishers = {
            name: ImagePublisher(node, name, name if name in OUTPUTS else f'~/{name}', labelled=True)
            for name in IMAGES
        }
        self._forced_publisher = make_publisher(node, DiagnosticStatus, 'forced_inputs')
        kinds: tuple[Kind, ...] = get_args(Kind)
        for kind in kinds:
            topic = f'{kind}_inputs'
            subscribe(node, image_message(topic), topic, partial(self._on_message, kind, topic))
        for service, name, serve in (
            (GetParameters, 'get_io', self._get),
            (SetParameters, 'set_io', self._set),
            (ListParameters, 'list_io', self._list),
            (DescribeParameters, 'describe_io', self._describe),
        ):
            node.create_service(service, f'~/{name}', serve)
        for channel in image.channels:
            if channel_services and channel.kind == 'digital':
                name = f'{channel.kind}_{channel.direction}_{channel.index}/set'
                node.serve(name, partial(self._set_digital, channel), SetBool)
        self.publish()
        node.create_timer(OUTPUT_PERIOD, self._repeat_outputs)

    def _repeat_outputs(self) -> None:
        with self._lock:
            for name in OUTPUTS:
                self._publishers[name].repeat()
        self.publish()

    def publish(self) -> None:
        """Publish what changed since the last time; safe from any thread."""
        with self._lock:  # held while publishing: an older image must not overtake a newer one
            for name in IMAGES:
                self._publishers[name].publish(self._image.numbers(name))
            if (forced := self._image.forced()) != self._forced:
                self._forced = forced
                self._forced_publisher.publish(BUILD.status(forced_status(forced), self._owner))

    def finish(self) -> None:
        """Wait until the outputs have arrived where they are needed, but not for long."""
        for name in OUTPUTS:
            self._publishers[name].publisher.wait_for_all_acked(FINISH_TIMEOUT)

    # -- the executor's thread ------------------------------------------------------------------

    def _on_message(self, kind: Kind, topic: str, message: UInt8MultiArray | Float64MultiArray) -> None:
        try:
            changed = self._image.set_inputs(kind, message.data)
        except InvalidInputError as error:
            self._on_inputs(topic, error)
        else:
            if changed:
                self.publish()
            self._on_inputs(topic, None)

    def _get(self, request: GetParameters.Request, response: GetParameters.Response) -> Any:
        response.values = [self._value(name) for name in request.names]
        return response

    def _value(self, name: str) -> ParameterValue:
        try:
            channel, force = self._find(name)
        except InvalidInputError as error:
            # The reason takes the place of the value: there is no other in the response.
            return ParameterValue(string_value=str(error))
        value = self._image.forced().get(channel) if force else self._image.value(channel)
        if value is None:
            return ParameterValue(string_value=f'{channel.name} is not forced')
        if channel.kind == 'digital':
            return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=bool(value))
        return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)

    def _set(self, request: SetParameters.Request, response: SetParameters.Response) -> Any:
        for parameter in request.parameters:
            try:
                reason = self._set_one(parameter.name, parameter.value)
            except InvalidInputError as error:
                response.results.append(SetParametersResult(successful=False, reason=str(error)))
            else:
                response.results.append(SetParametersResult(successful=True, reason=reason))
        self.publish()
        return response

    def _set_one(self, name: str, value: ParameterValue) -> str:
        channel, force = self._find(name)
        if force and value.type == ParameterType.PARAMETER_NOT_SET:
            self._image.release(channel)
            return 'released'
        number = _number(channel, value)
        if force:
            self._image.force(channel, number)
            return 'forced'
        self._image.set_value(channel, number)
        if (forced := self._image.forced().get(channel)) is not None:
            return f'{channel.name} is forced to {channel.text(forced)}; the value shows once it is released'
        return ''

    def _set_digital(self, channel: Channel, on: bool) -> str:  # noqa: FBT001  # the value of a SetBool
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=on)
        answer = self._set_one(channel.name, value)
        self.publish()
        return answer

    def _list(self, request: ListParameters.Request, response: ListParameters.Response) -> Any:
        names = [channel.name for channel in self._image.channels]
        names += [f'{channel.name}.{FORCE}' for channel in self._image.forced()]
        prefixes = [f'{prefix.rstrip(".")}.' for prefix in request.prefixes] or ['']
        listed = {
            name
            for name in names
            for prefix in prefixes
            if f'{name}.'.startswith(prefix)
            and (not request.depth or name.removeprefix(prefix).count('.') < request.depth)
        }
        response.result.names = [name for name in names if name in listed]
        response.result.prefixes = list(dict.fromkeys(n.rpartition('.')[0] for n in response.result.names))
        return response

    def _describe(self, request: DescribeParameters.Request, response: DescribeParameters.Response) -> Any:
        response.descriptors = [self._descriptor(name) for name in request.names]
        return response

    def _descriptor(self, name: str) -> ParameterDescriptor:
        try:
            channel, force = self._find(name)
        except InvalidInputError as error:
            return ParameterDescriptor(name=name, description=str(error))
        digital, text = channel.kind == 'digital', f'{channel.kind} {channel.direction} {channel.index}'
        if channel.label:
            text = f'{channel.label}: {text}'
        forced = self._image.forced().get(channel)
        if forced is not None:
            text += f', forced to {channel.text(forced)}'
        return ParameterDescriptor(
            name=f'{channel.name}.{FORCE}' if force else channel.name,
            type=ParameterType.PARAMETER_BOOL if digital else ParameterType.PARAMETER_DOUBLE,
            description=text,
            additional_constraints=_WANTED[channel.kind],
        )

    def _find(self, name: str) -> tuple[Channel, bool]:
        plain, dot, last = name.rpartition('.')
        # A channel may be called `force` itself: `digital_input.force`.
        if not (dot and last == FORCE) or plain in _GROUPS:
            return self._image.find(name), False
        channel = self._image.find(plain)
        if channel.direction == 'output':
            raise InvalidInputError(f'{channel.name} is an output; only inputs can be forced')
        return channel, True


def _number(channel: Channel, value: ParameterValue) -> float:
    if value.type == ParameterType.PARAMETER_BOOL and channel.kind == 'digital':
        return float(value.bool_value)
    if value.type == ParameterType.PARAMETER_INTEGER:
        return channel.checked(value.integer_value)
    if value.type == ParameterType.PARAMETER_DOUBLE and channel.kind == 'analog':
        return channel.checked(value.double_value)
    given = _TYPE_NAMES.get(value.type, 'an array')
    raise InvalidInputError(f'{channel.name} got {given}; valid is {_WANTED[channel.kind]}')
