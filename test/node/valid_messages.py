"""Valid messages, as the topics of the suite carry them: what generated ones are made from."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from builtin_interfaces.msg import Duration, Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import PoseStamped, Transform, Twist
from nav_msgs.msg import Path
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, Float64MultiArray, String, UInt8MultiArray
from trajectory_msgs.msg import (
    JointTrajectory,
    JointTrajectoryPoint,
    MultiDOFJointTrajectory,
    MultiDOFJointTrajectoryPoint,
)
from visualization_msgs.msg import Marker, MarkerArray

from robots_core import BaseRobotModel, Pose
from robots_core.ros.messages import BUILD, diagnostic_status, doubles
from robots_planning.motion_settings import MotionSettings, settings_status

SHAPES: Final = (Marker.CUBE, Marker.SPHERE, Marker.CYLINDER, Marker.TRIANGLE_LIST, Marker.MESH_RESOURCE)


def valid_messages(kind: type, robot: BaseRobotModel, stamp: Time) -> list[Any]:
    """Messages of a class, the first without effect on a robot that stands at its home."""
    make = _MAKERS.get(kind)
    return [kind()] if make is None else make(robot, stamp)


def _joint_states(robot: BaseRobotModel, stamp: Time) -> list[Any]:
    still = doubles(np.zeros(robot.num_axes))
    rows = {'position': doubles(robot.home), 'velocity': still, 'effort': still}
    message = JointState(name=list(robot.axes_data.names), **rows)
    message.header.stamp = stamp
    return [message]


def _trajectories(robot: BaseRobotModel, stamp: Time) -> list[Any]:
    names, still = list(robot.axes_data.names), doubles(np.zeros(robot.num_axes))
    rows = {'positions': doubles(robot.home), 'velocities': still, 'accelerations': still}
    points = [JointTrajectoryPoint(time_from_start=Duration(sec=sec), **rows) for sec in range(3)]
    long = JointTrajectory(joint_names=names, points=points)
    long.header.stamp = stamp
    return [JointTrajectory(joint_names=names, points=points[:1]), JointTrajectory(joint_names=names), long]


def _poses(robot: BaseRobotModel, stamp: Time) -> list[Any]:
    return [BUILD.pose_stamped(stamp, Pose(*robot.direct_kinematics(robot.home)))]


def _statuses(_: BaseRobotModel, __: Time) -> list[Any]:
    pairs = {'id': '1.000000000', 'ended': '1.0', 'progress': '0.5', 'payload': '[1, 0, 0, 0]'}
    plc = {'script': 'press.yaml', 'pending': '[[1.0, 7, {"digital_input.1": 1.0}]]'}
    return [
        diagnostic_status('motion', '', **pairs),
        diagnostic_status('motion', '', level=DiagnosticStatus.ERROR, **pairs),
        diagnostic_status('settings', '', **settings_status(MotionSettings()).values),
        diagnostic_status('plc', '', **plc),
    ]


def _base_motions(_: BaseRobotModel, __: Time) -> list[Any]:
    point = MultiDOFJointTrajectoryPoint(
        transforms=[Transform()], velocities=[Twist()], accelerations=[Twist()]
    )
    return [MultiDOFJointTrajectory(joint_names=['base'], points=[point])]


def _markers(robot: BaseRobotModel, _: Time) -> list[Any]:
    home = robot.pose(robot.home)
    pose = BUILD.pose(home.r, home.quaternion())
    markers = [Marker(ns=str(shape), type=shape, pose=pose) for shape in SHAPES]
    for marker in markers:
        marker.scale.x = marker.scale.y = marker.scale.z = 0.1
    return [MarkerArray(markers=[one]) for one in (Marker(action=Marker.DELETEALL), *markers)]


_MAKERS: Final[dict[type, Callable[[BaseRobotModel, Time], list[Any]]]] = {
    JointState: _joint_states,
    JointTrajectory: _trajectories,
    PoseStamped: _poses,
    Path: lambda robot, stamp: [Path(poses=2 * _poses(robot, stamp))],
    DiagnosticStatus: _statuses,
    MultiDOFJointTrajectory: _base_motions,
    MarkerArray: _markers,
    Float64: lambda _, __: [Float64(data=0.5)],
    Bool: lambda _, __: [Bool(data=False), Bool(data=True)],
    String: lambda _, __: [String(data='SENSOR'), String(data='NONE')],
    UInt8MultiArray: lambda _, __: [UInt8MultiArray(data=16 * [0, 1])],
    Float64MultiArray: lambda _, __: [Float64MultiArray(data=16 * [0.5])],
}
