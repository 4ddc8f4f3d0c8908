"""Interpolator: the moving average that makes a smooth reference of the sampled trajectory."""

import numpy as np

from robots_core.validation import Array


class Interpolator:
    """Moving average over the last samples of position, velocity and acceleration.

    The mean of samples inside the limits is inside the limits, the derivatives of the mean are the means
    of the derivatives, and a step in acceleration becomes a ramp: smoother, never faster. The reference
    lags by half the window.

    Args:
        num_axes: n.
        window: Number of samples averaged, from 1, which passes every sample through.
    """

    def __init__(self, num_axes: int, window: int) -> None:
        self.window = window
        self._samples = np.zeros((window, 3 * num_axes))
        self._weights = np.full(window, 1.0 / window)
        self._next = 0

    def reset(self, position: Array) -> None:
        """Stand still at `position` (n,)."""
        self._samples[:] = 0.0
        self._samples[:, : position.size] = position

    def ahead(self, samples: Array) -> Array:
        """What `push` returns for each of these samples, (k, 3, n) both, to the last bit."""
        rows = samples.reshape(len(samples), -1)
        rows = np.concatenate([np.roll(self._samples, -self._next, axis=0), rows])
        # In the order in which the samples are kept, the weighted sum has the same bits.
        places = np.arange(self.window) - self._next - 1
        first = np.arange(len(samples))[:, None]
        kept = rows[first + 1 + (places - first) % self.window]
        base = kept[:, 0]
        return np.asarray(base + self._weights @ (kept - base[:, None])).reshape(samples.shape)

    def pass_over(self, samples: Array) -> None:
        """Take samples (k, 3, n) whose means are known already."""
        self._next = (self._next + len(samples)) % self.window
        newest = samples[-self.window :]
        self._samples[(self._next - np.arange(len(newest), 0, -1)) % self.window] = newest.reshape(
            len(newest), -1
        )

    def push(self, sample: Array) -> Array:
        """Take a sample and return the smoothed one.

        Args:
            sample: (3, n): position, velocity, acceleration.

        Returns:
            (3, n), a new array.
        """
        self._samples[self._next] = sample.ravel()
        self._next = (self._next + 1) % self.window
        # Averaging differences to one sample keeps the last digits of large joint values.
        base = self._samples[0]
        return np.asarray(base + self._weights @ (self._samples - base)).reshape(sample.shape)
