"""Independent references: Pinocchio on the published description, difference quotients."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin

from robots_core import BaseRobotModel
from robots_core.orientation import rotation_vector

STEP = 1e-5
# Central differences at STEP: truncation h^2/6 f''' of about 2e-11, rounding eps/h of about 2e-11 per metre;
# robots of several metres and speeds of a few rad/s multiply both by up to 100.
DIFFERENCE_TOLERANCE = 1e-8


def derivative(function: Callable[[float], Any]) -> np.ndarray:
    """Central difference quotient of an array-valued function at 0."""
    return np.asarray((function(STEP) - function(-STEP)) / (2.0 * STEP))


def twist(pose: Callable[[float], tuple[np.ndarray, np.ndarray]]) -> np.ndarray:
    """Linear and angular velocity (6,) of a moving frame at 0."""
    (r0, T0), (r1, T1) = pose(-STEP), pose(STEP)
    return np.concatenate([r1 - r0, rotation_vector(T1 @ T0.T)]) / (2.0 * STEP)


class DescribedRobot:
    """What the robot's description means to Pinocchio: joints that the robot does not move stay at zero."""

    def __init__(self, robot: BaseRobotModel) -> None:
        self.model = pin.buildModelFromXML(robot.description)
        self.data = self.model.createData()
        ids = [self.model.getJointId(name) for name in robot.axes_data.names]
        self.joints = [self.model.joints[i] for i in ids]
        self.dofs = [joint.idx_v for joint in self.joints]

    def _configuration(self, q: np.ndarray) -> np.ndarray:
        full = pin.neutral(self.model)
        for joint, value in zip(self.joints, q, strict=True):
            # A continuous joint is a point on the unit circle.
            full[joint.idx_q : joint.idx_q + joint.nq] = (
                value if joint.nq == 1 else (np.cos(value), np.sin(value))
            )
        return np.asarray(full)

    def _velocity(self, v: np.ndarray) -> np.ndarray:
        full = np.zeros(self.model.nv)
        full[self.dofs] = v
        return full

    def torques(self, q: np.ndarray, q_dot: np.ndarray, q_ddot: np.ndarray) -> np.ndarray:
        """Recursive Newton-Euler."""
        tau = pin.rnea(
            self.model, self.data, self._configuration(q), self._velocity(q_dot), self._velocity(q_ddot)
        )
        return np.asarray(tau)[self.dofs]

    def frame(self, name: str, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pose of a link."""
        pin.framesForwardKinematics(self.model, self.data, self._configuration(q))
        placement = self.data.oMf[self.model.getFrameId(name)]
        return placement.translation.copy(), placement.rotation.copy()
