"""For tests with pytest: small bags to play, and recorded bags against expected ones.

Example:
    def test_my_cell(tmp_path):
        ...  # record into tmp_path / 'bag'
        assert_bag_matches(tmp_path / 'bag', 'expected/bag', 'expected/tolerances.yaml')
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from robots_controller.recording.bag_comparison import Comparison, compare_bags
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_qos import bag_qos
from robots_controller.recording.bag_tolerances import BagTolerances, read_tolerances

BAG_TYPES: Final = get_typestore(Stores.ROS2_JAZZY)
"""The messages to write: `BAG_TYPES.types['std_msgs/msg/Bool'](data=True)`."""

BAG_START: Final = 1_600_000_000_000_000_000  # ns, a day long past
_SECOND: Final = 1_000_000_000  # ns


def assert_bag_matches(
    recorded: Path | str, expected: Path | str, tolerances: BagTolerances | Path | str | None = None
) -> Comparison:
    """Fail the test with the first difference, if there is one.

    Args:
        recorded: The bag to check.
        expected: The expected bag.
        tolerances: How far apart they may be, or the YAML file that says so.

    Returns:
        The comparison, which found no difference.

    Raises:
        AssertionError: the bags differ, or one of them is incomplete.
        RobotsError: a bag or file that cannot be read.
    """
    if isinstance(tolerances, (Path, str)):
        tolerances = read_tolerances(tolerances)
    bags = read_bag(recorded), read_bag(expected)
    for bag in bags:
        if bag.problem:
            raise AssertionError(f'{bag.path} is incomplete: {bag.problem}')
    comparison = compare_bags(*bags, tolerances)
    if not comparison.ok:
        raise AssertionError(f'{recorded} is not as {expected}\n{comparison.describe()}')
    return comparison


def write_bag(
    path: Path,
    messages: Iterable[tuple[float, str, Any]],
    *,
    latched: Iterable[str] = (),
    storage: StoragePlugin = StoragePlugin.MCAP,
    compression: CompressionMode = CompressionMode.NONE,
    start: int = BAG_START,
) -> Path:
    """Write a bag.

    Args:
        path: Its folder; must not exist.
        messages: (s since the start, topic, message of `BAG_TYPES`), in any order.
        latched: Topics whose publisher latches.
        storage: MCAP or SQLite.
        compression: Of the bag (zstd).
        start: Time of the start, ns.

    Returns:
        The path.
    """
    latching = set(latched)
    writer = Writer(path, version=9, storage_plugin=storage)
    writer.set_compression(compression, CompressionFormat.ZSTD)
    connections: dict[str, Any] = {}
    with writer:
        for time, topic, message in messages:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(
                    topic,
                    kind,
                    typestore=BAG_TYPES,
                    offered_qos_profiles=[bag_qos(latched=topic in latching)],
                )
            data = BAG_TYPES.serialize_cdr(message, kind)
            writer.write(connections[topic], start + round(time * _SECOND), data)
    return path
