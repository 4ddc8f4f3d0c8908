"""The example of two robots: its files fit each other, and each robot finishes its program alone."""

from __future__ import annotations

import pytest

from robots_controller.io.io_map import IoMap, read_io_map
from robots_controller.simulate import simulate
from robots_core import load_robot_model
from robots_core.blocks import ZoneDetection, read_scene

from .test_documentation import DOCS, ROOT, blocks, section

FOLDER = ROOT / 'examples' / 'two_robots'
PAGE = DOCS / 'how_to' / 'several_robots.md'
ROBOTS = {'place': 'remove', 'remove': 'place'}


def topics(rows: IoMap, direction: str) -> dict[str, str]:
    return {row.place.port: row.channel.label for row in getattr(rows, direction)}


def test_each_robot_reads_what_the_other_one_sends() -> None:
    place, remove = (read_io_map(FOLDER / f'{name}_io.yaml') for name in ROBOTS)
    assert topics(place, 'outputs') == topics(remove, 'inputs') == {'/table/placed': 'placed'}
    assert topics(remove, 'outputs') == topics(place, 'inputs') == {'/table/removed': 'removed'}
    assert all(topic.startswith('/') for topic in topics(place, 'inputs'))


def test_they_share_one_zone() -> None:
    for robot, other in ROBOTS.items():
        (zone,) = read_scene(FOLDER / f'{robot}_scene.yaml').zones
        assert (zone.name, zone.shared_with) == ('table', (f'/{other}',))


@pytest.mark.parametrize('robot', ROBOTS)
def test_each_robot_can_be_simulated_alone(robot: str) -> None:
    run = simulate(
        FOLDER / f'{robot}.lua',
        robot='ur5e',
        io=str(FOLDER / f'{robot}_alone.yaml'),
        scene=str(FOLDER / f'{robot}_scene.yaml'),
    )
    assert run.ok
    zones = ZoneDetection(load_robot_model('ur5e'), read_scene(FOLDER / f'{robot}_scene.yaml'))
    to_table = [zones.clearance(zones.zones[0]).closest(q)[0] for q in run.position[::25]]
    assert min(to_table) < -0.1 < 0.01 < to_table[0]
    assert len(run.motions) == 10
    shown = section(PAGE, 'Simulate each')
    assert all(line.strip() in shown for line in run.printed)


def test_the_files_in_the_page_are_those_of_the_example() -> None:
    (text,) = blocks(PAGE, 'yaml')
    written = (FOLDER / 'place_io.yaml').read_text().partition('\n')[2]
    assert text.replace('      # place_io.yaml', '') == written
    (program,) = blocks(PAGE, 'lua')
    assert all(line in (FOLDER / 'place.lua').read_text() for line in program.splitlines())
    for command in blocks(PAGE, 'bash'):
        for word in command.split():
            assert not word.startswith('examples/') or (ROOT / word).is_file(), word
