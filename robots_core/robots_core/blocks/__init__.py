"""Functional blocks: robot-independent, ROS-free, numpy in and out."""

from typing import TYPE_CHECKING

# Not on demand: a module has the same name.
from robots_core.blocks.drive_level import drive_train

if TYPE_CHECKING:
    from robots_core.blocks.base_motion import BaseMotion
    from robots_core.blocks.collision.joint_path import JointPath
    from robots_core.blocks.collision.results import CollisionError, PathProximity, Proximity
    from robots_core.blocks.collision.scene import AttachedObject, Scene, SceneObject
    from robots_core.blocks.collision.scene_file import read_scene
    from robots_core.blocks.collision_detection import CollisionDetection
    from robots_core.blocks.direct_kinematics import DirectKinematics
    from robots_core.blocks.drive_faults import DriveFaults
    from robots_core.blocks.drive_train import DriveTrain, IdealDrive, SecondOrderDrive
    from robots_core.blocks.free_floating import FreeFloatingRobot
    from robots_core.blocks.free_floating_dynamics import FreeFloatingDynamics
    from robots_core.blocks.function_dynamics import FunctionDynamics
    from robots_core.blocks.inverse_kinematics.analytical import AnalyticalInverseKinematic
    from robots_core.blocks.inverse_kinematics.constrained import ConstrainedInverseKinematics
    from robots_core.blocks.inverse_kinematics.constrained_step import ActiveLimit, ConstrainedStep
    from robots_core.blocks.inverse_kinematics.damped_least_squares import DampedLeastSquares
    from robots_core.blocks.inverse_kinematics.ik_result import IkBatch, IkResult
    from robots_core.blocks.inverse_kinematics.redundancy import Redundancy
    from robots_core.blocks.numerical_dynamics import NumericalDynamics
    from robots_core.blocks.payload import Payload
    from robots_core.blocks.rigid_body_drive import RigidBodyDrive
    from robots_core.robot_model.analytic.configuration import Configuration
else:
    from robots_core.lazy_names import lazy_names

    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            'robots_core.blocks.base_motion': ('BaseMotion',),
            'robots_core.blocks.collision.joint_path': ('JointPath',),
            'robots_core.blocks.collision.results': ('CollisionError', 'PathProximity', 'Proximity'),
            'robots_core.blocks.collision.scene': ('AttachedObject', 'Scene', 'SceneObject'),
            'robots_core.blocks.collision.scene_file': ('read_scene',),
            'robots_core.blocks.collision_detection': ('CollisionDetection',),
            'robots_core.blocks.direct_kinematics': ('DirectKinematics',),
            'robots_core.blocks.drive_faults': ('DriveFaults',),
            'robots_core.blocks.drive_train': ('DriveTrain', 'IdealDrive', 'SecondOrderDrive'),
            'robots_core.blocks.free_floating': ('FreeFloatingRobot',),
            'robots_core.blocks.free_floating_dynamics': ('FreeFloatingDynamics',),
            'robots_core.blocks.function_dynamics': ('FunctionDynamics',),
            'robots_core.blocks.inverse_kinematics.analytical': ('AnalyticalInverseKinematic',),
            'robots_core.blocks.inverse_kinematics.constrained': ('ConstrainedInverseKinematics',),
            'robots_core.blocks.inverse_kinematics.constrained_step': ('ActiveLimit', 'ConstrainedStep'),
            'robots_core.blocks.inverse_kinematics.damped_least_squares': ('DampedLeastSquares',),
            'robots_core.blocks.inverse_kinematics.ik_result': ('IkBatch', 'IkResult'),
            'robots_core.blocks.inverse_kinematics.redundancy': ('Redundancy',),
            'robots_core.blocks.numerical_dynamics': ('NumericalDynamics',),
            'robots_core.blocks.payload': ('Payload',),
            'robots_core.blocks.rigid_body_drive': ('RigidBodyDrive',),
            'robots_core.robot_model.analytic.configuration': ('Configuration',),
        },
    )

__all__ = [
    'ActiveLimit',
    'AnalyticalInverseKinematic',
    'AttachedObject',
    'BaseMotion',
    'CollisionDetection',
    'CollisionError',
    'Configuration',
    'ConstrainedInverseKinematics',
    'ConstrainedStep',
    'DampedLeastSquares',
    'DirectKinematics',
    'DriveFaults',
    'DriveTrain',
    'FreeFloatingDynamics',
    'FreeFloatingRobot',
    'FunctionDynamics',
    'IdealDrive',
    'IkBatch',
    'IkResult',
    'JointPath',
    'NumericalDynamics',
    'PathProximity',
    'Payload',
    'Proximity',
    'Redundancy',
    'RigidBodyDrive',
    'Scene',
    'SceneObject',
    'SecondOrderDrive',
    'drive_train',
    'read_scene',
]
