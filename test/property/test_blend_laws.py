"""Laws of blended chains: in their zones, on their paths elsewhere, inside all limits, never slower."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from robots_core import Pose, load_robot_model
from robots_core.errors import RobotsError
from robots_planning import MotionSettings, PathPlanning, verify
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, QueuedCommand
from robots_planning.motion_kinds import CIRCLE, JOINT, LINE, MotionKind
from robots_planning.paths.circular_arc import CircularArc
from robots_planning.trajectory_generators.trajectory_generator import Target
from robots_planning.verification.trajectory_verification import LINE_TOLERANCE

ROBOTS = ('kuka_kr210_r2700', 'staubli_tx2_90', 'bello_bot')
_PLANNING = {name: PathPlanning(load_robot_model(name)) for name in ROBOTS}
ON_JOINT_LINE = 1e-9  # rad: rounding of the polynomials of a path that is straight
SHORTEST_WAY = 0.02  # m and rad
EDGE = 1.0 + 1e-6  # of a zone: its edge is found by bisection
SAMPLES = 300

Measure = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""From joint positions (m, n) and tool positions (m, 3) to numbers (m,)."""

direction = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
angles = st.lists(st.floats(-0.4, 0.4), min_size=7, max_size=7)
motion = st.tuples(st.sampled_from(['joints', 'line', 'arc']), angles, direction)
zones = st.tuples(st.floats(1e-3, 0.06), st.floats(5e-3, 0.3))


class Chain:
    """Commands that follow each other, and what each of them does without a blend.

    Attributes:
        orders: The commands.
        stops: Duration with a stop at each target, s.
        near: By motion, how far from its target, in sizes of its zone.
        away: By motion, how far from its path, as part of what is allowed there.
    """

    def __init__(self, name: str, moved: list[float]) -> None:
        self.planning = _PLANNING[name]
        self.robot = self.planning.robot
        axes = self.robot.axes_data
        # Off the straight wrist and the straight arm.
        q = self.robot.home + 0.3 * np.array(moved[: axes.num_axes])
        q[-2] += 0.6
        self.start = self.q = np.clip(q, axes.lower, axes.upper)
        self.orders: list[QueuedCommand] = []
        self.near: list[Measure] = []
        self.away: list[Measure] = []
        self.stops = 0.0

    def add(
        self, form: str, turn: list[float], way: tuple[float, ...], reach: float, modal: MotionSettings
    ) -> None:
        """One more motion; draws another example if the robot cannot do it."""
        axes, begin = self.robot.axes_data, self.q
        pose = Pose(*self.robot.direct_kinematics(begin))
        target, kind = self._target(form, turn, way, reach, pose)
        if isinstance(target, np.ndarray):
            target = np.clip(target, axes.lower, axes.upper)
            assume(np.abs(target - begin).max() > SHORTEST_WAY)
        order = QueuedCommand(str(len(self.orders)), kind, target, modal, 0.0)
        try:
            alone = self.planning.plan(kind, begin, target, modal)
        except RobotsError:
            assume(False)  # reach and singularities are not these laws' business
        self.stops += alone.duration
        self.q = end = alone.trajectory.position[-1]
        corner = self.robot.direct_kinematics(end)[0]
        if form == 'joints':
            self.near.append(lambda q, _: np.abs(q - end).max(axis=1) / modal.joint_blend_zone)
            self.away.append(lambda q, _: from_segment(q, begin, end) / ON_JOINT_LINE)
        else:
            self.near.append(lambda _, r: np.linalg.norm(r - corner, axis=1) / modal.blend_zone)
            if form == 'line':
                self.away.append(lambda _, r: from_segment(r, pose.r, corner) / LINE_TOLERANCE)
            else:
                assert isinstance(target, tuple)
                arc = CircularArc(pose, *target)
                self.away.append(lambda _, r: from_circle(r, arc) / LINE_TOLERANCE)
        self.orders.append(order)

    def _target(
        self, form: str, turn: list[float], way: tuple[float, ...], reach: float, pose: Pose
    ) -> tuple[Target, MotionKind]:
        if form == 'joints':
            return self.q + turn[: len(self.q)], JOINT
        move = reach * np.array(way)
        assume(np.linalg.norm(move) > SHORTEST_WAY)
        end = Pose(pose.r + move, Pose.from_angles([0.0] * 3, turn[:3]).T @ pose.T)
        if form == 'line':
            return end, LINE
        across = np.cross(move, np.eye(3)[int(np.argmin(np.abs(move)))])
        return (Pose(pose.r + 0.5 * move + 0.4 * across, pose.T), end), CIRCLE


