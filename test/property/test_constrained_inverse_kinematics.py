"""Laws of ConstrainedInverseKinematics: inside every limit, whatever the reference does."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import ConstrainedInverseKinematics, Redundancy

DT = 0.004
# Sums of a few terms of order one, relative to a limit.
ROUNDING = 1e-9


@cache
def solver(name: str, redundancy: str = '') -> ConstrainedInverseKinematics:
    criterion = Redundancy.away_from_limits() if redundancy else None
    return ConstrainedInverseKinematics(load_robot_model(name), DT, redundancy=criterion)


def ranges(robot: BaseRobotModel) -> tuple[np.ndarray, np.ndarray]:
    axes = robot.axes_data
    return np.where(axes.continuous, -3.0, axes.lower), np.where(axes.continuous, 3.0, axes.upper)


def check_limits(ik: ConstrainedInverseKinematics, start: np.ndarray, steps: Sequence[Any]) -> None:
    """Every limit, from rest, by the robot's own dynamics and the definition of constant acceleration."""
    axes = ik.robot.axes_data
    assert all(step.solved and step.slack == 0.0 for step in steps)
    q, q_dot, q_ddot = np.moveaxis(np.array([(step.q, step.q_dot, step.q_ddot) for step in steps]), 1, 0)
    assert (q >= axes.lower).all()
    assert (q <= axes.upper).all()
    assert (np.abs(q_dot) <= axes.velocity * (1.0 + ROUNDING)).all()
    assert (np.abs(q_ddot) <= axes.acceleration * (1.0 + ROUNDING)).all()
    before, before_dot = np.vstack([start, q[:-1]]), np.vstack([np.zeros_like(start), q_dot[:-1]])
    np.testing.assert_allclose(q_dot, before_dot + DT * q_ddot, atol=1e-12)
    np.testing.assert_allclose(q, before + DT * before_dot + 0.5 * DT**2 * q_ddot, atol=ROUNDING)
    torque = [ik.robot.rigid_dynamics(*row)[0] for row in zip(before, before_dot, q_ddot, strict=True)]
    assert (np.abs(torque) <= axes.effort * (1.0 + 1e-8)).all()


def alternations(accelerations: list[np.ndarray]) -> int:
    """How often an axis' acceleration, over its limit, goes up and at once down again, or the reverse.

    Chatter would alternate between two bounds; a bang-bang start and stop changes a few times.
    """
    changes = np.diff(np.array(accelerations), axis=0)
    return int(((changes[1:] * changes[:-1] < 0.0) & (np.abs(changes[1:]) > 0.2)).sum(axis=0).max())


@pytest.mark.parametrize('name', ['kuka_kr500_r2830', 'bello_bot', 'franka_fr3', 'manutec_r3', 'cello_bot'])
@settings(max_examples=12)
@given(
    seed=st.integers(0, 2**32 - 1),
    hold=st.integers(1, 80),
    speed=st.sampled_from([0.0, 1.0, 20.0]),
    wild=st.booleans(),
)
def test_no_reference_leads_out_of_the_limits(
    name: str, seed: int, hold: int, speed: float, *, wild: bool
) -> None:
    ik, rng = solver(name), np.random.default_rng(seed)
    low, high = ranges(ik.robot)
    start = q = rng.uniform(low, high)
    q_dot, steps = np.zeros(low.size), []
    for k in range(300):
        if k % hold == 0:
            r, T = ik.robot.direct_kinematics(rng.choice([low, high]) if k % 2 else rng.uniform(low, high))
            pose = Pose(r + (10.0 * rng.normal(size=3) if wild else 0.0), T)
            twist = speed * rng.normal(size=6)
        steps.append(ik.step(pose, q, q_dot, twist))
        q, q_dot = steps[-1].q, steps[-1].q_dot
    check_limits(ik, start, steps)


