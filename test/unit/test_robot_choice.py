"""Robots are found by entry points; third-party ones need nothing but to be installed."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from robots_core import BaseRobotModel, available_robot_models, load_robot_model
from robots_core.errors import UnknownRobotError

PLUGIN = """
from robots_core import load_robot_model

def robot():
    return load_robot_model('bello_bot')

def stone():
    return 'stone'
"""
ENTRY_POINTS = """
[robots_core.robot_models]
third_party = third_party_robots:robot
stone = third_party_robots:stone
lost = third_party_robots_that_are_gone:robot
"""


@pytest.fixture
def third_party(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An installed distribution with robots of its own."""
    (tmp_path / 'third_party_robots.py').write_text(PLUGIN)
    info = tmp_path / 'third_party_robots-1.0.dist-info'
    info.mkdir()
    (info / 'METADATA').write_text('Metadata-Version: 2.1\nName: third-party-robots\nVersion: 1.0\n')
    (info / 'entry_points.txt').write_text(ENTRY_POINTS)
    monkeypatch.syspath_prepend(tmp_path)
    yield
    sys.modules.pop('third_party_robots', None)


def test_own_robots_are_available():
    assert {'bello_bot', 'kuka_kr210_r2700'} <= set(available_robot_models())
    assert list(available_robot_models()) == sorted(available_robot_models())


def test_each_call_makes_a_robot_of_its_own():
    assert load_robot_model('bello_bot') is not load_robot_model('bello_bot')


@pytest.mark.usefixtures('third_party')
def test_third_party_robot_is_found():
    assert 'third_party' in available_robot_models()
    assert isinstance(load_robot_model('third_party'), BaseRobotModel)


@pytest.mark.usefixtures('third_party')
def test_plugin_that_is_no_robot_is_refused():
    with pytest.raises(UnknownRobotError, match=r"'stone' \(third_party_robots:stone\) returns str"):
        load_robot_model('stone')


@pytest.mark.usefixtures('third_party')
def test_plugin_that_cannot_be_imported_is_refused():
    with pytest.raises(UnknownRobotError, match=r"'lost'.*third_party_robots_that_are_gone"):
        load_robot_model('lost')


@pytest.mark.parametrize('name', ['bello', '', 'BELLO_BOT', '../bello_bot'])
def test_unknown_name_is_refused_with_the_known_ones(name: str):
    with pytest.raises(UnknownRobotError, match=r'bello_bot, .*kuka_kr210_r2700.*urdf:'):
        load_robot_model(name)
