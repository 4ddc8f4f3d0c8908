"""A program says at its top which cell it is for, and the tools take it from there."""

from __future__ import annotations

from pathlib import Path

import pytest

from cell_options import simulate_options
from robots_controller.cell.guide_recording import read_guide_recording
from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.io.plc_script import read_plc_script
from robots_controller.program.files.program_header import ProgramHeader, read_program_header
from robots_core import load_robot_model
from robots_core.blocks import read_cabin, read_orbit, read_scene
from robots_core.errors import RobotsError

PROGRAMS = sorted((Path(__file__).parents[2] / 'programs').glob('*.lua'))


def header_of(folder: Path, text: str) -> ProgramHeader:
    path = folder / 'program.lua'
    path.write_text(text)
    return read_program_header(path)


@pytest.mark.parametrize(
    ('text', 'robot'),
    [
        ('-- Robot: ur5e\nwait(1)', 'ur5e'),
        ('-- Welding\n--Robot: debris_arm?gravity=0,0,0  \n-- more\n', 'debris_arm?gravity=0,0,0'),
        ('-- Robot: urdf:/a/b.urdf?tip=hand', 'urdf:/a/b.urdf?tip=hand'),
        ('', ''),
        ('-- The robot: a large one\n', ''),
        ('-- Robot: a large one\n', ''),
        ('wait(1)\n-- Robot: ur5e\n', ''),
        ('print("-- Robot: ur5e")\n', ''),
    ],
)
def test_only_a_line_of_the_first_comment_says_it(tmp_path: Path, text: str, robot: str):
    assert header_of(tmp_path, text) == ProgramHeader(robot=robot)


def test_files_are_seen_from_the_program_s_folder(tmp_path: Path):
    header = header_of(
        tmp_path,
        '-- Robot: ur5e  Scene: scenes/car.yaml\n-- IO: /plc.yaml  References: drive\n'
        '-- Orbit: o.yaml  Cabin: c.yaml\n',
    )
    assert header == ProgramHeader(
        'ur5e',
        str(tmp_path / 'scenes/car.yaml'),
        '/plc.yaml',
        str(tmp_path / 'drive'),
        orbit=str(tmp_path / 'o.yaml'),
        cabin=str(tmp_path / 'c.yaml'),
    )


def test_what_is_given_takes_its_place():
    header = ProgramHeader('ur5e', 'own.yaml', 'plc.yaml')
    assert header.replaced_by() == header
    assert header.replaced_by(robot='ur10e', scene='other.yaml', references='bag') == ProgramHeader(
        'ur10e', 'other.yaml', 'plc.yaml', 'bag'
    )


def test_another_robot_is_noted_and_an_option_is_no_other_robot():
    header = ProgramHeader('debris_arm?gravity=0,0,0')
    assert not header.note('p/grasp.lua', 'debris_arm')
    assert header.note('p/grasp.lua', 'ur5e') == 'grasp.lua is written for debris_arm?gravity=0,0,0'
    assert not ProgramHeader().note('p/grasp.lua', 'ur5e')


@pytest.mark.parametrize('program', PROGRAMS, ids=lambda path: path.stem)
def test_programs_name_their_cell_and_fit_it(program: Path, capsys: pytest.CaptureFixture[str]):
    header = read_program_header(program)
    load_robot_model(header.robot)
    if header.scene:
        read_scene(header.scene)
    if header.io:
        read_plc_script(header.io)
    if header.references:
        joints = load_robot_model(header.robot).axes_data.names
        read_guide_recording(header.references, joints, cabin=bool(header.cabin))
    if header.cabin:
        read_cabin(header.cabin)
    if header.orbit:
        read_orbit(header.orbit)
    assert bool(header.io) == (program.parent / 'io' / f'{program.stem}.yaml').is_file()
    assert CHECK_PROGRAM.run([str(program)]) == 0, capsys.readouterr().out


def test_the_wrong_robot_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    path = tmp_path / 'program.lua'
    path.write_text('-- Robot: ur5e\nptpJointSpaceAngles(0, 0, 0, 0, 0, 0)\n')
    assert CHECK_PROGRAM.run([str(path)]) == 0
    assert CHECK_PROGRAM.run([str(path), '--robot', 'bello_bot']) == 1
    assert 'program.lua:2: ptpJointSpaceAngles' in capsys.readouterr().out
    options = simulate_options([str(path), '--robot', 'bello_bot'])
    assert (options.robot, options.note) == ('bello_bot', 'program.lua is written for ur5e')
    options = simulate_options([str(path)])
    assert (options.robot, options.note) == ('ur5e', '')


def test_a_program_that_says_nothing_needs_a_robot_to_be_simulated(tmp_path: Path):
    path = tmp_path / 'program.lua'
    path.write_text('wait(1)\n')
    with pytest.raises(RobotsError, match='does not say which robot it is for; --robot does'):
        simulate_options([str(path)])
    assert simulate_options([str(path), '--robot', 'ur5e']).robot == 'ur5e'
