"""Path planning: trajectory generators, verification, and the switch between them."""

from robots_planning.pathplanning import MotionSettings, PathPlanning, PlannedMotion
from robots_planning.robot_command_state import RobotCommandState
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited
from robots_planning.trajectory_generators.linear_joint import LinearJoint
from robots_planning.verification import LimitUse, VerificationReport, verify

__all__ = [
    'LimitUse',
    'LinearCartesianLimited',
    'LinearJoint',
    'MotionSettings',
    'PathPlanning',
    'PlannedMotion',
    'RobotCommandState',
    'Trajectory',
    'VerificationReport',
    'verify',
]
