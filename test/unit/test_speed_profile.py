"""The fastest speeds on a grid: known optima, limits, direction, and a search by linear programs."""

import numpy as np
import pytest
from scipy.optimize import linprog

from robots_planning.timing.speed_profile import fastest_speeds
from robots_planning.timing.tool_limits import LimitedRates, travel

Grid = tuple[np.ndarray, np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray, np.ndarray]]
"""s, (m,); q' and q'' of the axes, (m, n); `travel` of the tool."""

MotionLimits = tuple[np.ndarray, np.ndarray, np.ndarray]
FREE = np.full(4, np.inf)


def speeds_of(grid: Grid, limits: MotionLimits) -> np.ndarray:
    s, q_s, q_ss, of_tool = grid
    velocity, acceleration, tool = limits
    axes = np.stack([q_s / acceleration, q_ss / acceleration, 0.0 * q_s, 0.0 * q_s], axis=2)
    rows = np.concatenate([axes, LimitedRates(*of_tool, tool[::2], tool[1::2]).rows()], axis=1)
    with np.errstate(divide='ignore'):
        highest = 1.0 / np.abs(q_s / velocity).max(axis=1) ** 2
    u = np.zeros(len(s))
    assert fastest_speeds(s, rows, highest, np.ones(len(s)), 1, u, np.empty(len(s) - 1)) == -1
    return u


def duration_of(s: np.ndarray, u: np.ndarray) -> float:
    return float((2.0 * np.diff(s) / (np.sqrt(u[:-1]) + np.sqrt(u[1:]))).sum())