def from_segment(points: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    way = end - begin
    part = np.clip((points - begin) @ way / (way @ way), 0.0, 1.0)
    return np.asarray(np.abs(begin + part[:, None] * way - points).max(axis=1))


def from_circle(points: np.ndarray, arc: CircularArc) -> np.ndarray:
    out = points - arc.center
    height = out @ arc.normal
    radius = np.linalg.norm(out - height[:, None] * arc.normal, axis=1)
    return np.asarray(np.hypot(height, radius - arc.radius))


def build(
    name: str,
    moved: list[float],
    motions: list[tuple[str, list[float], tuple[float, ...]]],
    sizes: tuple[float, float],
    **options: object,
) -> Chain:
    reach = 0.4 if name == 'kuka_kr210_r2700' else 0.15
    modal = MotionSettings(blend_zone=sizes[0], joint_blend_zone=sizes[1], **options)  # type: ignore[arg-type]
    chain = Chain(name, moved)
    for kind, turn, way in motions:
        chain.add(kind, turn, way, reach, modal)
    return chain


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=12)  # planned, verified and sampled in full
@given(
    moved=angles,
    motions=st.lists(motion, min_size=2, max_size=4),
    sizes=zones,
    planner=st.sampled_from(['limited', 'dynamic_programming']),
    jerk_limited=st.booleans(),
    fast=st.booleans(),
)
def test_random_chains(  # noqa: PLR0917  # hypothesis gives every drawn value a name
    name: str,
    moved: list[float],
    motions: list[tuple[str, list[float], tuple[float, ...]]],
    sizes: tuple[float, float],
    planner: str,
    jerk_limited: bool,  # noqa: FBT001  # drawn by hypothesis
    fast: bool,  # noqa: FBT001
) -> None:
    speeds = {'cartesian_speed': 5.0, 'cartesian_acceleration': 50.0} if fast else {}
    chain = build(name, moved, motions, sizes, cartesian_planner=planner, jerk_limited=jerk_limited, **speeds)
    robot = chain.robot
    plan = MotionChain(chain.planning).plan(CommandChain(tuple(chain.orders)), chain.start)
    blended, ends = plan.motion, tuple(plan.ends.values())

    # Inside all limits, without a jump of acceleration, from and to rest.
    trajectory = blended.trajectory
    with_torque = planner == 'dynamic_programming' and chain.orders[-1].kind.cartesian
    report = verify(trajectory, robot, torque=with_torque)
    assert report.ok, report.describe()
    if jerk_limited:
        assert report.uses['jerk'].ratio <= 1.0
    np.testing.assert_allclose(trajectory.position[0], chain.start, atol=1e-12)
    np.testing.assert_allclose(trajectory.position[-1], chain.q, atol=1e-12)  # the same search

    # Through every zone, and on a motion's own path outside.
    q = trajectory.sample(np.linspace(0.0, trajectory.duration, SAMPLES))[0]
    r = np.array([robot.direct_kinematics(row)[0] for row in q])
    near = np.array([measure(q, r) for measure in chain.near[:-1]])
    away = np.array([measure(q, r) for measure in chain.away])
    outside = (near > EDGE).all(axis=0)
    assert away.min(axis=0)[outside].max(initial=0.0) <= 1.0
    passing = trajectory.sample(np.array(ends[:-1]))[0]
    there = np.array([robot.direct_kinematics(row)[0] for row in passing])
    assert all(measure(passing, there)[k] <= EDGE for k, measure in enumerate(chain.near[:-1]))

    # Never slower than motion by motion.
    assert trajectory.duration <= chain.stops + 1e-6  # s; nanoseconds of rounding per motion
    assert list(ends) == sorted(ends)
    assert ends[-1] == trajectory.duration
