"""TeachBox keeps all limits and can always be stopped, whatever it is commanded."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import load_robot_model
from robots_planning import TeachBox
from robots_planning.guidance.teach_box import FASTEST, TeachStep

DT = 0.008  # s
_LOADED = {name: load_robot_model(name) for name in ('kuka_kr210_r2700', 'bello_bot', 'kinova_j2n6s300')}

value = st.one_of(st.floats(-2.0, 2.0), st.sampled_from([0.0, 1.0, -1.0, 1e6, -1e6, 1e-9]))
command = st.tuples(
    st.sampled_from(['axes', 'base', 'tool', 'world']),
    st.lists(value, min_size=7, max_size=7),
    st.integers(1, 60),  # periods until the next command; the last ones of a long wait are stale
)


@pytest.mark.parametrize('name', list(_LOADED))
@settings(max_examples=25)  # hundreds of steps each
@given(
    start=st.lists(st.floats(0.0, 1.0), min_size=7, max_size=7),
    commands=st.lists(command, min_size=1, max_size=8),
    fraction=st.sampled_from([0.1, 0.5, 1.0]),
)
def test_limits_hold_whatever_is_commanded(
    name: str, start: list[float], commands: list[tuple[str, list[float], int]], fraction: float
) -> None:
    robot = _LOADED[name]
    axes, n = robot.axes_data, robot.num_axes
    low, high = axes.one_turn
    box = TeachBox(robot, DT, low + np.array(start[:n]) * (high - low), speed_fraction=fraction)
    velocity, acceleration = fraction * axes.velocity, 0.3 * axes.acceleration
    steps, now = list[TeachStep](), 0.0
    for frame, values, periods in commands:
        if frame == 'axes':
            box.jog_axes(np.array(values[:n]) * axes.velocity, now)
        else:
            twist = np.clip(0.3 * np.array(values[:6]), -FASTEST, FASTEST)
            box.jog_tool(twist, now, frame)  # type: ignore[arg-type]  # drawn from them
        for _ in range(periods):
            steps.append(box.step(now))
            now += DT
    q_dot = np.array([step.q_dot for step in steps])
    # Rounding of a step.
    assert (np.abs(q_dot) <= velocity * (1.0 + 1e-9)).all()
    changes = np.diff(q_dot, axis=0, prepend=np.zeros((1, n)))
    assert (np.abs(changes) <= acceleration * DT * (1.0 + 1e-9)).all()
    for step in steps:
        linear = robot.jacobian(step.q)[:3] @ step.q_dot
        # Braking is for all axes as fast as it can be: another direction, for a moment a faster one.
        assert np.linalg.norm(linear) <= 0.25 * (1.0 if step.jogging else 1.1)
    for _ in range(1250):
        steps.append(box.step(now + 1.0))
        now += DT
        if steps[-1].standing:
            break
    assert steps[-1].standing
    q = np.array([step.q for step in steps])
    assert (q <= axes.upper + 1e-9).all()
    assert (q >= axes.lower - 1e-9).all()
