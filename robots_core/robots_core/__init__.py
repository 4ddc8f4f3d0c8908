"""Robots: replaceable serial robots, and the blocks that work with any of them."""

from robots_core.errors import RobotsError
from robots_core.pose import Pose
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.structural_data import StructuralData
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel

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
