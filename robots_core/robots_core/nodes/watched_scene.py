"""WatchedScene: the scene of a node, from a file and from `collision_objects`."""

from collections.abc import Callable

from visualization_msgs.msg import MarkerArray

from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.nodes.scene_messages import updated_scene
from robots_core.ros.qos import COMMAND, STATE
from robots_core.ros.robot_node import RobotNode


class WatchedScene:
    """Declares the parameter `scene` and subscribes to `collision_objects`.

    Args:
        node: Whose scene.
        on_change: Called with the scene, now and at every change; a RobotsError leaves it as it was.

    Raises:
        InvalidInputError: a scene file that is missing or wrong; names its line.
    """

    def __init__(self, node: RobotNode, on_change: Callable[[Scene], None]) -> None:
        path = node.parameter('scene', '', 'scene file (YAML); empty for none', read_only=True)
        self.scene = read_scene(path) if path else Scene()
        on_change(self.scene)
        self._on_change = on_change
        # Who publishes several objects one by one must not lose any; what is latched reaches the other one.
        for qos in (COMMAND, STATE):
            node.create_subscription(MarkerArray, 'collision_objects', self._on_objects, qos)

    def _on_objects(self, message: MarkerArray) -> None:
        scene = updated_scene(self.scene, message)
        self._on_change(scene)
        self.scene = scene
