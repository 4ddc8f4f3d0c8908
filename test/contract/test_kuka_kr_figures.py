"""What KUKA's KR robots have beyond their figures: the flange's frame, reach, payloads and estimates."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from robots_core import load_robot_model
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel
from robots_models.families.kuka_kr import KukaKrData

# Rated payload kg, payload that the efforts hold everywhere kg, base's mass kg.
FACTS = {
    'kuka_kr210_r2700': (210.0, 177.0, 225.96),
    'kuka_kr210_r3100': (210.0, 104.0, 225.96),
    'kuka_kr500_r2830': (500.0, 123.0, 446.1),
}
# The description prints right angles as 1.57079632679, 5e-12 rad too small: four of them over 3 m.
EXACT = 1e-10
# Where the payloads are meant to hang: metres from the flange.
PAYLOAD_CENTRE = np.array([0.05, 0.0, 0.1])


@pytest.fixture(params=FACTS)
def name(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def kuka(name: str) -> UrdfRobotModel:
    robot = load_robot_model(name)
    assert isinstance(robot, UrdfRobotModel)
    return robot


@pytest.fixture
def data(kuka: UrdfRobotModel) -> KukaKrData:
    assert isinstance(kuka.structural_data, KukaKrData)
    return kuka.structural_data


def test_flange_at_zero_looks_forward(kuka: UrdfRobotModel, data: KukaKrData):
    r, T = kuka.direct_kinematics(np.zeros(6))
    forward = data.axis_1_to_axis_2 + data.upper_arm + data.forearm + data.flange
    np.testing.assert_allclose(r, [forward, 0.0, data.axis_2_height + data.elbow_offset], atol=EXACT)
    np.testing.assert_allclose(T[:, 2], [1.0, 0.0, 0.0], atol=EXACT)
    np.testing.assert_allclose(T[:, 0], [0.0, 0.0, -1.0], atol=EXACT)


def test_reach_is_the_published_one(kuka: UrdfRobotModel, data: KukaKrData):
    """Farthest wrist centre from axis 1: A2 and A3 as straight as the limits allow."""
    axes = kuka.axes_data
    a2, a3 = np.meshgrid(
        np.linspace(axes.lower[1], axes.upper[1], 1001), np.linspace(axes.lower[2], axes.upper[2], 1001)
    )
    distance = (
        data.axis_1_to_axis_2
        + data.upper_arm * np.cos(a2)
        + data.forearm * np.cos(a2 + a3)
        + data.elbow_offset * np.sin(a2 + a3)
    )
    # The data sheets' figures are rounded to millimetres, that of the R3100 to centimetres.
    assert distance.max() == pytest.approx(data.reach, abs=1e-3 if data.reach != 3.1 else 5e-3)


def test_facts_are_kept(name: str, kuka: UrdfRobotModel, data: KukaKrData):
    rated, held, base = FACTS[name]
    assert (data.rated_payload_kg, data.payload_held_everywhere_kg) == (rated, held)
    assert kuka.rigid_dynamics_model.masses[0] == base
    assert len(data.effort_estimate) == 6
    assert 'kuka_robot_descriptions' in data.source


def test_published_effort_of_axis_2_holds_the_payload_it_is_said_to_hold(
    kuka: UrdfRobotModel, data: KukaKrData
):
    """And little more: the arm stretched out as far as the limits allow."""
    reserve = {}
    for payload in (data.payload_held_everywhere_kg, 1.1 * data.payload_held_everywhere_kg):
        model = pin.buildModelFromXML(kuka.description)
        tool0 = model.frames[model.getFrameId('tool0')]
        model.appendBodyToJoint(
            tool0.parentJoint,
            pin.Inertia(payload, tool0.placement.act(PAYLOAD_CENTRE), np.zeros((3, 3))),
            pin.SE3.Identity(),
        )
        scratch = model.createData()
        axes = kuka.axes_data
        highest = max(
            np.abs(pin.computeGeneralizedGravity(model, scratch, np.array([0.0, a2, a3, 0.0, a5, 0.0]))[1])
            for a2 in np.linspace(axes.lower[1], axes.upper[1], 25)
            for a3 in np.linspace(axes.lower[2], axes.upper[2], 25)
            for a5 in np.linspace(-1.5, 1.5, 13)
        )
        reserve[payload] = axes.effort[1] - highest
    enough, too_much = reserve.values()
    assert enough > -0.01 * kuka.axes_data.effort[1]  # the grid and the payload's rounding to kilograms
    assert too_much < 0.0


def test_a_linear_axis_carries_the_same_robot():
    """With the carriage in its middle, flange and dynamics are those of the robot that stands."""
    sliding, standing = (load_robot_model(f'kuka_kr500_{name}') for name in ('linear_axis', 'r2830'))
    assert sliding.axes_data.prismatic == (True, *[False] * 6)
    assert 'ictive' in sliding.structural_data.source
    for name in ('lower', 'velocity', 'acceleration', 'jerk', 'effort'):
        np.testing.assert_array_equal(
            getattr(sliding.axes_data, name)[1:], getattr(standing.axes_data, name), name
        )
    q, q_dot, q_ddot = np.random.default_rng(2).uniform(-1.0, 1.0, (3, 6))
    axis = np.array([2.0, -1.0, 0.0])  # m, m/s, m/s^2
    rows = [np.concatenate([[first], rest]) for first, rest in zip(axis, (q, q_dot, q_ddot), strict=True)]
    r, T = standing.direct_kinematics(q)
    moved, turned = sliding.direct_kinematics(rows[0])
    np.testing.assert_allclose(moved, r + np.array([axis[0], 0.0, 0.0]), atol=EXACT)
    np.testing.assert_allclose(turned, T, atol=EXACT)
    tau, M, _ = sliding.rigid_dynamics(*rows)
    np.testing.assert_allclose(tau[1:], standing.rigid_dynamics(q, q_dot, q_ddot)[0], rtol=1e-9)
    carriage = sliding.structural_data.carriage_kg
    assert M[0, 0] == pytest.approx(carriage + sum(standing.rigid_dynamics_model.masses))
