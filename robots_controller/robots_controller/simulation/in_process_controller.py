"""InProcessController: the controller in one process with the program and the planner."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from robots_controller.cell.ports import ControllerPort
from robots_controller.control.control_loop import ControlLoop, ControlPort
from robots_controller.control.controller import ControllerState
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.controller_request import ControllerRequest
from robots_controller.control.span import Span
from robots_controller.control.stops.stop_latch import StopState
from robots_controller.program.turn_clock import NANOSECONDS
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.cell_interface.operating_modes import Commander
from robots_core.validation import Array

if TYPE_CHECKING:
    from robots_controller.simulation.in_process_cell import InProcessCell


class InProcessController(ControlPort, ControllerPort):
    """Both ends of the messages between the controller and the cell."""

    def __init__(self, cell: InProcessCell) -> None:
        self._cell, self.controller = cell, cell.controller
        self._mail, self._clock, self._log = cell.mail, cell.clock, cell.log
        settings = self.controller.settings
        self._period_ns = round(settings.period * NANOSECONDS)
        self.rates = ControllerRates(1.0 / settings.period, settings.feedback_timeout)
        self.loop = ControlLoop(self.controller, self.rates, self, progress_every=1)
        self._authority = self.controller.speed.authority
        self._progress = 1.0
        self.position: Array | None = None
        """Measured at the end of the last period, (n,), rad (m); None if nothing was measured."""

    @property
    def cycle(self) -> int:
        """Number of the last period; -1 before the first one."""
        return self.loop.cycle - 1

    @property
    def holding(self) -> bool:
        """The controller does not move the robot."""
        return self.controller.state in (ControllerState.HOLDING, ControllerState.STOPPED)

    # -- time -----------------------------------------------------------------------------------------

    def step(self) -> Array | None:
        """Make the step of the next period, whose time the clock has; returns its reference (3, n)."""
        position = self.position if self.loop.feedback_due else None
        reference = self.loop.step(self._clock.now(), position)
        self.loop.report()
        return reference

    def follow(self, span: Span, move: Callable[[slice], Array]) -> int:
        """Let the periods of a span pass.

        Args:
            span: See `Controller.ahead`.
            move: Lets the drives follow these periods of it; returns their positions (n,), rad (m).

        Returns:
            How many have passed: it ends early if the controller has to act on the feedback.
        """
        clock, begin, every = self._clock, self.loop.cycle, self.rates.feedback_every(self.controller)
        passed = 0
        while passed < len(span):
            cycle = begin + passed
            if cycle % every == 0:
                clock.nanoseconds = cycle * self._period_ns
                before = span.references[passed - 1] if passed else self.controller.reference
                assert before is not None
                if not self.controller.check(clock.now(), self.position, before):
                    break
            # The drives move until the controller checks their feedback again.
            end = min(passed + every - cycle % every, len(span))
            if not self.holding:
                self._report_progress(cycle, span.progress[passed:end])
            self.position = move(slice(passed, end))
            passed = end
        clock.nanoseconds = (begin + passed - 1) * self._period_ns
        if passed:
            self.loop.follow_span(span.first(passed), clock.now())
            self._progress = self.controller.progress
        return passed

    def _report_progress(self, cycle: int, progress: Array) -> None:
        """Report the progress after some periods from this one on, where a report is due."""
        every = self.rates.progress_every
        for k in range(-cycle % every, len(progress), every):
            self._clock.nanoseconds = (cycle + k) * self._period_ns
            self._log.progress(float(progress[k]))

    # -- the controller's end -------------------------------------------------------------------------

    def result(self, result: MotionResult) -> None:
        """See `ControlPort`."""
        result = result.ended_at(self._clock.now())
        self._log.report('motion_result', result.status)
        self._mail.append(partial(self._cell.control_ended, result))

    def progress(self, progress: float) -> None:
        """See `ControlPort`."""
        if progress < self._progress:  # of another motion than before
            self._mail.append(self._cell.motion_started)
        self._progress = progress
        if progress in (0.0, 1.0) or self.loop.cycle % self.rates.progress_every == 0:
            self._log.progress(progress)
        self._cell.progressed(progress)

    def stop_changed(self, state: StopState) -> None:
        """See `ControlPort`."""
        self._log.value('drives_on', state.drives_on)
        self._log.report('stop_status', state.status)
        if state.fault is not None:
            self._mail.append(partial(self._cell.stopped, state.reason))

    def run_enabled(self, *, enabled: bool) -> None:
        """See `ControlPort`; a simulation needs no run button."""
        self._log.value('run_enabled', enabled)
        self._cell.run_enabled(enabled=enabled)

    # -- the program's end ----------------------------------------------------------------------------

    def request(self, request: ControllerRequest) -> None:
        """See `ControllerPort`."""
        self.loop.request(request)

    def command(self, *, taken: bool) -> None:
        """See `ControllerPort`; there is no other commander."""
        if taken:
            self.loop.take(Commander.PROGRAM)
        else:
            self._authority.give_back(Commander.PROGRAM)
        self._log.value('commander', self._authority.commander.value)

    def set_override(self, value: float) -> None:
        """See `ControllerPort`."""
        self.loop.set_override(value)
        self._log.override(value)
