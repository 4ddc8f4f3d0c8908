"""SwitchedTimeLaw: its points where acceleration changes."""

import numpy as np
import pytest

from robots_planning.timing.switched_time_law import CLOSEST_RAMPS, SwitchedTimeLaw

LONGEST = 0.006  # s


@pytest.mark.parametrize('window', [5e-5, 0.002, 0.0065, 0.05])
@pytest.mark.parametrize('points', [40, 400])
def test_both_ends_of_every_ramp_have_a_point(window: float, points: int) -> None:
    s = np.linspace(0.0, 1.0, points + 1)
    # Accelerated by 4, even, and decelerated by 8 to rest.
    u = np.minimum(np.minimum(8.0 * s, 2.0), 16.0 * (1.0 - s))
    u[-1] = 0.0
    law = SwitchedTimeLaw(s, u, np.zeros(points), window)
    times = law.sample_times(LONGEST, np.ones(points + 1))
    _, begin, end = law.at_grid
    jump = np.abs(np.append(begin, 0.0) - np.append(0.0, end)) > 1.0
    starts = law.grid_times[jump] - 0.5 * window
    for ramp in (*starts, *(starts + window)):
        assert np.abs(times - ramp).min() <= min(CLOSEST_RAMPS, window)
    assert jump.sum() >= 4
    assert times[0] == 0.0
    assert times[-1] == law.duration
    steps = np.diff(times)
    assert steps.min() > 0.0
    assert steps.max() <= LONGEST * (1.0 + 1e-9)
