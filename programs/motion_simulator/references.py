"""Make the bag that guides the robot: the motion of a vehicle, and the poses of the flange that cue it.

Run `PYTHONPATH=$PYTHONPATH:programs python -m motion_simulator.references --to FOLDER`, with `--imu BAG` for
a motion of your own.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter
from pathlib import Path
from typing import Any, Final

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from motion_simulator.cabin import RATE, cue, flange, flange_twist
from motion_simulator.double_lane_change import DoubleLaneChange
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_qos import bag_qos
from robots_controller.simulation.record import ros_messages as ros
from robots_core import Pose
from robots_core.blocks import CueingStep, VehicleMotion
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.validation import Array

IMU: Final = '/vehicle_imu'
POSE: Final = '/reference_pose'
TWIST: Final = '/reference_twist'
TYPES: Final = {
    IMU: 'sensor_msgs/msg/Imu',
    POSE: 'geometry_msgs/msg/PoseStamped',
    TWIST: 'geometry_msgs/msg/TwistStamped',
}
IMU_RATE: Final = 50.0  # Hz, of the generated manoeuvre
SHORTEST: Final = 2  # samples
# Without a sample for this long there is none to interpolate to.
GAP: Final = 0.1  # s
NANOSECONDS: Final = 1_000_000_000
START: Final = 1_600_000_000 * NANOSECONDS  # a day long past


@dataclass(frozen=True, eq=False)
class VehicleRecording:
    """Samples of a vehicle's motion.

    Attributes:
        time: Of the samples, (k,) s, increasing.
        motions: k of them.
    """

    time: Array
    motions: Sequence[VehicleMotion]

    def sampled(self) -> list[VehicleMotion | None]:
        """Interpolated to a sample each 1/`RATE`; None within gaps of more than `GAP`."""
        values = np.array([[*motion.specific_force, *motion.angular_velocity] for motion in self.motions])
        now = np.arange(self.time[0], self.time[-1], 1.0 / RATE)
        after = np.searchsorted(self.time, now, side='right')
        inside = self.time[after] - self.time[after - 1] <= GAP
        rows = np.array([np.interp(now, self.time, column) for column in values.T]).T
        return [
            VehicleMotion(row[:3], row[3:]) if here else None for row, here in zip(rows, inside, strict=True)
        ]


def lane_change() -> VehicleRecording:
    """The generated manoeuvre."""
    manoeuvre = DoubleLaneChange()
    time = np.arange(0.0, manoeuvre.duration, 1.0 / IMU_RATE)
    return VehicleRecording(time, [manoeuvre.motion(now) for now in time])


def recorded(path: Path | str, topic: str = IMU) -> VehicleRecording:
    """A recorded motion.

    Args:
        path: A bag.
        topic: Of its sensor_msgs/Imu, in the vehicle's frame at the driver's head.

    Raises:
        RobotsError: not a readable bag, no such topic, or a value that is not finite.
    """
    bag = read_bag(path)
    kind = bag.topics[topic].type if topic in bag.topics else 'nothing'
    if kind != TYPES[IMU]:
        topics = ', '.join(bag.topics)
        raise RobotsError(f'{path}: {topic} must be {TYPES[IMU]}, found is {kind}; it holds {topics}')
    messages = [message for _, message in bag.deserialized([topic])[topic]]
    stamps = [message.header.stamp for message in messages]
    # In whole numbers: seconds since 1970 are 1e-7 s apart.
    nanoseconds = np.array([stamp.sec * NANOSECONDS + stamp.nanosec for stamp in stamps], np.int64)
    time = (nanoseconds - nanoseconds[:1]) / NANOSECONDS
    if len(time) < SHORTEST or (np.diff(time) <= 0.0).any():
        raise InvalidInputError(
            f'{path}: {topic} has {len(time)} messages; needed are {SHORTEST} or more with increasing stamps'
        )
    motions = []
    for number, message in enumerate(messages, 1):
        f, w = message.linear_acceleration, message.angular_velocity
        try:
            motions.append(VehicleMotion(np.array([f.x, f.y, f.z]), np.array([w.x, w.y, w.z])))
        except InvalidInputError as error:
            raise InvalidInputError(f'{path}: message {number} of {topic}: {error}') from error
    return VehicleRecording(time, motions)


def write(path: Path, recording: VehicleRecording, steps: Sequence[CueingStep]) -> None:
    """Write a bag of a motion and of the poses that cue it; the folder must not exist."""
    messages = [
        (_stamp(time), IMU, _imu(_stamp(time), motion))
        for time, motion in zip(recording.time, recording.motions, strict=True)
    ]
    for number, step in enumerate(steps):
        stamp = _stamp(number / RATE)
        messages.append((stamp, POSE, _pose(stamp, flange(step))))
        messages.append((stamp, TWIST, _twist(stamp, flange_twist(step))))
    writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    qos = [bag_qos(latched=False)]
    with writer:
        connections = {
            topic: writer.add_connection(topic, kind, typestore=ros.typestore(), offered_qos_profiles=qos)
            for topic, kind in TYPES.items()
        }
        for stamp, topic, message in sorted(messages, key=itemgetter(0)):
            writer.write(connections[topic], stamp, ros.typestore().serialize_cdr(message, TYPES[topic]))


def _numbers(type_name: str, values: Array) -> Any:
    """A message of numbers, rounded to single precision (1e-7 m): a compressed bag is much smaller so."""
    return ros.message(f'geometry_msgs/msg/{type_name}', *values.astype(np.float32).tolist())


def _pose(stamp: int, pose: Pose) -> Any:
    parts = _numbers('Point', pose.r), _numbers('Quaternion', pose.quaternion())
    body = ros.message('geometry_msgs/msg/Pose', *parts)
    return ros.message(TYPES[POSE], ros.header(stamp, ros.BASE_FRAME), body)


def _twist(stamp: int, twist: Array) -> Any:
    body = ros.message('geometry_msgs/msg/Twist', *(_numbers('Vector3', row) for row in twist.reshape(2, 3)))
    return ros.message(TYPES[TWIST], ros.header(stamp, ros.BASE_FRAME), body)


def _stamp(time: float) -> int:
    return START + round(time * NANOSECONDS)


def _imu(stamp: int, motion: VehicleMotion) -> Any:
    unknown, none = np.array([-1.0, *[0.0] * 8]), np.zeros(9)  # as the message's definition has it
    rate, force = (_numbers('Vector3', row) for row in (motion.angular_velocity, motion.specific_force))
    level = _numbers('Quaternion', np.array([0.0, 0.0, 0.0, 1.0]))
    return ros.message(TYPES[IMU], ros.header(stamp, 'vehicle'), level, unknown, rate, none, force, none)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog='motion_simulator.references', description=__doc__)
    parser.add_argument(
        '--imu', type=Path, metavar='BAG', help='a recorded motion; the double lane change by default'
    )
    parser.add_argument('--topic', default=IMU, help='its topic, sensor_msgs/Imu; %(default)s by default')
    parser.add_argument(
        '--to', type=Path, required=True, metavar='FOLDER', help='bag to write; must not exist'
    )
    options = parser.parse_args(arguments)
    recording = lane_change() if options.imu is None else recorded(options.imu, options.topic)
    steps = cue(recording.sampled())
    write(options.to, recording, steps)
    print(f'{options.to}: {len(steps) / RATE:.2f} s')
    for reason, count in reasons(steps).items():
        print(f'  {count / RATE:.2f} s: {reason}')


def reasons(steps: Sequence[CueingStep]) -> dict[str, int]:
    """What was limited and in how many steps, each kind by its first case."""
    found: dict[str, tuple[str, int]] = {}
    for step in steps:
        for limit in step.limits:
            kind = ' '.join(word for word in limit.split() if not any(c.isdigit() for c in word))
            first, count = found.get(kind, (limit, 0))
            found[kind] = (first, count + 1)
    return dict(found.values())


if __name__ == '__main__':
    main()
