"""Arms of any lengths, offsets, signs, zero positions and tools: closed forms are found and are complete."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robots_core import Pose, UrdfRobotModel

ACCURACY = 1e-9  # m and rad
# A posture is known from its pose up to rounding, some 1e-15 m and rad, over the Jacobian's smallest singular
# value; and where two branches meet, up to the root of rounding.
ROUNDING = 3e-14
MERGED = 3.0 * np.sqrt(ROUNDING)

X, Y, Z = np.eye(3)


@dataclass(frozen=True)
class Line:
    """An axis of an arm drawn in some posture: direction and a point, base frame."""

    direction: np.ndarray
    point: np.ndarray


def urdf_of(lines: list[Line], tool: Pose, zeros: np.ndarray, limit: float) -> str:
    """The arm as URDF text; joint i stands at `zeros[i]` in the drawn posture."""
    parts = ['<robot name="arm"><link name="link_0"/>']
    before = Pose.identity()
    for index, line in enumerate(lines):
        frame = Pose(line.point, Rotation.align_vectors([line.direction], [Z])[0].as_matrix())
        local = before.inverse() @ frame
        turned = local @ Pose(np.zeros(3), Rotation.from_rotvec([0.0, 0.0, -zeros[index]]).as_matrix())
        parts.append(
            f'<link name="link_{index + 1}"/><joint name="joint_{index + 1}" type="revolute">'
            f'<parent link="link_{index}"/><child link="link_{index + 1}"/>'
            f'{origin(turned)}<axis xyz="0 0 1"/>'
            f'<limit lower="{-limit}" upper="{limit}" velocity="2" effort="100"/></joint>'
        )
        before = frame
    parts.append(
        '<link name="tool0"/><joint name="flange" type="fixed"><parent link="link_6"/><child link="tool0"/>'
        f'{origin(before.inverse() @ tool)}</joint></robot>'
    )
    return ''.join(parts)


def origin(pose: Pose) -> str:
    xyz = ' '.join(f'{value:.17g}' for value in pose.r)
    rpy = ' '.join(
        f'{value:.17g}' for value in Rotation.from_matrix(pose.T).as_euler('xyz', suppress_warnings=True)
    )
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>'


def robot_of(urdf: str) -> UrdfRobotModel:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'arm.urdf'
        path.write_text(urdf)
        return UrdfRobotModel(path)


lengths = st.floats(0.1, 2.0)
offsets = st.one_of(st.just(0.0), st.floats(-0.5, 0.5))
angles = st.floats(-3.1, 3.1)
skew = st.one_of(st.just(0.0), st.floats(-0.6, 0.6))  # rad, of an axis from its right angle


@st.composite
def spherical_wrist_arms(draw: st.DrawFn) -> tuple[list[Line], np.ndarray]:
    shoulder = np.array([draw(offsets), draw(offsets), draw(offsets)])
    elbow = shoulder + np.array([0.0, draw(offsets), draw(lengths)])
    centre = elbow + np.array([draw(lengths), draw(offsets), draw(offsets)])
    tilt = draw(skew)
    second = np.cos(tilt) * Y + np.sin(tilt) * Z
    fifth, sixth = draw(skew), draw(skew)
    wrist = [
        X,
        np.cos(fifth) * Y + np.sin(fifth) * X,
        # Some arms have the same angle twice, so that the wrist can be straight.
        np.cos(sixth) * X + np.sin(sixth) * Z if draw(st.booleans()) else X,
    ]
    # Axes 2 and 3 turned together about a line through both keep the arm one of its kind.
    turn = Rotation.from_rotvec([tilt, 0.0, 0.0])
    elbow, centre = shoulder + turn.apply(elbow - shoulder), shoulder + turn.apply(centre - shoulder)
    wrist = [turn.apply(axis) for axis in wrist]
    points = [np.zeros(3), shoulder, elbow, centre, centre, centre]
    return [Line(d, p) for d, p in zip([Z, second, second, *wrist], points, strict=True)], centre


@st.composite
def ur_arms(draw: st.DrawFn) -> tuple[list[Line], np.ndarray]:
    shoulder = np.array([draw(offsets), 0.0, draw(offsets)])
    elbow = shoulder + np.array([draw(lengths), draw(offsets), draw(offsets)])
    wrist = elbow + np.array([draw(lengths), draw(offsets), draw(offsets)])
    centre = wrist + np.array([draw(offsets), draw(st.floats(0.05, 0.5)), draw(st.floats(0.02, 0.3))])
    s = draw(skew)
    fifth, sixth = np.cos(s) * Z + np.sin(s) * Y, np.cos(s) * Y - np.sin(s) * Z
    points = [np.zeros(3), shoulder, elbow, wrist, centre, centre]
    return [Line(d, p) for d, p in zip([Z, Y, Y, Y, fifth, sixth], points, strict=True)], centre


@st.composite
def drawn(draw: st.DrawFn, arms: st.SearchStrategy[tuple[list[Line], np.ndarray]]) -> UrdfRobotModel:
    lines, centre = draw(arms)
    base = Pose.from_angles([draw(offsets) for _ in range(3)], [draw(angles) for _ in range(3)])
    tool = Pose.from_angles(centre + [draw(offsets) for _ in range(3)], [draw(angles) for _ in range(3)])
    lines = [
        replace(
            line,
            direction=draw(st.sampled_from([1.0, -1.0])) * (base.T @ line.direction),
            # Any point of the axis is as good as another.
            point=base.r + base.T @ (line.point + draw(offsets) * line.direction),
        )
        for line in lines
    ]
    zeros = np.array([draw(angles) for _ in range(6)])
    return robot_of(urdf_of(lines, base @ tool, zeros, limit=draw(st.sampled_from([3.2, 6.3]))))


def check_complete(robot: UrdfRobotModel, seed: int) -> None:
    axes = robot.axes_data
    for q in np.random.default_rng(seed).uniform(axes.lower, axes.upper, (10, 6)):
        pose = Pose(*robot.direct_kinematics(q))
        solutions = robot.inverse_kinematics_analytic(pose.r, pose.T, q_near=q)
        for solution in solutions:
            axes.check_position(solution)
            assert max(pose.distance_to(Pose(*robot.direct_kinematics(solution)))) < ACCURACY
        singular = float(np.linalg.svd(robot.jacobian(q), compute_uv=False)[-1])
        assert len(solutions) > 0
        assert np.abs(solutions - q).max(axis=1).min() < ROUNDING / max(singular, 1e-12) + MERGED
        # No posture twice.
        apart = np.abs(solutions[:, None] - solutions[None]).max(axis=2) + 10.0 * np.eye(len(solutions))
        assert apart.min() > 0.0


@settings(max_examples=60)
@given(robot=drawn(spherical_wrist_arms()), seed=st.integers(0, 2**32 - 1))
def test_any_arm_with_a_spherical_wrist_has_all_its_postures(robot: UrdfRobotModel, seed: int):
    check_complete(robot, seed)


@settings(max_examples=60)
@given(robot=drawn(ur_arms()), seed=st.integers(0, 2**32 - 1))
def test_any_arm_with_three_parallel_axes_has_all_its_postures(robot: UrdfRobotModel, seed: int):
    check_complete(robot, seed)


@settings(max_examples=30)
@given(robot=drawn(spherical_wrist_arms()), seed=st.integers(0, 2**32 - 1))
def test_poses_far_out_of_reach_have_none(robot: UrdfRobotModel, seed: int):
    random = np.random.default_rng(seed)
    direction = random.normal(size=3)
    T = Rotation.random(rng=random).as_matrix()
    # Longer than all lengths and offsets that an arm above can have together.
    r = 20.0 * direction / np.linalg.norm(direction)
    assert robot.inverse_kinematics_analytic(r, T).shape == (0, 6)
