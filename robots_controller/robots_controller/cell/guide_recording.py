"""GuideRecording: the messages with which a sensor or a person guided a robot, read from a bag."""

from __future__ import annotations

import math
import struct
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.joint_rows import seconds
from robots_core.base_frames import AT_BASE, frame_in_base
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.motion_cueing.driven_vehicle import DriverInputs
from robots_core.blocks.motion_cueing.vehicle_inputs import INPUTS, read_input
from robots_core.blocks.motion_cueing.vehicle_motion import VehicleMotion
from robots_core.errors import BagError, InvalidInputError, RobotsError
from robots_core.pose import Pose
from robots_core.validation import Array, finite_vector
from robots_planning.guidance.jog_axes import JogAxes, jog_axes

NANOSECONDS: Final = 1_000_000_000
GUIDES: Final[Mapping[Guide, tuple[str, ...]]] = {
    Guide.SENSOR: ('reference_pose', 'reference_twist'),
    Guide.PERSON: ('teach_twist', 'teach_joints'),
}
"""Topics that guide a robot, by what guides it; a twist beside poses says how they move."""
# CDR: an encapsulation, whose second byte is 1 for little-endian numbers, and then the header's stamp.
STAMP_OFFSET: Final = 4
# A stamp that is farther from when its message was sent is of another clock.
SAME_CLOCK: Final = 1.0  # s


@dataclass(frozen=True, eq=False)
class GuidingMessage:
    """A message that guides the robot. Times are in ns, in a recording since the robot was handed over.

    Attributes:
        topic: One of `GUIDES`, or of the `INPUTS` of a cabin.
        time: When it came.
        valid: When its content was valid, by its stamp.
        data: The whole message, serialized; b'' for one that was not recorded.
        value: A `Pose`, a twist (6,) in m/s and rad/s, or the joints' velocities (n,) in rad/s (m/s); for a
            cabin, a driver's inputs or the motion of a vehicle.
        frame: Of a twist to jog with.
    """

    topic: str
    time: int
    valid: int
    data: bytes = field(repr=False)
    value: Pose | Array | DriverInputs | VehicleMotion
    frame: JogAxes = 'base'

    def replayed(self, start: int) -> GuidingMessage:
        """The message with the times and the stamp of a replay that begins at `start`, ns."""
        data, valid = bytearray(self.data), start + self.valid
        words = struct.Struct('<iI' if data[1] & 1 else '>iI')
        words.pack_into(data, STAMP_OFFSET, *divmod(valid, NANOSECONDS))
        return replace(self, time=start + self.time, valid=valid, data=bytes(data))


@dataclass(frozen=True, eq=False)
class GuideRecording:
    """What guides a robot from when it is handed over.

    Attributes:
        path: The bag.
        messages: In order.
        types: package/msg/Name of their topics.
        guides: Topics, by what guides a robot.
    """

    path: Path
    messages: tuple[GuidingMessage, ...] = field(repr=False)
    types: Mapping[str, str]
    guides: Mapping[Guide, tuple[str, ...]] = field(default_factory=lambda: GUIDES)

    def check(self, guide: Guide) -> None:
        """Check that it holds something of this guide.

        Raises:
            RobotsError: it holds nothing for it.
        """
        needed = self.guides[guide]
        if not self.types.keys() & set(needed):
            raise BagError(
                f'{self.path} holds no {" or ".join(needed)}, only {", ".join(sorted(self.types))}'
            )


class GuideReplay:
    """Plays a recording from when the program hands its robot over for the first time.

    Jog commands that come while the program does not let anybody jog are left out.
    """

    def __init__(self, recording: GuideRecording) -> None:
        self.recording = recording
        self.types = recording.types
        self._messages = deque(recording.messages)
        self._guide = Guide.NONE
        self.start: int | None = None
        """When the robot was handed over for the first time, ns; None before."""

    @property
    def next_time(self) -> float:
        """When the next message comes, ns; infinite for never."""
        if self.start is None or not self._messages:
            return math.inf
        return self.start + self._messages[0].time

    def hand_over(self, guide: Guide, now: int) -> None:
        """The program hands the robot over, or takes it back.

        Args:
            guide: SENSOR or PERSON; NONE takes it back.
            now: ns.

        Raises:
            RobotsError: nothing of it is recorded.
        """
        if guide is not Guide.NONE:
            self.recording.check(guide)
            if self.start is None:
                self.start = now
        self._guide = guide

    def due(self, now: int) -> Iterator[GuidingMessage]:
        """The messages that have come until `now` (ns), with the times and stamps of this replay."""
        while self.next_time <= now:
            assert self.start is not None
            message = self._messages.popleft()
            if message.topic not in GUIDES[Guide.PERSON] or self._guide is Guide.PERSON:
                yield message.replayed(self.start)