def waves(seed: int, m: int = 300, axes: int = 5) -> Grid:
    """A path of random waves, on which axes stand still and turn back; the tool stands still."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0.0, 1.0, m)
    size, rate = rng.normal(size=(4, 1, axes)), rng.uniform(1.0, 9.0, (4, 1, axes))
    phase = rate * s[None, :, None]
    q_s = (size * np.cos(phase)).sum(axis=0)
    q_ss = (-size * rate * np.sin(phase)).sum(axis=0)
    still = np.zeros((m, 6))
    return s, q_s, q_ss, travel(still, still)


def uses(grid: Grid, limits: MotionLimits, u: np.ndarray) -> tuple[float, float]:
    """Largest use of velocity and acceleration, the latter at both ends of every interval."""
    s, q_s, q_ss, *_ = grid
    path_acceleration = (np.diff(u) / (2.0 * np.diff(s)))[:, None]
    velocity = np.abs(q_s) * np.sqrt(u)[:, None] / limits[0]
    before = np.abs(q_ss[:-1] * u[:-1, None] + q_s[:-1] * path_acceleration) / limits[1]
    after = np.abs(q_ss[1:] * u[1:, None] + q_s[1:] * path_acceleration) / limits[1]
    return float(velocity.max()), float(max(before.max(), after.max()))


def test_a_straight_joint_path_is_the_trapezoid() -> None:
    m = 401
    s, zero, still = np.linspace(0.0, 1.0, m), np.zeros((m, 1)), np.zeros((m, 2))
    u = speeds_of((s, np.full((m, 1), 2.0), zero, (still, still, still)), (np.ones(1), np.array([1.5]), FREE))
    # The switch of acceleration lies between grid points: at most a step of them is lost.
    assert duration_of(s, u) == pytest.approx(2.0 + 1.0 / 1.5, rel=2e-3)


def test_a_circle_keeps_the_length_of_the_tools_acceleration() -> None:
    """Radius 1: where speeding up ends, the centripetal part v^2 uses up all acceleration, and v stays."""
    m, turn = 2001, 4.0
    s = np.linspace(0.0, 1.0, m)
    x_s, x_ss = np.zeros((m, 6)), np.zeros((m, 6))
    x_s[:, 0], x_s[:, 1] = -turn * np.sin(turn * s), turn * np.cos(turn * s)
    x_ss[:, 0], x_ss[:, 1] = -(turn**2) * np.cos(turn * s), -(turn**2) * np.sin(turn * s)
    still = np.zeros((m, 1))
    a = 2.0
    tool = np.array([np.inf, a, np.inf, np.inf])
    u = speeds_of((s, still, still, travel(x_s, x_ss)), (np.ones(1), np.ones(1), tool))
    # With v dv = sqrt(a^2 - v^4) ds: v^2 = a sin(2 s), s the arc length, until v^2 = a at a quarter turn over
    # 2.
    arc_length = turn * s
    optimum = a * np.sin(2.0 * np.minimum(np.minimum(arc_length, turn - arc_length), np.pi / 4.0))
    # On the grid, first order in its step around the tip of the cone.
    np.testing.assert_allclose(u * turn**2, optimum, atol=5e-3 * a)


@pytest.mark.parametrize('seed', range(8))
def test_keeps_the_limits_it_is_given(seed: int) -> None:
    grid = waves(seed)
    limits = np.full(5, 1.3), np.full(5, 2.1), FREE
    u = speeds_of(grid, limits)
    assert u[0] == u[-1] == 0.0
    assert (u[1:-1] > 0.0).all()
    velocity, acceleration = uses(grid, limits, u)
    assert velocity <= 1.0 + 1e-9
    assert acceleration <= 1.0 + 1e-6  # rounding of quotients of these sizes


@pytest.mark.parametrize('seed', range(8))
def test_is_the_same_from_the_other_end(seed: int) -> None:
    s, q_s, q_ss, tool = waves(seed)
    limits = np.full(5, 1.3), np.full(5, 2.1), FREE
    forward = speeds_of((s, q_s, q_ss, tool), limits)
    q_s, q_ss = (np.ascontiguousarray(v[::-1]) for v in (-q_s, q_ss))
    backward = speeds_of((1.0 - s[::-1], q_s, q_ss, tool), limits)
    # Where an axis turns back several profiles are nearly as fast; the passes choose by direction.
    assert duration_of(s, backward[::-1]) == pytest.approx(duration_of(s, forward), rel=1e-5)


@pytest.mark.parametrize('seed', range(3))
def test_is_as_fast_as_what_a_linear_program_finds(seed: int) -> None:
    """The highest sum of s_dot^2 over the same constraints, which is nearly the fastest profile."""
    grid = waves(seed, m=40, axes=3)
    s, q_s, q_ss, *_ = grid
    limits = np.full(3, 1.3), np.full(3, 2.1), FREE
    u = speeds_of(grid, limits)
    step = 0.5 / np.diff(s)
    rows, bounds = [], []
    for i in range(len(s) - 1):
        for first, second, here in ((q_s[i], q_ss[i], i), (q_s[i + 1], q_ss[i + 1], i + 1)):
            for k in range(3):
                row = np.zeros(len(s))
                row[here] += second[k]
                row[i + 1] += first[k] * step[i]
                row[i] -= first[k] * step[i]
                rows += [row, -row]
                bounds += [limits[1][k]] * 2
    top = np.minimum(((limits[0] / np.abs(q_s)) ** 2).min(axis=1), 1e6)
    top[[0, -1]] = 0.0
    best = linprog(-np.ones(len(s)), np.array(rows), np.array(bounds), bounds=[(0.0, high) for high in top])
    assert duration_of(s, u) <= 1.001 * duration_of(s, best.x)


@pytest.mark.parametrize('seed', range(20))
def test_limits_of_vectors_hold_at_both_ends_of_every_interval(seed: int) -> None:
    """Also where no speed above theirs has a next speed at all, with x that changes within the interval."""
    s, q_s, q_ss, _ = waves(seed, m=200, axes=3)
    rng = np.random.default_rng(seed)
    bends = np.stack(
        [rng.uniform(1.0, 40.0) * np.abs(np.sin(rng.uniform(2.0, 9.0) * s)) for _ in range(3)], 1
    )
    rows = np.stack([q_s, q_ss, 0.0 * q_s, bends], axis=2)
    scale = rng.uniform(0.5, 1.0, len(s))
    u, change = np.zeros(len(s)), np.empty(len(s) - 1)
    assert fastest_speeds(s, rows, np.full(len(s), np.inf), scale, 3, u, change) == -1
    x = np.diff(u) / (2.0 * np.diff(s))
    for first, sign in ((slice(None, -1), -0.5), (slice(1, None), 0.5)):
        along = rows[first, :, 0] * (x + sign * change)[:, None] + rows[first, :, 1] * u[first, None]
        use = np.hypot(along, rows[first, :, 3] * u[first, None]) / scale[first, None]
        assert use.max() <= 1.0 + 1e-6  # rounding, where a limit is at its tip
