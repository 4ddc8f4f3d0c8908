"""Ideal and second-order drives, and the choice of a level."""

import numpy as np
import pytest

from robots_core import load_robot_model
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.drives.drive_train import IdealDrive, SecondOrderDrive
from robots_core.blocks.drives.rigid_body_drive import RigidBodyDrive
from robots_core.errors import InvalidInputError

ROBOT = load_robot_model('bello_bot')


def test_an_ideal_drive_is_where_its_reference_is():
    drive = IdealDrive([0.1, 0.2], period=0.01)
    q, q_dot = drive.step([0.11, 0.18], [1.0, -1.5])
    np.testing.assert_array_equal(q, [0.11, 0.18])
    np.testing.assert_array_equal(q_dot, [1.0, -1.5])
    _, q_dot = drive.step([0.12, 0.18])
    np.testing.assert_allclose(q_dot, [1.0, 0.0], atol=1e-12)
    assert drive.torque is None


def test_a_second_order_drive_answers_a_step_as_its_transfer_function():
    from scipy.signal import lti  # noqa: PLC0415  # takes half a second to load

    # Complex eigenvalues, real ones, and those that meet or nearly do.
    bandwidth, damping = np.array([5.0, 12.0, 15.0, 15.0]), np.array([0.4, 1.3, 1.0, 1.0 + 1e-12])
    drive = SecondOrderDrive(np.zeros(4), period=0.004, bandwidth=bandwidth, damping=damping)
    answers = np.array([drive.step(np.ones(4))[0] for _ in range(200)])
    times = 0.004 * np.arange(201)
    for axis in range(4):
        w, D = 2.0 * np.pi * bandwidth[axis], damping[axis]
        _, expected = lti([w**2], [1.0, 2.0 * D * w, w**2]).step(T=times)
        np.testing.assert_allclose(answers[:, axis], expected[1:], atol=1e-9)


def test_levels_are_what_their_names_say():
    made = {level: drive_train(level, ROBOT, ROBOT.home, period=0.004) for level in DRIVE_LEVELS}
    kinds = {'ideal': IdealDrive, 'second_order': SecondOrderDrive, 'rigid_body': RigidBodyDrive}
    assert kinds.items() <= {level: type(drive) for level, drive in made.items()}.items()
    for drive in made.values():
        np.testing.assert_allclose(drive.position, ROBOT.home)
        np.testing.assert_array_equal(drive.velocity, np.zeros(7))
    torque = made['rigid_body'].torque
    assert torque is not None
    np.testing.assert_allclose(
        torque, ROBOT.rigid_dynamics(ROBOT.home, np.zeros(7), np.zeros(7))[2], atol=1e-9
    )


@pytest.mark.parametrize('level', DRIVE_LEVELS)
def test_drives_follow_many_references_as_one_after_the_other(level: str):
    stepped, following = (drive_train(level, ROBOT, ROBOT.home, period=0.004) for _ in range(2))
    references = np.zeros((50, 3, 7))
    references[:, 0] = ROBOT.home + np.linspace(0.0, 0.02, 50)[:, None] * np.array(
        [1, -1, 0.5, 0, 2, -0.1, 1]
    )
    references[:, 1] = np.diff(references[:, 0], axis=0, prepend=references[:1, 0]) / 0.004
    states = np.zeros((50, 2 if stepped.torque is None else 3, 7))
    for part in (slice(0, 1), slice(1, 50)):
        following.follow(references[part], states[part])
    for reference, state in zip(references, states, strict=True):
        q, q_dot = stepped.step(reference[0], reference[1])
        assert state[0].tobytes() == q.tobytes()
        assert state[1].tobytes() == q_dot.tobytes()
        assert stepped.torque is None or state[2].tobytes() == stepped.torque.tobytes()
    assert following.position.tobytes() == stepped.position.tobytes()
    assert following.velocity.tobytes() == stepped.velocity.tobytes()


def test_bad_input_is_named():
    *first, last = DRIVE_LEVELS
    with pytest.raises(
        InvalidInputError, match=f"'perfect' is unknown; valid are {', '.join(first)} and {last}"
    ):
        drive_train('perfect', ROBOT, ROBOT.home, period=0.004)
    with pytest.raises(InvalidInputError, match='bandwidth must be one number or 7'):
        drive_train('second_order', ROBOT, ROBOT.home, period=0.004, bandwidth=[1.0, 2.0])
    for level in DRIVE_LEVELS:
        with pytest.raises(InvalidInputError, match='period'):
            drive_train(level, ROBOT, ROBOT.home, period=-1.0)
        drive = drive_train(level, ROBOT, ROBOT.home, period=0.004)
        with pytest.raises(InvalidInputError, match='q_ref'):
            drive.step(np.full(7, np.inf))
        with pytest.raises(InvalidInputError, match='q_ref'):
            drive.step(np.zeros(6))
