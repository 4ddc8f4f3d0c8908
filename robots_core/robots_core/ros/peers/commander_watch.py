"""CommanderWatch: the commander of the robot and the operating mode, as controller_node publishes them."""

from collections.abc import Callable
from typing import Final

from std_msgs.msg import String

from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.operating_modes import Commander, OperatingMode, check_command
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode

NODES: Final = {'lua_program_node': Commander.PROGRAM, 'pendant_node': Commander.PENDANT}
PENDANT_LOST_AFTER: Final = 1.0  # s; without its run button the robot stands before


class CommanderWatch:
    """Follows `commander`, `operating_mode` and `guide`; without a controller everyone may command.

    Args:
        node: The node that subscribes.
        on_taken: Called with another commander that has taken the robot.
    """

    def __init__(self, node: RobotNode, on_taken: Callable[[Commander], object] = lambda _: None) -> None:
        self._on_taken = on_taken
        namespace = node.get_namespace().rstrip('/')
        self._nodes = {f'{namespace}/{name}': commander for name, commander in NODES.items()}
        self.commander = Commander.NOBODY
        """The commander of the robot."""
        self.mode: OperatingMode | None = None
        """The operating mode; None before the controller has published it."""
        self.guide: Guide | None = None
        """What the program lets guide its robot; None without a program's node."""
        subscribe(node, String, 'commander', self._on_commander)
        subscribe(node, String, 'operating_mode', self._on_mode)
        subscribe(node, String, 'guide', self._on_guide)

    def check(self, sender: Commander) -> None:
        """Check that a commander may command the robot now.

        Raises:
            CommandRefusedError: another one commands the robot, or the mode excludes the sender.
        """
        guide = self.guide or Guide.NONE
        check_command(sender, commander=self.commander, mode=self.mode, guide=guide)

    def of_node(self, name: str) -> Commander:
        """What a node that commands motions is, by its full name; the present commander for ''."""
        if not name:
            return Commander.REMOTE if self.commander is Commander.NOBODY else self.commander
        return self._nodes.get(name, Commander.REMOTE)

    def _on_commander(self, message: String) -> None:
        before, self.commander = self.commander, Commander(message.data)
        if self.commander not in (before, Commander.NOBODY):
            self._on_taken(self.commander)

    def _on_mode(self, message: String) -> None:
        self.mode = OperatingMode(message.data)

    def _on_guide(self, message: String) -> None:
        self.guide = Guide(message.data)
