"""MessageBuilder: the cell's messages from plain values, of the classes of any ROS client."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final

import numpy as np

from robots_core.base_frames import BASE_FRAME, TOOL_FRAME
from robots_core.pose import Pose
from robots_core.status import Status
from robots_core.validation import Array

NANOSECONDS: Final = 1_000_000_000
Point = tuple[int, Array, Array, Array]
"""Of a trajectory: time (ns), position, velocity, acceleration."""
NONE: Final = np.zeros(0)
VALUE_TYPES: Final = (
    (bool, 'std_msgs/msg/Bool'),
    (float, 'std_msgs/msg/Float64'),
    (str, 'std_msgs/msg/String'),
)


class MessageBuilder:
    """Builds the same messages for nodes and for bags of simulations.

    Stamps are builtin_interfaces/Time of the same classes, or whole ns.

    Args:
        make: Makes a message of a type, package/msg/Name, from all its fields; takes arrays as numpy has
            them, and a DiagnosticStatus's level as a number.
    """

    def __init__(self, make: Callable[..., Any]) -> None:
        self.make = make

    def time(self, nanoseconds: int) -> Any:
        """builtin_interfaces/Time."""
        sec, nanosec = divmod(nanoseconds, NANOSECONDS)
        return self.make('builtin_interfaces/msg/Time', sec=sec, nanosec=nanosec)

    def header(self, stamp: Any, frame_id: str = '') -> Any:
        """std_msgs/Header."""
        time = self.time(stamp) if isinstance(stamp, int) else stamp
        return self.make('std_msgs/msg/Header', stamp=time, frame_id=frame_id)

    def value(self, data: bool | float | str) -> Any:  # noqa: FBT001
        """std_msgs/Bool, Float64 or String: a message of one value."""
        return self.make(next(name for kind, name in VALUE_TYPES if isinstance(data, kind)), data=data)

    def status(self, status: Status, owner: str) -> Any:
        """diagnostic_msgs/DiagnosticStatus of a robot or another owner."""
        pairs = [
            self.make('diagnostic_msgs/msg/KeyValue', key=key, value=str(value))
            for key, value in status.values.items()
        ]
        return self.make(
            'diagnostic_msgs/msg/DiagnosticStatus',
            level=int(status.level),
            name=status.name,
            message=status.text,
            hardware_id=owner,
            values=pairs,
        )

    def joint_state(
        self, stamp: Any, names: Sequence[str], q: Array = NONE, q_dot: Array = NONE, tau: Array = NONE
    ) -> Any:
        """sensor_msgs/JointState."""
        return self.make(
            'sensor_msgs/msg/JointState',
            header=self.header(stamp),
            name=list(names),
            position=q,
            velocity=q_dot,
            effort=tau,
        )

    def joint_trajectory(
        self, stamp: Any, names: Sequence[str], points: Iterable[Point], frame_id: str = ''
    ) -> Any:
        """trajectory_msgs/JointTrajectory."""
        header = self.header(stamp, frame_id)
        rows = [self._point(*point) for point in points]
        kind = 'trajectory_msgs/msg/JointTrajectory'
        return self.make(kind, header=header, joint_names=list(names), points=rows)

    def _point(self, at: int, q: Array, q_dot: Array, q_ddot: Array) -> Any:
        sec, nanosec = divmod(at, NANOSECONDS)
        return self.make(
            'trajectory_msgs/msg/JointTrajectoryPoint',
            positions=q,
            velocities=q_dot,
            accelerations=q_ddot,
            effort=NONE,
            time_from_start=self.make('builtin_interfaces/msg/Duration', sec=sec, nanosec=nanosec),
        )

    def pose(self, r: Iterable[float], quaternion: Iterable[float]) -> Any:
        """geometry_msgs/Pose of a position and a quaternion x, y, z, w."""
        x, y, z = map(float, r)
        point = self.make('geometry_msgs/msg/Point', x=x, y=y, z=z)
        x, y, z, w = map(float, quaternion)
        orientation = self.make('geometry_msgs/msg/Quaternion', x=x, y=y, z=z, w=w)
        return self.make('geometry_msgs/msg/Pose', position=point, orientation=orientation)

    def pose_stamped(self, stamp: Any, pose: Pose, frame_id: str = BASE_FRAME) -> Any:
        """geometry_msgs/PoseStamped."""
        body = self.pose(pose.r, pose.quaternion())
        return self.make('geometry_msgs/msg/PoseStamped', header=self.header(stamp, frame_id), pose=body)

    def path(self, stamp: Any, poses: Iterable[Pose]) -> Any:
        """nav_msgs/Path in the base frame."""
        stamped = [self.pose_stamped(stamp, pose) for pose in poses]
        return self.make('nav_msgs/msg/Path', header=self.header(stamp, BASE_FRAME), poses=stamped)

    def twist_stamped(self, stamp: Any, twist: Array, frame_id: str = BASE_FRAME) -> Any:
        """geometry_msgs/TwistStamped of m/s and rad/s, (6,)."""
        linear, angular = self._vectors(twist)
        body = self.make('geometry_msgs/msg/Twist', linear=linear, angular=angular)
        return self.make('geometry_msgs/msg/TwistStamped', header=self.header(stamp, frame_id), twist=body)

    def wrench_stamped(self, stamp: Any, wrench: Array, frame_id: str = TOOL_FRAME) -> Any:
        """geometry_msgs/WrenchStamped of N and N m, (6,)."""
        force, torque = self._vectors(wrench)
        body = self.make('geometry_msgs/msg/Wrench', force=force, torque=torque)
        return self.make('geometry_msgs/msg/WrenchStamped', header=self.header(stamp, frame_id), wrench=body)

    def _vectors(self, values: Array) -> list[Any]:
        rows = values.reshape(2, 3).tolist()
        return [self.make('geometry_msgs/msg/Vector3', x=x, y=y, z=z) for x, y, z in rows]

    def matrix(self, values: Array, *labels: str) -> Any:
        """std_msgs/Float64MultiArray row by row, its dimensions labelled."""
        strides = values.size, values.shape[1]
        layout = self._layout(zip(labels, values.shape, strides, strict=True))
        return self.make('std_msgs/msg/Float64MultiArray', layout=layout, data=values.ravel())

    def image(self, name: str, values: Array, *, labelled: bool, label: str = '') -> Any:
        """std_msgs/UInt8MultiArray of an image of digital values, Float64MultiArray of one of analog ones.

        Its label is that of the channels if it is `labelled`, or another one.
        """
        if labelled and not label:
            label = f'{name.removesuffix("s")}.1..{values.size}'
        layout = self._layout([(label, values.size, values.size)] if label else [])
        if name.startswith('digital'):
            return self.make('std_msgs/msg/UInt8MultiArray', layout=layout, data=values.astype(np.uint8))
        return self.make('std_msgs/msg/Float64MultiArray', layout=layout, data=np.array(values))

    def _layout(self, dimensions: Iterable[tuple[str, int, int]]) -> Any:
        dim = [
            self.make('std_msgs/msg/MultiArrayDimension', label=label, size=size, stride=stride)
            for label, size, stride in dimensions
        ]
        return self.make('std_msgs/msg/MultiArrayLayout', dim=dim, data_offset=0)
