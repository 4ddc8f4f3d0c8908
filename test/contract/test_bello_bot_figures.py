"""What the fictive robot promises of itself."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from robots_core import load_robot_model
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel

PAYLOAD_CENTRE = 0.05  # m in front of the flange


@pytest.fixture(scope='module')
def bello() -> UrdfRobotModel:
    robot = load_robot_model('bello_bot')
    assert isinstance(robot, UrdfRobotModel)
    return robot


def test_says_that_it_is_fictive(bello: UrdfRobotModel):
    assert 'ictive' in bello.structural_data.source


def test_has_seven_axes_that_meet_in_shoulder_elbow_and_wrist(bello: UrdfRobotModel):
    data = bello.structural_data
    r, T = bello.kinematic_model.frame_axes(np.zeros(7))
    heights = np.cumsum([data.shoulder_height, data.upper_arm, data.forearm])
    np.testing.assert_allclose(r[[1, 3, 5], 2], heights, atol=1e-12)
    np.testing.assert_array_equal(r[:, :2], 0.0)
    np.testing.assert_array_equal(T, np.broadcast_to(np.eye(3), (7, 3, 3)))
    tool0, _ = bello.direct_kinematics(np.zeros(7))
    np.testing.assert_allclose(tool0, [0.0, 0.0, heights[-1] + data.hand], atol=1e-12)


def test_home_is_far_from_singularities_and_points_down(bello: UrdfRobotModel):
    singular_values = np.linalg.svd(bello.jacobian(bello.home), compute_uv=False)
    assert singular_values[-1] > 0.2  # zero at a singularity; the best this arm has is about 0.35
    _, T = bello.direct_kinematics(bello.home)
    np.testing.assert_allclose(T[:, 2], [0.0, 0.0, -1.0], atol=1e-12)


def test_effort_carries_the_payload_everywhere_at_full_acceleration(bello: UrdfRobotModel):
    """Gravity of robot and payload plus M_ii times acceleration, over postures all over the range."""
    axes, payload = bello.axes_data, bello.structural_data.rated_payload_kg
    model = pin.buildModelFromXML(bello.description)
    tool0 = model.frames[model.getFrameId('tool0')]
    centre = tool0.placement.act(np.array([0.0, 0.0, PAYLOAD_CENTRE]))
    model.appendBodyToJoint(
        tool0.parentJoint, pin.Inertia(payload, centre, np.zeros((3, 3))), pin.SE3.Identity()
    )
    data = model.createData()
    for q in np.random.default_rng(3).uniform(axes.lower, axes.upper, (3000, 7)):
        gravity = np.abs(pin.computeGeneralizedGravity(model, data, q))
        ramp = np.diag(pin.crba(model, data, q)) * axes.acceleration
        assert (gravity + ramp <= axes.effort).all()
