"""BagRecorder: all topics of a cell into a rosbag2 bag (MCAP), through rosbags."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

DISCOVERY_PERIOD = 0.1  # s
QUEUE_DEPTH = 1000
BAG_VERSION: Final = 9


class BagRecorder(Node):
    """Subscribes to every topic that it sees, without deserialising, and writes it with its own thread.

    Args:
        path: Folder of the bag; must not exist.
        namespace: Records the topics below it, and the global ones (`/diagnostics`, `/rosout`).
    """

    def __init__(self, path: Path, *, namespace: str) -> None:
        super().__init__('bag_recorder', namespace=namespace)
        self.path = path
        self._prefix = namespace.rstrip('/') + '/'
        self._typestore = get_typestore(Stores.ROS2_JAZZY)
        self._writer = Writer(path, version=BAG_VERSION, storage_plugin=StoragePlugin.MCAP)
        self._connections: dict[str, Connection] = {}
        self._topics: dict[str, object] = {}
        self._queue: queue.SimpleQueue[tuple[str, str, list[Qos], int, bytes] | None] = queue.SimpleQueue()
        self._writer.open()
        self._thread = threading.Thread(target=self._write, name='bag writer', daemon=True)
        self._thread.start()
        self.create_timer(DISCOVERY_PERIOD, self._discover)

    def records(self, topics: Iterable[str]) -> bool:
        """Every one of these topics is subscribed and has a publisher."""
        matched = {
            topic
            for topic, subscription in self._topics.items()
            if subscription.get_publisher_count() > 0  # type: ignore[attr-defined]
        }
        return all((topic if topic.startswith('/') else self._prefix + topic) in matched for topic in topics)

    def close(self) -> None:
        """Write what is left and close the bag."""
        self._queue.put(None)
        self._thread.join()

    def _discover(self) -> None:
        for topic, types in self.get_topic_names_and_types():
            if topic in self._topics or not topic.startswith((self._prefix, '/diagnostics', '/rosout')):
                continue
            publishers = self.get_publishers_info_by_topic(topic)
            if publishers and types[0] in self._typestore.types:
                self._subscribe(topic, types[0], publishers)

    def _subscribe(self, topic: str, type_name: str, publishers: list[TopicEndpointInfo]) -> None:
        latched = all(p.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL for p in publishers)
        reliable = all(p.qos_profile.reliability is ReliabilityPolicy.RELIABLE for p in publishers)
        offered = [_bag_qos(p.qos_profile) for p in publishers]

        def on_message(data: bytes, info: dict[str, int]) -> None:
            # Sent, not received: topics keep their order to each other however late they come in.
            self._queue.put((topic, type_name, offered, info['source_timestamp'], data))

        self._topics[topic] = self.create_subscription(
            _message_class(type_name),
            topic,
            on_message,  # type: ignore[arg-type]  # rclpy hands the info to a callback that takes it
            QoSProfile(
                history=HistoryPolicy.KEEP_LAST,
                depth=QUEUE_DEPTH,
                reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
                durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
            ),
            raw=True,
        )

    def _write(self) -> None:
        while (item := self._queue.get()) is not None:
            topic, type_name, offered, stamp, data = item
            if topic not in self._connections:
                self._connections[topic] = self._writer.add_connection(
                    topic, type_name, typestore=self._typestore, offered_qos_profiles=offered
                )
            self._writer.write(self._connections[topic], stamp, data)
        self._writer.close()


def _message_class(type_name: str) -> Any:
    package, _, name = type_name.split('/')
    return getattr(import_module(f'{package}.msg'), name)


def _bag_qos(profile: QoSProfile) -> Qos:
    latched = profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
    reliable = profile.reliability is ReliabilityPolicy.RELIABLE
    unlimited = QosTime(sec=2147483647, nsec=4294967295)
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=max(1, profile.depth),
        reliability=QosReliability.RELIABLE if reliable else QosReliability.BEST_EFFORT,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=unlimited,
        lifespan=unlimited,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=unlimited,
        avoid_ros_namespace_conventions=False,
    )
