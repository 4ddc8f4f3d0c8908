"""MotionRecording: positions and torques of the axes, kept while a person moves the robot."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_core.blocks.calibration.motion_samples import MotionSamples
from robots_core.validation import Array

PERIOD: Final = 0.01  # s, between two checks for new feedback
LONGEST: Final = 300.0  # s


@dataclass(frozen=True, eq=False)
class MeasuredMotion:
    """Feedback of one moment.

    Attributes:
        time: s.
        q: Joint positions, (n,), rad (m).
        tau: Torques of the motors, at the joints, (n,), N m (N).
    """

    time: float
    q: Array
    tau: Array


class MotionRecording:
    """Takes feedback in a thread of its own, from `start` to `stop`.

    Args:
        take: The newest feedback; None where there is none, or none with torques.
    """

    def __init__(self, take: Callable[[], MeasuredMotion | None]) -> None:
        self._take = take
        self._taken: list[MeasuredMotion] = []
        self._end = threading.Event()
        self._thread: threading.Thread | None = None

    @property
    def running(self) -> bool:
        """Feedback is taken."""
        return self._thread is not None and self._thread.is_alive()

    @property
    def duration(self) -> float:
        """Of what has been recorded, s."""
        taken = self._taken
        return taken[-1].time - taken[0].time if taken else 0.0

    def start(self) -> None:
        """Begin anew; an earlier recording is forgotten."""
        self.stop()
        self._taken, self._end = [], threading.Event()
        self._thread = threading.Thread(target=self._record, args=(self._taken, self._end), daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Take nothing more."""
        self._end.set()
        if self._thread is not None:
            self._thread.join()

    def samples(self) -> MotionSamples:
        """The motion that was recorded.

        Raises:
            InvalidInputError: too little was recorded.
        """
        taken = self._taken
        time, q, tau = ([getattr(one, name) for one in taken] for name in ('time', 'q', 'tau'))
        return MotionSamples.from_recording(np.array(time), np.array(q), np.array(tau))

    def _record(self, taken: list[MeasuredMotion], end: threading.Event) -> None:
        while not end.wait(PERIOD):
            newest = self._take()
            if newest is not None and (not taken or newest.time > taken[-1].time):
                taken.append(newest)
            if taken and taken[-1].time - taken[0].time > LONGEST:
                return
