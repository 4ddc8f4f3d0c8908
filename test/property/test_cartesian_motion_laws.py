# ruff: noqa: PLR0917  # hypothesis gives every drawn value a name
"""Laws of the motions along lines, arcs and splines: shape, limits, jerk, monotony, tool."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import PlanningError, UnreachablePoseError
from robots_planning import CircularCartesian, LinearCartesianLimited, SplineCartesian, verify
from robots_planning.paths.circular_arc import CircularArc

ROBOTS = ('kuka_kr210_r2700', 'bello_bot', 'ur10e')
_LOADED = {name: load_robot_model(name) for name in ROBOTS}
# What users are promised, m and rad: between the points too.
PATH_TOLERANCE = 1e-5
TOOL = Pose.from_angles([0.05, -0.03, 0.2], [0.3, -0.4, 0.2])

offset = st.tuples(*[st.floats(-0.15, 0.15)] * 3)
turn = st.tuples(*[st.floats(-0.3, 0.3)] * 3)
near_home = st.lists(st.floats(-0.3, 0.3), min_size=7, max_size=7)


def positions(robot: BaseRobotModel, moved: list[float]) -> np.ndarray:
    """Near home, with a bent wrist: home has a straight one on some robots."""
    q = robot.home + np.array(moved[: robot.num_axes])
    q[-2] += 0.6
    return np.clip(q, robot.axes_data.lower, robot.axes_data.upper)


def poses_from(pose: Pose, offsets: list[tuple[float, ...]], turns: list[tuple[float, ...]]) -> list[Pose]:
    return [
        Pose(pose.r + r, Rotation.from_rotvec(vector).as_matrix() @ pose.T)
        for r, vector in zip(offsets, turns, strict=True)
    ]


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=15)  # sampled and verified in full
@given(
    start=near_home,
    offsets=st.tuples(offset, offset),
    turns=st.tuples(turn, turn),
    keeps_torque=st.booleans(),
)
def test_arcs_stay_on_their_circle_within_all_limits(
    name: str,
    start: list[float],
    offsets: tuple[tuple[float, ...], ...],
    turns: tuple[tuple[float, ...], ...],
    keeps_torque: bool,  # noqa: FBT001  # drawn by hypothesis
) -> None:
    robot = _LOADED[name]
    q = positions(robot, start)
    generator = CircularCartesian(robot, keeps_torque=keeps_torque)
    begin = generator.path_kinematics.pose(q)
    via, end = poses_from(begin, list(offsets), list(turns))
    a, b = via.r - begin.r, end.r - begin.r
    sides = np.linalg.norm(a), np.linalg.norm(b), np.linalg.norm(b - a)
    # Circles of a size that fits into the reach.
    assume(min(sides) > 0.01 and np.linalg.norm(np.cross(a, b)) > 0.1 * sides[0] * sides[1])
    try:
        trajectory = generator.generate(q, [via, end])
    except (PlanningError, UnreachablePoseError):
        assume(False)  # the reach is not this law's business
    arc = CircularArc(begin, via, end)
    report = verify(trajectory, robot, path=arc, torque=keeps_torque)
    assert report.ok, report.describe()
    r = np.array([robot.direct_kinematics(p)[0] for p in trajectory.position])
    assert np.abs(np.linalg.norm(r - arc.center, axis=1) - arc.radius).max() < PATH_TOLERANCE
    assert max(generator.path_kinematics.pose(trajectory.position[-1]).distance_to(end)) < 1e-9


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=15)  # sampled and verified in full
@given(
    start=near_home,
    offsets=st.lists(offset, min_size=2, max_size=4),
    turns=st.lists(turn, min_size=4, max_size=4),
    jerk_limited=st.booleans(),
    keeps_torque=st.booleans(),
)
def test_splines_pass_their_poses_within_all_limits(
    name: str,
    start: list[float],
    offsets: list[tuple[float, ...]],
    turns: list[tuple[float, ...]],
    jerk_limited: bool,  # noqa: FBT001  # drawn by hypothesis
    keeps_torque: bool,  # noqa: FBT001  # drawn by hypothesis
) -> None:
    robot = _LOADED[name]
    q = positions(robot, start)
    generator = SplineCartesian(robot, jerk_limited=jerk_limited, keeps_torque=keeps_torque)
    begin = generator.path_kinematics.pose(q)
    poses = poses_from(begin, offsets, turns[: len(offsets)])
    corners = np.array([(0.0, 0.0, 0.0), *offsets])
    assume(np.linalg.norm(np.diff(corners, axis=0), axis=1).min() > 1e-3)
    try:
        path = generator.path(begin, poses)
        joint_path = generator.follow(path, q)
        trajectory = generator.generate(q, poses)
    except (PlanningError, UnreachablePoseError):
        assume(False)  # the reach is not this law's business
    for s, pose in zip(path.parameters[1:], poses, strict=True):
        q_there = joint_path.evaluate(np.array([s]))[0][0]
        assert max(generator.path_kinematics.pose(q_there).distance_to(pose)) < 1e-9
    report = verify(trajectory, robot, path=path, torque=keeps_torque)
    assert report.ok, report.describe()
    if jerk_limited:
        assert report.uses['jerk'].ratio <= 1.0


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=15)  # verified in full
@given(start=near_home, offset_r=offset, about=turn)
def test_jerk_limited_lines_keep_jerk_everywhere_at_a_bearable_price(
    name: str, start: list[float], offset_r: tuple[float, ...], about: tuple[float, ...]
) -> None:
    robot = _LOADED[name]
    q = positions(robot, start)
    begin = Pose(*robot.direct_kinematics(q))
    (target,) = poses_from(begin, [offset_r], [about])
    try:
        free = LinearCartesianLimited(robot).generate(q, target)
    except (PlanningError, UnreachablePoseError):
        assume(False)  # the reach is not this law's business
    trajectory = LinearCartesianLimited(robot, jerk_limited=True).generate(q, target)
    report = verify(trajectory, robot, line=(begin, target), torque=False)
    assert report.ok, report.describe()
    assert report.uses['jerk'].ratio <= 1.0
    # Acceleration reverses within 2 a / j, a few times on a line on which several axes turn back.
    ramp = float((robot.axes_data.acceleration / robot.axes_data.jerk).max())
    assert trajectory.duration <= 1.5 * free.duration + 6.0 * ramp


@pytest.mark.parametrize('name', ROBOTS)
@settings(max_examples=10)  # several plans each
@given(
    start=near_home,
    offsets=st.lists(offset, min_size=2, max_size=2),
    option=st.sampled_from(
        [
            'speed_fraction',
            'acceleration_fraction',
            'cartesian_speed',
            'cartesian_acceleration',
            'rotation_speed',
            'rotation_acceleration',
        ]
    ),
    less=st.floats(0.2, 0.9),
)
def test_larger_limits_are_never_slower(
    name: str, start: list[float], offsets: list[tuple[float, ...]], option: str, less: float
) -> None:
    robot = _LOADED[name]
    q = positions(robot, start)
    defaults = {
        'speed_fraction': 1.0,
        'acceleration_fraction': 1.0,
        'cartesian_speed': 0.5,
        'cartesian_acceleration': 2.0,
        'rotation_speed': 1.5,
        'rotation_acceleration': 6.0,
    }
    begin = Pose(*robot.direct_kinematics(q))
    poses = poses_from(begin, offsets, [(0.1, 0.2, 0.0), (0.0, 0.3, -0.2)])
    try:
        full = SplineCartesian(robot, **defaults).generate(q, poses).duration
    except (PlanningError, UnreachablePoseError):
        assume(False)  # the reach is not this law's business
    slow = SplineCartesian(robot, **{**defaults, option: less * defaults[option]}).generate(q, poses)
    # The local slow-down where smoothing would break a limit differs by about this much.
    assert slow.duration >= full * (1.0 - 0.01)


@pytest.fixture(scope='module')
def with_tool(tmp_path_factory: pytest.TempPathFactory) -> BaseRobotModel:
    """The KUKA with `TOOL` as its last link."""
    robot = _LOADED['kuka_kr210_r2700']
    folder: Path = tmp_path_factory.mktemp('robot')
    r, p, y = Rotation.from_matrix(TOOL.T).as_euler('xyz')
    link = (
        '<link name="tool0"/><joint name="tool" type="fixed"><parent link="flange0"/><child link="tool0"/>'
        f'<origin xyz="{" ".join(map(str, TOOL.r))}" rpy="{r} {p} {y}"/></joint></robot>'
    )
    urdf = folder / 'robot.urdf'
    urdf.write_text(robot.description.replace('"tool0"', '"flange0"').replace('</robot>', link))
    axes = robot.axes_data
    limits = {
        name: {'max_acceleration': float(axes.acceleration[i]), 'max_jerk': float(axes.jerk[i])}
        for i, name in enumerate(axes.names)
    }
    (folder / 'joint_limits.yaml').write_text(yaml.safe_dump({'joint_limits': limits}))
    return load_robot_model(f'urdf:{urdf}')


@pytest.mark.parametrize('jerk_limited', [False, True])
def test_a_tool_is_the_same_as_a_robot_with_a_longer_last_link(
    with_tool: BaseRobotModel,
    jerk_limited: bool,  # noqa: FBT001  # a case
) -> None:
    robot = _LOADED['kuka_kr210_r2700']
    q = positions(robot, [0.1, 0.2, -0.1, 0.2, 0.1, 0.3])
    begin = Pose(*robot.direct_kinematics(q)) @ TOOL
    poses = poses_from(begin, [(0.1, 0.05, 0.0), (0.2, -0.05, 0.1)], [(0.1, 0.0, 0.0), (0.2, 0.1, 0.0)])
    for kind, target in (
        (LinearCartesianLimited, poses[1]),
        (CircularCartesian, poses),
        (SplineCartesian, poses),
    ):
        ours = kind(robot, tool=TOOL, jerk_limited=jerk_limited).generate(q, target)
        theirs = kind(with_tool, jerk_limited=jerk_limited).generate(q, target)
        # The URDF says lengths and angles with the digits of a text.
        assert ours.duration == pytest.approx(theirs.duration, rel=1e-6)
        t = np.linspace(0.0, ours.duration, 50)
        np.testing.assert_allclose(ours.sample(t)[0], theirs.sample(t)[0], atol=1e-6)
        end = Pose(*robot.direct_kinematics(ours.position[-1])) @ TOOL
        assert max(end.distance_to(poses[1])) < 1e-9
