"""Laws of the dynamic programming planner: limits everywhere, and a plan wherever a search finds one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks.inverse_kinematics.hold import POSE
from robots_core.errors import PlanningError, UnreachablePoseError
from robots_core.robot_choice import available_robot_models
from robots_planning import LinearCartesianDynamicProgramming, verify
from robots_planning.paths.cartesian_line import CartesianLine

_LOADED: dict[str, BaseRobotModel] = {}
_PLANNERS: dict[str, LinearCartesianDynamicProgramming] = {}
CLOSED_FORM = ('kuka_kr210_r2700', 'mitsubishi_rv7frl', 'ur5e')
POSES = 400  # of the reference search
LARGEST_STEP = 0.2  # rad of one axis from pose to pose of the reference search

direction = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
# A straight wrist, and wrists nearly straight, on purpose.
bend = st.one_of(st.sampled_from([0.0, 1e-6, -1e-4, 1e-2]), st.floats(-1.0, 1.0))


def planner_of(name: str) -> LinearCartesianDynamicProgramming:
    if name not in _PLANNERS:
        _LOADED[name] = load_robot_model(name)
        _PLANNERS[name] = LinearCartesianDynamicProgramming(_LOADED[name])
    return _PLANNERS[name]


def posture(robot: BaseRobotModel, offsets: list[float]) -> np.ndarray:
    axes = robot.axes_data
    return np.clip(robot.home + offsets[: robot.num_axes], axes.lower, axes.upper)


def line_from(
    robot: BaseRobotModel, q: np.ndarray, ways: tuple[tuple[float, ...], ...], metres: float, radians: float
) -> CartesianLine:
    pose = Pose(*robot.direct_kinematics(q))
    turn = Rotation.from_rotvec(radians * np.array(ways[1])).as_matrix()
    return CartesianLine(pose, Pose(pose.r + metres * np.array(ways[0]), turn @ pose.T))


@pytest.mark.parametrize('name', available_robot_models())
@settings(max_examples=8)  # every plan is checked 1000 times a second with inverse dynamics
@given(
    offsets=st.lists(st.floats(-0.7, 0.7), min_size=7, max_size=7),
    ways=st.tuples(direction, direction),
    metres=st.floats(0.0, 0.4),
    radians=st.floats(0.0, 0.4),
)
def test_every_robot_keeps_every_limit(
    name: str, offsets: list[float], ways: tuple[tuple[float, ...], ...], metres: float, radians: float
) -> None:
    planner = planner_of(name)
    robot = planner.robot
    q = posture(robot, offsets)
    line = line_from(robot, q, ways, metres, radians)
    try:
        trajectory = planner.generate(q, line.end)
    except PlanningError as error:
        assert 0.0 <= float(error.details['fraction']) <= 1.0  # noqa: PT017  # a refusal is no failure
        return
    except UnreachablePoseError:
        return
    # An arm of fewer than six axes holds what it can of the orientation.
    report = verify(trajectory, robot, line=(line.start, line.end), oriented=planner.hold == POSE)
    assert report.ok, report.describe()


def search_finds(robot: BaseRobotModel, line: CartesianLine, start: np.ndarray) -> bool:
    """Whether closed-form solutions at many poses, each near one of the pose before, lead along a line."""
    reached = [start]
    for s in np.linspace(0.0, 1.0, POSES + 1)[1:]:
        pose, following = line.pose(float(s)), []
        for q in reached:
            for near in robot.inverse_kinematics_analytic(pose.r, pose.T, q_near=q):
                known = any(np.abs(near - other).max() < 1e-6 for other in following)
                if np.abs(near - q).max() < LARGEST_STEP and not known:
                    following.append(near)
        if not following:
            return False
        reached = following
    return True


@pytest.mark.parametrize('name', CLOSED_FORM)
@settings(max_examples=15)  # the reference search takes its time
@given(
    offsets=st.lists(st.floats(-0.7, 0.7), min_size=6, max_size=6),
    wrist=bend,
    ways=st.tuples(direction, direction),
    metres=st.floats(0.01, 0.4),
)
def test_a_plan_wherever_a_search_finds_one(
    name: str, offsets: list[float], wrist: float, ways: tuple[tuple[float, ...], ...], metres: float
) -> None:
    planner = planner_of(name)
    robot = planner.robot
    offsets[4] = wrist - robot.home[4]
    q = posture(robot, offsets)
    line = line_from(robot, q, ways, metres, 0.3)
    try:
        planner.generate(q, line.end)
    except (PlanningError, UnreachablePoseError) as error:
        assert not search_finds(robot, line, q), str(error)  # noqa: PT017  # a refusal is no failure


@pytest.mark.parametrize('name', CLOSED_FORM)
@settings(max_examples=12)  # four plans each
@given(
    offsets=st.lists(st.floats(-0.5, 0.5), min_size=6, max_size=6),
    ways=st.tuples(direction, direction),
    metres=st.floats(0.02, 0.3),
    less=st.floats(0.2, 0.9),
)
def test_backwards_it_takes_as_long_and_with_smaller_limits_not_less(
    name: str, offsets: list[float], ways: tuple[tuple[float, ...], ...], metres: float, less: float
) -> None:
    planner = planner_of(name)
    robot = planner.robot
    offsets[4] += 0.7  # off the straight wrist, where two configurations are equally near
    q = posture(robot, offsets)
    line = line_from(robot, q, ways, metres, 0.2)
    try:
        there = planner.generate(q, line.end)
        back = planner.generate(there.position[-1], line.start)
    except (PlanningError, UnreachablePoseError):
        assume(False)  # the other laws' business
    slow = LinearCartesianDynamicProgramming(robot, speed_fraction=less).generate(q, line.end)
    weak = LinearCartesianDynamicProgramming(robot, acceleration_fraction=less).generate(q, line.end)
    # 0.1 % over the optimum each at most.
    assert min(slow.duration, weak.duration) >= there.duration * (1.0 - 1e-3)
    assume(np.abs(back.position[-1] - q).max() < 1e-6)  # it came back in the same configuration
    # Inertia, Coriolis and gravity are the same in both directions of time; 0.1 % as above.
    assert back.duration == pytest.approx(there.duration, rel=1e-3)
