"""Joint motions around obstacles next to OMPL, on the same problems, bodies and margins in one run.

Run by `make benchmark-collision-free`; OPTIONS='--count 100' for more problems of each family, of which
`--peers` go to the peers too.

- ours: `CollisionFreeJoint` of `robots_planning`: certified edges, shortcuts, rounded corners.
- OMPL: RRT-Connect with its own simplification; postures are checked by our compiled check, edges at a step
  that moves no point by more than 5 mm.
- OMPL certified: the same with our certificate as the validator of motions.
- roboplan: RRT-Connect with its own shortcuts, checks of postures at the same steps as OMPL's.
- OMPL best (`--optimise SECONDS`): BIT* with the certificate, for as long, to compare durations with.
- OMPL PRM (`--prepare SECONDS`): a roadmap of certified edges, prepared for as long for each cell before the
  clock starts: what a cell that stays could gain.

All paths are timed alike, those of peers where their corners can be rounded freely. Peers have 2 s: OMPL of
the processor, roboplan of the clock. Paths that collide, those of peers before they are rounded, are found by
Pinocchio's kinematics and coal, at steps that move no point by more than `--dense` metres; our planner has no
part in that. `to cancel ms` is the longest time in which our planner does not look for a cancellation.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import ompl.base as ob
import ompl.geometric as og
import ompl.util as ou
from collision_free_problems import FAMILIES, MARGIN, REACH, Problem, problems
from pinocchio_bodies import PinocchioBodies
from rich.console import Console
from rich.table import Table
from roboplan_peer import RoboplanPeer

from robots_core import BaseRobotModel, load_robot_model
from robots_core.blocks import CollisionDetection
from robots_core.blocks.collision.along_paths.path_certificate import FREE
from robots_core.errors import PlanningError
from robots_planning import CollisionFreeJoint, Trajectory
from robots_planning.free_paths.free_path_search import FreePath
from robots_planning.free_paths.rounding import rounded
from robots_planning.timing.time_optimal import TimeOptimalTiming
from robots_planning.trajectory_generators.trajectory_generator import LIMIT_MARGIN

BUDGET = 2.0  # s
THINNEST = 0.005  # m, that OMPL's discrete checks shall not miss
PEERS = 'OMPL', 'OMPL certified', 'roboplan'
SAMPLES = 2001  # of our path; between them its curve is straight to a micrometre
LONGEST_REACH = 1.3  # of a tool's tip, of the reach of the arm


@dataclass
class Outcome:
    """What became of a problem: seconds of the CPU, and a path: postures (k, n) on it, and its timing.

    `to_cancel` is the longest time without a look for a cancellation, s.
    """

    seconds: float
    postures: np.ndarray | None = None
    trajectory: Trajectory | None = None
    to_cancel: float = 0.0


def timing(robot: BaseRobotModel) -> TimeOptimalTiming:
    axes, inside = robot.axes_data, 1.0 - LIMIT_MARGIN
    return TimeOptimalTiming(robot, axes.velocity * inside, axes.acceleration * inside, axes.effort * inside)


def ours(robot: BaseRobotModel, detection: CollisionDetection, problem: Problem) -> Outcome:
    planner = CollisionFreeJoint(robot, budget=BUDGET)
    looks: list[float] = []
    planner.surround(detection, MARGIN, lambda: bool(looks.append(time.process_time())))
    begin = time.process_time()
    try:
        path = planner.joint_path(problem.start, problem.target)
    except PlanningError:
        return Outcome(time.process_time() - begin)
    end = time.process_time()
    to_cancel = float(np.diff([begin, *looks, end]).max())
    postures = path.evaluate(np.linspace(0.0, 1.0, SAMPLES))[0]
    return Outcome(end - begin, postures, timing(robot).timed(path).trajectory, to_cancel)


class CertifiedMotions(ob.MotionValidator):  # type: ignore[misc]
    """Our certificate as OMPL's validator of motions."""

    def __init__(self, information: Any, free: Callable[[Any, Any], bool]) -> None:
        super().__init__(information)
        self._free = free

    def checkMotion(self, first: Any, second: Any, *_: Any) -> bool:
        return self._free(first, second)


