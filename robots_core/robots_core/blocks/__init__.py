"""Functional blocks: robot-independent, ROS-free, numpy in and out."""

from robots_core.blocks.direct_kinematics import DirectKinematics
from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
from robots_core.blocks.inverse_kinematics.constrained import ConstrainedInverseKinematics
from robots_core.blocks.inverse_kinematics.constrained_step import ActiveLimit, ConstrainedStep
from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
from robots_core.blocks.inverse_kinematics.ik_result import IkBatch, IkResult
from robots_core.blocks.inverse_kinematics.redundancy import Redundancy
from robots_core.robot_model.analytic.configuration import Configuration

__all__ = [
    'ActiveLimit',
    'AnalyticalInverseKinematic',
    'Configuration',
    'ConstrainedInverseKinematics',
    'ConstrainedStep',
    'DampedLeastSquares',
    'DirectKinematics',
    'IkBatch',
    'IkResult',
    'Redundancy',
]
