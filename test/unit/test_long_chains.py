"""Chains of any length run through: as fast as planned in one piece, inside all limits, without a stop."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_planning import MotionSettings, PathPlanning, Trajectory
from robots_planning.commands.command_queue import CommandQueue
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, MotionPlan, QueuedCommand
from robots_planning.motion_kinds import LINE
from robots_planning.verification.trajectory_verification import JUMP_TOLERANCE

from .simulated_program import PERIOD, outputs, run_text

START = (11, -69, 92, -109, -80, 17)  # deg
COUNT = 100
STEP, ZONE = 0.02, 0.005  # m
# What is planned of a chain at once is at least half a window: that costs next to nothing.
SLOWER = 1.02
AROUND_CORNERS = f"""
ptpJointSpaceAngles({', '.join(map(str, START))})
setSpeed(nil, 0.2)
local d = 1
for i = 1, {COUNT} do
  local options = {{blend = i < {COUNT} and {ZONE} or nil}}
  if i % 10 == 5 then
    options.on_path = {{distance_before_end = 0.008, output = 1, value = i % 20 == 5}}
  end
  if i % 10 == 0 then
    linearRelative(-0.014, 0, 0, 0, 0, 0, options)
    d = -d
  else
    linearRelative(0, d * {STEP}, 0, 0, 0, 0, options)
  end
