"""What nodes print with --help is what they have; parameters that they do not have are refused."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest
import rclpy

from robots_controller.live_cell.describe_nodes import described_nodes, page_text, table_text
from robots_controller.live_cell.node_types import node_scripts, node_type
from robots_core.exit_codes import ExitCode
from robots_core.nodes.direct_kinematics_node import DirectKinematicsNode
from robots_core.ros.running.node_help import TABLE, help_text
from robots_core.ros.running.run import run

PAGE = Path(__file__).parents[2] / 'docs' / 'reference' / 'node_parameters.md'


def test_the_tables_and_the_page_are_what_the_nodes_have(ros_domain: int):
    rclpy.init(args=[], domain_id=ros_domain)  # a log level would stay for the tests after it
    try:
        packages = described_nodes()
    finally:
        rclpy.shutdown()
    for package, nodes in packages.items():
        assert (files(package) / TABLE).read_text('utf-8') == table_text(nodes), package
    assert PAGE.read_text('utf-8') == page_text(packages)


@pytest.mark.parametrize('executable', [script.name for script in node_scripts()])
def test_help_names_everything_in_80_columns(executable: str):
    text = help_text(node_type(executable), 80)
    assert text.startswith(f'usage: {executable} ')
    assert '\n  robot_model\n' in text
    assert all(len(line) <= 80 for line in text.split('\n'))


def test_help_starts_no_node(capsys: pytest.CaptureFixture[str]):
    assert run(DirectKinematicsNode, ['--help']) == 0
    assert 'direct_kinematics_node' in capsys.readouterr().out


@pytest.mark.usefixtures('ros_domain')
@pytest.mark.parametrize('option', ['-p', '--param'])
def test_unknown_parameter_is_refused_with_the_nearest(capsys: pytest.CaptureFixture[str], option: str):
    arguments = ['node', '--ros-args', option, 'robot_modell:=ur5e']
    assert run(DirectKinematicsNode, arguments) == ExitCode.BAD_INPUT
    error = capsys.readouterr().err
    assert "there is no parameter 'robot_modell'; did you mean 'robot_model'? (--help lists all)" in error
