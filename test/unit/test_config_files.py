"""Configurations that are shipped: they name nodes and parameters that exist, and cover all of them."""

from __future__ import annotations

import re
from importlib.resources import files
from pathlib import Path
from typing import Any

import pytest
import yaml

from robots_controller.live_cell import describe_nodes
from robots_controller.live_cell.node_types import node_scripts
from robots_core.ros.running.node_help import TABLE

CONFIG = Path(__file__).parents[2] / 'robots_controller' / 'config'
OTHERS = ('bag_recorder', 'bag_player')  # nodes without an executable of their own


def analyzers() -> dict[str, list[str]]:
    parameters = yaml.safe_load((CONFIG / 'diagnostic_aggregator.yaml').read_text())['/**']['ros__parameters']
    return {name: one['contains'] for name, one in parameters.items() if isinstance(one, dict)}


@pytest.mark.parametrize('namespace', ['', '/left'])
def test_the_diagnostics_of_each_node_are_in_one_group(namespace: str) -> None:
    names = [*(script.name for script in node_scripts()), *OTHERS]
    for name in names:
        found = [
            group
            for group, parts in analyzers().items()
            if any(part in f'{namespace}/{name}' for part in parts)
        ]
        assert len(found) == 1, f'{name} is in {found}'
    assert sorted(part for parts in analyzers().values() for part in parts) == sorted(
        f'/{one}' for one in names
    )


def test_the_groups_are_those_of_the_nodes() -> None:
    assert (CONFIG / describe_nodes.AGGREGATOR.name).read_text() == describe_nodes.aggregator_text()


def parameters_of_nodes() -> dict[str, set[str]]:
    packages = {script.module.partition('.')[0] for script in node_scripts()}
    tables: dict[str, Any] = {}
    for package in packages:
        tables |= yaml.safe_load((files(f'{package}.nodes') / TABLE).read_text())
    return {name: {row['name'] for row in table['parameters']} for name, table in tables.items()}


def test_the_parameter_file_of_a_cell_names_parameters_that_exist() -> None:
    content = yaml.safe_load((CONFIG / 'cell_parameters.yaml').read_text())
    known = parameters_of_nodes()
    common = set(content.pop('/**')['ros__parameters'])
    for key, section in content.items():
        name = re.fullmatch(r'/\*\*/(\w+)', key)
        assert name is not None, key
        given = set(section['ros__parameters']) | common
        assert given <= known[name[1]], f'{name[1]}: {given - known[name[1]]}'
