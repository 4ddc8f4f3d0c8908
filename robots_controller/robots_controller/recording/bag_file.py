"""Bag: all messages of a ROS 2 bag of any kind, also of one that was cut off."""

import math
from collections.abc import Collection, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from operator import itemgetter
from pathlib import Path
from typing import Any, Final

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat, QosDurability
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.reader import DirectoryReader
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.typesys import Stores, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robots_controller.recording.mcap_recovery import recover_mcap
from robots_core.errors import BagError
from robots_core.files.user_file import MAX_TEXT, check_file, exists

STORAGE_SUFFIXES: Final = ('.mcap', '.db3')
METADATA: Final = 'metadata.yaml'


@dataclass(frozen=True)
class BagTopic:
    """A topic of a bag.

    Attributes:
        name: Its full name.
        type: package/msg/Name.
        latched: Its publishers latch: late subscribers get the last message.
        definition: Text of the message definition, '' where the bag has none.
        definition_format: Of the text: 'msg' or 'idl'.
    """

    name: str
    type: str
    latched: bool
    definition: str = field(repr=False, default='')
    definition_format: str = 'msg'


@dataclass(frozen=True)
class Bag:
    """A bag in memory.

    Attributes:
        path: Where it is.
        topics: By name.
        messages: (topic, time of sending in ns, serialized message) in order of time.
        problem: What is wrong with it, '' for nothing; then `messages` are those that could be read.
    """

    path: Path
    topics: dict[str, BagTopic]
    messages: tuple[tuple[str, int, bytes], ...] = field(repr=False)
    problem: str = ''

    def typestore(self) -> Typestore:
        """The message types as they were when the bag was recorded; Jazzy's where it does not say.

        Types whose definition is not valid, as those of events of services can be, are left out.
        """
        definitions = {(t.type, t.definition, t.definition_format) for t in self.topics.values()}
        return _typestore(tuple(sorted(definitions)))

    def defines(self, topic: str) -> bool:
        """The type of a topic is known, so that its messages can be read."""
        return topic in self.topics and self.topics[topic].type in self.typestore().types

    def serialized(self, topic: str) -> list[tuple[int, bytes]]:
        """Messages of a topic: (time of sending in ns, serialized message)."""
        return [(stamp, data) for name, stamp, data in self.messages if name == topic]

    def deserialized(self, topics: Collection[str]) -> dict[str, list[tuple[int, Any]]]:
        """Messages of some topics: (time of sending in ns, message); none where the bag lacks the topic.

        Raises:
            RobotsError: an unknown type, or a message that is not of its type.
        """
        store = self.typestore()
        found: dict[str, list[tuple[int, Any]]] = {topic: [] for topic in topics}
        for name, stamp, data in self.messages:
            if name not in found:
                continue
            kind = self.topics[name].type
            if kind not in store.types:
                problem = (
                    'whose definition in the bag is not valid'
                    if self.topics[name].definition
                    else 'which neither the bag nor Jazzy defines'
                )
                raise BagError(f'{self.path}: {name} is a {kind}, {problem}')
            try:
                found[name].append((stamp, store.deserialize_cdr(data, kind)))
            except Exception as error:  # a damaged message fails in as many ways as there are fields
                raise BagError(
                    f'{self.path}: message {len(found[name]) + 1} of {name} is no {kind}: {error!r}'
                ) from error
        return found


@lru_cache(maxsize=16)
def _typestore(definitions: tuple[tuple[str, str, str], ...]) -> Typestore:
    """Types by (name, text, format); parsing the texts takes longer than reading a small bag."""
    described = definitions and all(text for _, text, _ in definitions)
    store = get_typestore(Stores.EMPTY if described else Stores.ROS2_JAZZY)
    for name, text, kind in definitions:
        if text and name not in store.types:
            with suppress(Exception):  # the parser has no error of its own for every text
                types = get_types_from_idl(text) if kind == 'idl' else get_types_from_msg(text, name)
                store.register({key: fields for key, fields in types.items() if key not in store.types})
    return store


def read_bag(path: Path | str) -> Bag:
    """Read a bag: a folder as rosbag2 writes it, or one .mcap or .db3 file.

    MCAP files that were cut off (by a kill, a full disk) are read up to the cut, and `Bag.problem` says so.

    Raises:
        RobotsError: what is wrong with it.
    """
    path = Path(path)
    if not exists(path):
        raise BagError(
            f'{path} does not exist; a bag is a folder with metadata.yaml, or a .mcap or .db3 file'
        )
    if path.is_file() and path.suffix not in STORAGE_SUFFIXES:
        kind = 'a bag of ROS 1' if path.suffix == '.bag' else f'a {path.suffix or "nameless"} file'
        raise BagError(f'{path} is {kind}; read are folders with metadata.yaml, .mcap and .db3 files')
    _check_files(path)
    try:
        topics, messages = _read(path)
    except Exception as error:  # noqa: BLE001  # damaged files fail in as many ways as they have bytes
        return _recovered(path, error)
    return Bag(path, topics, messages)


