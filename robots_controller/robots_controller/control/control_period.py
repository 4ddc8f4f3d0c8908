"""ControlPeriod: the order in which a period of the control loop takes and sends messages."""

from collections.abc import Callable, Mapping

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.zones.shared_zone import ZoneState
from robots_core.validation import Array


class ControlPeriod:
    """A period in which nothing that can wait delays the reference.

    Args:
        control: The loop.
        feedback: Takes the newest feedback (n,), rad (m); None if none came that is valid.
        send: Sends a reference (3, n) to the drives at a time, s.
        claim: Gets the states of shared zones when they have changed.
        ahead: Feedback that is due in the next period is taken in this one, once the reference is out.
    """

    def __init__(
        self,
        control: ControlLoop,
        *,
        feedback: Callable[[], Array | None],
        send: Callable[[Array, float], object],
        claim: Callable[[Mapping[str, ZoneState]], object],
        ahead: bool,
    ) -> None:
        self._control, self._feedback, self._send, self._claim = control, feedback, send, claim
        self._ahead, self._taken = ahead, False  # the feedback of the next period
        self._claims: Mapping[str, ZoneState] = {}

    def run(self, now: float, *, active: bool = True) -> None:
        """Take feedback if it is due, send the reference, and report; now in s.

        A controller that is not active sends no reference of a robot that stands.
        """
        control, controller = self._control, self._control.controller
        due = control.feedback_due and not self._taken
        reference = control.step(now, self._feedback() if due else None)
        if not controller.stops.state.drives_on:
            control.report_stop()  # drives that are to be switched off need not follow the reference
        if reference is not None and (active or not controller.standing):
            self._send(reference, now)
        control.report()
        zones = controller.speed.zones
        if zones is not None and (claims := zones.states) != self._claims:
            self._claims = claims
            self._claim(claims)
        due = control.feedback_due and self._ahead
        position = self._feedback() if due else None
        self._taken = position is not None
        if position is not None:
            control.take_feedback(position)
