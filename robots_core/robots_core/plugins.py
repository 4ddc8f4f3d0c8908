"""Plugins of third parties, found through entry points."""

import sys
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Final

from robots_core.errors import RobotsError

ROBOT_MODELS: Final = 'robots_core.robot_models'
"""The group of robots."""


def installed_plugins(group: str) -> dict[str, list[EntryPoint]]:
    """All entry points of a group by name; several where distributions offer the same name."""
    return _installed(group, tuple(sys.path))


@cache
def _installed(group: str, path: tuple[str, ...]) -> dict[str, list[EntryPoint]]:  # noqa: ARG001  # where they are
    plugins: dict[str, list[EntryPoint]] = {}
    for point in entry_points(group=group):
        plugins.setdefault(point.name, []).append(point)
    return plugins


def load_plugin(points: list[EntryPoint], kind: str, error: type[RobotsError]) -> Any:
    """What the entry points of one name lead to.

    Args:
        points: Of that name.
        kind: What the plugins are, for messages.
        error: What is raised.

    Raises:
        RobotsError: several distributions offer the name, or the plugin cannot be imported.
    """
    point, *others = points
    if others:
        raise error(
            f'{kind} {point.name!r} is offered by several distributions, keep one: '
            + '; '.join(_origin(one) for one in points)
        )
    try:
        return point.load()
    except Exception as caught:  # whatever a third party's module raises
        raise error(f'{plugin_text(point)} cannot be loaded: {type(caught).__name__}: {caught}') from caught


def plugin_text(point: EntryPoint) -> str:
    """A plugin with its distribution, for messages."""
    return f'plugin {point.name!r} ({_origin(point)})'


def _origin(point: EntryPoint) -> str:
    distribution = 'unknown' if point.dist is None else f'{point.dist.name} {point.dist.version}'
    return f'{point.value}, distribution {distribution}'
