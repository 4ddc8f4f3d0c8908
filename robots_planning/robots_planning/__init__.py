"""Path planning: trajectory generators, verification, and the switch between them."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
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
else:
    from robots_core.lazy_names import lazy_names

    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            'robots_planning.motion_settings': ('MotionSettings',),
            'robots_planning.pathplanning': ('PathPlanning', 'PlannedMotion'),
            'robots_planning.realtime_movement': ('MovementState', 'RealtimeMovement', 'RealtimeStep'),
            'robots_planning.robot_command_state': ('RobotCommandState',),
            'robots_planning.teach_box': ('TeachBox', 'TeachStep'),
            'robots_planning.trajectory': ('Trajectory',),
            'robots_planning.trajectory_generators.circular_cartesian': ('CircularCartesian',),
            'robots_planning.trajectory_generators.linear_cartesian_dynamic_programming': (
                'LinearCartesianDynamicProgramming',
            ),
            'robots_planning.trajectory_generators.linear_cartesian_limited': ('LinearCartesianLimited',),
            'robots_planning.trajectory_generators.linear_joint': ('LinearJoint',),
            'robots_planning.trajectory_generators.linear_joint_axes': ('LinearJointAxes',),
            'robots_planning.trajectory_generators.spline_cartesian': ('SplineCartesian',),
            'robots_planning.verification': ('LimitUse', 'VerificationReport', 'verify'),
        },
    )

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
