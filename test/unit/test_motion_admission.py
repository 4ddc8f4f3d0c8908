"""MotionAdmission: motions that break a limit, or that were given up, are refused."""

import math

import numpy as np
import pytest

from robots_controller.control.motion_admission import GIVEN_UP_AFTER, MotionAdmission
from robots_core import load_robot_model
from robots_core.errors import InvalidInputError, NotNowError
from robots_planning import LinearJoint, Trajectory

ROBOT = load_robot_model('kuka_kr210_r2700')
NOW, STAMP = 10.0, 1_000_000_000


@pytest.fixture
def admission() -> MotionAdmission:
    return MotionAdmission(ROBOT)


def test_what_nobody_has_given_up_is_admitted(admission: MotionAdmission) -> None:
    admission.check_lost(NOW, STAMP)


def test_after_the_loss_of_a_commander_nothing_is_admitted_for_a_while(admission: MotionAdmission) -> None:
    admission.lose_commander('the pendant is silent', NOW)
    last = math.nextafter(NOW + GIVEN_UP_AFTER, 0.0)
    with pytest.raises(NotNowError, match='given up: the pendant is silent'):
        admission.check_lost(last, STAMP)
    admission.check_lost(NOW + GIVEN_UP_AFTER, STAMP)


def test_a_planner_that_is_lost_sends_nothing_of_what_was_commanded_before(
    admission: MotionAdmission,
) -> None:
    admission.lose_planner('the planner is silent', STAMP)
    for later in (NOW, NOW + 100.0):
        with pytest.raises(NotNowError, match='given up: the planner is silent'):
            admission.check_lost(later, STAMP - 1)
        admission.check_lost(later, STAMP)
    admission.planner_is_back(NOW)
    with pytest.raises(NotNowError):
        admission.check_lost(NOW, STAMP - 1)
    admission.check_lost(NOW + GIVEN_UP_AFTER, STAMP - 1)


def test_limits_hold_for_what_is_admitted(admission: MotionAdmission) -> None:
    whole = LinearJoint(ROBOT).generate(ROBOT.home, ROBOT.home + 0.3)
    admission.check_limits(whole, joins=False)
    fast = Trajectory(0.5 * whole.time, whole.position, 2.0 * whole.velocity, 4.0 * whole.acceleration)
    with pytest.raises(InvalidInputError, match='joint_trajectory breaks a limit'):
        admission.check_limits(fast, joins=False)


def test_only_what_joins_a_motion_may_begin_with_a_velocity(admission: MotionAdmission) -> None:
    whole = LinearJoint(ROBOT).generate(ROBOT.home, ROBOT.home + 0.3)
    half = np.linspace(0.5 * whole.duration, whole.duration, 200)
    rest = Trajectory(half - half[0], *whole.sample(half))
    admission.check_limits(rest, joins=True)
    with pytest.raises(InvalidInputError, match='joint_trajectory breaks a limit'):
        admission.check_limits(rest, joins=False)
