"""The nodes of the suite, by the names of their executables."""

from collections.abc import Iterator
from importlib.metadata import EntryPoint, distribution
from typing import Any, Final

from robots_core.errors import InvalidInputError

PACKAGES: Final = ('robots_core', 'robots_planning', 'robots_controller')


def node_scripts() -> Iterator[EntryPoint]:
    """The executables of all nodes."""
    for package in PACKAGES:
        for script in distribution(package).entry_points.select(group='console_scripts'):
            if script.name.endswith('_node'):
                yield script


def node_type(executable: str) -> Any:
    """The class of a node, a `RobotNode`.

    Raises:
        InvalidInputError: there is none.
    """
    scripts = {script.name: script for script in node_scripts()}
    if executable not in scripts:
        raise InvalidInputError(f'unknown node {executable!r}; nodes are: {", ".join(sorted(scripts))}')
    return scripts[executable].load().args[0]  # of functools.partial(run, node type)
