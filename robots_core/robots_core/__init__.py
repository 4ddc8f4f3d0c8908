"""Robots: replaceable serial robots, and the blocks that work with any of them."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from robots_core.errors import RobotsError
    from robots_core.pose import Pose
    from robots_core.robot_choice import available_robot_models, load_robot_model
    from robots_core.robot_model.axes_data import AxesData
    from robots_core.robot_model.base_robot_model import BaseRobotModel
    from robots_core.robot_model.structural_data import StructuralData
    from robots_core.robot_model.urdf_robot_model import UrdfRobotModel
else:
    from robots_core.lazy_names import lazy_names

    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            'robots_core.errors': ('RobotsError',),
            'robots_core.pose': ('Pose',),
            'robots_core.robot_choice': ('available_robot_models', 'load_robot_model'),
            'robots_core.robot_model.axes_data': ('AxesData',),
            'robots_core.robot_model.base_robot_model': ('BaseRobotModel',),
            'robots_core.robot_model.structural_data': ('StructuralData',),
            'robots_core.robot_model.urdf_robot_model': ('UrdfRobotModel',),
        },
    )

__all__ = [
    'AxesData',
    'BaseRobotModel',
    'Pose',
    'RobotsError',
    'StructuralData',
    'UrdfRobotModel',
    'available_robot_models',
    'load_robot_model',
]
