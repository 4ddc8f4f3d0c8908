"""No body comes across a closed border, whatever the motion is and when the border closes."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from robots_controller.control.controller import Controller, ControllerState
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.zones.zone_guard import ZoneGuard
from robots_core import Pose, load_robot_model
from robots_core.blocks import PlacedBox, Zone, ZoneDetection
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.zones.zone import Keep
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Box
from robots_planning import LinearJoint, LinearJointAxes, Trajectory

PERIOD = 0.004
PATIENCE = 400  # periods after the planned end


@cache
def robot_of(name: str) -> BaseRobotModel:
    return load_robot_model(name)


def motion(robot: BaseRobotModel, seed: int) -> Trajectory:
    random = np.random.default_rng(seed)
    low, high = robot.axes_data.one_turn
    start, goal = low + random.uniform(0.3, 0.7, (2, robot.num_axes)) * (high - low)
    return (LinearJoint, LinearJointAxes)[seed % 2](robot).generate(start, goal)


def zone_on(robot: BaseRobotModel, trajectory: Trajectory, keep: Keep) -> Zone:
    """A box in the way of the flange, or one that it leaves."""
    places = [
        robot.direct_kinematics(trajectory.sample(part * trajectory.duration)[0])[0] for part in (0.0, 0.6)
    ]
    size = 0.2 if keep == 'out' else 1.6 * float(np.linalg.norm(places[1] - places[0]))
    centre = places[1] if keep == 'out' else places[0]
    what = 'bodies' if keep == 'out' else 'tool'
    return Zone(
        'zone',
        PlacedBox(Box((size,) * 3), Pose.from_angles(centre, [0.3, 0.2, 0.1])),
        keep,
        what,
        {'i': False},
    )


@pytest.mark.parametrize('keep', ['in', 'out'])
@pytest.mark.parametrize('name', ['kuka_kr210_r2700', 'ur5e', 'franka_fr3'])
def test_no_reference_is_across_a_closed_border(name: str, keep: Keep) -> None:
    robot, held = robot_of(name), 0
    for seed in range(6):
        trajectory = motion(robot, seed)
        zone = zone_on(robot, trajectory, keep)
        if (
            ZoneDetection(robot, Scene(zones=(zone,))).clearance(zone).closest(trajectory.position[0])[0]
            > 0.01
        ):
            held += follow(robot, zone, trajectory, late=seed > 2)
    assert held >= 2


def follow(robot: BaseRobotModel, zone: Zone, trajectory: Trajectory, *, late: bool) -> bool:
    """Follow a motion into a zone that is closed, or closes a second of path before it; True if held."""
    scene = Scene(zones=(zone,))
    clearance, guard = ZoneDetection(robot, scene).clearance(zone), ZoneGuard(robot, scene)
    speed = SpeedControl(robot.axes_data, ControllerSettings(), zones=guard)
    controller, q = Controller(robot.axes_data, speed=speed), trajectory.position[0]
    guard.close(())
    controller.step(0.0, q)
    borders, cap = speed.borders(trajectory), speed.cap(trajectory)
    controller.follow(FollowedMotion(trajectory, 'motion', cap=cap, borders=borders), 0.0)
    closing = max(0, round((borders[0].start - 1.0) / PERIOD)) if borders and late else 0
    for step in range(round(trajectory.duration / PERIOD) + PATIENCE):
        if step == closing:
            guard.close(('zone',))
        reference = controller.step((step + 1) * PERIOD, q)
        assert reference is not None
        q = reference[0]
        if step % 5 == 0:
            assert clearance.closest(q)[0] >= 0.0
    assert not controller.stops.latched
    if borders:
        assert controller.state is ControllerState.FOLLOWING
        assert clearance.closest(q)[0] < 5e-3
    return bool(borders)
