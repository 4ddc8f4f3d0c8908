"""WatchedInputs: digital inputs that stop the robot or close the borders of zones, at the controller."""

from collections.abc import Collection, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import Fault
from robots_controller.io.stopping_inputs import Closing, Stopping, closed_zones, emergency_reason

NO_IMAGE: Final = 'digital_inputs, in which the emergency stop is, has not been published yet'


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


def missing_signs(expected: Sequence[str], unseen: Collection[str], *, image: bool) -> str:
    """What no motion starts without and is not there yet, for a person; '' if nothing is missing.

    Args:
        expected: Names of nodes.
        unseen: Of those without a sign of life so far.
        image: The image with the emergency stop is missing.
    """
    missing = [f'no sign of life of {name} yet: is it running?' for name in expected if name in unseen]
    return '; '.join([*missing, NO_IMAGE] if image else missing)
