"""Bags as other programs write them: rosbag2 in Humble, Jazzy and Rolling, and the package `mcap`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from mcap.writer import CompressionType

from foreign_bags import START, Topic, double, text, write_foreign_bag, write_mcap
from robots_controller.commands.command_table import CHECK_BAG
from robots_controller.recording.bag_file import read_bag

MODE = Topic('/mode', 'std_msgs/msg/String', 'string data', latched=True)
LEVEL = Topic('/level', 'plant_msgs/msg/Level', 'float64 data')
BY_IDL = Topic(
    '/level',
    'plant_msgs/msg/Level',
    'module plant_msgs { module msg { struct Level { double data; }; }; };',
    'ros2idl',
)
UNDEFINED = Topic('/level', 'plant_msgs/msg/Level')
TENTH = 100_000_000  # ns
LEVELS = [(TENTH * k, 0.5 * k) for k in range(10)]


def messages(level: Topic = LEVEL) -> list[Any]:
    return [(0, MODE, text('auto')), *((time, level, double(value)) for time, value in LEVELS)]


def check(path: Path) -> None:
    """A bag has all `messages`."""
    bag = read_bag(path)
    assert bag.problem == ''
    found = bag.deserialized(['/mode', '/level'])
    assert [message.data for _, message in found['/mode']] == ['auto']
    assert [(stamp - START, message.data) for stamp, message in found['/level']] == LEVELS


@pytest.mark.parametrize('level', [LEVEL, BY_IDL], ids=['msg', 'idl'])
@pytest.mark.parametrize('compression', ['', 'FILE', 'MESSAGE'])
@pytest.mark.parametrize(('distro', 'storage'), [('humble', 'mcap'), ('jazzy', 'mcap'), ('jazzy', 'sqlite3')])
def test_rosbag2(tmp_path: Path, distro: str, storage: str, compression: str, level: Topic) -> None:
    rows = messages(level)
    path = write_foreign_bag(
        tmp_path / 'bag', [rows[:4], rows[4:]], distro=distro, storage=storage, compression=compression
    )
    check(path)
    assert {name: topic.latched for name, topic in read_bag(path).topics.items()} == {
        '/mode': True,
        '/level': False,
    }


@pytest.mark.parametrize('compression', ['', 'FILE', 'MESSAGE'])
def test_a_database_of_humble_that_defines_no_types(
    tmp_path: Path, compression: str, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = messages()
    path = write_foreign_bag(
        tmp_path / 'humble', [rows], distro='humble', storage='sqlite3', compression=compression
    )
    bag = read_bag(path)
    assert bag.topics['/mode'].latched
    assert [message.data for _, message in bag.deserialized(['/mode'])['/mode']] == ['auto']
    assert not bag.defines('/level')
    assert len(bag.serialized('/level')) == len(LEVELS)
    later = write_foreign_bag(tmp_path / 'jazzy', [rows], distro='jazzy', storage='mcap')
    assert CHECK_BAG.run([str(later), '--against', str(path)]) == 0
    assert 'compared byte by byte, as their types are not known: /level' in capsys.readouterr().out


@pytest.mark.parametrize('summary', [True, False])
@pytest.mark.parametrize('compression', [*CompressionType, None])
def test_mcap(tmp_path: Path, compression: CompressionType | None, summary: bool) -> None:  # noqa: FBT001
    path = tmp_path / 'bag.mcap'
    write_mcap(path, messages(), compression=compression, summary=summary, extras=True)
    check(path)
    assert not read_bag(path).topics['/mode'].latched  # the package `mcap` has no QoS


@pytest.mark.parametrize('compression', [CompressionType.ZSTD, None])
def test_mcap_without_statistics(tmp_path: Path, compression: CompressionType | None) -> None:
    path = tmp_path / 'bag.mcap'
    write_mcap(path, messages(), compression=compression, statistics=False)
    check(path)


@pytest.mark.parametrize('summary', [True, False])
@pytest.mark.parametrize('compression', [CompressionType.ZSTD, None])
def test_messages_that_were_not_written_in_the_order_of_their_times(
    tmp_path: Path,
    compression: CompressionType | None,
    summary: bool,  # noqa: FBT001
) -> None:
    path, rows = tmp_path / 'bag.mcap', messages()
    write_mcap(path, [*rows[5:], *rows[:5]], compression=compression, summary=summary)
    check(path)


def test_a_type_that_nobody_defines_leaves_the_other_topics_readable(tmp_path: Path) -> None:
    path = tmp_path / 'bag.mcap'
    write_mcap(path, messages(UNDEFINED))
    bag = read_bag(path)
    assert bag.problem == ''
    assert [message.data for _, message in bag.deserialized(['/mode'])['/mode']] == ['auto']
    assert not bag.defines('/level')