def with_ompl(
    robot: BaseRobotModel,
    detection: CollisionDetection,
    problem: Problem,
    *,
    certified: bool,
    optimise: float = 0.0,
    prepare: float = 0.0,
) -> Outcome:
    n = robot.num_axes
    certificate = detection.certificate(problem.start, margin=MARGIN)

    def posture(state: Any) -> np.ndarray:
        return np.array([state[k] for k in range(n)])

    space, bounds = ob.RealVectorStateSpace(n), ob.RealVectorBounds(n)
    ends = np.array([problem.start, problem.target])
    low = np.maximum(robot.axes_data.lower, ends.min(axis=0) - np.pi)
    high = np.minimum(robot.axes_data.upper, ends.max(axis=0) + np.pi)
    for k in range(n):
        bounds.setLow(k, float(low[k]))
        bounds.setHigh(k, float(high[k]))
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(step_of(robot) / space.getMaximumExtent())
    setup = og.SimpleSetup(space)
    setup.setStateValidityChecker(lambda state: certificate.posture(posture(state)) == FREE)
    information = setup.getSpaceInformation()
    if certified:
        information.setMotionValidator(
            CertifiedMotions(information, lambda a, b: certificate.line(posture(a), posture(b)) == FREE)
        )
    states = [space.allocState() for _ in range(2)]
    for state, q in zip(states, ends, strict=True):
        for k in range(n):
            state[k] = float(q[k])
    setup.setStartAndGoalStates(*states)
    kind = og.BITstar if optimise else og.PRM if prepare else og.RRTConnect
    planner = kind(information)
    setup.setPlanner(planner)
    if prepare:
        setup.setup()
        planner.growRoadmap(prepare)
    begin = time.process_time()
    longest = optimise or BUDGET
    if prepare:  # a second thread of PRM asks, which must not wait for this one
        over = ob.timedPlannerTerminationCondition(longest)
    else:
        over = ob.PlannerTerminationCondition(lambda: time.process_time() - begin > longest)
    solved = setup.solve(over)
    if not solved or not setup.haveExactSolutionPath():
        return Outcome(time.process_time() - begin)
    setup.simplifySolution()
    seconds = time.process_time() - begin
    postures = np.array([posture(state) for state in setup.getSolutionPath().getStates()])
    return smoothed(robot, seconds, FreePath(postures, certificate))


def smoothed(robot: BaseRobotModel, seconds: float, way: FreePath) -> Outcome:
    """A peer's way with corners rounded as ours are, and timed."""
    try:
        return Outcome(seconds, way.postures, timing(robot).timed(rounded(way)).trajectory)
    except PlanningError:  # at a corner that is not free
        return Outcome(seconds, way.postures)


def with_roboplan(robot: BaseRobotModel, detection: CollisionDetection, problem: Problem) -> Outcome:
    peer = RoboplanPeer(robot, detection, problem, step=step_of(robot), budget=BUDGET)
    begin = time.process_time()
    postures = peer.plan(problem.start, problem.target)
    seconds = time.process_time() - begin
    if postures is None:
        return Outcome(seconds)
    return smoothed(robot, seconds, FreePath(postures, detection.certificate(problem.start, margin=MARGIN)))


def step_of(robot: BaseRobotModel) -> float:
    """A step of the joints that moves no point by more than `THINNEST`, rad."""
    return float(THINNEST / (LONGEST_REACH * REACH[robot.name] * np.sqrt(robot.num_axes)))


def collides(robot: BaseRobotModel, problem: Problem, postures: np.ndarray, dense: float) -> bool:
    """Whether coal finds a contact on a path, at steps that move no point by more than `dense`, m."""
    bodies = PinocchioBodies.of(robot, problem.scene)
    return bodies.path_in_contact(postures, LONGEST_REACH * REACH[robot.name], dense)


