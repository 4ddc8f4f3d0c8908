"""The parameter `scene` of a node."""

from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.ros.robot_node import RobotNode


def scene_by_parameter(node: RobotNode) -> Scene:
    """Declare the parameter `scene` and read its file; an empty scene without one.

    Raises:
        InvalidInputError: a scene file that is missing or wrong; names its line.
    """
    path = node.parameter('scene', '', 'scene file (YAML); empty for none')
    return read_scene(path) if path else Scene()
