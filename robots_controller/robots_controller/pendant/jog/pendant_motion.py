"""Motions that a person commands from the operator's page: steps, and motions to typed targets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Final, Literal, get_args

import numpy as np

from robots_controller.pendant.jog.jog_command import JogCommand
from robots_controller.pendant.pendant_state import JogSpeeds, PendantState
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.blocks.collision.along_paths.joint_path import JointPath
from robots_core.blocks.collision.results import Proximity
from robots_core.errors import InvalidInputError
from robots_core.orientation import rotation_from_vector
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, read_only
from robots_planning.guidance.teach_box import ROTATION_SPEED
from robots_planning.motion_kinds import JOINT, JOINT_TO_POSE, LINE
from robots_planning.motion_settings import MotionSettings, frame
from robots_planning.pathplanning import PathPlanning, PlannedMotion
from robots_planning.trajectory import Trajectory

ACCELERATION: Final = 0.3  # part of the limits, as of a teach box
SPEED_MARGIN: Final = 0.95  # of the highest tool speed, which does not grow quite as the axes' do
Way = Literal['joints', 'pose', 'line']
SAMPLES: Final = 200  # of a motion, for the speed of the tool and the 3D view
WAYS: Final[tuple[Way, ...]] = get_args(Way)
"""How a typed target is given and reached: joint positions; a pose, with all axes or on a line."""


@dataclass(frozen=True, eq=False)
class Preview:
    """A motion that is planned and not yet commanded.

    Attributes:
        command: The motion.
        duration: How long it takes at full override, s.
        way: Joint positions at equal steps of its time, (SAMPLES, n), rad (m).
        limiting_axis: The axis that limits it.
        around: It leads around obstacles.
        closest: The smallest distance on it; None where nothing is checked.
    """

    command: MotionCommand
    duration: float
    way: Array
    limiting_axis: str
    around: bool = False
    closest: Proximity | None = None

    @property
    def q(self) -> Array:
        """Joint positions at its end, (n,), rad (m)."""
        return self.at(self.duration)

    def at(self, time: float) -> Array:
        """Joint positions a time (s) after its start, (n,), rad (m); afterwards those at its end."""
        part = min(max(time / self.duration, 0.0), 1.0) if self.duration > 0.0 else 1.0
        q: Array = self.way[round(part * (SAMPLES - 1))]
        return q


def step_command(
    robot: BaseRobotModel, jog: JogCommand, size: float, q: Array, state: PendantState
) -> MotionCommand:
    """The motion of one step, of a size in rad or m, from where the robot stands, (n,), rad (m).

    Raises:
        JointLimitError: the step leads an axis out of its limits.
    """
    way = float(np.copysign(size, jog.share))
    settings = jog_settings(abs(jog.share), state.jog_speeds)
    axes = robot.axes_data
    if jog.frame == 'axes':
        target = np.array(q)
        target[jog.index] += way
        return MotionCommand(JOINT, 0, '', q=read_only(axes.check_position(target, 'q')), settings=settings)
    pose = robot.pose(q) @ state.settings.tool_pose
    way_of = way * jog.direction()
    turn = rotation_from_vector(way_of[3:])
    if jog.frame == 'tool':
        target_pose = pose @ Pose(way_of[:3], turn)
    else:
        target_pose = Pose(pose.r + way_of[:3], turn @ pose.T)
    return MotionCommand(LINE, 0, '', pose=_in_program_base(target_pose, state), settings=settings)


def target_command(
    robot: BaseRobotModel, way: Way, values: Sequence[float], share: float, state: PendantState
) -> MotionCommand:
    """The motion to a typed target.

    Args:
        robot: The robot.
        way: How it is given and reached.
        values: Joint positions (n,), rad (m); or x, y, z (m) and orientation angles (rad) of the tool centre
            point in the robot's base, in the robot's convention.
        share: Part of the highest jog speed, (0, 1].
        state: Has the jog speeds, and the tool and base of planning_node.

    Raises:
        InvalidInputError: another number of values, or one that is not finite.
        JointLimitError: a position outside its limits.
    """
    settings = jog_settings(share, state.jog_speeds)
    if way == 'joints':
        q = robot.axes_data.check_position(finite_vector(values, robot.num_axes, 'q'), 'q')
        return MotionCommand(JOINT, 0, '', q=read_only(q), settings=settings)
    numbers = finite_vector(values, 6, 'pose')
    pose = Pose.from_angles(numbers[:3], numbers[3:], robot.orientation_convention)
    kind = LINE if way == 'line' else JOINT_TO_POSE
    return MotionCommand(kind, 0, '', pose=_in_program_base(pose, state), settings=settings)


def _in_program_base(pose: Pose, state: PendantState) -> Pose:
    """A pose in the robot's base, seen from the base of the settings.

    That stays as it is: whatever happens to the page, the program moves in its own base afterwards.
    """
    return frame(state.settings.base, 'base').inverse() @ pose


def jog_settings(share: float, speeds: JogSpeeds) -> Mapping[str, Any]:
    """Settings of planning_node for a motion as slow as a jog."""
    if not 0.0 < share <= 1.0:
        raise InvalidInputError(f'jog speed = {share:g} must be in (0, 1]')
    return MappingProxyType(
        {
            'speed_fraction': share * speeds.fraction,
            'acceleration_fraction': ACCELERATION,
            'cartesian_speed': share * speeds.tool,
            'rotation_speed': share * ROTATION_SPEED,
            'blend_zone': 0.0,
            'joint_blend_zone': 0.0,
        }
    )


def motion_preview(
    planning: PathPlanning, command: MotionCommand, q: Array, settings: MotionSettings, tool_speed: float
) -> Preview:
    """Plan a motion as planning_node will; a joint motion is so slow that no tool is too fast.

    Args:
        planning: The planner, with the scene that motions are checked in; it keeps scratch memory.
        command: The motion.
        q: Where the robot stands, (n,), rad (m).
        settings: Those of planning_node, of which the command changes some.
        tool_speed: Highest speed of the tool centre point, m/s.

    Raises:
        RobotsError: as `PathPlanning.plan`.
    """
    planned = _planned(planning, command, q, settings)
    fastest = _fastest(planning.robot, planned, settings.tool_pose.r) if command.kind is not LINE else 0.0
    if fastest > tool_speed:
        fraction = float(str(command.settings['speed_fraction'])) * SPEED_MARGIN * tool_speed / fastest
        slower = MappingProxyType({**command.settings, 'speed_fraction': fraction})
        command = replace(command, settings=slower)
        planned = _planned(planning, command, q, settings)
    around = planned.via is not None and len(planned.via) > 0
    closest = _closest(planning, planned.trajectory)
    return Preview(command, planned.duration, _samples(planned), planned.limiting_axis, around, closest)


def _closest(planning: PathPlanning, trajectory: Trajectory) -> Proximity | None:
    if planning.collision is None:
        return None
    path = JointPath(*trajectory.points)
    found = planning.collision.closest_approach(path)
    return None if found is None else found.proximity


def _planned(
    planning: PathPlanning, command: MotionCommand, q: Array, settings: MotionSettings
) -> PlannedMotion:
    target = command.q if command.q is not None else command.pose
    assert target is not None
    wanted = MotionSettings(**{**vars(settings), **command.settings})
    return planning.plan(command.kind, q, target, wanted)


def _fastest(robot: BaseRobotModel, planned: PlannedMotion, tool: Array) -> float:
    r, T = robot.tool_poses(_samples(planned))
    step = planned.duration / (SAMPLES - 1)
    return float(np.linalg.norm(np.diff(r + T @ tool, axis=0), axis=1).max() / step)


def _samples(planned: PlannedMotion) -> Array:
    """Joint positions at equal steps of a motion's time, (SAMPLES, n)."""
    times = np.linspace(0.0, planned.duration, SAMPLES)
    return read_only(planned.trajectory.sample(times)[0])
