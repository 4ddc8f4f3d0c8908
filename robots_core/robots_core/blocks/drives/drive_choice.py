"""Levels of simulated drives: ideal, second-order, and rigid-body."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Final

from numpy.typing import ArrayLike

from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.drives.drive_train import DriveTrain, IdealDrive, SecondOrderDrive
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import one_of

check_level: Final = one_of('drive level', DRIVE_LEVELS)


def drive_train(
    level: str,
    robot: BaseRobotModel,
    q: ArrayLike,
    *,
    period: float,
    bandwidth: ArrayLike = 15.0,
    damping: ArrayLike = 1.0,
    payload: Payload = NOTHING,
    feed_forward: bool = True,
    orbit: Path | str = '',
) -> DriveTrain:
    """Drives of a robot.

    Args:
        level: `ideal` (on the reference), `second_order` (`bandwidth`, `damping`) or `rigid_body` (the
            robot's motors, gears and masses, with `payload`).
        robot: The robot.
        q: Joint positions at the start, (n,), rad (m), at rest.
        period: Time of one step, s.
        bandwidth: Natural frequency of `second_order`, Hz, one number or (n,).
        damping: Damping ratio of `second_order`, one number or (n,).
        payload: Payload on tool0, for `rigid_body`.
        feed_forward: Feed-forward by the model of robot and payload, for `rigid_body` (see `RigidBodyDrive`).
        orbit: Orbit in which the robot's base floats (YAML, see `read_orbit`); '' for one that stands.

    Raises:
        InvalidInputError: no such level, a file that is no orbit, or values out of range.
    """
    check_level(level)
    bodies = None
    if orbit:
        # Imported on demand: a robot that stands needs no bodies in orbit.
        floating = import_module('robots_core.blocks.drives.floating_drive')
        bodies = floating.bodies_in_orbit(orbit, robot, q, period=period, payload=payload)
    drives: DriveTrain
    if level == 'ideal':
        drives = IdealDrive(q, period=period)
    elif level == 'second_order':
        drives = SecondOrderDrive(q, period=period, bandwidth=bandwidth, damping=damping)
    else:
        # Imported on demand: only `rigid_body` needs the compiler.
        rigid_body = import_module('robots_core.blocks.drives.rigid_body_drive')
        drives = rigid_body.RigidBodyDrive(
            robot,
            q,
            period=period,
            payload=payload,
            feed_forward=feed_forward,
            base=None if bodies is None else bodies.base,
        )
    if bodies is not None:
        drives = floating.FloatingDrive(drives, bodies)
    return drives
