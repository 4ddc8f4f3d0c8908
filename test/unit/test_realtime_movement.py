"""RealtimeMovement: states, feasibility and its reasons, staleness."""

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks.following.pose_reference import moved
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.blocks.multibody.payload import payload_of
from robots_core.errors import InvalidInputError
from robots_planning import MovementState, RealtimeMovement

DT = 0.004
TWIST = np.array([0.1, -0.05, 0.05, 0.1, 0.0, -0.1])


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


@pytest.fixture(scope='module')
def posture() -> np.ndarray:
    return np.array([0.2, -1.2, 1.4, 0.3, 0.8, -0.4])


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares', 'analytical'])
def test_a_reference_that_moves_is_followed(robot: BaseRobotModel, posture: np.ndarray, method: str) -> None:
    tool = Pose.from_angles([0.1, 0.0, 0.2], [0.0, 0.3, 0.0])
    movement = RealtimeMovement(robot, DT, posture, tool=tool, method=method)
    start = Pose(*robot.direct_kinematics(posture)) @ tool
    assert movement.step(0.0).state is MovementState.IDLE
    feasible = []
    for k in range(1, 300):
        now = k * DT
        if k % 5 == 1:  # 50 Hz
            movement.put(moved(start, TWIST, now), now)
        step = movement.step(now)
        feasible.append(step.feasible)
        assert step.state is MovementState.FOLLOWING
    assert all(feasible[100:])  # at the start it has to catch up
    reached = Pose(*robot.direct_kinematics(step.q)) @ tool
    # Rounding of the extrapolation; the numerical methods follow to 1e-8.
    assert max(reached.distance_to(moved(start, TWIST, now + DT))) < 1e-6


@pytest.mark.parametrize('method', ['constrained', 'damped_least_squares', 'analytical'])
def test_a_twist_alone_leads_the_tool_on(robot: BaseRobotModel, posture: np.ndarray, method: str) -> None:
    movement = RealtimeMovement(robot, DT, posture, method=method)
    start, count = Pose(*robot.direct_kinematics(posture)), 250
    for k in range(count):
        if k % 10 == 0:  # 25 Hz
            movement.put_twist(TWIST, k * DT)
        step = movement.step(k * DT)
        assert step.state is MovementState.FOLLOWING
    # It gains its speed first: the way is that of the twist except for some milliseconds, and no other.
    behind = moved(start, TWIST, count * DT).error_to(Pose(*robot.direct_kinematics(step.q)))
    lost = -behind[:3] @ TWIST[:3] / (TWIST[:3] @ TWIST[:3])
    assert 0.0 <= lost < 0.1
    np.testing.assert_allclose(behind, -lost * TWIST, atol=1e-4)
    while step.state is not MovementState.IDLE:
        k += 1
        step = movement.step(k * DT)
    assert k * DT < count * DT + 1.0  # the timeout, and the way to brake
    movement.place(posture)
    movement.put_twist(TWIST, k * DT)
    again = movement.step(k * DT)
    np.testing.assert_allclose(again.q, posture, atol=np.abs(again.q_dot).max() * DT + 1e-12)


def test_a_stale_reference_stops_and_a_fresh_one_goes_on(robot: BaseRobotModel, posture: np.ndarray) -> None:
    movement = RealtimeMovement(robot, DT, posture)
    start = Pose(*robot.direct_kinematics(posture))
    states = []
    for k in range(400):
        if k < 50 or k >= 300:
            movement.put(moved(start, TWIST, k * DT), k * DT)
        states.append(movement.step(k * DT).state)
    changes = [state for index, state in enumerate(states) if index == 0 or states[index - 1] is not state]
    following, stale, idle = MovementState.FOLLOWING, MovementState.STALE, MovementState.IDLE
    assert changes == [following, stale, idle, following]
    assert states.index(stale) == pytest.approx(49 + 0.2 / DT, abs=1.1)


