"""Which nodes a cell has, and with which parameters."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cell_options import nodes_of_cell
from robots_core.errors import OptionError, RobotsError

ROOT = Path(__file__).parents[2]
PRESS = str(ROOT / 'programs' / 'io' / 'press_tending.yaml')
TAGS = str(ROOT / 'robots_controller' / 'config' / 'io_map_tags.yaml')


def test_a_plc_and_a_bridge_are_there_when_their_files_are_given(tmp_path: Path):
    names = {node.executable for node in nodes_of_cell(robot='bello_bot')}
    assert not names & {'plc_node', 'io_bridge_node'}
    with_plc = {node.executable: node for node in nodes_of_cell(robot='bello_bot', io=PRESS)}
    assert set(with_plc) == names | {'plc_node'}
    assert with_plc['plc_node'].parameters['script'] == PRESS
    with_bridge = {node.executable: node for node in nodes_of_cell(robot='bello_bot', io_map=TAGS)}
    assert set(with_bridge) == names | {'io_bridge_node'}
    assert with_bridge['io_bridge_node'].parameters['io_map'] == TAGS
    outputs = tmp_path / 'outputs.yaml'
    outputs.write_text('outputs:\n  - {channel: digital_output.1, topic: a, type: Bool}\n')
    assert {node.executable for node in nodes_of_cell(robot='bello_bot', io=PRESS, io_map=str(outputs))} == (
        names | {'plc_node', 'io_bridge_node'}
    )


def test_the_names_of_the_files_are_those_of_the_robot_program():
    (lua,) = (
        node for node in nodes_of_cell(robot='bello_bot', io=PRESS) if node.executable == 'lua_program_node'
    )
    assert lua.parameters['digital_input_names'] == [
        *('press_ready', 'press_closed', 'part_present', 'part_pressed')
    ]
    assert lua.parameters['digital_output_names'] == ['start_press', 'gripper', 'part_placed']
    assert lua.parameters['analog_input_names'] == ['press_force']
    assert 'analog_output_names' not in lua.parameters


def test_the_program_gets_the_file_of_tools_and_bases():
    (lua,) = (
        node
        for node in nodes_of_cell(robot='bello_bot', frames='f.yaml')
        if node.executable == 'lua_program_node'
    )
    assert lua.parameters['frames_file'] == 'f.yaml'


def test_two_that_set_the_same_inputs_are_refused():
    with pytest.raises(RobotsError, match='both set analog_inputs, digital_inputs; only one can publish'):
        nodes_of_cell(robot='bello_bot', io=PRESS, io_map=TAGS)


def test_a_name_means_one_channel(tmp_path: Path):
    path = tmp_path / 'map.yaml'
    path.write_text(
        'signals: {gripper: digital_output.7}\noutputs:\n  - {channel: gripper, topic: a, type: Bool}\n'
    )
    conflict = r'signals: gripper is digital_output\.2 in .* and digital_output\.7 in'
    with pytest.raises(RobotsError, match=conflict):
        nodes_of_cell(robot='bello_bot', io=PRESS, io_map=str(path))


def test_a_mistake_in_a_file_is_reported_with_its_line(tmp_path: Path):
    path = tmp_path / 'plc.yaml'
    path.write_text('rules:\n  - {when: start}\n')
    with pytest.raises(RobotsError, match=r'plc\.yaml:2: set is missing'):
        nodes_of_cell(robot='bello_bot', io=str(path))


def test_the_drives_have_the_level_asked_for():
    (drives,) = (
        node
        for node in nodes_of_cell(robot='bello_bot', drive='rigid_body')
        if node.executable == 'drive_node'
    )
    assert drives.parameters['level'] == 'rigid_body'


def test_the_goal_tolerance_is_the_controllers_own_unless_given():
    for given in ({}, {'goal_tolerance': 0.002}):
        nodes = nodes_of_cell(robot='bello_bot', **given)
        (controller,) = (node for node in nodes if node.executable == 'controller_node')
        assert {'goal_tolerance': controller.parameters.get('goal_tolerance', None)} == (
            given or {'goal_tolerance': None}
        )


def test_planner_and_drives_have_the_payload_of_the_cell():
    nodes = {node.executable: node for node in nodes_of_cell(robot='bello_bot', payload=(2.0, 0.0, 0.0, 0.1))}
    for name in ('drive_node', 'planning_node'):
        assert nodes[name].parameters['payload'] == [2.0, 0.0, 0.0, 0.1]


def test_nodes_that_others_depend_on_are_watched_for_as_long_as_it_is_given():
    nodes = {node.executable: node for node in nodes_of_cell(robot='bello_bot', watchdog=3.0)}
    for name in ('controller_node', 'planning_node', 'lua_program_node'):
        assert nodes[name].parameters['watchdog'] == 3.0
    assert nodes['controller_node'].parameters['feedback_timeout'] == 3.0
    with pytest.raises(RobotsError, match=r'watchdog = 0\.01 s must be in'):
        nodes_of_cell(robot='bello_bot', watchdog=0.01)


def test_parameters_of_nodes_that_share_a_process_differ_in_name_or_are_equal(tmp_path: Path):
    (tmp_path / 'plc.yaml').write_text('signals: {part: digital_input.1}\ninitial: {part: 1}\n')
    (tmp_path / 'map.yaml').write_text('outputs:\n  - {channel: digital_output.1, topic: out, type: Bool}\n')
    files = {'io': str(tmp_path / 'plc.yaml'), 'io_map': str(tmp_path / 'map.yaml')}
    nodes = nodes_of_cell(
        robot='bello_bot', composed=True, guided='constrained', payload=(2.0, 0.0, 0.0, 0.1), **files
    )
    values: dict[str, Any] = {}
    for node in nodes:
        if node.process != node.executable:
            for name, value in node.parameters.items():
                assert values.setdefault(name, value) == value, name
    assert len(values) > 10


def test_nodes_that_do_not_keep_time_share_a_process_when_they_are_composed():
    separate = nodes_of_cell(robot='bello_bot')
    assert [node.process for node in separate] == [node.executable for node in separate]
    composed = {node.executable: node.process for node in nodes_of_cell(robot='bello_bot', composed=True)}
    assert {name for name, process in composed.items() if process == name} == {
        'drive_node',
        'controller_node',
    }
    assert len(set(composed.values())) == 3
    assert len({node.process for node in nodes_of_cell(robot='bello_bot', composed=True, lockstep=True)}) == 1


def test_the_operators_page_has_a_process_and_a_port_of_its_own():
    nodes = nodes_of_cell(
        robot='ur5e', pendant=True, composed=True, port=8080, program='/cell/programs/pick.lua'
    )
    (pendant,) = (node for node in nodes if node.executable == 'pendant_node')
    assert pendant.process == 'pendant_node'
    shared = {
        'robot_model': 'ur5e',
        'scene': '',
        'host': '127.0.0.1',
        'password_file': '',
        'recordings': 'out',
    }
    assert pendant.parameters == {**shared, 'port': 8090, 'programs': '/cell/programs'}
    (pendant,) = (
        node for node in nodes_of_cell(robot='ur5e', pendant=True, port=0) if 'pendant' in node.executable
    )
    assert pendant.parameters == {**shared, 'port': 0}


def test_the_opcua_server_has_a_process_of_its_own_and_settings_that_are_valid(tmp_path: Path):
    assert 'opcua_node' not in [node.executable for node in nodes_of_cell(robot='ur5e')]
    nodes = nodes_of_cell(robot='ur5e', opcua=4840, composed=True, program='/cell/programs/pick.lua')
    (server,) = (node for node in nodes if node.executable == 'opcua_node')
    assert server.process == 'opcua_node'
    assert server.parameters == {
        'robot_model': 'ur5e',
        'port': 4840,
        'access': '',
        'programs': '/cell/programs',
    }
    access = tmp_path / 'access.yaml'
    access.write_text('user: {}')
    with pytest.raises(RobotsError, match=r'access\.yaml:1'):
        nodes_of_cell(robot='ur5e', opcua=4840, opcua_access=str(access))


SCRIPTED_STOP = 'initial: {digital_input.2: 1}\nemergency_stop: {digital_input.2: off}\n'
MAPPED_STOP = (
    'inputs:\n  - {channel: digital_input.2, topic: a, type: Bool}\nemergency_stop: {digital_input.2: off}\n'
)


@pytest.mark.parametrize(
    ('option', 'text', 'source'),
    [('io', SCRIPTED_STOP, 'plc_node'), ('io_map', MAPPED_STOP, 'io_bridge_node')],
)
def test_the_controller_watches_the_node_that_publishes_the_inputs_of_the_emergency_stop(
    tmp_path: Path, option: str, text: str, source: str
):
    (tmp_path / 'file.yaml').write_text(text)
    file: Any = {option: str(tmp_path / 'file.yaml')}
    nodes = {node.executable: node.parameters for node in nodes_of_cell(robot='bello_bot', **file)}
    assert source in nodes
    assert nodes['controller_node']['emergency_stop_inputs'] == ['digital_input.2=off']
    assert nodes['controller_node']['emergency_stop_source'] == source
    for name in ('controller_node', 'lua_program_node'):
        assert nodes[name]['expected_nodes'] == [source]


def test_a_cell_with_a_scene_expects_its_collision_guard_and_one_without_expects_no_node():
    scene = str(ROOT / 'programs' / 'scenes' / 'car_frame.yaml')
    for options, expected in (({'scene': scene}, ['collision_node']), ({}, None)):
        for lockstep in (False, True):
            nodes = nodes_of_cell(robot='bello_bot', lockstep=lockstep, **options)
            for name in ('controller_node', 'lua_program_node'):
                (parameters,) = (node.parameters for node in nodes if node.executable == name)
                assert parameters.get('expected_nodes') == (None if lockstep else expected)


def test_a_driver_of_primitives_excludes_an_emergency_stop_by_inputs(tmp_path: Path):
    (tmp_path / 'driver.yaml').write_text('primitives: {name: /driver/motion_sequence}\n')
    (tmp_path / 'plc.yaml').write_text(SCRIPTED_STOP)
    files: Any = {'driver': str(tmp_path / 'driver.yaml'), 'io': str(tmp_path / 'plc.yaml')}
    with pytest.raises(OptionError, match=r'excludes emergency_stop: digital_input\.2 would stop nothing'):
        nodes_of_cell(robot='ur5e', **files)


def test_a_driver_of_primitives_has_no_planner_and_no_controller_of_the_suite(tmp_path: Path):
    (tmp_path / 'driver.yaml').write_text('primitives: {name: /driver/motion_sequence}\n')
    driver = str(tmp_path / 'driver.yaml')
    nodes = {node.executable: node.parameters for node in nodes_of_cell(robot='ur5e', driver=driver)}
    assert nodes['lua_program_node']['driver'] == driver
    assert nodes.keys() >= {'robot_state_node', 'direct_kinematics_node'}
    assert not nodes.keys() & {'drive_node', 'hardware_node', 'controller_node', 'planning_node'}
    for option in ({'guided': 'damped_least_squares'}, {'operating_mode': 'T1'}, {'tool_speed_limit': 0.5}):
        (name,) = option
        with pytest.raises(OptionError, match=f'excludes --{name.replace("_", "-")}'):
            nodes_of_cell(robot='ur5e', driver=driver, **option)
