"""WatchedInputs: digital inputs that stop the robot or close the borders of zones, at the controller."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import Fault
from robots_controller.io.stopping_inputs import Closing, Stopping, closed_zones, emergency_reason


class WatchedInputs:
    """Passes on what an image of the inputs changes."""

    def __init__(self, control: ControlLoop, emergency: Stopping, zones: Closing) -> None:
        self._control, self._emergency, self._zones = control, emergency, zones
        self._reason = ''
        self._closed: frozenset[str] | None = None

    def check(self, image: Sequence[int], unknown: Mapping[int, str] = MappingProxyType({})) -> None:
        """Look at the digital inputs, from the first one on; `unknown` is that of `emergency_reason`."""
        closed = closed_zones(self._zones, image)
        reason = emergency_reason(self._emergency, image, unknown)
        if closed != self._closed:
            self._closed = closed
            self._control.close_zones(closed)
        if reason != self._reason:
            self._reason = reason
            self._control.watch(Fault.EMERGENCY_STOP_INPUT, reason)
