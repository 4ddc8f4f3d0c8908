"""What stops, watches, slows down or fences in says that it is no certified safety function."""

import argparse
from importlib.resources import files
from pathlib import Path

import pytest
import yaml

from robots_controller.commands.cell_arguments import cell_arguments
from robots_core.wording.safety_note import NOT_CERTIFIED

PARAMETERS = {'emergency_stop_inputs', 'operating_mode', 'tool_speed_limit', 'watchdog', 'zone_inputs'}
PACKAGES = ('robots_core', 'robots_planning', 'robots_controller')
LAUNCH = Path('robots_controller/launch/cell.launch.py')


@pytest.mark.parametrize('option', ['watchdog', 'operating_mode', 'tool_speed_limit'])
def test_options_of_a_cell_say_so(option: str) -> None:
    parser = argparse.ArgumentParser()
    cell_arguments(parser)
    (text,) = (str(action.help) for action in parser._actions if action.dest == option)
    assert NOT_CERTIFIED in text
    described = next(line for line in LAUNCH.read_text().splitlines() if f"'{option}': (" in line)
    assert NOT_CERTIFIED in described


def test_parameters_of_nodes_say_so() -> None:
    tables = [
        yaml.safe_load((files(package) / 'nodes' / 'nodes.yaml').read_text('utf-8')) for package in PACKAGES
    ]
    found = {
        (parameter['name'], parameter['description'])
        for table in tables
        for node in table.values()
        for parameter in node['parameters']
        if parameter['name'] in PARAMETERS
    }
    assert {name for name, _ in found} == PARAMETERS
    assert all(NOT_CERTIFIED in text for _, text in found)
