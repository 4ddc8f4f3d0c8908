"""Plan a random motion, let a controller follow it, and hold both to the limits."""

import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Final

import numpy as np

from limit_differences import broken_limits, limit_uses
from robots_controller.control.controller import Controller
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.followed_motion import FollowedMotion
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.stops.faults import Fault
from robots_core.errors import PlanningError, RobotsError
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, QueuedCommand
from robots_planning.pathplanning import PathPlanning
from robots_planning.trajectory import Trajectory
from robots_planning.verification.limit_use import LimitUse

from .random_motion import RandomMotion, random_motion, robot_of

FINE: Final = 1e-4  # s, ten times as fine as references may be
# Torques are of accelerations and velocities by differences, which lag the positions by up to a step, and are
# verified at 250 Hz: between two of these instants torque changes a little.
TORQUE_TOLERANCE: Final = 1e-3
TORQUE_STEPS: Final = 10  # of the fine steps: 1 kHz
SPEED_TOLERANCE: Final = 1e-3  # of speeds of the tool, verified at 250 Hz too
STOP: Final = 'stopped on purpose'
LAST_CHANGE: Final = 1.3  # durations of a plan after which its override is 1 again
# A motion takes at most so many times its plan's duration, and seconds more: frames that may move at 0.2 m/s
# would move at 10 m/s at most.
SLOWEST: Final = 60.0
LONGEST_WAIT: Final = 30.0
VERIFICATION: Final = 'verification'


@dataclass(frozen=True)
class MotionFigures:
    """What became of a random motion.

    Attributes:
        seed: Its seed.
        robot: The robot's name.
        refused: Why it was not planned: the kind of error; '' if it was.
        uses: Worst ratio to each limit: of the plan by quantity, of the references with 'reference ' before.
        problems: What must not happen, a line each.
        duration: Of the plan, s.
    """

    seed: int
    robot: str
    refused: str = ''
    uses: dict[str, float] = field(default_factory=dict)
    problems: tuple[str, ...] = ()
    duration: float = 0.0


def run_seed(seed: int, robots: tuple[str, ...] | None = None) -> MotionFigures:
    """The figures of a seed; an exception that is no RobotsError is a problem of it."""
    name = robot_of(seed, robots)
    try:
        robot, planning = _planning(name)
        return run_motion(random_motion(seed, robot), robot, planning)
    except Exception:  # noqa: BLE001  # every one is a finding
        return MotionFigures(seed, name, problems=(traceback.format_exc(),))


def run_motion(motion: RandomMotion, robot: BaseRobotModel, planning: PathPlanning) -> MotionFigures:
    """Plan a motion, follow it, and look for limits that are not kept."""
    commands = tuple(
        QueuedCommand(str(index), *command, received=0.0) for index, command in enumerate(motion.commands)
    )
    try:
        plan = MotionChain(planning).plan(CommandChain(commands), motion.start).motion
    except RobotsError as error:
        by_verification = isinstance(error, PlanningError) and 'breaks a limit' in str(error)
        return MotionFigures(
            motion.seed, motion.robot, VERIFICATION if by_verification else type(error).__name__
        )
    trajectory = plan.trajectory
    uses, problems = plan_uses(motion, robot, planning, trajectory, with_torque='torque' in plan.report.uses)
    positions, failures = follow(motion, robot, trajectory)
    found = limit_uses(robot.axes_data, positions, motion.period)
    problems += [f'references: {line}' for line in broken_limits(robot.axes_data, found)]
    if motion.tool_speed_limit:
        found.append(frame_speed(robot, positions, motion.period, motion.tool_speed_limit))
        if found[-1].ratio > 1.0:
            problems.append(f'references: {found[-1].describe()}')
    ratios = {use.quantity: use.ratio for use in uses}
    ratios |= {f'reference {use.quantity}': use.ratio for use in found}
    return MotionFigures(motion.seed, motion.robot, '', ratios, (*problems, *failures), trajectory.duration)


def plan_uses(
    motion: RandomMotion,
    robot: BaseRobotModel,
    planning: PathPlanning,
    trajectory: Trajectory,
    *,
    with_torque: bool,
) -> tuple[list[LimitUse], list[str]]:
    """Worst uses of a plan at 10 kHz, from and to rest, and the limits that it does not keep."""
    axes, settings = robot.axes_data, [settings for _, _, settings in motion.commands]
    t = FINE * np.arange(-3, int(trajectory.duration / FINE) + 5)
    q = trajectory.sample(t)[0]
    alone = len(motion.commands) == 1 and not motion.commands[0][0].cartesian
    uses = limit_uses(axes, q, FINE, jerk=alone or settings[0].jerk_limited)
    problems = list(broken_limits(axes, uses))
    others = []
    if with_torque:
        others.append((torque(planning.loaded(settings[-1].payload), q), TORQUE_TOLERANCE))
    if all(kind.cartesian for kind, _, _ in motion.commands):
        speed = tool_speed(robot, q, settings[0].tool_pose.r, settings[0].cartesian_speed)
        others.append((speed, SPEED_TOLERANCE))
    problems += [use.describe() for use, tolerance in others if use.ratio > 1.0 + tolerance]
    return [*uses, *(use for use, _ in others)], [f'plan: {line}' for line in problems]


