"""Recording: collects the samples of a simulated cell."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_controller.program.turn_clock import NANOSECONDS
from robots_core.validation import Array, read_only

INITIAL_SIZE: Final = 4096  # samples; 16 s at 250 Hz


class Recording:
    """Grows as the simulation continues."""

    def __init__(self, num_axes: int, *, torque: bool) -> None:
        self.count = 0
        """Number of samples k."""
        self.nanoseconds: NDArray[np.int64] = np.zeros(INITIAL_SIZE, np.int64)
        """Times of the samples in their first k elements; so are the others."""
        self.reference: Array = np.zeros((INITIAL_SIZE, 3, num_axes))
        # Positions, velocities and torques of the drives.
        self.state: Array = np.zeros((INITIAL_SIZE, 3 if torque else 2, num_axes))

    @property
    def time(self) -> Array:
        """Times of the samples, (k,) s, read-only."""
        return read_only(self.nanoseconds[: self.count] / NANOSECONDS)

    @property
    def references(self) -> Array:
        """Positions, velocities and accelerations of the references, (k, 3, n), read-only."""
        return read_only(self.reference[: self.count])

    @property
    def states(self) -> tuple[Array, Array, Array | None]:
        """Positions, velocities and, where known, torques of the drives, (k, n) each, read-only."""
        parts = [read_only(part) for part in np.moveaxis(self.state[: self.count], 1, 0)]
        return parts[0], parts[1], parts[2] if len(parts) > 2 else None

    def add(self, nanoseconds: int, reference: Array, q: Array, q_dot: Array, torque: Array | None) -> None:
        """Add a sample."""
        k = self.count
        if k == self.nanoseconds.size:
            self._grow(1)
        self.nanoseconds[k] = nanoseconds
        self.reference[k] = reference
        state = self.state[k]
        state[0], state[1] = q, q_dot
        if torque is not None:
            state[2] = torque
        self.count = k + 1

    def room(self, count: int) -> tuple[NDArray[np.int64], Array, Array]:
        """Where the next `count` samples are put: times, references and states, see the attributes."""
        if self.count + count > self.nanoseconds.size:
            self._grow(count)
        part = slice(self.count, self.count + count)
        return self.nanoseconds[part], self.reference[part], self.state[part]

    def repeat(self, count: int, period: int) -> None:
        """Add copies of the last sample, `period` (ns) apart."""
        nanoseconds, reference, state = self.room(count)
        last = self.count - 1
        nanoseconds[:] = self.nanoseconds[last] + period * np.arange(1, count + 1)
        reference[:], state[:] = self.reference[last], self.state[last]
        self.count += count

    def standing(self, samples: int) -> bool:
        """The reference has not changed in the last samples."""
        last = self.reference[max(0, self.count - samples) : self.count]
        return bool((last == last[0]).all())

    def _grow(self, more: int) -> None:
        size = max(2 * self.nanoseconds.size, self.count + more)
        for name in ('nanoseconds', 'reference', 'state'):
            old = getattr(self, name)
            new = np.zeros((size, *old.shape[1:]), old.dtype)
            new[: self.count] = old[: self.count]
            setattr(self, name, new)
