"""Writes the tables of nodes: `python -m robots_controller.live_cell.describe_nodes`, in the repository.

For each package the table that `--help` prints from, and the page of the docs; the groups of the nodes'
diagnostics; the editor's help for robot programs, as `lua_meta` prints it; and rows of the docs that follow
from code: motion commands, functions of programs, nodes and their phases. To be run again for another node,
when a node gets another parameter, topic or service, and for another kind of motion, function of programs or
level of drives.
"""

import re
from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import EntryPoint
from pathlib import Path
from typing import Any, Final

import rclpy
import yaml

from robots_controller.editor.lua_meta import meta_file
from robots_controller.interpreter.lua_functions import LUA_FUNCTIONS
from robots_controller.live_cell.node_types import node_scripts, node_type
from robots_core.cell_interface.topic_qos import topic_qos
from robots_core.process_end import end_quickly
from robots_core.ros.lockstep.phases import Phase
from robots_core.ros.running.node_help import TABLE, default_text, described
from robots_planning.motion_kinds import MOTION_KINDS

DOCS: Final = Path('docs')
_COMMANDS: Final = re.compile(r'(?:^\|.*\| command: .*\|\n)+', re.MULTILINE)
_FUNCTIONS: Final = re.compile(
    r'(?<=\| function \| what it does \| returns \|\n\|---\|---\|---\|\n)(?:\|.*\n)+'
)
_NODES: Final = re.compile(
    r'(?<=\| executable \| package \| what it does \|\n\|---\|---\|---\|\n)(?:\|.*\n)+'
)
_PHASES: Final = re.compile(r'(?<=\| phase \| what \| nodes \|\n\|---\|---\|---\|\n)(?:\|.*\n)+')
PAGE: Final = Path('docs/reference/node_parameters.md')
AGGREGATOR: Final = Path('robots_controller/config/diagnostic_aggregator.yaml')
LIBRARY: Final = Path('programs/library/robot_functions.lua')
GROUPS: Final = ('program', 'motion', 'robot', 'surroundings', 'plant', 'recording')
"""Of diagnostics, in their order."""
RECORDING: Final = ('bag_recorder', 'bag_player')
"""Nodes without an executable of their own."""
HEAD: Final = """# Parameters, topics and services of the nodes

Every node prints its part of this page with `--help`. Parameters are given on its command line, as in
`planning_node --ros-args -p robot_model:=ur5e -p blend_zone:=0.05`, or in a parameter file of ROS. Names
without a slash are relative to the node's namespace; `~` is the node's own name, N the number of a channel.
"""
NOTE: Final = (
    '# Made by `python -m robots_controller.live_cell.describe_nodes`; what was here before is replaced.\n'
)
AGGREGATOR_HEAD: Final = (
    '# Groups the diagnostics of a cell, in any namespace:\n'
    '# ros2 run diagnostic_aggregator aggregator_node --ros-args --params-file diagnostic_aggregator.yaml\n'
)


def topics_page(page: str) -> str:
    """The page of topics with a row for each motion command."""
    rows = (
        f'| `{kind.topic}` | {kind.message_type.replace("/msg", "")} | {topic_qos(kind.topic).text} | anyone '
        f'| command: {kind.what} |\n'
        for kind in MOTION_KINDS
    )
    return _COMMANDS.sub(lambda _: ''.join(rows), page)


def programs_page(page: str) -> str:
    """The page of robot programs with a row for each function."""
    rows = (f'| `{one.signature}` | {one.doc} | {one.result or "-"} |\n' for one in LUA_FUNCTIONS.values())
    return _FUNCTIONS.sub(lambda _: ''.join(rows), page)


def nodes_page(page: str) -> str:
    """The page of nodes with a row for each node; those that are there stay as they are."""
    return _NODES.sub(lambda found: found.group() + ''.join(_missing_nodes(found.group())), page)


def _missing_nodes(rows: str) -> Iterator[str]:
    for script in node_scripts():
        if f'| `{script.name}` |' not in rows:
            yield f'| `{script.name}` | {script.module.partition(".")[0]} | {what_of(script).rstrip(".")} |\n'


