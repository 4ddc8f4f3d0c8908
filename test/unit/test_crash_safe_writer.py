"""Bags that are whole while they are written."""

from __future__ import annotations

import shutil
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import Reader, StoragePlugin, Writer, storage_mcap

from robots_controller.recording import crash_safe_file, crash_safe_writer
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_qos import bag_qos
from robots_controller.recording.crash_safe_writer import CHUNK_SIZE, CrashSafeWriter
from robots_core.errors import RobotsError
from written_bags import BAG_START, BAG_TYPES, no_file_larger_than

TEXT = 'std_msgs/msg/String'


def content(path: Path) -> list[tuple[str, int, bytes]]:
    """As any other reader finds it."""
    with Reader(path) as reader:
        found = [(connection.topic, stamp, bytes(data)) for connection, stamp, data in reader.messages()]
        assert reader.message_count == len(found)
    return found


class Recording:
    def __init__(self, path: Path, *, chunks: int = 1) -> None:
        self.path = path
        self.writer = CrashSafeWriter(path, chunks=chunks)
        self.writer.open()
        self.rows: list[tuple[str, int, bytes]] = []
        self.connections = {}

    def write(self, topic: str, length: int) -> None:
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, TEXT, typestore=BAG_TYPES)
        message = BAG_TYPES.types[TEXT]('x' * length)
        row = (topic, BAG_START + len(self.rows), bytes(BAG_TYPES.serialize_cdr(message, TEXT)))
        self.writer.write(self.connections[topic], *row[1:])
        self.rows.append(row)

    def write_for_ever(self) -> None:
        while True:
            self.write('/a', 1000)


STEPS = st.lists(
    st.one_of(
        st.just('flush'),
        st.tuples(st.sampled_from(['/a', '/b']), st.sampled_from([0, 10, 600_000, 2_000_000])),
    ),
    max_size=12,
)


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(STEPS)
def test_after_every_flush_the_bag_is_whole(tmp_path: Path, steps: list[str | tuple[str, int]]):
    recording = Recording(tmp_path / str(len(list(tmp_path.iterdir()))))
    for step in steps:
        if isinstance(step, str):
            recording.writer.flush()
            assert content(recording.path) == recording.rows
        else:
            recording.write(*step)
    recording.writer.close()
    assert content(recording.path) == recording.rows


def test_the_description_is_that_of_the_format(tmp_path: Path):
    def describe(writer: Writer) -> object:
        with writer:
            for topic, latched, count in (('/a', True, 2), ('/b', False, 0)):
                profiles = [bag_qos(latched=latched, depth=depth) for depth in (1, 7)]
                connection = writer.add_connection(
                    topic, TEXT, typestore=BAG_TYPES, offered_qos_profiles=profiles
                )
                for row in range(count):
                    writer.write(connection, BAG_START + row, b'')
        return yaml.safe_load((writer.path / 'metadata.yaml').read_text())

    own = describe(CrashSafeWriter(tmp_path / 'own' / 'bag'))
    assert own == describe(Writer(tmp_path / 'bag', version=9, storage_plugin=StoragePlugin.MCAP))


def test_what_waits_in_memory_is_bounded_and_written_whole(tmp_path: Path):
    recording = Recording(tmp_path / 'bag')
    length = 300_000
    written = 0
    for _ in range(20):
        recording.write('/a', length)
        saved = len(content(recording.path)) if (recording.path / 'metadata.yaml').exists() else 0
        assert saved >= written
        written = saved
        assert (len(recording.rows) - saved) * length <= CHUNK_SIZE
    assert written > 0
    recording.writer.close()
    assert content(recording.path) == recording.rows


@pytest.mark.parametrize('chunks', [1, 3])
def test_a_long_bag_goes_on_in_other_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, chunks: int
) -> None:
    monkeypatch.setattr(crash_safe_writer, 'MOST_CHUNKS', 4)
    recording = Recording(tmp_path / 'bag', chunks=chunks)
    for number in range(30):
        recording.write('/a' if number < 20 else '/b', 1_000 * number)
        recording.writer.flush()
        assert content(recording.path) == recording.rows
        assert read_bag(recording.path).problem == ''
    recording.writer.close()
    assert content(recording.path) == recording.rows
    assert [file.name for file in sorted(recording.path.glob('*.mcap'))][:3] == [
        'bag.mcap',
        'bag_1.mcap',
        'bag_2.mcap',
    ]
    for file in recording.path.glob('*.mcap'):
        assert read_bag(file).problem == ''


