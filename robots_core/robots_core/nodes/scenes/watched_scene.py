"""WatchedScene: the scene of a node, from a file and from `collision_objects`."""

from collections.abc import Callable

from visualization_msgs.msg import MarkerArray

from robots_core.blocks.collision.scene import Scene
from robots_core.nodes.scenes.scene_messages import updated_scene
from robots_core.nodes.scenes.scene_parameter import scene_by_parameter
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode


class WatchedScene:
    """Follows `collision_objects` from a scene on.

    Args:
        node: Whose scene.
        on_change: Called with the scene, now and at every change; a RobotsError leaves it as it was.
        scene: To begin with; by default that of the parameter, which is declared.

    Raises:
        InvalidInputError: a scene file that is missing or wrong; names its line.
    """

    def __init__(
        self, node: RobotNode, on_change: Callable[[Scene], None], scene: Scene | None = None
    ) -> None:
        self._base_link = node.robot.base_link
        self.scene = scene_by_parameter(node) if scene is None else scene
        on_change(self.scene)
        self._on_change = on_change
        subscribe(node, MarkerArray, 'collision_objects', self._on_objects)

    def _on_objects(self, message: MarkerArray) -> None:
        scene = updated_scene(self.scene, message, self._base_link)
        self._on_change(scene)
        self.scene = scene
