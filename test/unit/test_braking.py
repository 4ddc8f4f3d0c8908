"""furthest: against Ruckig moving to a target far behind the axis, for which it brakes as hard as it can."""

import numpy as np
import pytest
from ruckig import InputParameter, Result, Ruckig, Trajectory

from robots_planning.trajectory_generators.braking import furthest


@pytest.mark.parametrize('seed', range(3))
def test_it_is_where_the_hardest_brake_turns_round(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ruckig, command, found = Ruckig(1), InputParameter(1), Trajectory(1)
    command.max_velocity, command.target_position = [100.0], [-1000.0]
    for _ in range(60):
        acceleration, jerk = rng.uniform(1.0, 10.0), rng.uniform(20.0, 200.0)
        q_ddot = rng.uniform(-1.0, 1.0) * acceleration * rng.choice([1.0, 0.01, 0.0])
        q_dot = rng.uniform(-2.0, 2.0) * rng.choice([1.0, 0.01, 1e-3])
        command.current_velocity, command.current_acceleration = [q_dot], [q_ddot]
        command.max_acceleration, command.max_jerk = [acceleration], [jerk]
        assert ruckig.calculate(command, found) in (Result.Working, Result.Finished)
        # Ruckig's own extrema leave some out. Turning round takes less than the highest speed and ramps do.
        latest = 2.0 / acceleration + 2.0 * acceleration / jerk
        sampled = max(found.at_time(t)[0][0] for t in np.linspace(0.0, latest, 2001))
        # Between samples the axis continues by up to a dt^2 / 8.
        missed = acceleration * (latest / 2000.0) ** 2 / 8.0
        assert -1e-12 <= furthest(0.0, q_dot, q_ddot, acceleration, jerk) - sampled <= missed + 1e-12


def test_rest_stays_where_it_is() -> None:
    assert furthest(0.3, 0.0, 0.0, 5.0, 50.0) == 0.3
