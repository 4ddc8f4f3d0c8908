from .guidance.realtime_movement import MovementState as MovementState
from .guidance.realtime_movement import RealtimeMovement as RealtimeMovement
from .guidance.realtime_movement import RealtimeStep as RealtimeStep
from .guidance.teach_box import TeachBox as TeachBox
from .guidance.teach_box import TeachStep as TeachStep
from .motion_settings import MotionSettings as MotionSettings
from .pathplanning import PathPlanning as PathPlanning
from .pathplanning import PlannedMotion as PlannedMotion
from .robot_command_state import RobotCommandState as RobotCommandState
from .trajectory import Trajectory as Trajectory
from .trajectory_generators.collision_free_joint import CollisionFreeJoint as CollisionFreeJoint
from .trajectory_generators.curves_cartesian import CircularCartesian as CircularCartesian
from .trajectory_generators.curves_cartesian import SplineCartesian as SplineCartesian
from .trajectory_generators.linear_cartesian import (
    LinearCartesianDynamicProgramming as LinearCartesianDynamicProgramming,
)
from .trajectory_generators.linear_cartesian import LinearCartesianLimited as LinearCartesianLimited
from .trajectory_generators.linear_joint import LinearJoint as LinearJoint
from .trajectory_generators.linear_joint import LinearJointAxes as LinearJointAxes
from .trajectory_generators.trajectory_generator import TrajectoryGenerator as TrajectoryGenerator
from .verification.limit_use import LimitUse as LimitUse
from .verification.trajectory_verification import VerificationReport as VerificationReport
from .verification.trajectory_verification import verify as verify
