"""A recorded vehicle motion, replayed into nodes in lock-step: the paper's motion simulator (section 5.1)."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from scipy.spatial.transform import Rotation
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.bags.bag_player import BagPlayer
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_core import Pose, load_robot_model
from robots_core.ros.lockstep.phases import START
from robots_core.ros.qos import COMMAND
from robots_core.ros.timed_node import TimedNode

from .node_process import node_process

ROBOT = load_robot_model('kuka_kr500_r2830')
AXES = ROBOT.axes_data
NAMES = list(AXES.names)
# Elbow and wrist bent: a cabin moves about here in all six directions.
CABIN = np.array([0.0, -1.3, 1.8, 0.0, 0.9, 0.0])
RATE = 100.0  # Hz, of the recorded motion and the references
DT = 1.0 / RATE
SINES = 3.0  # s
IMPACTS = ((4.0, 4.03), (4.5, 4.51))  # s
DURATION, REST = 5.0, 1.5  # s
RECORDED_AT = 1_600_000_000.0  # s: stamps of a day long past


def vehicle_motion(t: float) -> Pose:
    """Sums of sines as of a road, then steps, then impacts that no robot can follow."""
    fade = min(t, 1.0) ** 2 * (3.0 - 2.0 * min(t, 1.0)) if t < SINES else 1.0
    waves = [(0.02, 0.35, 0.3), (0.008, 0.9, 1.1), (0.002, 2.1, 2.0)]  # m, Hz, rad
    away = np.zeros(6)
    for axis in range(6):
        for size, frequency, phase in waves:
            size_here = size if axis < 3 else 0.7 * size
            away[axis] += size_here * (
                np.sin(2.0 * np.pi * frequency * t + phase * (axis + 1)) - np.sin(phase * (axis + 1))
            )
    away *= fade
    if t >= SINES:
        away *= 0.3
        # A step every half second.
        away[:3] += 0.1 * np.array([1.0, -1.0, 0.5]) * (int(2.0 * (t - SINES)) % 2)
        if any(begin <= t < end for begin, end in IMPACTS):
            away += np.array([0.5, 0.3, -0.4, 0.4, -0.3, 0.5])  # an impact: there and back within 30 ms
    r, T = ROBOT.direct_kinematics(CABIN)
    return Pose(r + away[:3], Rotation.from_rotvec(away[3:]).as_matrix() @ T)


def write_bag(path: Path) -> None:
    typestore = get_typestore(Stores.ROS2_JAZZY)
    types = typestore.types
    kind = 'geometry_msgs/msg/PoseStamped'
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection('/reference_pose', kind, typestore=typestore)
        for k in range(int(DURATION * RATE)):
            pose, nanoseconds = vehicle_motion(k / RATE), int(1e9 * (RECORDED_AT + k / RATE))
            stamp = types['builtin_interfaces/msg/Time'](*divmod(nanoseconds, 1_000_000_000))
            message = types[kind](
                types['std_msgs/msg/Header'](stamp, 'base'),
                types['geometry_msgs/msg/Pose'](
                    types['geometry_msgs/msg/Point'](*pose.r),
                    types['geometry_msgs/msg/Quaternion'](*pose.quaternion()),
                ),
            )
            writer.write(connection, nanoseconds, typestore.serialize_cdr(message, kind))


class Listener(TimedNode):
    """Collects the references and the stream that the controller follows."""

    def __init__(self, **options: Any) -> None:
        super().__init__('listener', **options)
        self.references: list[JointTrajectory] = []
        self.stream: list[JointTrajectory] = []
        self.create_subscription(JointTrajectory, 'joint_reference', self.references.append, COMMAND)
        self.create_subscription(JointTrajectory, 'joint_trajectory', self.stream.append, COMMAND)


def rows(messages: list[JointTrajectory]) -> tuple[np.ndarray, np.ndarray]:
    """Stamps (m,) s and positions, velocities, accelerations (m, 3, n)."""
    stamps = np.array([m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in messages])
    values = [(m.points[0].positions, m.points[0].velocities, m.points[0].accelerations) for m in messages]
    return stamps, np.array(values)


def check_limits(values: np.ndarray) -> None:
    """Positions, velocities and accelerations, as stated and as differences of the positions."""
    q, q_dot, q_ddot = values[:, 0], values[:, 1], values[:, 2]
    within = 1.0 + 1e-5  # second differences of positions over (10 ms)^2 round to 1e-9 rad/s^2 of 1 rad/s^2
    assert (q >= AXES.lower - 1e-9).all()
    assert (q <= AXES.upper + 1e-9).all()
    assert (np.abs(q_dot) <= AXES.velocity * within).all()
    assert (np.abs(q_ddot) <= AXES.acceleration * within).all()
    assert (np.abs(np.diff(q, axis=0)) <= AXES.velocity * DT * within).all()
    assert (np.abs(np.diff(q, 2, axis=0)) <= AXES.acceleration * DT**2 * within).all()


def test_vehicle_motion_is_followed_inside_all_limits(ros_nodes: Any, tmp_path: Path) -> None:
    write_bag(tmp_path / 'bag')
    plan = replay_plan(read_bag(tmp_path / 'bag'))
    robot = {'robot_model': ROBOT.name, 'rate': RATE, 'lockstep': True}
    with (
        node_process('robots_core', 'drive_node', initial_position=CABIN.tolist(), **robot),
        node_process('robots_controller', 'controller_node', **robot),
        node_process('robots_core', 'inverse_kinematics_node', **robot),
    ):
        listener = ros_nodes.add(Listener(**ros_nodes.options(lockstep=True)))
        ros_nodes.add(BagPlayer(plan, wait=0.0, **ros_nodes.options(lockstep=True)))
        run = ros_nodes.coordinate(
            *('listener', 'bag_player', 'drive_node', 'controller_node', 'inverse_kinematics_node')
        )
        ros_nodes.wait_for(lambda: run.time > START + round(1e9 * (DURATION + REST)), what='the end')
        ros_nodes.call(run.end)

    stamps, references = rows(listener.references)
    np.testing.assert_allclose(np.diff(stamps), DT, rtol=1e-6)  # none is missing
    check_limits(references)
    assert not references[-50:, 1].any()
    _, stream = rows(listener.stream)
    torque = [
        ROBOT.rigid_dynamics(before[0], before[1], after[2])[0]
        for before, after in itertools.pairwise(stream)
    ]
    assert (np.abs(torque) <= AXES.effort * (1.0 + 1e-6)).all()

    errors = []
    for k in range(int(DURATION * RATE)):
        index = np.searchsorted(stamps, 1e-9 * START + k / RATE)
        pose = Pose(*ROBOT.direct_kinematics(references[index, 0]))
        errors.append(pose.distance_to(vehicle_motion(k / RATE)))
    smooth = np.array(errors)[int(1.5 * RATE) : int(SINES * RATE) - 10]
    assert np.sqrt((smooth**2).mean(axis=0)).max() < 0.01  # m, rad
