"""Make the bag of a vehicle's motion that moves the cabin.

Run `PYTHONPATH=$PYTHONPATH:programs python -m motion_simulator.references --to FOLDER`, with `--imu BAG` for
a motion of your own.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from motion_simulator.double_lane_change import DoubleLaneChange
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_qos import bag_qos_of
from robots_controller.simulation.record import ros_messages as ros
from robots_core.blocks import VehicleMotion
from robots_core.blocks.motion_cueing.vehicle_inputs import INPUTS, read_input
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.validation import Array

TOPIC: Final = 'vehicle_imu'
TYPE: Final = INPUTS[TOPIC]
IMU_RATE: Final = 125.0  # Hz, of the generated manoeuvre: every second sample of the cueing
SHORTEST: Final = 2  # samples
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


def lane_change() -> VehicleRecording:
    """The generated manoeuvre."""
    manoeuvre = DoubleLaneChange()
    time = np.arange(0.0, manoeuvre.duration, 1.0 / IMU_RATE)
    return VehicleRecording(time, [manoeuvre.motion(now) for now in time])


def recorded(path: Path | str, topic: str = f'/{TOPIC}') -> VehicleRecording:
    """A recorded motion.

    Args:
        path: A bag.
        topic: Of its sensor_msgs/Imu, in the vehicle's frame at the driver's head.

    Raises:
        RobotsError: not a readable bag, no such topic, or a value that is not finite.
    """
    bag = read_bag(path)
    kind = bag.topics[topic].type if topic in bag.topics else 'nothing'
    if kind != TYPE:
        raise RobotsError(
            f'{path}: {topic} must be {TYPE}, found is {kind}; it holds {", ".join(bag.topics)}'
        )
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
        try:
            motion = read_input(TOPIC, message)
        except InvalidInputError as error:
            raise InvalidInputError(f'{path}: message {number} of {topic}: {error}') from error
        assert isinstance(motion, VehicleMotion)
        motions.append(motion)
    return VehicleRecording(time, motions)


def write(path: Path, recording: VehicleRecording) -> None:
    """Write a bag of a motion; the folder must not exist."""
    writer = Writer(path, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    with writer:
        connection = writer.add_connection(
            f'/{TOPIC}', TYPE, typestore=ros.typestore(), offered_qos_profiles=[bag_qos_of(TOPIC)]
        )
        for time, motion in zip(recording.time, recording.motions, strict=True):
            stamp = START + round(time * NANOSECONDS)
            writer.write(connection, stamp, ros.typestore().serialize_cdr(_imu(stamp, motion), TYPE))


def _numbers(type_name: str, values: Array) -> Any:
    """A message of numbers, rounded to single precision: a compressed bag is much smaller so."""
    return ros.message(f'geometry_msgs/msg/{type_name}', *values.astype(np.float32).tolist())


def _imu(stamp: int, motion: VehicleMotion) -> Any:
    unknown, none = np.array([-1.0, *[0.0] * 8]), np.zeros(9)  # as the message's definition has it
    rate, force = (_numbers('Vector3', row) for row in (motion.angular_velocity, motion.specific_force))
    level = _numbers('Quaternion', np.array([0.0, 0.0, 0.0, 1.0]))
    return ros.message(TYPE, ros.BUILD.header(stamp, 'vehicle'), level, unknown, rate, none, force, none)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(prog='motion_simulator.references', description=__doc__)
    parser.add_argument(
        '--imu', type=Path, metavar='BAG', help='a recorded motion; the double lane change by default'
    )
    parser.add_argument(
        '--topic', default=f'/{TOPIC}', help='its topic, sensor_msgs/Imu; %(default)s by default'
    )
    parser.add_argument(
        '--to', type=Path, required=True, metavar='FOLDER', help='bag to write; must not exist'
    )
    options = parser.parse_args(arguments)
    recording = lane_change() if options.imu is None else recorded(options.imu, options.topic)
    write(options.to, recording)
    print(f'{options.to}: {recording.time[-1]:.2f} s')


if __name__ == '__main__':
    main()
