"""The launch file: the nodes that `cell` describes, without anything that the system's Python has not."""

from __future__ import annotations

import ast
import io
import runpy
import subprocess
import sys
from contextlib import redirect_stdout
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from rich.console import Console

from cell_options import nodes_of_cell, parse_options
from robots_controller.live_cell.cell_command import run_cell
from robots_controller.live_cell.cell_graph import NodeDescription

ROOT = Path(__file__).parents[2]
LAUNCH_FILE = ROOT / 'robots_controller' / 'launch' / 'cell.launch.py'
PROGRAM = str(ROOT / 'programs' / 'bello_bot_tour.lua')
PRESS = str(ROOT / 'programs' / 'io' / 'press_tending.yaml')
CELL = NodeDescription('robots_controller', 'cell').executable_path()
# What a ROS 2 installation has for its own Python, besides the standard library.
ROS_MODULES = {'launch', 'launch_ros', 'ament_index_python'}


def test_it_imports_what_ros_has_and_nothing_of_ours() -> None:
    imported: set[str] = set()
    for node in ast.walk(ast.parse(LAUNCH_FILE.read_text())):
        if isinstance(node, ast.Import):
            imported |= {name.name.partition('.')[0] for name in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported.add((node.module or '').partition('.')[0])
    assert imported - set(sys.stdlib_module_names) == ROS_MODULES


class Configuration:
    """In the place of launch's: arguments as they were given."""

    given: dict[str, str]

    def __init__(self, name: str) -> None:
        self.name = name

    def perform(self, _context: object) -> str:
        return self.given.get(self.name, '')


@pytest.fixture
def launch_file(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The launch file, with what it takes from `launch` recorded: that is in no wheel."""

    def record(**options: Any) -> SimpleNamespace:
        return SimpleNamespace(**options)

    def anything(*_arguments: Any, **_options: Any) -> None:
        """Nothing of interest here."""

    modules = {
        'launch': {'LaunchContext': object, 'LaunchDescription': list},
        'launch.actions': {
            'DeclareLaunchArgument': lambda name, **options: record(name=name, **options),
            'ExecuteProcess': record,
            'OpaqueFunction': anything,
            'SetEnvironmentVariable': anything,
        },
        'launch.substitutions': {'EnvironmentVariable': anything, 'LaunchConfiguration': Configuration},
        'launch_ros': {},
        'launch_ros.actions': {'Node': record},
    }
    for name, contents in modules.items():
        module = ModuleType(name)
        vars(module).update(contents)
        monkeypatch.setitem(sys.modules, name, module)
    return runpy.run_path(str(LAUNCH_FILE))


@pytest.fixture
def described_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """`cell --describe` runs in this process: one of its own takes almost a second to load."""

    def run(command: list[str], **_options: bool) -> subprocess.CompletedProcess[str]:
        path, *arguments = command
        assert Path(path) == CELL
        output = io.StringIO()
        with redirect_stdout(output):
            code = run_cell(parse_options(arguments), Console())
        return subprocess.CompletedProcess(command, code, output.getvalue(), '')

    monkeypatch.setattr(subprocess, 'run', run)


def launched(launch_file: dict[str, Any], **arguments: str) -> list[SimpleNamespace]:
    Configuration.given = {'namespace': '/left', 'drive': 'second_order', 'debug_port': '0'} | arguments
    nodes: list[SimpleNamespace] = launch_file['nodes'](None)
    return nodes


def without_launch(node: NodeDescription) -> dict[str, Any]:
    parameters = dict(node.parameters)
    parameters.pop('launch', None)  # another one each time
    return parameters


@pytest.mark.parametrize('arguments', [{'robot': 'cello_bot'}, {'program': PROGRAM, 'io': PRESS}])
def test_its_nodes_are_those_of_the_cell(launch_file: dict[str, Any], arguments: dict[str, str]) -> None:
    robot = {'robot': 'bello_bot'}  # which the program names at its top
    expected = nodes_of_cell(**robot | arguments, describe=True)
    nodes = launched(launch_file, **arguments)
    launches = {node.parameters[0].pop('launch', None) for node in nodes} - {None}
    assert len(launches) == 1
    assert all(launches)
    assert [(node.package, node.executable, node.parameters) for node in nodes] == [
        (node.package, node.executable, [without_launch(node)]) for node in expected
    ]
    assert {node.namespace for node in nodes} == {'/left'}


@pytest.mark.usefixtures('described_here')
def test_nodes_may_share_a_process(launch_file: dict[str, Any]) -> None:
    processes = launched(launch_file, robot='cello_bot', composed='true')
    assert {process.executable for process in processes} == {
        'drive_node',
        'controller_node',
        'composed_nodes',
    }
    (shared,) = (process for process in processes if process.executable == 'composed_nodes')
    nodes = {node.executable: node for node in nodes_of_cell(robot='cello_bot', composed=True)}
    assert shared.package == 'robots_controller'
    assert set(shared.arguments) == nodes.keys() - {'drive_node', 'controller_node'}
    assert not hasattr(shared, 'name')  # it would be that of each node
    for name in shared.arguments:
        assert without_launch(nodes[name]).items() <= shared.parameters[0].items()


def test_every_argument_can_be_given(launch_file: dict[str, Any]) -> None:
    described = {part.name for part in launch_file['generate_launch_description']() if part is not None}
    assert described == {*launch_file['ARGUMENTS'], *launch_file['LAUNCH_ARGUMENTS']}


@pytest.mark.usefixtures('described_here')
def test_options_of_the_cell_reach_its_nodes(launch_file: dict[str, Any]) -> None:
    nodes = launched(launch_file, robot='cello_bot', rate='500', port='9000', goal_tolerance='0.01')
    parameters = {node.executable: node.parameters[0] for node in nodes}
    assert parameters['controller_node']['rate'] == 500.0
    assert parameters['controller_node']['goal_tolerance'] == 0.01
    assert parameters['visualizer_node']['port'] == 9000


@pytest.mark.usefixtures('described_here')
def test_a_cell_may_have_no_view(launch_file: dict[str, Any]) -> None:
    nodes = launched(launch_file, robot='cello_bot', headless='true')
    assert {node.executable for node in nodes} == {
        node.executable for node in nodes_of_cell(robot='cello_bot') if node.executable != 'visualizer_node'
    }


@pytest.mark.usefixtures('described_here')
def test_a_bag_and_rviz_are_started_beside_the_nodes(launch_file: dict[str, Any]) -> None:
    *_, bag, rviz = launched(launch_file, robot='cello_bot', record='out/bag', rviz='true')
    assert bag.cmd == ['ros2', 'bag', 'record', '--all', '--output', 'out/bag']
    assert (rviz.package, rviz.namespace) == ('rviz2', '/left')
    assert Path(rviz.arguments[1]).is_file()


@pytest.mark.usefixtures('described_here')
def test_an_argument_that_does_not_exist_is_refused(
    launch_file: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        sys, 'argv', ['ros2', 'launch', 'robots_controller', 'cell.launch.py', 'progam:=x.lua']
    )
    with pytest.raises(RuntimeError, match=r"there is no launch argument 'progam'; did you mean 'program'\?"):
        launched(launch_file, robot='cello_bot')
    monkeypatch.setattr(sys, 'argv', ['launch', 'plant', 'plant.launch.py', 'progam:=x.lua'])
    assert launched(launch_file, robot='cello_bot')


def test_a_mistake_is_reported_in_one_line(launch_file: dict[str, Any]) -> None:
    with pytest.raises(RuntimeError, match=r"^error: unknown robot 'nobody'; robots are: bello_bot, .*$"):
        launched(launch_file, robot='nobody')


def test_the_description_is_all_that_is_printed() -> None:
    started = subprocess.run([CELL, '--describe'], capture_output=True, text=True, check=True)
    assert started.stdout.startswith('[')
    assert not started.stderr
