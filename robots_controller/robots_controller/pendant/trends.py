"""Trends: what signals of the cell were over the last minutes."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_controller.io.io_image import IMAGES
from robots_controller.pendant.pendant_state import PendantState, ShownIo
from robots_core.robot_model.axes_data import AxesData
from robots_core.validation import Array

PERIOD: Final = 0.1  # s between two samples
LONGEST: Final = 300.0  # s
SAMPLES: Final = round(LONGEST / PERIOD)
MOST_CHANNELS: Final = 256  # of each image: memory is bounded
MOST_POINTS: Final = 300  # of a curve


@dataclass(frozen=True)
class Signal:
    """What can be drawn over time.

    Attributes:
        key: Its own, such as 'position 0' or 'digital_input.3'.
        name: Of the axis or the channel, for a person; '' where there is one alone.
        unit: Of its values.
    """

    key: str
    name: str
    unit: str


class Trends:
    """Keeps the last minutes of all signals, in memory that is bounded. Safe from any thread."""

    def __init__(self, axes: AxesData) -> None:
        self._axes = axes
        self._lock = threading.Lock()
        self._sizes: tuple[int, ...] = ()
        self._labels: Mapping[str, tuple[str, ...]] = {}
        self._begin(ShownIo())

    def add(self, now: float, state: PendantState) -> None:
        """Add a sample of the state at a time, s."""
        sizes = tuple(min(len(state.io.values.get(image, ())), MOST_CHANNELS) for image in IMAGES)
        with self._lock:
            if sizes != self._sizes:
                self._sizes = sizes
                self._begin(state.io)
            elif state.io.labels is not self._labels:
                self.signals = tuple(self._all_signals(state.io))
            self._labels = state.io.labels
            with np.errstate(over='ignore'):  # what is too large counts as missing
                self._samples.append((now, np.array([*self._sample(state)], np.float32)))

    def curve(self, key: str, window: float) -> tuple[Array, Array]:
        """Times (s, up to 0 for now) and values of a signal in a window, s, oldest first.

        Values that are missing are left out.
        """
        with self._lock:
            column = next((i for i, one in enumerate(self.signals) if one.key == key), -1)
            if column < 0 or not self._samples:
                return np.empty(0), np.empty(0)
            times = np.array([time for time, _ in self._samples]) - self._samples[-1][0]
            values = np.array([float(row[column]) for _, row in self._samples])
        wanted = (times >= -window) & np.isfinite(values)
        times, values = times[wanted], values[wanted]
        every = max(1, -(-times.size // MOST_POINTS))
        return times[::-1][::every][::-1], values[::-1][::every][::-1]

    def _begin(self, io: ShownIo) -> None:
        self.signals = tuple(self._all_signals(io))
        """All of them, with the newest names of their channels."""
        self._samples: deque[tuple[float, NDArray[np.float32]]] = deque(maxlen=SAMPLES)

    def _all_signals(self, io: ShownIo) -> Iterator[Signal]:
        axes = self._axes
        for quantity, turning, sliding in (
            ('position', '°', 'mm'),
            ('speed', '°/s', 'mm/s'),
            ('torque', '%', '%'),
        ):
            for i, name in enumerate(axes.names):
                yield Signal(f'{quantity} {i}', name, sliding if axes.prismatic[i] else turning)
        yield Signal('tool_speed', '', 'mm/s')
        yield Signal('distance', '', 'mm')
        for image in IMAGES:
            for channel in io.found(image)[:MOST_CHANNELS]:
                yield Signal(channel.name, f'{channel.index} {channel.label}'.strip(), '')

    def _sample(self, state: PendantState) -> Iterator[float]:
        axes = self._axes
        missing = np.full(axes.num_axes, np.nan)
        scale = np.where(axes.prismatic, 1e3, math.degrees(1.0))
        yield from missing if state.q is None else scale * state.q
        yield from missing if state.q_dot is None else scale * state.q_dot
        yield from missing if state.torque is None else 100.0 * np.abs(state.torque) / axes.effort
        yield 1e3 * state.tool_speed if state.tool is not None else math.nan
        yield 1e3 * state.distance
        for image, size in zip(IMAGES, self._sizes, strict=True):
            yield from state.io.values[image][:size] if size else ()
