"""RandomMotion: what one seed stands for."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from robots_core.pose import Pose
from robots_core.robot_choice import available_robot_models, load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.motion_kinds import MOTION_KINDS, MotionKind
from robots_planning.motion_settings import MotionSettings
from robots_planning.trajectory_generators.trajectory_generator import Target

PERIODS: Final = (0.001, 0.002, 0.004, 0.004, 0.01)  # s
PART_OF_TURN: Final = 0.7  # rad: how far motions near the start lead each axis
LONGEST_CHAIN: Final = 4
EDGES: Final = (0.0, 0.5, 1.0)  # parts of an axis' range: its ends, and where wrists are straight


@dataclass(frozen=True, eq=False)
class RandomMotion:
    """A motion, or several that blend, and what happens to it in the controller.

    Attributes:
        seed: All follows from it.
        robot: The robot's name.
        start: Joint positions, (n,), rad (m).
        commands: Kind, target and settings of each motion.
        period: Of the controller, s.
        smoothing_time: Of the controller, s.
        tool_speed_limit: Of the controller, m/s; 0 for none.
        overrides: Speed overrides and the part of the plan's duration at which each is set, in order; 0 is a
            pause.
        stop_at: Part of the plan's duration at which it is stopped; infinite for never.
        fast_stop: It is stopped as fast as the limits permit.
    """

    seed: int
    robot: str
    start: Array
    commands: tuple[tuple[MotionKind, Target, MotionSettings], ...]
    period: float
    smoothing_time: float
    tool_speed_limit: float
    overrides: tuple[tuple[float, float], ...]
    stop_at: float
    fast_stop: bool

    @property
    def title(self) -> str:
        """Its kinds."""
        return ' + '.join(kind.title for kind, _, _ in self.commands)


def robot_of(seed: int, robots: Sequence[str] | None = None) -> str:
    """Seeds go through the robots in turn."""
    robots = robots or available_robot_models()
    return robots[seed % len(robots)]


def random_motion(seed: int, robot: BaseRobotModel | None = None) -> RandomMotion:
    """The motion of a seed; always the same."""
    rng = np.random.default_rng(seed)
    robot = robot or load_robot_model(robot_of(seed))
    start = _start(rng, robot)
    settings = _settings(rng, robot)
    count = 1 if rng.random() < 0.75 else int(rng.integers(2, LONGEST_CHAIN + 1))
    commands = []
    q = start
    for index in range(count):
        kind = MOTION_KINDS[int(rng.integers(len(MOTION_KINDS)))]
        q, target = _target(rng, robot, kind, q, settings)
        blends = index < count - 1
        zones = {'blend_zone': _log(rng, 1e-3, 0.2), 'joint_blend_zone': _log(rng, 1e-3, 0.5)}
        commands.append((kind, target, replace(settings, **zones) if blends else settings))
    happens = rng.choice(['nothing', 'overrides', 'stop'], p=[0.5, 0.35, 0.15])
    count = int(rng.integers(1, 6)) if happens == 'overrides' else 0
    values = [float(rng.choice([0.0, rng.random(), 1.0], p=[0.2, 0.6, 0.2])) for _ in range(count)]
    return RandomMotion(
        seed=seed,
        robot=robot.name,
        start=start,
        commands=tuple(commands),
        period=float(rng.choice(PERIODS)),
        smoothing_time=float(rng.choice([0.0, 0.02])),
        tool_speed_limit=_log(rng, 0.2, 2.0) if rng.random() < 0.15 else 0.0,
        overrides=tuple(zip(np.sort(1.2 * rng.random(count)).tolist(), values, strict=True)),
        stop_at=float(rng.random()) if happens == 'stop' else np.inf,
        fast_stop=bool(rng.random() < 0.5),
    )


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _start(rng: np.random.Generator, robot: BaseRobotModel) -> Array:
    axes = robot.axes_data
    low, high = axes.one_turn
    if rng.random() < 0.5:
        return np.clip(robot.home + 0.5 * rng.uniform(-1.0, 1.0, robot.num_axes), axes.lower, axes.upper)
    part = rng.random(robot.num_axes)
    if rng.random() < 0.2:  # at a bound, or singular
        part[int(rng.integers(robot.num_axes))] = rng.choice(EDGES)
    return np.asarray(low + part * (high - low))


def _settings(rng: np.random.Generator, robot: BaseRobotModel) -> MotionSettings:
    """Settings of which each has its default half of the time."""
    choices: dict[str, Callable[[], Any]] = {
        'speed_fraction': lambda: _log(rng, 0.1, 1.0),
        'acceleration_fraction': lambda: _log(rng, 0.1, 1.0),
        'cartesian_speed': lambda: _log(rng, 0.05, 5.0),
        'cartesian_acceleration': lambda: _log(rng, 0.2, 50.0),
        'rotation_speed': lambda: _log(rng, 0.2, 10.0),
        'rotation_acceleration': lambda: _log(rng, 0.5, 100.0),
        'jerk_limited': lambda: True,
        'joint_planner': lambda: 'linear_joint_axes',
        'cartesian_planner': lambda: 'dynamic_programming',
        'hold': lambda: str(rng.choice(['position', 'directions'] if robot.num_axes < 6 else ['position'])),
        'tool': lambda: _frame(rng, 0.3),
        'base': lambda: _frame(rng, 1.0),
        'payload': lambda: (_log(rng, 0.1, 5.0), *rng.uniform(-0.1, 0.1, 3).tolist()),
    }
    rare = {'hold': 0.1, 'payload': 0.2, 'base': 0.2}
    return MotionSettings(
        **{name: choose() for name, choose in choices.items() if rng.random() < rare.get(name, 0.5)}
    )


def _frame(rng: np.random.Generator, reach: float) -> tuple[float, ...]:
    turn = rng.normal(size=4)
    return (*rng.uniform(-reach, reach, 3).tolist(), *(turn / np.linalg.norm(turn)).tolist())


def _target(
    rng: np.random.Generator, robot: BaseRobotModel, kind: MotionKind, q: Array, settings: MotionSettings
) -> tuple[Array, Target]:
    """Joint positions where the motion may end, and what is commanded."""
    axes = robot.axes_data
    low, high = axes.one_turn
    if rng.random() < 0.05:  # next to nothing
        way = rng.choice([0.0, 1e-9, 1e-6, 1e-3]) * rng.uniform(-1.0, 1.0, robot.num_axes)
    else:
        way = _log(rng, 0.05, PART_OF_TURN) * rng.uniform(-1.0, 1.0, robot.num_axes)
    near = np.clip(q + way, axes.lower, axes.upper)
    if not kind.cartesian and rng.random() < 0.5:
        near = low + rng.random(robot.num_axes) * (high - low)
    if kind.target == 'joints':
        return near, near
    pose = _commanded(robot, near, settings)
    if kind.target == 'pose':
        return near, pose
    between = [0.5 * (q + near) + 0.3 * np.abs(way).max() * rng.uniform(-1.0, 1.0, robot.num_axes)]
    if rng.random() < 0.3:
        between.append(0.3 * q + 0.7 * near)
    passed = [_commanded(robot, np.clip(each, axes.lower, axes.upper), settings) for each in between]
    if len(passed) == 2 and kind.name == 'circle':  # a full circle ends where it starts
        return q, (*passed, _commanded(robot, q, settings))
    return near, (*passed, pose)


def _commanded(robot: BaseRobotModel, q: Array, settings: MotionSettings) -> Pose:
    """The pose of the tool at joint positions, in the frame of commands."""
    tool = Pose(*robot.direct_kinematics(q)) @ settings.tool_pose
    return settings.in_base(Pose.identity()).inverse() @ tool
