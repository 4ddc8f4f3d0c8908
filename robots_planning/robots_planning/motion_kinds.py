"""MotionKind: the kinds of motion that can be commanded, in one table."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

from robots_core.cell_interface.topic_qos import add_commands
from robots_planning.robot_command_state import RobotCommandState


@dataclass(frozen=True)
class MotionKind:
    """One kind of motion: how it is commanded, and what plans it.

    Attributes:
        name: Short name, which planners list.
        title: What reports and messages call it.
        what: Where it leads, for the table of topics.
        topic: Topic of its commands.
        message_type: Type of its commands, as package/msg/Name.
        state: Command state while a robot program moves so.
        target: Joint positions, a pose of the tool, or several poses of its path.
        functions: Functions of robot programs that command it.
        setting: The motion setting that chooses its planner.
        planner: Plans it where the planner that is set does not; '' for none.
    """

    name: str
    title: str
    what: str
    topic: str
    message_type: str
    state: RobotCommandState
    target: Literal['joints', 'pose', 'poses']
    functions: tuple[str, ...]
    setting: Literal['joint_planner', 'cartesian_planner']
    planner: str = ''

    @property
    def cartesian(self) -> bool:
        """The tool follows a path; otherwise the axes move point to point."""
        return self.setting == 'cartesian_planner'


JOINT: Final = MotionKind(
    name='joint',
    title='PTPJOINT_JOINT',
    what='to joint positions, straight in joint space',
    topic='ptpjoint_joint',
    message_type='sensor_msgs/msg/JointState',
    state=RobotCommandState.PTPJOINT_JOINT,
    target='joints',
    functions=('ptpJointSpaceAngles', 'ptpJointSpaceAnglesRelative'),
    setting='joint_planner',
)
JOINT_TO_POSE: Final = MotionKind(
    name='joint_to_pose',
    title='PTPJOINT_CARTESIAN',
    what='to a pose, straight in joint space',
    topic='ptpjoint_cartesian',
    message_type='geometry_msgs/msg/PoseStamped',
    state=RobotCommandState.PTPJOINT_CARTESIAN,
    target='pose',
    functions=('ptpJointSpacePosition',),
    setting='joint_planner',
)
LINE: Final = MotionKind(
    name='line',
    title='PTPCARTESIAN',
    what='to a pose, on a straight line',
    topic='ptpcartesian',
    message_type='geometry_msgs/msg/PoseStamped',
    state=RobotCommandState.PTPCARTESIAN,
    target='pose',
    functions=('ptpCartesianSpace', 'linearRelative'),
    setting='cartesian_planner',
)
CIRCLE: Final = MotionKind(
    name='circle',
    title='PTPCARTESIAN circle',
    what='on an arc through a pose to another',
    topic='circcartesian',
    message_type='nav_msgs/msg/Path',
    state=RobotCommandState.TRAJECTORY,
    target='poses',
    functions=('circCartesianSpace',),
    setting='cartesian_planner',
    planner='circular',
)
SPLINE: Final = MotionKind(
    name='spline',
    title='PTPCARTESIAN spline',
    what='on a smooth curve through poses',
    topic='splinecartesian',
    message_type='nav_msgs/msg/Path',
    state=RobotCommandState.TRAJECTORY,
    target='poses',
    functions=('splineCartesianSpace',),
    setting='cartesian_planner',
    planner='spline',
)

MOTION_KINDS: Final = (JOINT, JOINT_TO_POSE, LINE, CIRCLE, SPLINE)
"""All that can be commanded."""
add_commands(kind.topic for kind in MOTION_KINDS)
KIND_OF_TOPIC: Final[Mapping[str, MotionKind]] = MappingProxyType({kind.topic: kind for kind in MOTION_KINDS})
KIND_OF_FUNCTION: Final[Mapping[str, MotionKind]] = MappingProxyType(
    {function: kind for kind in MOTION_KINDS for function in kind.functions}
)
"""By the function of a robot program."""
