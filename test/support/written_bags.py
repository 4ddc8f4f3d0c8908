"""Small bags to play."""

import resource
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from robots_controller.recording.bag_qos import bag_qos

BAG_TYPES: Final = get_typestore(Stores.ROS2_JAZZY)
"""The messages to write: `BAG_TYPES.types['std_msgs/msg/Bool'](data=True)`."""

BAG_START: Final = 1_600_000_000_000_000_000  # ns, a day long past
_SECOND: Final = 1_000_000_000  # ns


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


@contextmanager
def no_file_larger_than(size: int) -> Iterator[None]:
    """Writing more than so many bytes fails, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


PLANT_TYPE: Final = 'plant_msgs/msg/Level'
"""A message type that is not installed."""


def write_plant_bag(
    path: Path, levels: Iterable[float], *, defined: bool = True, trigger: bool = True
) -> Path:
    """Write a bag with `/trigger` (Bool), and `/level` of `PLANT_TYPE`, a message each 0.1 s.

    Args:
        path: Its folder; must not exist.
        levels: What `/level` holds.
        defined: The bag has a definition of the type that can be read.
        trigger: It has the topic `/trigger`.

    Returns:
        The path.
    """
    store = get_typestore(Stores.ROS2_JAZZY)
    store.register(get_types_from_msg('float64 data', PLANT_TYPE))
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        if trigger:
            kind = 'std_msgs/msg/Bool'
            data = store.serialize_cdr(store.types[kind](data=True), kind)
            writer.write(writer.add_connection('/trigger', kind, typestore=store), BAG_START, data)
        connection = writer.add_connection('/level', PLANT_TYPE, typestore=store)
        for index, level in enumerate(levels):
            data = store.serialize_cdr(store.types[PLANT_TYPE](level), PLANT_TYPE)
            writer.write(connection, BAG_START + round(0.1 * index * _SECOND), data)
    if not defined:
        file = path / f'{path.name}.mcap'
        file.write_bytes(file.read_bytes().replace(b'float64 data', b'float64 [dat'))
    return path