def lockstep_page(page: str) -> str:
    """The page of lock-step with the nodes whose loops and timers have their turn in a phase."""
    rows = dict(re.findall(r'^\| `([A-Z]+)` \| (.*?) \| ', page, re.MULTILINE))
    nodes: dict[str, list[str]] = {phase.name: [] for phase in Phase}
    for script in sorted(node_scripts()):
        phase = node_type(script.name).phase
        if phase is not Phase.OBSERVE:
            nodes[phase.name].append(f'`{script.name}`')
    nodes[Phase.OBSERVE.name] = ['all others']
    text = ''.join(f'| `{name}` | {rows[name]} | {", ".join(nodes[name]) or "-"} |\n' for name in nodes)
    return _PHASES.sub(lambda _: text, page)


PAGES: Final = {
    'reference/topics.md': topics_page,
    'reference/robot_programs.md': programs_page,
    'reference/nodes.md': nodes_page,
    'how_to/lockstep.md': lockstep_page,
}
"""By their names in `DOCS`."""


def write_pages(docs: Path = DOCS) -> None:
    """Renew the rows."""
    for name, renewed in PAGES.items():
        page = docs / name
        page.write_text(renewed(page.read_text('utf-8')), 'utf-8')


def aggregator_text() -> str:
    """The parameters of the node that groups the diagnostics of a cell."""
    members: dict[str, list[str]] = {group: [] for group in GROUPS} | {
        GROUPS[-1]: [f'/{name}' for name in RECORDING]
    }
    for script in sorted(node_scripts()):
        members[node_type(script.name).diagnostics_group].append(f'/{script.name}')
    groups = {
        name: {'type': 'diagnostic_aggregator/GenericAnalyzer', 'path': name.capitalize(), 'contains': nodes}
        for name, nodes in members.items()
    }
    parameters = {'/**': {'ros__parameters': {'path': 'Cell', **groups}}}
    return NOTE + AGGREGATOR_HEAD + yaml.safe_dump(parameters, sort_keys=False)


def what_of(script: EntryPoint) -> str:
    """What a node does, by the first line of its module."""
    return str(import_module(script.module).__doc__).partition('\n')[0].partition(': ')[2]


def described_nodes() -> dict[str, dict[str, Any]]:
    """All nodes by package and executable; ROS is initialised, and nodes have their default parameters."""
    found: dict[str, dict[str, Any]] = {}
    for script in node_scripts():
        node = node_type(script.name)()
        try:
            package = script.module.rpartition('.')[0]
            found.setdefault(package, {})[script.name] = {'what': what_of(script), **described(node)}
        finally:
            node.destroy_node()
    return found


def table_text(nodes: dict[str, Any]) -> str:
    """The file of a package's nodes."""
    return NOTE + yaml.safe_dump(nodes, sort_keys=False, width=110, allow_unicode=True)


def page_text(packages: dict[str, dict[str, Any]]) -> str:
    """The page of the docs."""
    lines = [HEAD]
    nodes = {name: entry for package in packages.values() for name, entry in package.items()}
    for name, entry in sorted(nodes.items()):
        lines += [f'## `{name}`', '', f'{entry["what"][:1].upper()}{entry["what"][1:]}', '']
        lines += ['| parameter | default | meaning |', '|---|---|---|']
        for row in entry['parameters']:
            meaning = row['description'].replace('|', r'\|')
            lines.append(f'| `{row["name"]}` | `{default_text(row["default"])}` | {meaning} |')
        lines.append('')
        for kind in ('publishes', 'subscribes', 'services'):
            if entry[kind]:
                ends = ', '.join(f'`{end}` ({type_})' for end, type_ in entry[kind].items())
                lines += [f'{kind.capitalize()}: {ends}', '']
    return '\n'.join(lines)


def main() -> None:
    """Write all."""
    end_quickly()
    rclpy.init(args=['describe_nodes', '--ros-args', '--log-level', 'error'])
    packages = described_nodes()
    rclpy.shutdown()
    for package, nodes in packages.items():
        folders = package.split('.')
        Path(folders[0], *folders, TABLE).write_text(table_text(nodes), 'utf-8')
    PAGE.write_text(page_text(packages), 'utf-8')
    AGGREGATOR.write_text(aggregator_text(), 'utf-8')
    LIBRARY.write_text(meta_file(), 'utf-8')
    write_pages()


if __name__ == '__main__':
    main()
