"""BagDescription: what a bag's `metadata.yaml` says, with each topic put into YAML once."""

from collections.abc import Mapping
from typing import Any, Final

import yaml
from rosbags.interfaces import Connection, ConnectionExtRosbag2
from rosbags.rosbag2.metadata import dump_qos_v9

VERSION: Final = 9
"""Of rosbag2's format."""


class BagDescription:
    """Describes a bag of one MCAP file.

    YAML of all topics takes a hundred milliseconds, which a bag that is described every second cannot spare.

    Args:
        file: Name of the file.
    """

    def __init__(self, file: str) -> None:
        self._file = file
        self._topics: dict[int, str] = {}

    def add(self, connection: Connection) -> None:
        """Describe one topic more."""
        assert isinstance(connection.ext, ConnectionExtRosbag2)
        metadata = {
            'name': connection.topic,
            'type': connection.msgtype,
            'serialization_format': connection.ext.serialization_format,
            'offered_qos_profiles': dump_qos_v9(connection.ext.offered_qos_profiles),
            'type_description_hash': connection.digest,
        }
        self._topics[connection.id] = _yaml([{'topic_metadata': metadata}])

    def text(self, counts: Mapping[int, int], start: int, end: int) -> str:
        """The description as YAML.

        Args:
            counts: Messages so far, by the connection's id.
            start: Time of the first one, ns.
            end: Time of the last one, ns.
        """
        span = {
            'starting_time': {'nanoseconds_since_epoch': start},
            'duration': {'nanoseconds': max(0, end - start)},
            'message_count': sum(counts.values()),
        }
        values = {
            'version': VERSION,
            'storage_identifier': 'mcap',
            'relative_file_paths': [self._file],
            **span,
            'compression_format': '',
            'compression_mode': '',
            'files': [{'path': self._file, **span}],
            'custom_data': None,
            'ros_distro': 'rosbags',
        }
        topics = [f'{text}  message_count: {counts[key]}\n' for key, text in self._topics.items()]
        head = 'topics_with_message_count:' + ('\n' if topics else ' []\n')
        return _yaml(values) + head + ''.join(topics)


class _Dumper(yaml.SafeDumper):
    """Without references to what stands there already, which other readers need not follow."""

    def ignore_aliases(self, data: object) -> bool:
        del data
        return True


def _yaml(value: Any) -> str:
    return str(yaml.dump(value, Dumper=_Dumper, sort_keys=False))
