"""What a cell is made of: the command line first, then what the program says, then a default."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from cell_options import nodes_of_cell, parse_options
from robots_controller.live_cell import cell_command, cell_run
from robots_core.errors import RobotsError
from short_programs import PROGRAMS

PRESS = str(PROGRAMS / 'press_tending.lua')
PILLAR = str(PROGRAMS / 'welding_around_pillar.lua')
COMMANDS = ('cell', 'simulate')


@pytest.mark.parametrize(
    ('arguments', 'robot', 'scene', 'io'),
    [
        ([], 'bello_bot', '', ''),
        (['--robot', 'ur5e'], 'ur5e', '', ''),
        (['--program', PRESS], 'kuka_kr210_r2700', '', 'io/press_tending.yaml'),
        (['--program', PILLAR], 'kuka_kr210_r2700', 'scenes/car_frame.yaml', ''),
        (['--program', PILLAR, '--robot', '', '--io', ''], 'kuka_kr210_r2700', 'scenes/car_frame.yaml', ''),
        (
            ['--program', PILLAR, '--robot', 'ur5e', '--scene', PRESS, '--io', PILLAR],
            'ur5e',
            'press_tending.lua',
            'welding_around_pillar.lua',
        ),
    ],
)
def test_cell(arguments: list[str], robot: str, scene: str, io: str) -> None:
    options = parse_options(arguments)
    assert options.robot == robot
    assert options.scene == (str(PROGRAMS / scene) if scene else '')
    assert options.io == (str(PROGRAMS / io) if io else '')


def test_a_program_on_another_robot_is_noted() -> None:
    assert not parse_options(['--program', PRESS]).note
    options = parse_options(['--program', PRESS, '--robot', 'kuka_kr210_r3100'])
    assert options.note == 'press_tending.lua is written for kuka_kr210_r2700'


def test_the_view_has_the_operators_page_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert parse_options(['--view']).pendant
    assert not parse_options([]).pendant
    assert cell_run.without_page(parse_options(['--view'])) == ''
    with pytest.raises(RobotsError, match='--view and --headless exclude each other'):
        parse_options(['--view', '--headless'])
    lockstep = parse_options(['--view', '--lockstep'])
    assert not lockstep.pendant
    assert 'in lock-step nobody operates' in cell_run.without_page(lockstep)
    monkeypatch.setattr(cell_command, 'find_spec', lambda _: None)
    options = parse_options(['--view'])
    assert not options.pendant
    assert 'NiceGUI is not installed; pip install' in cell_run.without_page(options)
    assert cell_run.without_page(parse_options([])) == ''


def test_a_map_takes_the_place_of_the_scripted_plc_whose_inputs_it_sets(tmp_path: Path) -> None:
    plant = 'robots_controller/config/io_map_press.yaml'
    options = parse_options(['--program', PRESS, '--io-map', plant])
    assert (options.io, Path(options.io_map).name) == ('', 'io_map_press.yaml')
    lamp = tmp_path / 'lamp.yaml'
    lamp.write_text('outputs: [{channel: digital_output.9, topic: lamp, type: Bool}]')
    assert parse_options(['--program', PRESS, '--io-map', str(lamp)]).io.endswith('press_tending.yaml')


def test_the_opcua_server_is_refused_where_it_cannot_be(monkeypatch: pytest.MonkeyPatch) -> None:
    assert parse_options([]).opcua == 0
    assert parse_options(['--opcua', '4840']).opcua == 4840
    with pytest.raises(RobotsError, match='--opcua and --lockstep exclude each other'):
        parse_options(['--opcua', '4840', '--lockstep'])
    with pytest.raises(RobotsError, match='--opcua-access needs --opcua'):
        parse_options(['--opcua-access', PRESS])
    monkeypatch.setattr(cell_command, 'find_spec', lambda _: None)
    with pytest.raises(RobotsError, match='needs the package asyncua'):
        parse_options(['--opcua', '4840'])


def test_the_payload_is_a_list_of_numbers() -> None:
    assert parse_options(['--payload', '5,0,0,0.1']).payload == (5.0, 0.0, 0.0, 0.1)
    with pytest.raises(RobotsError, match='--payload: '):
        parse_options(['--payload', '-5,0,0,0.1'])


def test_make_leaves_the_cell_to_the_program_by_default() -> None:
    def shown(*words: str) -> list[str]:
        """The commands of a demo and of a simulation."""
        command = ['make', '-n', 'demo', 'simulate', 'PROGRAM=programs/press_tending.lua', *words]
        output = subprocess.run(
            command, cwd=PROGRAMS.parent, capture_output=True, text=True, check=True
        ).stdout
        found = [
            output.partition(f'robots_controller/{name} ')[2].partition(' --scene ') for name in COMMANDS
        ]
        return [before + scene + after.partition('\n')[0] for before, scene, after in found]

    for command in shown():
        assert all(
            option in command
            for option in ('programs/press_tending.lua', '--robot ""', '--io ""', '--scene ""')
        )
    for command in shown('ROBOT=ur5e', 'IO=plc.yaml', 'SCENE=table.yaml'):
        assert all(
            option in command for option in ('--robot "ur5e"', '--io "plc.yaml"', '--scene "table.yaml"')
        )


def test_the_operators_page_is_served_to_others_with_a_password_alone(tmp_path: Path) -> None:
    password_file = tmp_path / 'password'
    password_file.write_text('long enough')
    password_file.chmod(0o600)
    with pytest.raises(RobotsError, match='--host and --password-file need --view'):
        parse_options(['--host', '0.0.0.0'])  # noqa: S104
    options = parse_options(['--view', '--host', '0.0.0.0', '--password-file', str(password_file)])  # noqa: S104
    graph = nodes_of_cell(robot='ur5e', pendant=True, host=options.host, password_file=options.password_file)
    parameters = next(node.parameters for node in graph if node.executable == 'pendant_node')
    assert (parameters['host'], parameters['password_file']) == ('0.0.0.0', str(password_file))  # noqa: S104
    with pytest.raises(RobotsError, match='this needs a password'):
        nodes_of_cell(robot='ur5e', pendant=True, host=options.host)
