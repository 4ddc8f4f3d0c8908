"""Forces on arm and rover in a recorded run of the program, and how far both stay apart."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.joint_rows import joint_rows
from robots_core import BaseRobotModel, load_robot_model
from robots_core.blocks import CollisionDetection, NumericalDynamics, read_scene
from robots_core.blocks.multibody.payload import payload_of
from robots_core.validation import Array
from robots_planning.motion_settings import NOTHING

ROBOT: Final = 'rover_jaco'
RATE: Final = 25.0  # Hz


@dataclass(frozen=True, eq=False)
class RecordedMission:
    """A run, sampled at `RATE`. Times are in s since the first reference.

    Attributes:
        robot: Rover and arm.
        time: (k,).
        position: Joint positions, (k, n).
        tool: Positions of the hand, (k, 3) m.
        torque: That the motion takes, with the payload of its time, (k, n) N m (N).
        ground: Force (N) and moment (N m) of the ground on the rover, at the base frame, (k, 6).
        mass: Of the payload, (k,) kg.
        clearance: Of arm and package to the rover and what is around, (k,) m.
    """

    robot: BaseRobotModel
    time: Array
    position: Array
    tool: Array
    torque: Array
    ground: Array
    mass: Array
    clearance: Array


def read_mission(run: Path | str, scene: Path | str) -> RecordedMission:
    """Read a run of the program.

    Args:
        run: Bag of `simulate` or `cell`.
        scene: That of the program.

    Raises:
        RobotsError: not readable.
    """
    robot = load_robot_model(ROBOT)
    bag = read_bag(run)
    rows = joint_rows(bag, '/joint_reference', robot)
    step = max(1, round(1.0 / (RATE * rows.period)))
    q, q_dot, q_ddot = (np.asarray(values)[::step] for values in rows.values)
    stamp = rows.stamp[::step]
    times = 1e-9 * (stamp - rows.stamp[0])
    payloads = _payloads(bag, stamp)
    models = {values: NumericalDynamics(robot, payload=payload_of(values)) for values in set(payloads)}
    found = [
        (models[values].torques(*state), models[values].base_wrench(*state))
        for values, *state in zip(payloads, q, q_dot, q_ddot, strict=True)
    ]
    collision = CollisionDetection(robot, scene=read_scene(scene))
    return RecordedMission(
        robot,
        times,
        q,
        np.array([robot.direct_kinematics(row)[0] for row in q]),
        np.array([torque for torque, _ in found]),
        np.array([wrench for _, wrench in found]),
        np.array([values[0] for values in payloads]),
        np.array([_clearance(collision, row) for row in q]),
    )


def _clearance(collision: CollisionDetection, q: Array) -> float:
    closest = collision.distance(q)
    return np.inf if closest is None else closest.distance


def _payloads(bag: Bag, stamps: NDArray[np.int64]) -> list[tuple[float, ...]]:
    """What the settings said that the arm carries, at each of the stamps (k,), ns."""
    set_at, values = [0], [tuple(NOTHING)]
    for stamp, message in bag.deserialized(['/motion_settings'])['/motion_settings']:
        found = {item.key: item.value for item in message.values}
        set_at.append(stamp)
        values.append(tuple(json.loads(found['payload'])))
    return [values[row - 1] for row in np.searchsorted(set_at, stamps, side='right')]


def describe(mission: RecordedMission) -> list[str]:
    """Figures of the run, in lines."""
    used = np.abs(mission.torque) / mission.robot.axes_data.effort
    axis = int(used.max(axis=0).argmax())
    tilt = np.linalg.norm(mission.ground[:, 3:5], axis=1)
    low, high = mission.ground[:, 2].min(), mission.ground[:, 2].max()
    return [
        f'largest torque: {mission.robot.axes_data.names[axis]} at {100.0 * used.max():.0f} % of its limit',
        f'ground on the rover: {low:.0f} to {high:.0f} N; tilting moment at most {tilt.max():.0f} N m',
        f'payload: 0 to {mission.mass.max():g} kg',
        f'arm and package come as close as {1e3 * mission.clearance.min():.1f} mm to rover, ground and rock',
    ]
