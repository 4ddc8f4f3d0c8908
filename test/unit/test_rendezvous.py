"""Rendezvous: what is grasped, what is refused with which numbers, and what both bodies do then."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks.drives.drive_choice import drive_train
from robots_core.blocks.drives.supervised_drives import SupervisedDrives
from robots_core.blocks.floating_base.orbit import Approach, Gripper, Orbit, Target, Wheels, read_orbit
from robots_core.blocks.floating_base.rendezvous import Rendezvous
from robots_core.blocks.multibody.payload import Payload
from robots_core.errors import InvalidInputError

from .simulated_program import PROGRAMS

ROBOT = load_robot_model('debris_arm?gravity=0,0,0')
ORBIT = PROGRAMS / 'debris_removal' / 'orbit.yaml'
PERIOD = 0.02  # s
Q, STILL = np.array(ROBOT.home), np.zeros(3)


def before_the_tool(
    *, spin: float = 0.02, away: float = 0.0, capacity: float = 50.0, duration: float = 0.2
) -> Orbit:
    """A target whose ring is before tool0 by a distance, m, and that turns about its x, rad/s.

    The gripper needs a duration, s, to close.
    """
    r, _ = ROBOT.direct_kinematics(Q)
    ring = Pose(np.array([-0.9, 0.0, 0.0]), np.eye(3))
    place = Pose(r + np.array([0.9 + away, 0.0, 0.0]), np.eye(3))
    body, turn = Payload(220.0, inertia=np.diag([30.0, 60.0, 75.0])), np.array([spin, 0.0, 0.0])
    target = Target(body, place, STILL, turn, ring, 0.7)
    return Orbit(
        target, Gripper(0.005, 0.05, 0.06, duration), Wheels(2.0, capacity, 1.0), Approach(0.4, 0.03, 4.0)
    )


def test_both_come_to_rest_and_their_momentum_stays():
    bodies = Rendezvous(ROBOT, Q, before_the_tool(), period=PERIOD)
    start = bodies.momentum.sum(axis=0)
    np.testing.assert_allclose(start[3:], [30.0 * 0.02, 0.0, 0.0], atol=1e-12)
    bodies.step(Q, STILL)
    assert bodies.digital_inputs == (False, True, False)  # contact with a gripper that is open
    bodies.close(closing=True)
    bodies.step(Q, STILL)
    assert bodies.digital_inputs[:2] == (True, False)
    assert 'impulse on the target' in bodies.report
    seen = bodies.base.tool[0].inverse() @ bodies.target.pose
    for _ in range(450):
        bodies.step(Q, STILL)
        np.testing.assert_allclose(bodies.momentum.sum(axis=0), start, atol=1e-9)
    assert bodies.at_rest
    assert np.abs(bodies.base.twist).max() < 1e-3
    assert max((bodies.base.tool[0].inverse() @ bodies.target.pose).distance_to(seen)) < 1e-12
    # The wheels have all of it.
    np.testing.assert_allclose(bodies.momentum[2], start, atol=0.02)
    bodies.close(closing=False)
    assert bodies.grasped


def test_what_cannot_be_held_is_refused_with_its_numbers():
    fast = Rendezvous(ROBOT, Q, before_the_tool(spin=0.1, away=0.3), period=PERIOD)
    fast.close(closing=True)
    assert fast.report == 'grasp refused: the target turns at 0.1 rad/s, the gripper holds 0.06 rad/s'
    assert fast.measured[1] == pytest.approx(0.1)
    heavy = Rendezvous(ROBOT, Q, before_the_tool(capacity=0.5), period=PERIOD)
    heavy.close(closing=True)
    assert heavy.report == (
        'grasp refused: both have an angular momentum of 0.6 N m s, the wheels take 0.5 N m s'
    )
    momentum = heavy.momentum
    for _ in range(10):  # it is not grasped later either
        heavy.step(Q, STILL)
    assert heavy.digital_inputs == (False, True, False)
    np.testing.assert_allclose(heavy.momentum, momentum, atol=1e-12)
    moving = Rendezvous(ROBOT, Q, before_the_tool(), period=PERIOD)
    moving.close(closing=True)
    moving.step(Q + np.array([0.0, 0.0, 1e-3]), np.array([0.0, 0.0, 0.1]))
    assert 'the gripper holds 0.05 m/s' in moving.report
    moving.close(closing=False)
    assert not moving.refused


def test_contact_that_was_not_planned_is_named():
    orbit = before_the_tool(away=-0.3)
    bodies = Rendezvous(ROBOT, Q, orbit, period=PERIOD)
    bodies.close(closing=True)
    bodies.step(Q, STILL)
    assert bodies.refused
    assert bodies.report.startswith('grasp refused: contact where none was planned: the arm behind J3 is 0.')
    assert bodies.report.endswith("from the target's centre, which needs 0.7 m")


def test_the_camera_measures_what_it_sees_while_it_leads():
    bodies = Rendezvous(ROBOT, Q, before_the_tool(away=0.6), period=PERIOD)
    assert bodies.reference is None
    bodies.guided = True
    seen = []
    for k in range(50):
        angle = 0.1 * np.sin(0.02 * k)
        bodies.step(Q + np.array([angle, 0.0, 0.0]), np.array([0.002 * np.cos(0.02 * k) / PERIOD, 0.0, 0.0]))
        assert bodies.reference is not None
        seen.append(bodies.reference)
    for (before, _), (now, twist), (after, _) in zip(seen, seen[1:], seen[2:], strict=False):
        # Central differences are off by some 1e-5 of this motion.
        moved = before.error_to(after) / (2.0 * PERIOD)
        np.testing.assert_allclose(moved, twist, atol=5e-5)
        assert np.isfinite(now.r).all()
    blind = replace(before_the_tool(away=0.6), approach=Approach(0.4, 0.03, 1.0))
    bodies = Rendezvous(ROBOT, Q, blind, period=PERIOD)
    bodies.guided = True
    bodies.step(Q, STILL)
    assert bodies.reference is None


def test_the_base_moves_on_while_brakes_hold_the_joints(tmp_path: Path):
    path = tmp_path / 'orbit.yaml'
    path.write_text(ORBIT.read_text() + 'twist: [0.01, 0, 0, 0, 0, 0.02]\n')
    drives = drive_train('ideal', ROBOT, Q, period=PERIOD, orbit=path)
    assert drives.rendezvous is not None
    supervised = SupervisedDrives(drives, ROBOT.axes_data, period=PERIOD)
    for k in range(100):
        supervised.step(k * PERIOD, None)
    assert supervised.braked
    np.testing.assert_allclose(drives.position, Q)
    assert drives.rendezvous.base.pose.distance_to(Pose.identity())[1] == pytest.approx(0.04, rel=1e-2)
    momentum = drives.rendezvous.base.momentum
    drives.step(Q + 1e-3, [0.05, 0.05, 0.05])
    drives.rest()
    np.testing.assert_allclose(drives.rendezvous.base.momentum, momentum, atol=1e-10)
    assert not drives.velocity.any()


def test_a_grasp_that_loads_the_joints_too_much_is_refused():
    bodies = Rendezvous(ROBOT, Q, before_the_tool(duration=1e-4), period=PERIOD)
    bodies.close(closing=True)
    moving = np.array([0.01, 0.0, 0.0])
    bodies.step(Q + PERIOD * moving, moving)
    assert re.fullmatch(
        r'grasp refused: the grasp within 0\.0001 s would load J\d with [\d.e+]+ N m, its limit is \d+ N m',
        bodies.report,
    )


@pytest.mark.parametrize('level', ['second_order', 'rigid_body'])
def test_the_joints_hold_or_yield_as_their_drives_do(tmp_path: Path, level: str):
    """The arm swings against the ring; drives with masses are struck, and bring the joints back."""
    drives = drive_train(level, ROBOT, Q, period=0.004, orbit=_near_the_ring(tmp_path))
    bodies = drives.rendezvous
    assert bodies is not None
    start = bodies.momentum.sum(axis=0)
    bodies.close(closing=True)
    rows = [drives.step(Q, STILL) for _ in range(100)]
    assert bodies.grasped, bodies.report
    struck = np.array([q_dot for _, q_dot in rows])
    if level == 'rigid_body':
        assert np.abs(struck[0]).max() > 1e-4
        assert np.abs(struck[-1]).max() < 0.05 * np.abs(struck[0]).max()
        assert (np.abs(drives.torque) <= ROBOT.axes_data.effort).all()
    else:
        np.testing.assert_allclose(struck, 0.0, atol=1e-12)
    np.testing.assert_allclose(bodies.momentum.sum(axis=0), start, atol=1e-9)


def _near_the_ring(folder: Path) -> Path:
    """The orbit of the program with its ring at the tool."""
    r, T = ROBOT.direct_kinematics(Q)
    ring = Pose.from_angles([-0.9, 0.0, 0.0], [0.0, 1.5708, 0.0])
    place = Pose(r, T) @ ring.inverse()
    text = ORBIT.read_text()
    x, y, z, w = place.quaternion()
    old = 'pose: {position: [3.5, 0.25, 1.9]}'
    assert old in text
    new = f'pose: {{position: {place.r.tolist()}, quaternion: [{x}, {y}, {z}, {w}]}}'
    path = folder / 'orbit.yaml'
    path.write_text(text.replace(old, new))
    return path


@pytest.mark.parametrize(
    ('old', 'new', 'message'),
    [
        ('body: [220', 'body: [0', 'body needs a mass'),
        ('0.035, 0.004', '35, 0.004', r'angular_velocity is .*; valid are values within \+-1'),
        ('speed: 0.05', 'speed: -1', 'speed is -1'),
        ('gripper:', 'griper:', 'gripper is missing'),
        ('radius: 0.7', 'radios: 0.7', "unknown key 'radios'; did you mean 'radius'"),
        ('torque: 0.4', 'torque: 0.4, size: 3', "unknown key 'size'"),
        ('[220, 0, 0, 0, 30', '[220, 0, 0, 0, 300', 'no body has principal moments'),
    ],
)
def test_a_damaged_orbit_is_named_with_its_line(tmp_path: Path, old: str, new: str, message: str):
    path = tmp_path / 'orbit.yaml'
    text = ORBIT.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    with pytest.raises(InvalidInputError, match=rf'orbit.yaml:\d+: .*{message}'):
        read_orbit(path)