def test_a_reference_that_is_let_go_of_brakes_the_robot_at_once(
    robot: BaseRobotModel, posture: np.ndarray
) -> None:
    movement = RealtimeMovement(robot, DT, posture)
    start = Pose(*robot.direct_kinematics(posture))
    for k in range(50):
        movement.put(moved(start, TWIST, k * DT), k * DT)
        fast = np.abs(movement.step(k * DT).q_dot).max()
    movement.release()
    braked = movement.step(50 * DT)
    assert braked.state is MovementState.STALE
    assert np.abs(braked.q_dot).max() < fast
    movement.put(start, 51 * DT)
    assert movement.step(51 * DT).state is MovementState.FOLLOWING


def test_what_cannot_be_reached_is_said(robot: BaseRobotModel, posture: np.ndarray) -> None:
    far = Pose(np.array([9.0, 0.0, 1.0]), np.eye(3))
    movement = RealtimeMovement(robot, DT, posture)
    movement.put(far, 0.0)
    step = movement.step(0.0)
    assert not step.feasible
    assert step.position_error > 5.0
    assert 'away' in step.reason
    assert 'limited by' in step.reason
    analytical = RealtimeMovement(robot, DT, posture, method='analytical')
    analytical.put(far, 0.0)
    step = analytical.step(0.0)
    assert not step.feasible
    assert 'out of reach' in step.reason
    np.testing.assert_array_equal(step.q, posture)


def test_a_jump_is_not_feasible_until_it_is_caught_up_with(
    robot: BaseRobotModel, posture: np.ndarray
) -> None:
    movement = RealtimeMovement(robot, DT, posture)
    start = Pose(*robot.direct_kinematics(posture))
    feasible = []
    for k in range(500):
        movement.put(Pose(start.r + np.array([0.0, 0.1, 0.0]), start.T), k * DT)
        step = movement.step(k * DT)
        feasible.append(step.feasible)
        assert (np.abs(step.q_dot) <= robot.axes_data.velocity).all()
    assert not feasible[0]
    assert feasible[-1]
    assert not step.reason


def test_bad_input_is_refused(robot: BaseRobotModel, posture: np.ndarray) -> None:
    with pytest.raises(InvalidInputError, match='method'):
        RealtimeMovement(robot, DT, posture, method='guess')
    movement = RealtimeMovement(robot, DT, posture)
    with pytest.raises(InvalidInputError, match='twist'):
        movement.put_twist([0.0], 0.0)
    with pytest.raises(InvalidInputError, match='q_dot'):
        movement.place(posture, [np.inf] * 6)


def test_it_takes_over_a_robot_in_motion(robot: BaseRobotModel, posture: np.ndarray) -> None:
    movement = RealtimeMovement(robot, DT, posture)
    movement.place(posture, 0.2 * robot.axes_data.velocity)
    first = movement.step(0.0)
    assert first.state is MovementState.STALE
    assert (np.abs(first.q_ddot) <= robot.axes_data.acceleration * (1.0 + 1e-9)).all()


def test_the_torques_of_a_payload_are_inside_the_limits(robot: BaseRobotModel) -> None:
    payload = payload_of([210.0, 0.0, 0.0, 0.3])
    stretched = np.array([0.0, -0.4, 0.6, 0.0, 0.2, 0.0])
    loaded = LoadedRobot(robot, payload)

    def largest_torque(movement: RealtimeMovement) -> float:
        """Of the limits, with the payload, while the tool is to jump up by half a metre."""
        movement.place(stretched)
        start = Pose(*robot.direct_kinematics(stretched))
        q, q_dot = stretched, np.zeros(6)
        part = 0.0
        for k in range(250):
            movement.put(Pose(start.r + np.array([0.0, 0.0, 0.5]), start.T), k * DT)
            step = movement.step(k * DT)
            torques, _, _ = loaded.rigid_dynamics(q, q_dot, step.q_ddot)
            part = max(part, float(np.abs(torques / robot.axes_data.effort).max()))
            q, q_dot = step.q, step.q_dot
        return part

    movement = RealtimeMovement(robot, DT, stretched)
    assert largest_torque(movement) > 1.05
    movement.load(payload)
    assert largest_torque(movement) < 1.0 + 1e-9
    movement.load(payload_of([0.0, 0.0, 0.0, 0.0]))
    assert largest_torque(movement) > 1.05
