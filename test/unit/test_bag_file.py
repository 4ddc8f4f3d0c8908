"""Bags of every kind, whole and damaged."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from robots_controller.recording.bag_file import read_bag
from robots_core.errors import RobotsError
from written_bags import BAG_START, BAG_TYPES, write_bag, write_plant_bag

SECOND = 1_000_000_000


T = BAG_TYPES.types


def number(value: float) -> Any:
    return T['std_msgs/msg/Float64'](value)


def text(value: str) -> Any:
    return T['std_msgs/msg/String'](value)


def switch(value: bool) -> Any:  # noqa: FBT001
    return T['std_msgs/msg/Bool'](value)


MESSAGES = [(0.0, '/mode', text('auto')), *((0.1 * k, '/level', number(0.5 * k)) for k in range(10))]


def values(path: Path) -> list[tuple[float, float]]:
    found = read_bag(path).deserialized(['/level'])['/level']
    return [((stamp - BAG_START) / SECOND, message.data) for stamp, message in found]


EXPECTED = [(pytest.approx(0.1 * k), 0.5 * k) for k in range(10)]


@pytest.mark.parametrize(
    ('storage', 'compression'),
    [
        (StoragePlugin.MCAP, CompressionMode.NONE),
        (StoragePlugin.MCAP, CompressionMode.STORAGE),
        (StoragePlugin.MCAP, CompressionMode.FILE),
        (StoragePlugin.MCAP, CompressionMode.MESSAGE),
        (StoragePlugin.SQLITE3, CompressionMode.NONE),
        (StoragePlugin.SQLITE3, CompressionMode.FILE),
        (StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
    ],
)
def test_every_storage_and_compression(tmp_path: Path, storage: Any, compression: Any):
    path = write_bag(tmp_path / 'bag', MESSAGES, latched=['/mode'], storage=storage, compression=compression)
    bag = read_bag(path)
    assert bag.problem == ''
    assert {name: (t.type, t.latched) for name, t in bag.topics.items()} == {
        '/mode': ('std_msgs/msg/String', True),
        '/level': ('std_msgs/msg/Float64', False),
    }
    assert values(path) == EXPECTED


@pytest.mark.parametrize('storage', [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_one_file_alone(tmp_path: Path, storage: Any):
    path = write_bag(tmp_path / 'bag', MESSAGES, storage=storage)
    (file,) = (f for f in path.iterdir() if f.suffix in ('.mcap', '.db3'))
    assert values(file) == EXPECTED
    (path / 'metadata.yaml').unlink()
    assert values(path) == EXPECTED
    assert 'metadata' in read_bag(path).problem


def test_a_split_bag_is_read_in_order(tmp_path: Path):
    parts = tmp_path / 'bag'
    parts.mkdir()
    for index in (0, 2, 10):
        part = write_bag(
            tmp_path / str(index), [(index, '/level', number(index)), (index + 1, '/level', number(index))]
        )
        shutil.copy(part / f'{index}.mcap', parts / f'bag_{index}.mcap')
    assert [value for _, value in values(parts)] == [0, 0, 2, 2, 10, 10]


def test_types_are_those_of_the_bag(tmp_path: Path):
    bag = read_bag(write_plant_bag(tmp_path / 'bag', [2.5]))
    assert bag.defines('/level')
    ((_, message),) = bag.deserialized(['/level'])['/level']
    assert message.data == 2.5


def test_a_definition_that_is_not_valid_leaves_the_other_topics_readable(tmp_path: Path):
    bag = read_bag(write_plant_bag(tmp_path / 'bag', [2.5], defined=False))
    assert bag.problem == ''
    assert bag.deserialized(['/trigger'])['/trigger'][0][1].data
    assert not bag.defines('/level')
    with pytest.raises(RobotsError, match='Level, whose definition in the bag is not valid'):
        bag.deserialized(['/level'])


@pytest.mark.parametrize('storage', [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
@pytest.mark.parametrize('compression', [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE])
def test_metadata_with_another_qos_than_the_file_hides_no_message(
    tmp_path: Path, storage: Any, compression: Any
):
    path = write_bag(tmp_path / 'bag', MESSAGES, latched=['/mode'], storage=storage, compression=compression)
    metadata = path / 'metadata.yaml'
    text = metadata.read_text()
    assert 'depth: 1' in text
    metadata.write_text(text.replace('depth: 1', 'depth: 7'))
    assert values(path) == EXPECTED
    assert len(read_bag(path).messages) == len(MESSAGES)


def test_a_file_that_was_cut_off_is_read_up_to_the_cut_and_reported(tmp_path: Path):
    path = write_bag(tmp_path / 'bag', MESSAGES)
    file = path / 'bag.mcap'
    whole = file.read_bytes()
    file.write_bytes(whole[: len(whole) - 100])
    bag = read_bag(path)
    assert bag.problem.endswith('11 messages could be read')
    assert values(path) == EXPECTED


def test_a_damaged_database_is_reported(tmp_path: Path):
    path = write_bag(tmp_path / 'bag', MESSAGES, storage=StoragePlugin.SQLITE3)
    file = path / 'bag.db3'
    file.write_bytes(file.read_bytes()[:3000])
    with pytest.raises(RobotsError, match=r'bag\.db3 cannot be read'):
        read_bag(path)


@pytest.mark.parametrize(
    ('make', 'message'),
    [
        (lambda _: None, 'does not exist; a bag is a folder'),
        (lambda path: path.mkdir(), r'is no bag: it holds nothing; needed are metadata\.yaml and'),
        (lambda path: (path.mkdir(), (path / 'a.txt').touch()), r'is no bag: it holds a\.txt'),
        (lambda path: path.write_text('x'), 'is a nameless file; read are'),
    ],
)
def test_what_is_no_bag_is_reported(tmp_path: Path, make: Any, message: str):
    make(tmp_path / 'bag')
    with pytest.raises(RobotsError, match=message):
        read_bag(tmp_path / 'bag')


@pytest.mark.parametrize(
    ('name', 'content', 'message'),
    [
        ('a.bag', b'#ROSBAG V2.0\n', 'is a bag of ROS 1'),
        ('a.mcap', b'', 'is empty'),
        ('a.mcap', b'something else', 'is no MCAP file'),
        ('a.mcap', b'\x89MCAP0\r\n', 'no message could be recovered'),
        ('a.db3', b'something else', 'cannot be read'),
    ],
)
def test_foreign_files_are_reported(tmp_path: Path, name: str, content: bytes, message: str):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(RobotsError, match=message):
        read_bag(tmp_path / name)


def test_a_message_that_is_not_of_its_type_is_reported(tmp_path: Path):
    path = write_bag(tmp_path / 'bag', [(0.0, '/a', switch(True))])
    file = path / 'bag.mcap'
    # The message is there, without what follows its header.
    file.write_bytes(file.read_bytes().replace(b'\x00\x01\x00\x00\x01', b'\x00\x07\x00\x00\x01'))
    with pytest.raises(RobotsError, match='message 1 of /a is no std_msgs/msg/Bool'):
        read_bag(path).deserialized(['/a'])


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 10_000), st.binary(max_size=20))
def test_any_damage_is_survived(tmp_path: Path, position: int, noise: bytes):
    path = tmp_path / 'bag'
    if not path.exists():
        write_bag(path, MESSAGES)
        shutil.copy(path / 'bag.mcap', tmp_path / 'whole')
    whole = (tmp_path / 'whole').read_bytes()
    position %= len(whole)
    (path / 'bag.mcap').write_bytes(whole[:position] + noise)
    try:
        bag = read_bag(path)
        told = bag.problem
        assert 0 < len(bag.messages) <= len(MESSAGES)
    except RobotsError as error:
        told = str(error)
    assert told
