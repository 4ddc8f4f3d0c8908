"""A control loop whose drives follow at once: for tests of the loop."""

from __future__ import annotations

from typing import Any

import numpy as np

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.controller import Controller, ControllerSettings
from robots_controller.control.controller_rates import ControllerRates
from robots_controller.control.stops.stop_latch import StopState
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import RobotsError

from .two_axes import quintic, two_axes

PERIOD = 0.004
AXES = two_axes((4.0, 3.0))
START, GOAL = np.zeros(2), np.array([0.4, -0.2])


class ControlRig:
    """A control loop with drives that follow at once."""

    def __init__(self, progress_every: int = 1, **options: Any) -> None:
        settings = ControllerSettings(period=PERIOD)
        rates = ControllerRates(1.0 / PERIOD, settings.feedback_timeout)
        self.results: list[MotionResult] = []
        self.progresses: list[float] = []
        self.refusals: list[str] = []
        self.stops: list[StopState] = []
        self.enabled: list[bool] = []
        self.loop = ControlLoop(
            Controller(AXES, settings), rates, self, progress_every=progress_every, **options
        )
        self.checks = 0
        self.q = START
        self.run(1)

    def begin(self, *, paused: bool) -> None:
        """Move from `START` to `GOAL`, and pause on the way."""
        self.loop.follow(quintic(START, GOAL, 1.0), '1')
        self.run(100)
        if paused:
            self.loop.request('pause')
            self.run(100)

    def result(self, result: MotionResult) -> None:
        self.results.append(result)

    def progress(self, progress: float) -> None:
        self.progresses.append(progress)

    def stream_refused(self, error: RobotsError, _now: float) -> None:
        self.refusals.append(str(error))

    def run_enabled(self, *, enabled: bool) -> None:
        self.enabled.append(enabled)

    def stop_changed(self, state: StopState) -> None:
        self.stops.append(state)

    @property
    def now(self) -> float:
        return self.loop.cycle * PERIOD

    def run(self, periods: int) -> None:
        for _ in range(periods):
            self.checks += self.loop.feedback_due
            reference = self.loop.step(self.now, self.q if self.loop.feedback_due else None)
            assert reference is not None
            self.q = reference[0].copy()
            self.loop.report()

    def run_until_result(self) -> MotionResult:
        while not self.results:
            self.run(1)
            assert self.loop.cycle < 10_000
        return self.results.pop(0)
