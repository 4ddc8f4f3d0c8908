"""Robots are found by entry points; third-party ones need nothing but to be installed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from robots_core import BaseRobotModel, available_robot_models, load_robot_model
from robots_core.errors import InvalidInputError, UnknownRobotError

PLUGIN = """
from robots_core import load_robot_model

def robot():
    return load_robot_model('bello_bot')

def stone():
    return 'stone'

def broken():
    return 1 / 0

granite = 'granite'
"""
ENTRY_POINTS = """
[robots_core.robot_models]
third_party = third_party_robots:robot
stone = third_party_robots:stone
granite = third_party_robots:granite
broken = third_party_robots:broken
lost = third_party_robots_that_are_gone:robot
unfinished = third_party_robots_unfinished:robot
"""


@pytest.fixture
def third_party(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An installed distribution with robots of its own."""
    (tmp_path / 'third_party_robots.py').write_text(PLUGIN)
    (tmp_path / 'third_party_robots_unfinished.py').write_text('def robot(:')
    install(tmp_path, 'third-party-robots', ENTRY_POINTS)
    monkeypatch.syspath_prepend(tmp_path)
    yield
    sys.modules.pop('third_party_robots', None)


def install(folder: Path, name: str, entry_points: str) -> None:
    info = folder / f'{name.replace("-", "_")}-1.0.dist-info'
    info.mkdir()
    (info / 'METADATA').write_text(f'Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n')
    (info / 'entry_points.txt').write_text(entry_points)


def test_own_robots_are_available():
    assert {'bello_bot', 'kuka_kr210_r2700'} <= set(available_robot_models())
    assert list(available_robot_models()) == sorted(available_robot_models())


def test_each_call_makes_a_robot_with_memory_of_its_own():
    """Two threads may compute with one each."""
    one, other = (vars(load_robot_model('bello_bot')) for _ in range(2))
    assert one['_data'] is not other['_data']


@pytest.mark.usefixtures('third_party')
def test_third_party_robot_is_found():
    assert 'third_party' in available_robot_models()
    assert isinstance(load_robot_model('third_party'), BaseRobotModel)


@pytest.mark.usefixtures('third_party')
@pytest.mark.parametrize(
    ('name', 'message'),
    [
        ('stone', r"'stone' \(third_party_robots:stone, .*\) returns str"),
        ('granite', r"'granite' .* is str, not a class or function"),
        ('broken', r"'broken' .* fails: ZeroDivisionError: division by zero"),
        ('lost', r"'lost' .* cannot be loaded: ModuleNotFoundError: .*third_party_robots_that_are_gone"),
        ('unfinished', r"'unfinished' .* cannot be loaded: SyntaxError"),
    ],
)
def test_broken_plugin_is_refused_with_its_distribution(name: str, message: str):
    with pytest.raises(UnknownRobotError, match=message) as refusal:
        load_robot_model(name)
    assert 'distribution third-party-robots 1.0' in str(refusal.value)


@pytest.mark.usefixtures('third_party')
def test_two_robots_of_one_name_are_refused_with_both_distributions(tmp_path: Path):
    install(tmp_path, 'others', '[robots_core.robot_models]\nthird_party = others:robot\n')
    assert available_robot_models().count('third_party') == 1
    with pytest.raises(UnknownRobotError, match=r"'third_party' .*several distributions") as refusal:
        load_robot_model('third_party')
    for distribution in ('third-party-robots 1.0', 'others 1.0'):
        assert distribution in str(refusal.value)
    assert load_robot_model('bello_bot').name == 'bello_bot'


def test_options_are_keywords_or_part_of_the_name():
    zero = np.zeros(7)
    for robot in (
        load_robot_model('bello_bot', gravity=(0.0, 0.0, 0.0)),
        load_robot_model('bello_bot?gravity=0,0,0'),
        load_robot_model('bello_bot?gravity=0,0,-9.81', gravity=(0.0, 0.0, 0.0)),
    ):
        assert robot.name == 'bello_bot'
        np.testing.assert_array_equal(robot.rigid_dynamics(robot.home, zero, zero)[2], 0.0)


@pytest.mark.parametrize(
    ('name', 'message'),
    [
        ('bello_bot?colour=red', r"'bello_bot' .*'colour'; options are: gravity, "),
        ('bello_bot?gravity', r'options look like \?option=value'),
        ('urdf:/no/where.urdf?colour=red', r"'colour'; options are: .*base, tip"),
    ],
)
def test_unknown_option_is_refused_with_the_known_ones(name: str, message: str):
    with pytest.raises(UnknownRobotError, match=message):
        load_robot_model(name)


@pytest.mark.parametrize('gravity', ['0,0', '0,0,nan', 'down'])
def test_value_that_an_option_cannot_have_is_refused(gravity: str):
    with pytest.raises(InvalidInputError, match='gravity'):
        load_robot_model(f'bello_bot?gravity={gravity}')


@pytest.mark.parametrize('name', ['bello', '', 'BELLO_BOT', '../bello_bot'])
def test_unknown_name_is_refused_with_the_known_ones(name: str):
    with pytest.raises(UnknownRobotError, match=r'bello_bot, .*kuka_kr210_r2700.*urdf:'):
        load_robot_model(name)


@pytest.mark.parametrize('shapes', ['visualization', 'collision_model'])
def test_the_meshes_of_a_robot_are_read_once(shapes: str):
    earth, space = load_robot_model('ur5e'), load_robot_model('ur5e?gravity=0,0,0')
    assert getattr(space, shapes).shapes is getattr(earth, shapes).shapes
    assert getattr(load_robot_model('ur10e'), shapes).shapes is not getattr(earth, shapes).shapes
