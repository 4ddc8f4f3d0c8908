"""FloatingDrive: drives of an arm whose base floats."""

from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from robots_core.blocks.drives.drive_train import DriveTrain
from robots_core.blocks.floating_base.orbit import read_orbit
from robots_core.blocks.floating_base.rendezvous import Rendezvous
from robots_core.blocks.multibody.payload import Payload
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only


class FloatingDrive(DriveTrain):
    """Drives of any level, and the bodies in orbit that they move.

    The base reacts to the motion of the joints, and the torques are those that this motion takes, of level
    `rigid_body` those of the motors. A grasp strikes the joints, which yield if their drives have masses, and
    hold otherwise. What the arm carries changes by a grasp alone: a payload that a program sets counts in its
    plans.
    """

    rendezvous: Rendezvous

    def __init__(self, drives: DriveTrain, rendezvous: Rendezvous) -> None:
        self._drives, self.rendezvous = drives, rendezvous
        rendezvous.impact_inertia = drives.impact_inertia
        self.position, self.velocity = drives.position, drives.velocity
        self._torque = read_only(np.zeros_like(drives.position))

    @property
    def torque(self) -> Array:
        """See `DriveTrain.torque`; without friction and rotors unless the drives have masses."""
        return self._torque

    def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
        """See `DriveTrain.step`."""
        return self._move(*self._drives.step(q_ref, q_dot_ref))

    def hold(self) -> tuple[Array, Array]:
        """See `DriveTrain.hold`; the base moves on."""
        return self._move(self._drives.position, np.zeros_like(self._drives.position))

    def rest(self) -> None:
        """See `DriveTrain.rest`; the base takes over the momentum of the arm."""
        self._drives.rest()
        self.velocity = self._drives.velocity
        self.rendezvous.base.stop_joints()

    def _move(self, q: Array, q_dot: Array) -> tuple[Array, Array]:
        before = self.rendezvous.grasped
        self.rendezvous.step(q, q_dot)
        base, torque = self.rendezvous.base, self._drives.torque
        if self.rendezvous.grasped and not before:
            q_dot = base.joint_velocity
            self._drives.apply_impact(q_dot)
        self.position, self.velocity = q, q_dot
        self._torque = read_only(base.torque if torque is None else torque)
        return q, q_dot


def bodies_in_orbit(
    orbit: Path | str, robot: BaseRobotModel, q: ArrayLike, *, period: float, payload: Payload
) -> Rendezvous:
    """The bodies of an orbit's file (YAML, see `read_orbit`), and a robot at rest at `q`, (n,), rad (m)."""
    return Rendezvous(robot, np.array(q, dtype=np.float64), read_orbit(orbit), period=period, payload=payload)
