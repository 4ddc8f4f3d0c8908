"""A wheel at a tool over its bed: the wrench that a sensor at the tool measures."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose
from robots_core.blocks import ContactStep, SoilBed, Wheel, WheelContact, WheelSoilModel
from robots_core.blocks.terramechanics.soil import SOILS
from robots_core.errors import InvalidInputError
from robots_core.validation import Array

MODEL = WheelSoilModel(Wheel(radius=0.09, width=0.11), SOILS['regolith_simulant'])
BED = SoilBed(0.6, np.array([1.0, -0.5]), np.array([2.0, 0.5]))
HUB, FORWARD = np.array([0.0, 0.01, 0.3]), np.array([1.0, 0.0, 0.0])
DOWN = Pose.from_angles([0.0, 0.0, 0.0], [np.pi / 2.0, 0.0, np.pi])  # tool x along base y, tool z down
DEPTH = 0.02


def contact() -> WheelContact:
    return WheelContact(MODEL, BED, hub=HUB, forward=FORWARD)


def tool(x: float, y: float, depth: float, turn: float = 0.0) -> Pose:
    """With the wheel's lowest point at a place and depth, turned about the vertical."""
    T = Pose.from_angles([0.0, 0.0, 0.0], [turn, 0.0, 0.0]).T @ DOWN.T
    hub = np.array([x, y, BED.height + MODEL.wheel.radius - depth])
    return Pose(hub - T @ HUB, T)


def moved(pose: Pose, way: Array) -> Pose:
    return Pose(pose.r + way, pose.T)


def rolled(wheel: WheelContact, pose: Pose, way: Array) -> ContactStep:
    """The last step of a wheel that touches down and then rolls."""
    wheel.step(pose)
    return wheel.step(moved(pose, way))


@pytest.mark.parametrize('turn', [0.0, 0.7, -2.0])
def test_the_wrench_at_the_tool_is_that_of_the_forces_at_the_hub(turn: float) -> None:
    wheel = contact()
    wheel.slip = 0.3
    pose = tool(1.5, 0.0, DEPTH, turn)
    ahead = pose.T @ FORWARD
    step = rolled(wheel, pose, 0.2 * ahead)
    expected = MODEL.forces(DEPTH, 0.3)
    assert step.forces.load == pytest.approx(expected.load, rel=1e-12)
    force, torque = pose.T @ step.wrench[:3], pose.T @ step.wrench[3:]
    np.testing.assert_allclose(force, expected.drawbar_pull * ahead + [0.0, 0.0, expected.load], atol=1e-9)
    at_hub = torque - np.cross(pose.T @ HUB, force)
    axle = np.cross([0.0, 0.0, 1.0], ahead)
    # The soil turns the wheel against its drive.
    np.testing.assert_allclose(at_hub, -expected.torque * axle, atol=1e-9)
    assert step.sinkage == pytest.approx(DEPTH)
    assert step.slip == 0.3


def test_a_wheel_that_rolls_back_is_pulled_back() -> None:
    wheel = contact()
    wheel.slip = 0.5
    pose = tool(1.5, 0.0, DEPTH)
    forth, back = (rolled(contact_of(0.5), pose, sign * 0.2 * (pose.T @ FORWARD)) for sign in (1.0, -1.0))
    np.testing.assert_allclose(back.wrench[0], -forth.wrench[0])
    np.testing.assert_allclose(back.wrench[2], forth.wrench[2])


def test_a_wheel_that_swings_back_when_it_stops_pulls_on() -> None:
    wheel, pose = contact_of(0.5), tool(1.5, 0.0, DEPTH)
    ahead = pose.T @ FORWARD
    wheel.step(pose)
    pulls = [
        (pose.T @ wheel.step(moved(pose, way * ahead)).wrench[:3]) @ ahead
        for way in (0.2, 0.1995, 0.198, 0.1985)
    ]
    assert pulls[0] == pytest.approx(pulls[1]) == pytest.approx(-pulls[2]) == pytest.approx(-pulls[3])


def contact_of(slip: float) -> WheelContact:
    wheel = contact()
    wheel.slip = slip
    return wheel


def test_forces_change_to_those_of_rolling_without_a_jump_and_stay_so() -> None:
    wheel = contact_of(0.4)
    pose = tool(1.5, -0.2, DEPTH)
    ahead = pose.T @ FORWARD
    ways = np.arange(0.0, 0.12, 1e-4)
    loads = []
    for way in ways:
        step = wheel.step(moved(pose, way * ahead))
        loads.append(step.forces.load)
    entry, _, leave = MODEL.angles(DEPTH, 0.4)
    assert loads[0] == pytest.approx(MODEL.standing(DEPTH).load)
    assert loads[-1] == pytest.approx(MODEL.forces(DEPTH, 0.4).load)
    change = abs(loads[0] - loads[-1]) * 1e-4 / (0.09 * (entry - leave))
    assert np.abs(np.diff(loads)).max() <= 1.01 * change
    # Lifted and put down again, it begins again.
    assert wheel.step(tool(1.5, 0.0, -0.01)).forces.load == 0.0
    assert wheel.step(pose).forces.load == pytest.approx(loads[0])


@pytest.mark.parametrize(('x', 'y'), [(0.9, 0.0), (2.1, 0.0), (1.5, 0.6), (1.5, -0.6)])
def test_beside_the_bed_there_is_no_soil(x: float, y: float) -> None:
    step = contact().step(tool(x, y, 0.05))
    assert not step.wrench.any()
    assert step.sinkage < 0.0


def test_a_wheel_in_the_air_may_point_anywhere() -> None:
    up = Pose(np.array([1.5, 0.0, 2.0]), Pose.from_angles([0.0, 0.0, 0.0], [0.0, np.pi / 2.0, 0.0]).T)
    step = contact().step(up)
    assert not step.wrench.any()


@pytest.mark.parametrize(
    ('make', 'reason'),
    [
        (lambda: SoilBed(0.6, np.array([1.0, 0.0]), np.array([1.0, 1.0])), 'x side of the soil bed = 0.0'),
        (lambda: SoilBed(np.inf, np.zeros(2), np.ones(2)), r'height\[0\] is inf'),
        (lambda: WheelContact(MODEL, BED, hub=HUB, forward=np.zeros(3)), 'length of forward = 0.0'),
    ],
)  # fmt: skip
def test_what_is_no_contact_is_refused(make: object, reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        make()  # type: ignore[operator]
