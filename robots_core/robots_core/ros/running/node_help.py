"""The tables of nodes: `--help` prints from them, and the docs are made from them; unknown parameters."""

import re
import shutil
import sys
from collections.abc import Callable, Iterable, Sequence
from importlib.resources import files
from itertools import pairwise
from textwrap import fill
from typing import Any, Final

import yaml
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from robots_core.errors import InvalidInputError
from robots_core.wording.nearest_name import did_you_mean

TABLE: Final = 'nodes.yaml'
"""In the folder of a package's nodes; written by `python -m robots_controller.live_cell.describe_nodes`."""
SMALLEST_WIDTH: Final = 40  # characters
# What every node of rclpy has.
_OF_ALL: Final = ('start_type_description_service', '/parameter_events', '/rosout')
_OF_RCLPY: Final = {'use_sim_time': 'time comes from /clock'}
_SERVICES_OF_ALL: Final = re.compile(r'/(describe|get|list|set)_parameter|/get_type_description$')
_CHANNEL: Final = re.compile(r'_\d+(?=/|$)')


def described(node: Node) -> dict[str, Any]:
    """Parameters, topics and services of a node with default parameters, as they stand in the table."""
    own = f'{node.get_fully_qualified_name()}/'
    parameters = [
        {
            'name': name,
            'default': _plain(node.get_parameter(name)),
            'description': _description(node.describe_parameter(name)) or _OF_RCLPY.get(name, ''),
        }
        for name in sorted(node._parameters)  # noqa: SLF001  # rclpy lists them to other nodes only
        if name not in _OF_ALL
    ]
    return {
        'parameters': parameters,
        'publishes': _ends((one.topic_name, one.msg_type) for one in node.publishers),
        'subscribes': _ends((one.topic_name, one.msg_type) for one in node.subscriptions),
        'services': _ends(
            (one.service_name.replace(own, '~/'), one.srv_type)
            for one in node.services
            if not _SERVICES_OF_ALL.search(one.service_name)
        ),
    }


def _description(descriptor: ParameterDescriptor) -> str:
    ranges = (*descriptor.floating_point_range, *descriptor.integer_range)
    bounds = ''.join(f' [{one.from_value:g}, {one.to_value:g}]' for one in ranges)
    return f'{descriptor.description}{bounds}'


def _plain(parameter: Parameter) -> Any:
    value = parameter.value
    return list(value) if parameter.type_.name.endswith('_ARRAY') else value


def _ends(ends: Iterable[tuple[str, Any]]) -> dict[str, str]:
    """Types by name; channels of inputs and outputs are one entry."""
    found = {}
    for name, kind in ends:
        if name not in _OF_ALL:
            package, *_ = kind.__module__.split('.')
            shown = name if name.startswith('/diagnostics') else name.removeprefix('/')
            found[_CHANNEL.sub('_N', shown)] = f'{package}/{kind.__name__}'
    return dict(sorted(found.items()))


def node_table(package: str) -> dict[str, Any]:
    """The table of a package of nodes, as `robots_core.nodes`."""
    table: dict[str, Any] = yaml.safe_load((files(package) / TABLE).read_text('utf-8'))
    return table


def help_text(make_node: Callable[..., Any], width: int | None = None) -> str:
    """What `--help` prints.

    Args:
        make_node: The node's class.
        width: Characters of a line; by default those of the terminal.
    """
    package, _, executable = make_node.__module__.rpartition('.')
    width = max(width or shutil.get_terminal_size().columns, SMALLEST_WIDTH)
    entry = node_table(package)[executable]
    lines = [
        f'usage: {executable} [--help] [--ros-args -p parameter:=value ...]',
        '',
        fill(entry['what'], width),
        '',
        'parameters:',
    ]
    for row in entry['parameters']:
        text = f'{row["description"]}; default {default_text(row["default"])}'
        lines += [f'  {row["name"]}', fill(text, width, initial_indent=6 * ' ', subsequent_indent=6 * ' ')]
    for kind in ('publishes', 'subscribes', 'services'):
        if entry[kind]:
            lines += ['', f'{kind}:', *(_topic(name, type_, width) for name, type_ in entry[kind].items())]
    return '\n'.join(lines)


def _topic(name: str, type_: str, width: int) -> str:
    line = f'  {name}  [{type_}]'
    return line if len(line) <= width else f'  {name}\n      [{type_}]'


def default_text(value: object) -> str:
    """A default, as it is written on a command line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f'[{", ".join(default_text(one) for one in value)}]'
    return f'{value:g}' if isinstance(value, float) else str(value) or "''"


def help_requested(arguments: Sequence[str] | None = None) -> bool:
    """Whether a command line requests help, before the arguments of ROS."""
    given = list(sys.argv[1:] if arguments is None else arguments)
    own = given[: given.index('--ros-args')] if '--ros-args' in given else given
    return '--help' in own or '-h' in own


def check_parameter_names(nodes: Sequence[Node], arguments: Sequence[str] | None = None) -> None:
    """Refuse parameters of the command line that no node of this process has.

    Those of parameter files are not checked: a file may be meant for many nodes.

    Raises:
        InvalidInputError: there is one; names the nearest.
    """
    given = list(sys.argv if arguments is None else arguments)
    known = sorted({name for node in nodes for name in node._parameters})  # noqa: SLF001  # as above
    for before, text in pairwise(given):
        if before in ('-p', '--param') and ':=' in text:
            name = text.partition(':=')[0].rpartition(':')[2]
            if name not in known and not name.startswith('qos_overrides.'):
                raise InvalidInputError(
                    f'there is no parameter {name!r}{did_you_mean(name, known)} (--help lists all)'
                )
