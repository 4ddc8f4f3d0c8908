"""ControllerRest: the loop of controller_node sleeps while the robot holds its position."""

from robots_controller.control.control_loop import ControlLoop
from robots_core.ros.streams.serialized_streams import ReferenceStream


class ControllerRest:
    """See `Rest`: leaves out cycles where no request waits, nothing is checked and no reference is sent."""

    def __init__(self, control: ControlLoop, references: ReferenceStream, health_every: int) -> None:
        self._control, self._references, self._health_every = control, references, health_every
        self.wait = control.wait

    def periods(self) -> int:
        """See `Rest`."""
        ahead = self._references.ahead  # of a robot that moves there are none: found out at the least cost
        return ahead and min(ahead, self._control.idle_cycles, -self._control.cycle % self._health_every)

    def left_out(self, periods: int) -> None:
        """See `Rest`."""
        if periods:
            self._control.pass_over(periods)
            self._references.pass_over(periods)