@pytest.mark.parametrize('name', ['kuka_kr500_r2830', 'bello_bot', 'franka_fr3'])
@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1))
def test_arrives_at_a_pose_near_by_and_stands_there(name: str, seed: int) -> None:
    ik, rng = solver(name), np.random.default_rng(seed)
    low, high = ranges(ik.robot)
    start = 0.6 * np.array(ik.robot.home) + 0.4 * rng.uniform(low, high)
    target = np.clip(start + rng.uniform(-0.1, 0.1, low.size), low, high)
    if np.linalg.svd(ik.robot.jacobian(target))[1][-1] < 0.1:
        return  # a singular pose is approached more and more slowly
    pose = Pose(*ik.robot.direct_kinematics(target))
    q, q_dot = start, np.zeros(low.size)
    for _ in range(2500):
        step = ik.step(pose, q, q_dot)
        q, q_dot = step.q, step.q_dot
    assert step.position_error < 1e-6
    assert step.orientation_error < 1e-6
    assert np.abs(q_dot).max() < 1e-6


@settings(max_examples=10)
@given(direction=st.floats(0.0, 2.0 * np.pi), speed=st.floats(0.01, 0.3), tilt=st.floats(-0.02, 0.02))
def test_smooth_through_a_singular_wrist(direction: float, speed: float, tilt: float) -> None:
    """Axes 4 and 6 aligned: motion sideways; joint acceleration never alternates from step to step."""
    ik = solver('kuka_kr500_r2830')
    start = q = np.array(ik.robot.home) + np.array([0, 0, 0, 0, tilt, 0])
    q_dot, steps = np.zeros(6), []
    r, T = ik.robot.direct_kinematics(q)
    way = speed * np.array([0.0, np.cos(direction), np.sin(direction)])
    for k in range(400):
        t = (k + 1) * DT
        steps.append(ik.step(Pose(r + way * t, T), q, q_dot, np.concatenate([way, np.zeros(3)])))
        q, q_dot = steps[-1].q, steps[-1].q_dot
    check_limits(ik, start, steps)
    assert alternations([step.q_ddot / ik.robot.axes_data.acceleration for step in steps]) <= 12


@settings(max_examples=8)
@given(direction=st.floats(-0.6, 0.6), speed=st.floats(0.5, 1.5))
def test_smooth_out_of_reach_and_back(direction: float, speed: float) -> None:
    """The arm stretches after a reference that leaves its workspace; it may come back with its elbow over."""
    ik = solver('kuka_kr500_r2830')
    start = q = np.array([0.0, -1.3, 1.8, 0.0, 0.9, 0.0])
    q_dot, steps = np.zeros(6), []
    r, T = ik.robot.direct_kinematics(q)
    way = np.array([np.cos(direction), np.sin(direction), 0.0])
    turn = 2.0 / speed
    for k in range(int((2.0 * turn + 3.0) / DT)):
        t = (k + 1) * DT
        moving = 1.0 if t < turn else -1.0 if t < 2.0 * turn else 0.0
        away = speed * min(t, max(2.0 * turn - t, 0.0))
        twist = np.append(moving * speed * way, np.zeros(3))
        steps.append(ik.step(Pose(r + away * way, T), q, q_dot, twist))
        q, q_dot = steps[-1].q, steps[-1].q_dot
    check_limits(ik, start, steps)
    assert alternations([step.q_ddot / ik.robot.axes_data.acceleration for step in steps]) <= 12


@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1))
def test_self_motion_of_seven_axes_leaves_the_tool_where_it_is(seed: int) -> None:
    robot = load_robot_model('bello_bot')
    rng = np.random.default_rng(seed)
    low, high = ranges(robot)
    start = q = 0.7 * np.array(robot.home) + 0.3 * rng.uniform(low, high)
    wish = np.clip(q + rng.uniform(-0.5, 0.5, robot.num_axes), low, high)
    ik = ConstrainedInverseKinematics(robot, DT, redundancy=Redundancy.near(wish))
    pose = Pose(*robot.direct_kinematics(q))
    q_dot, steps = np.zeros(robot.num_axes), []
    for _ in range(800):
        steps.append(ik.step(pose, q, q_dot))
        q, q_dot = steps[-1].q, steps[-1].q_dot
        # Self-motion bends the path of the tool by the square of a period's motion.
        assert steps[-1].position_error < 1e-4
        assert steps[-1].orientation_error < 1e-4
    check_limits(ik, start, steps)
    assert np.linalg.norm(wish - q) <= np.linalg.norm(wish - start) + 1e-9