end
"""


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('ur10e')


def corners(robot: BaseRobotModel) -> list[Pose]:
    """The targets of the program above."""
    start = Pose(*robot.direct_kinematics(np.radians(START)))
    r, targets, direction = start.r.copy(), [], 1.0
    for number in range(1, COUNT + 1):
        if number % 10 == 0:
            r[0] -= 0.014
            direction = -direction
        else:
            r[1] += direction * STEP
        targets.append(Pose(r.copy(), start.T))
    return targets


def commands(robot: BaseRobotModel, **how: object) -> list[QueuedCommand]:
    settings = MotionSettings(cartesian_speed=0.2, blend_zone=ZONE, **how)  # type: ignore[arg-type]
    last = MotionSettings(cartesian_speed=0.2, **how)  # type: ignore[arg-type]
    return [
        QueuedCommand(str(number), LINE, target, settings if number < COUNT - 1 else last, 0.0)
        for number, target in enumerate(corners(robot))
    ]


def in_windows(chain: MotionChain, queued: list[QueuedCommand], start: np.ndarray) -> list[MotionPlan]:
    """The plans of commands that come one after the other."""
    queue, plans = CommandQueue(), []
    for command in queued:
        part = queue.hold(command)
        if part is None:
            continue
        end = plans[-1].open_end if plans else None
        plans.append(chain.plan(part, start) if end is None else chain.continue_from(end, part))
    return plans


def joined(plans: list[MotionPlan]) -> Trajectory:
    """What a robot does that follows each plan until the next one carries it on."""
    time, begin = [np.zeros(1)], 0.0
    rows = [[part[:1] for part in _rows(plans[0])]]
    for plan in plans:
        own = plan.motion.trajectory.time
        until = plan.open_time
        part = slice(1, int(np.searchsorted(own, until)) + 1)
        time.append(begin + own[part])
        rows.append([row[part] for row in _rows(plan)])
        begin += until
    return Trajectory(np.concatenate(time), *(np.concatenate(parts) for parts in zip(*rows, strict=True)))


def _rows(plan: MotionPlan) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    trajectory = plan.motion.trajectory
    return trajectory.position, trajectory.velocity, trajectory.acceleration


@pytest.mark.parametrize(
    'how', [{}, {'jerk_limited': True}, {'cartesian_planner': 'dynamic_programming'}], ids=str
)
def test_plans_that_carry_each_other_on_are_as_fast_as_one(
    robot: BaseRobotModel, how: dict[str, object]
) -> None:
    chain, start = MotionChain(PathPlanning(robot)), np.radians(START)
    queued = commands(robot, **how)
    plans = in_windows(chain, queued, start)
    assert len(plans) > 3
    assert all(plan.open_end is not None for plan in plans[:-1])
    whole = joined(plans)
    one = chain.plan(CommandChain(tuple(queued)), start)
    assert whole.duration <= SLOWER * one.motion.duration
    # Each plan was verified alone; where one carries another on, the robot moves alike in both.
    for before, after in pairwise(plans):
        assert before.open_end is not None
        states = zip(before.motion.trajectory.sample(before.open_end.time), _rows(after), strict=True)
        limits = (1.0, robot.axes_data.velocity, robot.axes_data.acceleration)
        for (state, rows), limit, tolerance in zip(states, limits, JUMP_TOLERANCE, strict=True):
            assert (np.abs(rows[0] - state) / limit).max() <= tolerance
    # The tool goes where it goes in one piece.
    ways = []
    for trajectory in (whole, one.motion.trajectory):
        q = trajectory.sample(np.linspace(0.0, trajectory.duration, 20_000))[0]
        ways.append(robot.tool_poses(q)[0])
    length = [np.linalg.norm(np.diff(way, axis=0), axis=1).sum() for way in ways]
    assert length[0] == pytest.approx(length[1], abs=1e-4)


def tool_speeds(run: SimulationRun, robot: BaseRobotModel) -> np.ndarray:
    return np.array([np.linalg.norm((robot.jacobian(q) @ rate)[:3]) for q, rate, _ in run.reference])


def check_limits(run: SimulationRun, robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    q, q_dot, q_ddot = np.swapaxes(run.reference, 0, 1)
    # The controller's guard lets this pass.
    within = 1.0 + 1e-6
    for rates, limit in (
        (q_dot, axes.velocity),
        (np.diff(q, axis=0) / PERIOD, axes.velocity),
        (q_ddot, axes.acceleration),
        (np.diff(q, 2, axis=0) / PERIOD**2, axes.acceleration),
    ):
        assert (np.abs(rates) <= limit * within).all()


def test_a_hundred_short_lines_run_through_and_switch_outputs_at_their_places(
    tmp_path: Path, robot: BaseRobotModel
) -> None:
    run = run_text(tmp_path, AROUND_CORNERS, robot='ur10e')
    assert run.ok
    motions = run.motions[1:]
    assert [motion.message for motion in motions] == ['passed'] * (COUNT - 1) + ['reached']
    check_limits(run, robot)
    speeds = tool_speeds(run, robot)
    moving = (run.time > motions[0].started + 0.1) & (run.time < motions[-1].ended - 0.2)
    assert speeds[moving].min() > 0.03
    # Each motion belongs to the plan by which it was done.
    ends = [motion.started + motion.end_on_plan for motion in motions]
    assert ends == sorted(ends)
    switched = [motion for number, motion in enumerate(motions, 1) if number % 10 == 5]
    targets = corners(robot)[4::10]
    assert len(outputs(run)) == len(switched)
    for (time, _), motion, target in zip(outputs(run), switched, targets, strict=True):
        assert motion.started + motion.start_on_plan < time < motion.started + motion.end_on_plan + 0.02
        q = run.position[np.searchsorted(run.time, time)]
        # One period at 0.2 m/s, and the smoothing's lag of 10 ms before which the plan is.
        distance = np.linalg.norm(robot.direct_kinematics(q)[0] - target.r)
        assert distance == pytest.approx(0.008, abs=0.2 * (PERIOD + 0.012))


def test_a_weld_bead_of_short_lines_keeps_its_speed(tmp_path: Path, robot: BaseRobotModel) -> None:
    run = run_text(
        tmp_path,
        f"""
        ptpJointSpaceAngles({', '.join(map(str, START))})
        setSpeed(nil, 0.05)
        local x, y, n = 0, 0, 150
        for i = 1, n do
          local to_x, to_y = 0.02 * math.sin(i / 15), 0.002 * i
          linearRelative(to_x - x, to_y - y, 0, 0, 0, 0, {{blend = i < n and 0.0008 or nil}})
          x, y = to_x, to_y
        end
        """,
        robot='ur10e',
    )
    assert run.ok
    check_limits(run, robot)
    motions = run.motions[1:]
    speeds = tool_speeds(run, robot)
    welding = (run.time > motions[0].started + 0.2) & (run.time < motions[-1].ended - 0.2)
    assert speeds[welding].min() > 0.95 * 0.05


def test_a_chain_that_ends_in_the_open_part_of_its_plan_stops_there_once(tmp_path: Path) -> None:
    """The program waits: nothing comes that the chain could run through to."""
    run = run_text(
        tmp_path,
        f"""
        ptpJointSpaceAngles({', '.join(map(str, START))})
        for i = 1, 40 do linearRelative(0, 0.01, 0, 0, 0, 0, {{blend = 0.002}}) end
        wait(1)
        for i = 1, 40 do linearRelative(0, -0.01, 0, 0, 0, 0, {{blend = 0.002}}) end
        """,
        robot='ur10e',
    )
    assert run.ok
    messages = [motion.message for motion in run.motions[1:]]
    assert messages == (['passed'] * 39 + ['reached']) * 2


@pytest.mark.parametrize('at', [1.3, 1.75, 3.0])
def test_a_chain_that_is_aborted_stops_on_its_path_and_every_motion_has_a_result(
    tmp_path: Path, robot: BaseRobotModel, at: float
) -> None:
    (tmp_path / 'plc.yaml').write_text(
        f'rules: [{{when: digital_output.8 rises, after: {at}, set: {{digital_input.1: 1}}}}]'
    )
    around = AROUND_CORNERS.replace('setSpeed(', 'setDigitalOutput(8, 1) setSpeed(')
    run = run_text(
        tmp_path,
        f"onDigitalInput(1, true, function() return 'abort' end)\n{around}\nsetDigitalOutput(2, 1)",
        robot='ur10e',
        io=tmp_path / 'plc.yaml',
    )
    assert run.ok, run.error
    check_limits(run, robot)
    assert run.duration < 3.0 + at
    assert not np.isnan([motion.ended for motion in run.motions]).any()
    passed = [motion.ok for motion in run.motions[1:]]
    assert passed == sorted(passed, reverse=True)
    assert 0 < sum(passed) < COUNT
