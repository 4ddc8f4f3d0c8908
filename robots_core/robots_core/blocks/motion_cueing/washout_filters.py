"""Linear filters of the washout: three equal channels each, stepped with any period."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag, expm

from robots_core.validation import Array


class ChannelFilters:
    """One linear filter for each channel, from rest.

    Exact for inputs that are straight lines between the samples (first-order hold, Franklin, Powell and
    Workman, Digital Control of Dynamic Systems), so that positions, velocities and accelerations agree with
    each other at every period.

    Args:
        channels: (A, B, C, D) of each channel with one input: x' = A x + B u, y = C x + D u.
        dt: Period, s.
    """

    def __init__(self, channels: Sequence[tuple[Array, Array, Array, Array]], dt: float) -> None:
        discrete = [_discrete(*channel, dt) for channel in channels]
        self._A, self._B, self._C, self._D = (
            block_diag(*matrices) for matrices in zip(*discrete, strict=True)
        )
        self._state = np.zeros(len(self._A))
        self._shape = (len(channels), -1)

    def step(self, inputs: Array) -> Array:
        """Outputs (outputs, channels) at the next sample, whose inputs are (channels,)."""
        outputs: Array = self._C @ self._state + self._D @ inputs
        self._state = self._A @ self._state + self._B @ inputs
        return outputs.reshape(self._shape).T


def _discrete(A: Array, B: Array, C: Array, D: Array, dt: float) -> tuple[Array, Array, Array, Array]:
    """A channel for periods dt with first-order hold, as by `scipy.signal`, which takes 0.9 s to load."""
    n = len(A)
    exponent = np.zeros((n + 2, n + 2))
    exponent[:n, :n], exponent[:n, n : n + 1], exponent[n, n + 1] = A * dt, B * dt, 1.0
    rows = expm(exponent)[:n]
    of_state, of_input, of_slope = rows[:, :n], rows[:, n : n + 1], rows[:, n + 1 :]
    return of_state, of_input - of_slope + of_state @ of_slope, C, D + C @ of_slope


def translation_filters(
    frequency: Sequence[float], damping: Sequence[float], pole: Sequence[float], dt: float
) -> ChannelFilters:
    """From a wanted acceleration to position, velocity and acceleration of the cabin.

    The third-order high-pass s^3 / ((s^2 + 2 zeta omega s + omega^2) (s + omega_b)), integrated twice.
    """
    return ChannelFilters(
        [
            _chain([w**2 * b, w**2 + 2.0 * z * w * b, 2.0 * z * w + b], 1)
            for w, z, b in zip(frequency, damping, pole, strict=True)
        ],
        dt,
    )


def rotation_filters(frequency: Sequence[float], damping: Sequence[float], dt: float) -> ChannelFilters:
    """From a wanted angular rate to angle and rate of the cabin.

    The second-order high-pass s^2 / (s^2 + 2 zeta omega s + omega^2), integrated once.
    """
    return ChannelFilters(
        [_chain([w**2, 2.0 * z * w], 1) for w, z in zip(frequency, damping, strict=True)], dt
    )


def tilt_filters(frequency: Sequence[float], damping: Sequence[float], dt: float) -> ChannelFilters:
    """From a wanted specific force along x and y to what tilting gives of it.

    The second-order low-pass omega^2 / (s^2 + 2 zeta omega s + omega^2).
    """
    channels = []
    for w, z in zip(frequency, damping, strict=True):
        A, B, C, D = _chain([w**2, 2.0 * z * w], 0)
        channels.append((A, B, w**2 * C[:1], D[:1]))
    return ChannelFilters(channels, dt)


def _chain(coefficients: Sequence[float], first: int) -> tuple[Array, Array, Array, Array]:
    """Chain of integrators x_1, x_2 = x_1', ... whose last derivative is u - sum a_i x_i.

    Its outputs are the states from number `first` on (from 0), and the last derivative.
    """
    n = len(coefficients)
    A = np.eye(n, k=1)
    A[-1] = -np.asarray(coefficients)
    B = np.eye(n)[:, -1:]
    C = np.vstack([np.eye(n)[first:], A[-1:]])
    D = np.zeros((len(C), 1))
    D[-1] = 1.0
    return A, B, C, D
