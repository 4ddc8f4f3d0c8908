"""What a recorded run of the wheel laboratory has measured, run by run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from robots_controller.cell.contact_setup import ContactSetup
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.joint_rows import JointRows, joint_rows
from robots_core import load_robot_model
from robots_core.errors import RobotsError
from robots_core.validation import Array

ROBOT: Final = 'kuka_kr210_r3100'
SECOND: Final = 1_000_000_000  # ns
EVERY: Final = 5  # samples of the recording, of which one is evaluated
UNSTEADY: Final = 0.05  # part of the usual speed that the speed may differ from it
STEADY: Final = 0.6  # part of the time of driving after which forces are steady


@dataclass(frozen=True, eq=False)
class WheelRun:
    """The wheel pressed, driven with one slip. Arrays are (k,), times in s since force control began.

    Attributes:
        wanted: Load to press with, N.
        slip: Of the wheel's drive.
        driving: Since when it drives, s.
        time: Of the samples.
        load: Upward force of the soil, N.
        drawbar_pull: Its forward force, N.
        torque: Of the wheel's drive, N m.
        sinkage: m.
        speed: Of the hub, m/s.
        wheel_speed: Angular velocity of the wheel, rad/s.
    """

    wanted: float
    slip: float
    driving: float
    time: Array
    load: Array
    drawbar_pull: Array
    torque: Array
    sinkage: Array
    speed: Array
    wheel_speed: Array

    def steady(self, name: str) -> Array:
        """The samples of a quantity while the wheel drives and the forces are steady, at least one."""
        since = self.driving + STEADY * (self.time[-1] - self.driving)
        late = self.time >= since
        usual = float(np.median(self.speed[late]))
        return np.asarray(getattr(self, name)[late & (np.abs(self.speed - usual) <= UNSTEADY * abs(usual))])


def read_runs(path: Path | str, setup: ContactSetup) -> list[WheelRun]:
    """The runs of a bag of the program.

    Args:
        path: Bag of `simulate` or `cell`.
        setup: With which it was recorded.

    Raises:
        RobotsError: not readable, or it holds no run.
    """
    bag = read_bag(path)
    found = bag.deserialized(['/measured_wrench', '/analog_outputs'])
    spans = _spans(found['/analog_outputs'], setup)
    if not spans or not found['/measured_wrench']:
        raise RobotsError(f'{path} holds no run of the wheel laboratory: nothing was pressed and driven')
    wrenches = {_stamp(m): _values(m.wrench) for _, m in found['/measured_wrench']}
    states = joint_rows(bag, '/joint_states', load_robot_model(ROBOT))
    return [_run(setup, states, wrenches, *span) for span in spans]


def _run(
    setup: ContactSetup,
    states: JointRows,
    wrenches: Mapping[int, Array],
    outputs: Array,
    span: tuple[int, int, int],
) -> WheelRun:
    robot, (start, drive, end) = load_robot_model(ROBOT), span
    position = states.values[0]
    assert position is not None
    rows, up = [], np.array([0.0, 0.0, 1.0])
    bottom = setup.bed.height + setup.wheel.radius
    inside = np.flatnonzero((states.stamp >= start) & (states.stamp <= end))[::EVERY]
    for k in inside:
        stamp = int(states.stamp[k])
        if stamp not in wrenches:
            continue
        r, T = robot.direct_kinematics(position[k])
        hub, ahead = r + T @ setup.hub, T @ setup.forward
        force, torque = T @ wrenches[stamp][:3], T @ wrenches[stamp][3:]
        at_hub = torque - np.cross(T @ setup.hub, force)
        drive_torque = -at_hub @ np.cross(up, ahead)
        place = (bottom - hub[2], hub @ ahead)
        rows.append(((stamp - start) / SECOND, force @ up, force @ ahead, drive_torque, *place))
    time, load, pull, torque, sinkage, way = np.array(rows).T
    # Not the reported velocities: drives are not exact in these.
    speed = np.gradient(way, time)
    slip = float(outputs[setup.slip.index - 1])
    return WheelRun(
        wanted=float(outputs[setup.load.index - 1]),
        slip=slip,
        driving=(drive - start) / SECOND,
        time=time,
        load=load,
        drawbar_pull=pull,
        torque=torque,
        sinkage=sinkage,
        speed=speed,
        wheel_speed=speed / (setup.wheel.radius * (1.0 - slip)),
    )


def _spans(messages: list[tuple[int, Any]], setup: ContactSetup) -> list[tuple[Array, tuple[int, int, int]]]:
    """Of each run its outputs, and when it is pressed, driven and ended, ns."""
    spans, start, drive, driven = [], 0, 0, np.zeros(0)
    for stamp, message in messages:
        load, speed = (float(message.data[channel.index - 1]) for channel in (setup.load, setup.speed))
        if load > 0.0 and not start:
            start = stamp
        if speed > 0.0 and start and not drive:
            drive, driven = stamp, np.array(message.data)
        if load == 0.0:
            if drive:
                spans.append((driven, (start, drive, stamp)))
            start = drive = 0
    return spans


def _stamp(message: Any) -> int:
    return int(message.header.stamp.sec) * SECOND + int(message.header.stamp.nanosec)


def _values(wrench: Any) -> Array:
    f, m = wrench.force, wrench.torque
    return np.array([f.x, f.y, f.z, m.x, m.y, m.z])
