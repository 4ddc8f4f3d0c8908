"""The graph of a robot cell: which nodes it has, in one place, for `cell` and for ros2 launch."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ament_index_python.packages import PackageNotFoundError, get_package_prefix

from robots_core.errors import RobotsError


@dataclass(frozen=True)
class NodeDescription:
    """One node of the cell, an own process.

    Attributes:
        package: ROS package.
        executable: Executable in that package; also the node's name.
        parameters: ROS parameters.
    """

    package: str
    executable: str
    parameters: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, 'parameters', MappingProxyType(dict(self.parameters)))

    @property
    def name(self) -> str:
        """The node's name."""
        return self.executable

    def executable_path(self) -> Path:
        """The executable as `ros2 run` finds it: prefix/lib/package/executable by the ament index.

        Raises:
            RobotsError: the package is not installed, or has no such executable.
        """
        try:
            prefix = Path(get_package_prefix(self.package))
        except PackageNotFoundError as error:
            raise RobotsError(
                f'package {self.package!r} is not in the ament index; build the workspace '
                f'(`make build`) and source install/setup.bash'
            ) from error
        path = prefix / 'lib' / self.package / self.executable
        if not path.is_file():
            raise RobotsError(
                f'package {self.package!r} has no executable {self.executable!r} in {path.parent}'
            )
        return path


def cell_graph(
    *,
    robot: str,
    program: str = '',
    autostart: bool = False,
    rate: float = 250.0,
    drive: Mapping[str, Any] | None = None,
    port: int = 8080,
) -> tuple[NodeDescription, ...]:
    """All nodes of a cell with one simulated robot.

    Args:
        robot: The robot's name; all that depends on it.
        program: Robot program that the Lua node opens.
        autostart: The Lua node runs the program by itself as soon as it can.
        rate: References per second, Hz.
        drive: Further parameters of the drives.
        port: First port to try for the browser page.
    """

    def node(package: str, executable: str, **parameters: Any) -> NodeDescription:
        return NodeDescription(package, executable, {'robot_model': robot, **parameters})

    return (
        node('robots_core', 'drive_node', rate=rate, **(drive or {})),
        node('robots_controller', 'controller_node', rate=rate),
        node('robots_planning', 'planning_node'),
        node('robots_controller', 'lua_program_node', program=program, autostart=autostart),
        node('robots_core', 'direct_kinematics_node'),
        node('robots_core', 'visualizer_node', port=port),
    )
