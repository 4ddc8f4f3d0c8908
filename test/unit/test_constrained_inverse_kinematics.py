"""ConstrainedInverseKinematics: feed-forward, weights, slack and what is refused."""

import numba
import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks import ActiveLimit, ConstrainedInverseKinematics, Redundancy
from robots_core.blocks.inverse_kinematics.redundancy import redundancy_arrays
from robots_core.errors import InvalidInputError, JointLimitError
from robots_core.kernels.chain_dynamics import NO_DYNAMICS, chain_dynamics_of

DT = 0.004
ROBOT = load_robot_model('bello_bot')
HOME = np.array(ROBOT.home)
START = Pose(*ROBOT.direct_kinematics(HOME))


@pytest.fixture(scope='module')
def ik() -> ConstrainedInverseKinematics:
    return ConstrainedInverseKinematics(ROBOT, DT)


def circle(t: float) -> tuple[Pose, np.ndarray]:
    """5 cm about the start, twice in three seconds, faded in."""
    fade, fade_dot = (1.0, 0.0) if t > 1.0 else (t**2 * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t))
    omega = 4.0
    offset = 0.05 * np.array([np.cos(omega * t) - 1.0, np.sin(omega * t), 0.0])
    offset_dot = 0.05 * omega * np.array([-np.sin(omega * t), np.cos(omega * t), 0.0])
    twist = np.concatenate([fade * offset_dot + fade_dot * offset, np.zeros(3)])
    return Pose(START.r + fade * offset, START.T), twist


def worst_error(ik: ConstrainedInverseKinematics, *, forward: bool) -> float:
    q, q_dot, worst = HOME, np.zeros(ROBOT.num_axes), 0.0
    for k in range(800):
        pose, twist = circle((k + 1) * DT)
        step = ik.step(pose, q, q_dot, twist if forward else None)
        q, q_dot = step.q, step.q_dot
        worst = max(worst, step.position_error)
    return worst


def test_the_references_twist_takes_the_lag_away(ik: ConstrainedInverseKinematics) -> None:
    without, with_twist = worst_error(ik, forward=False), worst_error(ik, forward=True)
    assert without > 2e-4  # 0.2 m/s, some periods late
    assert with_twist < 2e-5


def test_stands_still_on_its_reference(ik: ConstrainedInverseKinematics) -> None:
    step = ik.step(START, HOME, np.zeros(ROBOT.num_axes))
    np.testing.assert_allclose(step.q_ddot, 0.0, atol=1e-9)
    assert step.active_limits == ()
    assert step.slack == 0.0


def test_names_the_limits_that_it_meets(ik: ConstrainedInverseKinematics) -> None:
    far = Pose(START.r + np.array([0.0, 1.0, 0.0]), START.T)
    step = ik.step(far, HOME, np.zeros(ROBOT.num_axes))
    assert step.active_limits
    names = ROBOT.axes_data.names
    for limit in step.active_limits:
        assert isinstance(limit, ActiveLimit)
        axis = names.index(limit.joint)
        assert limit.quantity == 'acceleration'
        sign = 1.0 if limit.side == 'upper' else -1.0
        assert step.q_ddot[axis] == pytest.approx(sign * ROBOT.axes_data.acceleration[axis])


def test_a_state_outside_the_limits_comes_back_and_says_how_far_it_is_off(
    ik: ConstrainedInverseKinematics,
) -> None:
    axes = ROBOT.axes_data
    q, q_dot = HOME.copy(), np.zeros(ROBOT.num_axes)
    q[1] = axes.upper[1] + 0.01
    q_dot[0] = 1.2 * axes.velocity[0]
    steps = []
    for _ in range(1500):
        step = ik.step(START, q, q_dot)
        assert (np.abs(step.q_ddot) <= axes.acceleration * (1.0 + 1e-9)).all()
        q, q_dot = step.q, step.q_dot
        steps.append(step)
    assert steps[0].slack > 0.0
    assert steps[-1].slack == 0.0
    axes.check_position(q)


def test_a_torque_that_cannot_be_kept_is_the_smallest_overload() -> None:
    robot = load_robot_model('franka_fr3')
    ik = ConstrainedInverseKinematics(robot, DT)
    # Falling fast into a position limit: braking for it needs more than the motors have.
    axes = robot.axes_data
    ik._limits[5] = 0.05 * axes.effort
    step = ik.step(Pose(*robot.direct_kinematics(robot.home)), robot.home, np.zeros(7))
    assert step.solved
    assert step.slack > 0.0
    overload = (np.abs(step.torque) / (0.05 * axes.effort)).max() - 1.0
    assert step.slack == pytest.approx(overload, rel=1e-6)
    assert any(limit.quantity == 'torque' for limit in step.active_limits)


def test_weights_choose_between_position_and_orientation() -> None:
    turned = Pose.from_angles(START.r + 0.1 * np.eye(3)[1], START.angles() + 0.5 * np.eye(3)[0])
    only_position = ConstrainedInverseKinematics(ROBOT, DT, weights=(1.0, 0.0))
    q, q_dot = HOME, np.zeros(ROBOT.num_axes)
    for _ in range(1500):
        step = only_position.step(turned, q, q_dot)
        q, q_dot = step.q, step.q_dot
    assert step.position_error < 1e-6
    assert step.orientation_error > 0.1