Message = tuple[str, int, bytes]
STAMP: Final = itemgetter(1)


def _check_files(path: Path) -> None:
    """Refuse what has no end or cannot be opened; a storage is as large as it is."""
    try:
        files = list(path.iterdir()) if path.is_dir() else [path]
    except OSError as error:
        raise BagError(f'{path} cannot be read: {error.strerror}') from error
    for file in files:
        if file.suffix in STORAGE_SUFFIXES:
            check_file(file, 'storage of a bag', largest=math.inf)
        elif file.name == METADATA:
            check_file(file, 'metadata of a bag', largest=MAX_TEXT)


def _read(path: Path) -> tuple[dict[str, BagTopic], tuple[Message, ...]]:
    with Reader(path) as reader:
        storages = (
            reader.storage.storages if isinstance(reader.storage, DirectoryReader) else [reader.storage]
        )
        # Those in metadata.yaml can differ from them, as in their QoS, and would find no message.
        written = [one for storage in storages for one in storage.connections]
        for storage in storages:
            if isinstance(storage, McapReader) and not storage.chunks:
                # Without an index it refuses messages that are not in the order of their times.
                storage.messages = storage.messages_scan  # type: ignore[method-assign]
        return _topics([*reader.connections, *written]), _in_order(reader.messages(written))


def _topics(connections: Iterable[Connection]) -> dict[str, BagTopic]:
    topics: dict[str, BagTopic] = {}
    for connection in connections:
        topics.setdefault(connection.topic, _topic(connection))
    return topics


def _in_order(messages: Iterable[tuple[Connection, int, Any]]) -> tuple[Message, ...]:
    found = ((connection.topic, stamp, bytes(data)) for connection, stamp, data in messages)
    return tuple(sorted(found, key=STAMP))


class _ForeignError(BagError):
    """A bag that is whole, but of a kind that cannot be read."""


def _topic(connection: Connection) -> BagTopic:
    assert isinstance(connection.ext, ConnectionExtRosbag2)
    if connection.ext.serialization_format != 'cdr':
        raise _ForeignError(
            f'{connection.topic} has messages in {connection.ext.serialization_format!r}; read is cdr'
        )
    definition, profiles = connection.msgdef, connection.ext.offered_qos_profiles
    known = definition.format is not MessageDefinitionFormat.NONE
    return BagTopic(
        connection.topic,
        connection.msgtype,
        bool(profiles) and all(p.durability is QosDurability.TRANSIENT_LOCAL for p in profiles),
        definition.data if known else '',
        'idl' if definition.format is MessageDefinitionFormat.IDL else 'msg',
    )


def _recovered(path: Path, error: Exception) -> Bag:
    reason = str(error) or repr(error)
    if isinstance(error, _ForeignError):
        raise BagError(f'{path} cannot be read: {reason}') from error
    files = sorted(path.glob('*'), key=_natural) if path.is_dir() else [path]
    files = [file for file in files if file.suffix in STORAGE_SUFFIXES]
    if not files:
        names = ', '.join(sorted(file.name for file in path.iterdir())[:5]) or 'nothing'
        raise BagError(
            f'{path} is no bag: it holds {names}; needed are metadata.yaml and .mcap or .db3 files ({reason})'
        ) from error
    topics: dict[str, BagTopic] = {}
    messages: list[Message] = []
    cut: list[str] = []
    for file in files:
        try:
            some_topics, some = _read(file)
        except Exception as file_error:
            if file.suffix != '.mcap':
                raise BagError(f'{file} cannot be read: {file_error}') from file_error
            connections, found, wrong = recover_mcap(file)
            some_topics, some = _topics(connections), _in_order(found)
            cut += [wrong] if wrong else []
        topics = {**some_topics, **topics}
        messages += some
    if not messages:
        raise BagError(f'{path} cannot be read, and no message could be recovered: {reason}') from error
    problem = f'{"; ".join(cut) or reason}; {len(messages)} messages could be read'
    return Bag(path, topics, tuple(sorted(messages, key=STAMP)), problem)


def _natural(path: Path) -> tuple[int, str]:
    """bag_2 before bag_10."""
    digits = ''.join(filter(str.isdigit, path.stem[-6:]))
    return int(digits or 0), path.name