def test_a_damaged_file_costs_nothing_of_the_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(crash_safe_writer, 'MOST_CHUNKS', 2)
    recording = Recording(tmp_path / 'bag')
    for _ in range(6):
        recording.write('/a', 1000)
        recording.writer.flush()
    recording.writer.close()
    file = recording.path / 'bag_1.mcap'
    file.write_bytes(file.read_bytes()[:-2500])
    bag = read_bag(recording.path)
    assert 'bag_1.mcap is damaged' in bag.problem
    assert bag.messages == (*recording.rows[:3], *recording.rows[4:])


def test_the_index_of_a_long_recording_does_not_stay_in_memory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(crash_safe_writer, 'MOST_CHUNKS', 50)
    recording = Recording(tmp_path / 'bag')
    ours = [
        tracemalloc.Filter(True, module.__file__)
        for module in (crash_safe_file, crash_safe_writer, storage_mcap)
    ]
    kept, flushes, entry = [], 100, 100  # an entry of the index takes more bytes
    tracemalloc.start()
    for _ in range(3):
        for _ in range(flushes):
            recording.write('/a', 10)
            recording.writer.flush()
        traces = tracemalloc.take_snapshot().filter_traces(ours).traces
        kept.append(sum(trace.size for trace in traces))
    tracemalloc.stop()
    assert kept[-1] - kept[-2] < flushes * entry


def test_another_file_that_does_not_fit_leaves_the_bag_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(crash_safe_writer, 'MOST_CHUNKS', 2)
    recording = Recording(tmp_path / 'bag')
    for _ in range(4):
        recording.write('/a', 1000)
        recording.writer.flush()
    saved = list(recording.rows)
    recording.write('/a', 1000)
    with no_file_larger_than(1), pytest.raises(RobotsError, match='cannot take more'):
        recording.writer.flush()
    assert content(recording.path) == saved


def test_a_bag_whose_folder_is_removed_ends_and_says_so(tmp_path: Path):
    recording = Recording(tmp_path / 'bag')
    for _ in range(3):
        recording.write('/a', 1000)
        recording.writer.flush()
    shutil.rmtree(recording.path)
    recording.write('/a', 1000)
    with pytest.raises(RobotsError, match='bag cannot take more: No such file or directory; it ends early'):
        recording.writer.flush()
    recording.writer.close()
    assert not recording.path.exists()


@pytest.mark.parametrize('chunks', [1, 3])
def test_rows_are_the_messages_that_would_be_written_one_by_one(tmp_path: Path, chunks: int):
    text = 'x' * 500
    data = bytes(BAG_TYPES.serialize_cdr(BAG_TYPES.types[TEXT](text), TEXT))
    count = 6 * CHUNK_SIZE // len(data)  # several chunks
    stamps = BAG_START + np.arange(count)
    rows = np.tile(np.frombuffer(data, np.uint8), (count, 1))
    with CrashSafeWriter(tmp_path / 'rows', chunks=chunks) as writer:
        writer.write_rows(writer.add_connection('/a', TEXT, typestore=BAG_TYPES), stamps, rows)
    with CrashSafeWriter(tmp_path / 'single', chunks=chunks) as writer:
        connection = writer.add_connection('/a', TEXT, typestore=BAG_TYPES)
        for stamp in stamps.tolist():
            writer.write(connection, stamp, data)
    expected = [('/a', stamp, data) for stamp in stamps.tolist()]
    assert content(tmp_path / 'rows') == content(tmp_path / 'single') == expected


@pytest.mark.parametrize('chunks', [1, 64])
def test_a_bag_that_cannot_grow_ends_whole_and_says_so_once(tmp_path: Path, chunks: int):
    recording = Recording(tmp_path / 'bag', chunks=chunks)
    limit = 5 * CHUNK_SIZE + 200_000
    with no_file_larger_than(limit):
        with pytest.raises(RobotsError, match='bag cannot take more: File too large; it ends early'):
            recording.write_for_ever()
        for step in (recording.writer.flush, recording.writer.close, lambda: recording.write('/b', 9)):
            step()
    found = content(recording.path)
    assert found == recording.rows[: len(found)]
    assert sum(len(data) for *_, data in found) > limit - 2.2 * CHUNK_SIZE


def test_a_bag_that_cannot_even_end_keeps_what_fits(tmp_path: Path):
    """Not the messages but the end of the file is too long."""
    recording = Recording(tmp_path / 'bag', chunks=64)
    for _ in range(3):
        recording.write('/a', 900_000)
    size = (recording.path / 'bag.mcap').stat().st_size
    with no_file_larger_than(size + 100), pytest.raises(RobotsError, match='cannot take more'):
        recording.writer.close()
    assert content(recording.path) == recording.rows[:1]
