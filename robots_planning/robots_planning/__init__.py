"""Path planning: trajectory generators, verification, and the switch between them."""

from robots_planning.motion_settings import MotionSettings
from robots_planning.pathplanning import PathPlanning, PlannedMotion
from robots_planning.realtime_movement import MovementState, RealtimeMovement, RealtimeStep
from robots_planning.robot_command_state import RobotCommandState
from robots_planning.teach_box import TeachBox, TeachStep
from robots_planning.trajectory import Trajectory
from robots_planning.trajectory_generators.circular_cartesian import CircularCartesian
from robots_planning.trajectory_generators.linear_cartesian_dynamic_programming import (
    LinearCartesianDynamicProgramming,
)
from robots_planning.trajectory_generators.linear_cartesian_limited import LinearCartesianLimited
from robots_planning.trajectory_generators.linear_joint import LinearJoint
from robots_planning.trajectory_generators.linear_joint_axes import LinearJointAxes
from robots_planning.trajectory_generators.spline_cartesian import SplineCartesian
from robots_planning.verification import LimitUse, VerificationReport, verify

__all__ = [
    'CircularCartesian',
    'LimitUse',
    'LinearCartesianDynamicProgramming',
    'LinearCartesianLimited',
    'LinearJoint',
    'LinearJointAxes',
    'MotionSettings',
    'MovementState',
    'PathPlanning',
    'PlannedMotion',
    'RealtimeMovement',
    'RealtimeStep',
    'RobotCommandState',
    'SplineCartesian',
    'TeachBox',
    'TeachStep',
    'Trajectory',
    'VerificationReport',
    'verify',
]