def planners_of(options: argparse.Namespace) -> dict[str, Callable[..., Outcome]]:
    peers: tuple[Callable[..., Outcome], ...] = (
        lambda *given: with_ompl(*given, certified=False),
        lambda *given: with_ompl(*given, certified=True),
        with_roboplan,
    )
    chosen = {name: plan for name, plan in zip(PEERS, peers, strict=True) if name in options.planners}
    if options.optimise:
        chosen['OMPL best'] = lambda *given: with_ompl(*given, certified=True, optimise=options.optimise)
    if options.prepare:
        chosen['OMPL PRM'] = lambda *given: with_ompl(*given, certified=True, prepare=options.prepare)
    return {'ours': ours} | chosen


def rows(options: argparse.Namespace) -> Iterator[tuple[str, ...]]:
    planners = planners_of(options)
    for name in options.robots:
        robot = load_robot_model(name)
        for family in options.families:
            found: dict[str, list[Outcome]] = {planner: [] for planner in planners}
            colliding = dict.fromkeys(planners, 0)
            for number, problem in enumerate(problems(robot, family, options.count)):
                detection = CollisionDetection(robot, scene=problem.scene)
                for label, plan in planners.items():
                    if number >= options.peers and label != 'ours':
                        continue
                    outcome = plan(robot, detection, problem)
                    found[label].append(outcome)
                    if outcome.postures is not None and label != 'OMPL best':
                        colliding[label] += collides(robot, problem, outcome.postures, options.dense)
            for label, outcomes in found.items():
                if outcomes:
                    yield (name, family, label, *figures(outcomes, colliding[label], found['ours']))


def figures(outcomes: list[Outcome], colliding: int, ours: list[Outcome]) -> tuple[str, ...]:
    times = 1e3 * np.array([outcome.seconds for outcome in outcomes])
    paths = [outcome.postures for outcome in outcomes if outcome.postures is not None]
    durations = [o.trajectory.duration for o in outcomes if o.trajectory is not None]
    # Of problems that both have solved.
    ratios = [
        mine.trajectory.duration / outcome.trajectory.duration
        for mine, outcome in zip(ours, outcomes, strict=False)
        if mine.trajectory is not None and outcome.trajectory is not None
    ]
    lengths = [np.linalg.norm(np.diff(postures, axis=0), axis=1).sum() for postures in paths]
    return (
        f'{len(paths)} of {len(outcomes)}',
        f'{np.median(times):.1f}',
        f'{np.percentile(times, 95):.1f}',
        f'{np.mean(lengths):.2f}' if lengths else '-',
        f'{np.mean(durations):.2f}' if durations else '-',
        f'{np.mean(ratios):.2f}' if ratios else '-',
        f'{colliding}',
        f'{1e3 * max(outcome.to_cancel for outcome in outcomes):.1f}' if outcomes is ours else '-',
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--count', type=int, default=20, help='problems of each robot and family')
    parser.add_argument('--peers', type=int, default=20, help='so many of these go to the peers too')
    parser.add_argument('--dense', type=float, default=1e-4, help='step of the check with coal, m')
    parser.add_argument('--optimise', type=float, default=0.0, help='s that BIT* gets for each problem')
    parser.add_argument('--prepare', type=float, default=0.0, help='s that PRM gets for each cell before')
    parser.add_argument('--planners', nargs='*', default=list(PEERS), choices=list(PEERS), help='which peers')
    parser.add_argument('--robots', nargs='+', default=list(REACH))
    parser.add_argument('--families', nargs='+', default=list(FAMILIES), choices=list(FAMILIES))
    options = parser.parse_args()
    ou.setLogLevel(ou.LOG_ERROR)
    ou.RNG.setSeed(1)
    robot = load_robot_model(options.robots[0])  # compiled and loaded before the clock starts
    first = next(problems(robot, 'shelf', 1))
    ours(robot, CollisionDetection(robot, scene=first.scene), first)
    table = Table(
        'robot',
        'family',
        'planner',
        'solved',
        'median ms',
        '95 % ms',
        'length rad',
        'duration s',
        'ours of it',
        'colliding',
        'to cancel ms',
    )
    for row in rows(options):
        table.add_row(*row)
        print(' | '.join(row), flush=True)
    Console(width=120).print(table)


if __name__ == '__main__':
    main()
