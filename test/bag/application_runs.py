"""Short runs of the paper's applications, and their recordings beside this file.

`python test/bag/application_runs.py`, with `PYTHONPATH=$PYTHONPATH:test/support`, records them anew.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import Final

from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from robots_controller.program.files.program_header import read_program_header
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_qos import bag_qos
from robots_controller.simulate import simulate
from robots_controller.simulation.record import ros_messages as ros
from robots_controller.simulation.simulation_run import SimulationRun
from short_programs import short_copy

RECORDED: Final = Path(__file__).parent / 'applications'
RATE: Final = 50.0  # Hz
COMMON: Final = ('guide', 'joint_reference', 'joint_states', 'motion_result')
TOPICS: Final = {
    'motion_simulator': ('vehicle_imu',),
    'wheel_laboratory': ('measured_wrench', 'analog_outputs'),
    'debris_removal': ('base_pose', 'target_pose', 'momentum', 'grasp_status', 'digital_inputs'),
    'rover_placement': ('digital_inputs', 'digital_outputs'),
}
"""What is kept of each application, beside what is common."""


def run(name: str, folder: Path, *, references: Path | str = '') -> SimulationRun:
    """Simulate a short program in a new folder; its bag is `folder / 'bag'`."""
    program = short_copy(folder / 'programs', f'{name}.lua')
    header = read_program_header(program)
    return simulate(
        program,
        robot=header.robot,
        scene=header.scene,
        io=header.io,
        references=references or header.references,
        contact=header.contact,
        orbit=header.orbit,
        cabin=header.cabin,
        rate=RATE,
        bag=folder / 'bag',
    )


def keep(name: str, bag: Path, to: Path) -> None:
    """Write what is kept of a run's bag into a small one."""
    found, store = read_bag(bag), ros.typestore()
    kept = {f'/{topic}' for topic in (*COMMON, *TOPICS[name])}
    writer = Writer(to, version=9, storage_plugin=StoragePlugin.MCAP)
    writer.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    with writer:
        connections = {
            topic: writer.add_connection(
                topic,
                found.topics[topic].type,
                typestore=store,
                offered_qos_profiles=[bag_qos(latched=False)],
            )
            for topic in sorted(kept & {*found.topics})
        }
        for topic, stamp, data in found.messages:
            if topic in kept:
                writer.write(connections[topic], stamp, data)


def main() -> None:
    """Record all applications anew."""
    shutil.rmtree(RECORDED, ignore_errors=True)
    for name in TOPICS:
        with tempfile.TemporaryDirectory() as folder:
            result = run(name, Path(folder))
            assert result.ok, result.error
            keep(name, Path(folder) / 'bag', RECORDED / name)
        size = sum(file.stat().st_size for file in (RECORDED / name).iterdir())
        print(f'{RECORDED / name}: {size // 1000} kB')


if __name__ == '__main__':
    main()