def torque(robot: BaseRobotModel, q: Array) -> LimitUse:
    """Worst use of torque at 1 kHz, of velocities and accelerations by differences of fine positions."""
    rows = np.arange(1, len(q) - 1, TORQUE_STEPS)
    q_dot = (q[rows + 1] - q[rows - 1]) / (2.0 * FINE)
    q_ddot = (q[rows + 1] - 2.0 * q[rows] + q[rows - 1]) / FINE**2
    model, effort = robot.rigid_dynamics_model, robot.axes_data.effort
    tau = np.abs([model.torques(*state) for state in zip(q[rows], q_dot, q_ddot, strict=True)])
    row, axis = np.unravel_index(int(np.argmax(tau / effort)), tau.shape)
    value, limit = float(tau[row, axis]), float(effort[axis])
    return LimitUse(
        'torque',
        value / limit,
        robot.axes_data.names[axis],
        float(rows[row] * FINE),
        value,
        limit,
        robot.axes_data.unit(int(axis), 'torque'),
    )


def tool_speed(robot: BaseRobotModel, q: Array, tool: Array, limit: float) -> LimitUse:
    """Worst use of the speed of a tool centre point (3,) in tool0, by its places at 1 kHz."""
    places = np.array([r + T @ tool for r, T in map(robot.direct_kinematics, q[::TORQUE_STEPS])])
    return _fastest('speed', 'the tool', places[:, None], FINE * TORQUE_STEPS, limit)


def frame_speed(robot: BaseRobotModel, q: Array, period: float, limit: float) -> LimitUse:
    """Worst use of the speed limit of tool0 and the frames of all axes, by their places."""
    frames = [robot.kinematic_model.frame_axes(row)[0] for row in q]
    places = np.array(
        [np.vstack([places, robot.direct_kinematics(row)[0]]) for places, row in zip(frames, q, strict=True)]
    )
    return _fastest('frame speed', 'a frame', places, period, limit)


def _fastest(quantity: str, what: str, places: Array, period: float, limit: float) -> LimitUse:
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=2).max(axis=1) / period
    row = int(np.argmax(speeds))
    value = float(speeds[row])
    return LimitUse(quantity, value / limit, what, row * period, value, limit, 'm/s')


def follow(motion: RandomMotion, robot: BaseRobotModel, trajectory: Trajectory) -> tuple[Array, list[str]]:
    """References of a controller whose drives are ideal, (m, n), and how the motion failed if it did."""
    settings = ControllerSettings(period=motion.period, smoothing_time=motion.smoothing_time)
    limit = FrameSpeedLimit(robot, motion.tool_speed_limit)
    speed = SpeedControl(robot.axes_data, settings, frame_limit=limit)
    controller = Controller(robot.axes_data, settings, speed=speed)
    now, q = 0.0, motion.start
    controller.step(now, q)
    controller.follow(FollowedMotion(trajectory, 'motion', cap=controller.speed.cap(trajectory)), now)
    positions, events = [q, q, q], _events(motion, controller, trajectory.duration)
    deadline = LONGEST_WAIT + SLOWEST * trajectory.duration
    while not controller.outcomes:
        if now > deadline:
            return np.array(positions), [f'controller: does not end within {deadline:.0f} s']
        while events and events[0][0] <= now:
            events.pop(0)[1](now)
        now += motion.period
        reference = controller.step(now, q)
        assert reference is not None
        q = reference[0].copy()
        positions.append(q)
    outcome = controller.outcomes[0]
    stopped = motion.stop_at < np.inf and outcome.message == STOP
    failures = [] if outcome.ok or stopped else [f'controller: {outcome.message}']
    return np.array([*positions, q, q, q]), failures


def _events(
    motion: RandomMotion, controller: Controller, duration: float
) -> list[tuple[float, Callable[[float], None]]]:
    """What happens to the motion, and when, s."""

    def override(value: float) -> Callable[[float], None]:
        def change(_now: float) -> None:
            controller.speed.paused = value == 0.0
            if value > 0.0:
                controller.speed.set_override(value)

        return change

    def stop(now: float) -> None:
        if motion.fast_stop:
            controller.trip(Fault.EMERGENCY_STOP, STOP, now)
        else:
            controller.cancel(STOP)

    if motion.stop_at < np.inf:
        return [(motion.stop_at * duration, stop)]
    changes = [(part * duration, override(value)) for part, value in motion.overrides]
    return [*changes, (LAST_CHANGE * duration, override(1.0))]


@cache
def _planning(name: str) -> tuple[BaseRobotModel, PathPlanning]:
    robot = load_robot_model(name)
    return robot, PathPlanning(robot)