def read_guide_recording(
    path: Path | str, joints: Sequence[str], *, base_link: Pose = AT_BASE, cabin: bool = False
) -> GuideRecording:
    """Read what guided a robot, from a recording of a sensor or of a whole cell.

    It begins where the recorded cell handed its robot over for the first time (its topic `guide`),
    or with the first message that guides.

    Args:
        path: A rosbag2 folder, or one .mcap or .db3 file.
        joints: Names of the robot's n joints.
        base_link: See `BaseRobotModel.base_link`.
        cabin: The robot carries a cabin, and its driver's inputs or the motion of a vehicle are read in the
            place of references.

    Raises:
        RobotsError: not a readable bag, or a message in it that is not valid.
    """
    bag = read_bag(path)
    guides = {**GUIDES, Guide.SENSOR: tuple(INPUTS)} if cabin else GUIDES
    topics = [f'/{topic}' for guide in guides for topic in guides[guide]]
    found = bag.deserialized([*topics, '/guide'])
    start = _start(bag, topics, [stamp for topic in topics for stamp, _ in found[topic]], found['/guide'])
    values = {topic: enumerate(found[topic], 1) for topic in topics}
    messages = []
    for topic, stamp, data in bag.messages:
        if topic not in values:
            continue
        number, (_, message) = next(values[topic])
        if stamp < start:
            continue
        try:
            value, frame = _value(topic, message, joints, base_link)
        except (AttributeError, RobotsError) as error:
            raise BagError(f'{bag.path}: message {number} of {topic}: {error}') from error
        stamped = round(seconds(message.header.stamp) * NANOSECONDS)
        valid = min(stamped, stamp) if abs(stamped - stamp) < SAME_CLOCK * NANOSECONDS else stamp
        messages.append(GuidingMessage(topic[1:], stamp - start, valid - start, data, value, frame))
    types = {message.topic: bag.topics[f'/{message.topic}'].type for message in messages}
    return GuideRecording(bag.path, tuple(messages), types, guides)


def _start(bag: Bag, topics: Sequence[str], stamps: Sequence[int], guides: Sequence[tuple[int, Any]]) -> int:
    handed_over = [stamp for stamp, guide in guides if guide.data in {*GUIDES}]
    first = handed_over[0] if handed_over else min(stamps, default=None)
    if first is None or max(stamps, default=first - 1) < first:
        needed = ', '.join(topic[1:] for topic in topics)
        raise BagError(
            f'{bag.path} holds nothing that guides a robot: needed is one of {needed}; it holds '
            f'{", ".join(sorted(bag.topics)) or "nothing"}'
        )
    return first


def _value(
    topic: str, message: Any, joints: Sequence[str], base_link: Pose
) -> tuple[Pose | Array | DriverInputs | VehicleMotion, JogAxes]:
    if topic[1:] in INPUTS:
        return read_input(topic[1:], message), 'base'
    match topic:
        case '/reference_pose':
            p, o = message.pose.position, message.pose.orientation
            pose = Pose.from_quaternion([p.x, p.y, p.z], [o.x, o.y, o.z, o.w])
            return frame_in_base(message.header.frame_id, base_link) @ pose, 'base'
        case '/teach_joints':
            return _velocities(message, joints), 'base'
    v, w = message.twist.linear, message.twist.angular
    twist = finite_vector([v.x, v.y, v.z, w.x, w.y, w.z], 6, 'twist')
    if topic == '/teach_twist':
        return twist, jog_axes(message.header.frame_id)
    turn = frame_in_base(message.header.frame_id, base_link).T
    return np.ravel(twist.reshape(2, 3) @ turn.T), 'base'


def _velocities(message: Any, joints: Sequence[str]) -> Array:
    missing = [name for name in joints if name not in message.name]
    if missing or len(message.velocity) != len(message.name):
        raise InvalidInputError(
            f'it has {len(message.velocity)} velocities of {", ".join(message.name) or "no joint"}; '
            f'needed is one of each of {", ".join(joints)}'
        )
    columns = [list(message.name).index(name) for name in joints]
    return finite_vector(np.asarray(message.velocity)[columns], len(joints), 'velocity')
