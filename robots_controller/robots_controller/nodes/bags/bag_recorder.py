"""BagRecorder: all topics of a cell into a rosbag2 bag (MCAP), through rosbags."""

import threading
import time
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rosbags.interfaces import Connection, Qos
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock

from robots_controller.nodes.bags.lockstep_times import LockstepTimes, Sent
from robots_controller.recording.bag_qos import bag_qos
from robots_controller.recording.crash_safe_writer import CrashSafeWriter
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.ros.lockstep.counted_endpoints import ALL
from robots_core.ros.lockstep.protocol import is_of_protocol
from robots_core.ros.messages import message_class
from robots_core.ros.peers.heartbeat import HEARTBEAT
from robots_core.ros.streams.polled_subscription import PolledSubscription

HIDDEN: Final = '/_'

DISCOVERY_PERIOD = 0.1  # s
WRITE_PERIOD = 0.02  # s
# Messages of one topic between two writes: as many as Fast DDS keeps by default, 5 s at 1 kHz in which a
# busy machine may not get to writing.
QUEUE_DEPTH = 5000
FLUSH_PERIOD = 1.0  # s; what a kill may cost


class BagRecorder(Node):
    """Subscribes to every topic that it finds and writes it as received, with a thread of its own.

    Memory is bounded: a queue per topic and one chunk of the file. The bag on disk is whole after every
    `FLUSH_PERIOD`: a kill of the process costs what came since.

    Args:
        path: Folder of the bag; must not exist.
        namespace: Records the topics below it, and the global ones (`/diagnostics`, `/rosout`), but not
            what keeps a run in lock-step, and no heartbeats.
        lockstep: Times are those of a lock-step run, not of the system's clock.
    """

    def __init__(self, path: Path, *, namespace: str, lockstep: bool = False, **options: Any) -> None:
        super().__init__('bag_recorder', namespace=namespace, **options)
        self.path = path
        self._prefix = namespace.rstrip('/') + '/'
        self._typestore = get_typestore(Stores.ROS2_JAZZY)
        self._writer = CrashSafeWriter(path)
        self._topics: dict[str, tuple[Connection, PolledSubscription]] = {}
        self._left_out: set[str] = set()
        self._received: Counter[str] = Counter()
        self._writer.open()
        self._writing = threading.Lock()  # a topic is found while another's messages are written
        self._closed = threading.Event()
        self.problem = ''
        """Why the bag ends early; '' if it does not."""
        self._times: LockstepTimes | None = None
        if lockstep:
            clock = PolledSubscription(self, Clock, '/clock', ALL)
            self._times = LockstepTimes(clock)
        # A topic may be found while the bag is being closed; then it comes too late.
        self._discovering = threading.Lock()
        self._thread = threading.Thread(target=self._write_all, name='bag writer', daemon=True)
        self._thread.start()
        self.create_timer(DISCOVERY_PERIOD, self._discover)

    def records(self, topics: Iterable[str]) -> bool:
        """Every one of these topics is subscribed and has a publisher."""
        found = {name for name, (_, messages) in list(self._topics.items()) if messages.publishers > 0}
        return all((topic if topic.startswith('/') else self._prefix + topic) in found for topic in topics)

    def recorded(self, topics: Iterable[str]) -> frozenset[str] | None:
        """Those of the topics, by their full names, that it records; None until it is subscribed to these."""
        found = frozenset(topic for topic in topics if self._records(topic)) - self._left_out
        return found if found <= self._topics.keys() else None

    def expect_instants(self, count: int, last: int) -> None:
        """So many instants of a lock-step run have begun, the last one at this time (ns)."""
        if self._times is not None:
            self._times.expect(count, last)

    def missing(self, sent: Mapping[str, int]) -> str:
        """What has not come yet of so many messages by topic; '' if all have, or the bag has ended."""
        if self.problem or self.closed:
            return ''
        return '; '.join(
            f'{self._received[topic]} of {count} messages on {topic} have come'
            for topic, count in sent.items()
            if self._received[topic] < count
        )

    @property
    def closed(self) -> bool:
        """The bag is complete."""
        return self._closed.is_set()

    def close(self) -> None:
        """Write what has come and close the bag; further calls do nothing."""
        with self._discovering:
            self._closed.set()
        self._thread.join()

    def _discover(self) -> None:
        with self._discovering:
            if not (self._closed.is_set() or self.problem):
                self._find_topics()

    def _records(self, topic: str) -> bool:
        known = topic.startswith((self._prefix, '/diagnostics', '/rosout'))
        if HIDDEN in topic:  # as of actions, whose messages have no types of their own
            return False
        return known and not (is_of_protocol(topic) or topic.endswith(f'/{HEARTBEAT}'))

    def _find_topics(self) -> None:
        for topic, types in self.get_topic_names_and_types():
            if topic in self._topics or topic in self._left_out or not self._records(topic):
                continue
            publishers = self.get_publishers_info_by_topic(topic)
            if not publishers:
                continue
            try:
                self._topics[topic] = self._subscribe(topic, types[0], publishers)
            except Exception as error:  # noqa: BLE001  # whatever foreign packages raise when imported
                self._left_out.add(topic)
                self.get_logger().warning(f'{topic} is not recorded: {error}')  # type: ignore[no-untyped-call]

    def _subscribe(
        self, topic: str, type_name: str, publishers: list[TopicEndpointInfo]
    ) -> tuple[Connection, PolledSubscription]:
        latched = all(p.qos_profile.durability is DurabilityPolicy.TRANSIENT_LOCAL for p in publishers)
        reliable = all(p.qos_profile.reliability is ReliabilityPolicy.RELIABLE for p in publishers)
        qos = QoSProfile(
            depth=QUEUE_DEPTH,
            reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        )
        if type_name not in self._typestore.types:
            raise InvalidInputError(f'{type_name} is no message type that a bag can have')
        subscription = PolledSubscription(self, message_class(type_name), topic, qos, raw=True)
        with self._writing:
            connection = self._writer.add_connection(
                topic,
                type_name,
                typestore=self._typestore,
                offered_qos_profiles=[_bag_qos(p.qos_profile) for p in publishers],
            )
        return connection, subscription

    def _write_all(self) -> None:
        unsaved, saved = False, time.monotonic()
        try:
            while not self._closed.wait(WRITE_PERIOD):
                unsaved |= self._write_what_came()
                if unsaved and time.monotonic() - saved >= FLUSH_PERIOD:
                    with self._writing:
                        self._writer.flush()
                    unsaved, saved = False, time.monotonic()
            self._write_what_came(last=True)
            self._writer.close()
        except RobotsError as error:
            self.problem = str(error)
            self.get_logger().error(self.problem)  # type: ignore[no-untyped-call]

    def _write_what_came(self, *, last: bool = False) -> bool:
        # Sent, not received: topics keep their order to each other however late they come in.
        messages: Iterable[Sent] = [
            (info['source_timestamp'], connection, data)
            for connection, subscription in list(self._topics.values())
            for data, info in subscription.take_all()
        ]
        self._received.update(connection.topic for _, connection, _ in messages)
        if self._times is not None:
            messages = self._times.stamped(messages, last=last)
        written = False
        for stamp, connection, data in messages:
            with self._writing:
                self._writer.write(connection, stamp, data)
            written = True
        if self._times is not None:
            self._received['/clock'] = self._times.count
        return written


def _bag_qos(profile: QoSProfile) -> Qos:
    return bag_qos(
        latched=profile.durability is DurabilityPolicy.TRANSIENT_LOCAL,
        reliable=profile.reliability is ReliabilityPolicy.RELIABLE,
        depth=profile.depth,
    )
