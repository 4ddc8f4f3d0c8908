"""The paper's robotChoice: robots by name, found through entry points."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Final

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.urdf_robot_model import UrdfRobotModel

ENTRY_POINT_GROUP: Final = 'robots_core.robot_models'
URDF_PREFIX: Final = 'urdf:'


def available_robot_models() -> tuple[str, ...]:
    """Names of all installed robots, sorted."""
    return tuple(sorted(_plugins()))


def load_robot_model(name: str) -> BaseRobotModel:
    """Load a robot.

    Args:
        name: An installed robot's name, or `urdf:/path/to/robot.urdf`.

    Raises:
        UnknownRobotError: no such robot, a broken plugin, or a URDF that is not a serial robot.
    """
    if name.startswith(URDF_PREFIX):
        return UrdfRobotModel(Path(name.removeprefix(URDF_PREFIX)))
    plugins = _plugins()
    if name not in plugins:
        known = ', '.join(sorted(plugins)) or 'none installed'
        raise UnknownRobotError(f'unknown robot {name!r}; robots are: {known}; or urdf:/path/to/robot.urdf')
    try:
        robot = plugins[name].load()()
    except (ImportError, AttributeError) as error:
        raise UnknownRobotError(
            f'plugin {name!r} ({plugins[name].value}) cannot be loaded: {error}'
        ) from error
    if not isinstance(robot, BaseRobotModel):
        raise UnknownRobotError(
            f'plugin {name!r} ({plugins[name].value}) returns {type(robot).__name__}, not a BaseRobotModel'
        )
    return robot


def _plugins() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=ENTRY_POINT_GROUP)}
