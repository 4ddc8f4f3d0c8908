"""ControllerRest: the loop of controller_node sleeps while the robot holds its position."""

from collections.abc import Sequence

from robots_controller.control.control_loop import ControlLoop
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.streams.serialized_streams import ReferenceStream


class ControllerRest:
    """See `Rest`: leaves out cycles where no request waits, nothing is checked and no reference is sent."""

    def __init__(
        self,
        control: ControlLoop,
        references: ReferenceStream,
        health_every: int,
        watches: Sequence[HeartbeatWatch],
    ) -> None:
        self._control, self._references, self._health_every = control, references, health_every
        self._watches = watches
        self.wait = control.wait

    def periods(self) -> int:
        """See `Rest`."""
        control = self._control
        ahead = self._references.resting.ahead
        if not ahead:  # as of a robot that moves: found out at the least cost
            return 0
        unwatched = min(watch.due for watch in self._watches) - control.now
        return int(
            min(
                ahead,
                control.idle_cycles,
                -(control.cycle + 1) % self._health_every,  # watched at the end of a cycle
                unwatched / control.controller.settings.period,
            )
        )

    def left_out(self, periods: int) -> None:
        """See `Rest`."""
        if periods:
            self._control.pass_over(periods)
            self._references.pass_over(periods)