def errors_after(ik: ConstrainedInverseKinematics, pose: Pose) -> tuple[float, float]:
    """Position (m) and orientation (rad) error when the robot has come to rest."""
    q, q_dot = np.array(ik.robot.home), np.zeros(ik.robot.num_axes)
    for _ in range(2000):
        step = ik.step(pose, q, q_dot)
        q, q_dot = step.q, step.q_dot
    assert np.abs(q_dot).max() < 1e-4
    return step.position_error, step.orientation_error


def test_the_heavier_error_is_the_smaller_where_both_cannot_be_had() -> None:
    robot = load_robot_model('cello_bot')  # five axes: a pose that they cannot bring about, near one they can
    home = Pose(*robot.direct_kinematics(robot.home))
    pose = Pose.from_angles(home.r + 0.02, home.angles() + np.array([0.3, 0.2, -0.3]))
    position, orientation = np.transpose(
        [
            errors_after(ConstrainedInverseKinematics(robot, DT, weights=weights), pose)
            for weights in [(0.0, 1.0), (0.3, 1.0), (1.0, 1.0), (1.0, 0.3), (1.0, 0.0)]
        ]
    )
    assert (np.diff(position) < 0.0).all()
    assert (np.diff(orientation) > 0.0).all()
    assert position[-1] < 1e-6


def test_a_tool_follows_instead_of_the_flange() -> None:
    tool = Pose.from_angles([0.1, 0.0, 0.2], [0.0, 0.3, 0.0])
    ik = ConstrainedInverseKinematics(ROBOT, DT, tool=tool)
    step = ik.step(START @ tool, HOME, np.zeros(ROBOT.num_axes))
    assert step.position_error < 1e-12
    np.testing.assert_allclose(step.q, HOME, atol=1e-12)


@pytest.mark.parametrize('criterion', [Redundancy.away_from_limits(), Redundancy.manipulability()])
def test_redundancy_improves_its_criterion_without_moving_the_tool(criterion: Redundancy) -> None:
    axes = ROBOT.axes_data
    q = 0.5 * HOME + 0.5 * (0.75 * axes.upper + 0.25 * axes.lower)
    pose = Pose(*ROBOT.direct_kinematics(q))

    def badness(q: np.ndarray) -> float:
        if criterion.kind == Redundancy.manipulability().kind:
            return -float(np.log(np.linalg.det(ROBOT.jacobian(q) @ ROBOT.jacobian(q).T)))
        return float((((q - 0.5 * (axes.lower + axes.upper)) / (axes.upper - axes.lower)) ** 2).sum())

    ik = ConstrainedInverseKinematics(ROBOT, DT, redundancy=criterion)
    before, q_dot = badness(q), np.zeros(ROBOT.num_axes)
    for _ in range(1000):
        step = ik.step(pose, q, q_dot)
        q, q_dot = step.q, step.q_dot
    assert badness(q) < before
    assert step.position_error < 1e-5


def test_one_compilation_serves_every_criterion() -> None:
    criteria = (None, Redundancy.near(ROBOT.home), Redundancy.away_from_limits(), Redundancy.manipulability())
    assert len({numba.typeof(redundancy_arrays(one, ROBOT.axes_data)) for one in criteria}) == 1


def test_one_compilation_serves_robots_with_dynamics_of_their_own() -> None:
    assert numba.typeof(NO_DYNAMICS) == numba.typeof(chain_dynamics_of(ROBOT).arrays)


def test_results_are_read_only(ik: ConstrainedInverseKinematics) -> None:
    step = ik.step(START, HOME, np.zeros(ROBOT.num_axes))
    for array in (step.q, step.q_dot, step.q_ddot, step.torque):
        with pytest.raises(ValueError, match='read-only'):
            array[0] = 1.0


def test_bad_input_is_refused(ik: ConstrainedInverseKinematics) -> None:
    zero = np.zeros(ROBOT.num_axes)
    with pytest.raises(InvalidInputError, match=r'q\[0\] is nan'):
        ik.step(START, np.full(ROBOT.num_axes, np.nan), zero)
    with pytest.raises(InvalidInputError, match='twist'):
        ik.step(START, HOME, zero, [0.0, np.inf, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InvalidInputError, match='dt'):
        ConstrainedInverseKinematics(ROBOT, 0.0)
    with pytest.raises(InvalidInputError, match='gain'):
        ConstrainedInverseKinematics(ROBOT, DT, gain=300.0)
    with pytest.raises(InvalidInputError, match='weights'):
        ConstrainedInverseKinematics(ROBOT, DT, weights=(0.0, 0.0))
    with pytest.raises(JointLimitError):
        ConstrainedInverseKinematics(ROBOT, DT, redundancy=Redundancy.near(ROBOT.axes_data.upper + 1.0))
