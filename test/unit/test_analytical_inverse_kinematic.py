"""AnalyticalInverseKinematic: branches, turns, configurations, and errors where there is no solution."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from robots_core import BaseRobotModel, Configuration, Pose, UrdfRobotModel, load_robot_model
from robots_core.blocks import AnalyticalInverseKinematic
from robots_core.errors import InvalidInputError, NoAnalyticInverseKinematicsError, UnreachablePoseError

ACCURACY = 1e-9  # m and rad
Q = np.array([0.4, -1.2, 1.3, 0.7, 0.9, -0.5])


@pytest.fixture
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


@pytest.fixture
def block(robot: BaseRobotModel) -> AnalyticalInverseKinematic:
    return AnalyticalInverseKinematic(robot)


@pytest.fixture
def pose(robot: BaseRobotModel) -> Pose:
    return Pose(*robot.direct_kinematics(Q))


def test_all_branches_have_different_configurations(robot: BaseRobotModel, block: AnalyticalInverseKinematic):
    random = np.random.default_rng(2)
    most = 0
    for q in random.uniform(robot.axes_data.lower, robot.axes_data.upper, (200, 6)):
        branches = block.solve_all(Pose(*robot.direct_kinematics(q)))
        configurations = {block.configuration(branch) for branch in branches}
        assert len(configurations) == len(branches)
        assert block.configuration(q) in configurations
        most = max(most, len(branches))
    assert most == 8


@pytest.mark.parametrize('name', ['staubli_tx2_90', 'manutec_r3', 'mitsubishi_rv7frl', 'ur5e'])
def test_configuration_chooses_the_branch(name: str):
    robot = load_robot_model(name)
    block = AnalyticalInverseKinematic(robot)
    random = np.random.default_rng(4)
    for q in random.uniform(robot.axes_data.lower, robot.axes_data.upper, (50, 6)):
        target = Pose(*robot.direct_kinematics(q))
        asked = block.configuration(q)
        solution = block.solve(target, configuration=asked)
        assert block.configuration(solution) == asked
        assert target.distance_to(Pose(*robot.direct_kinematics(solution)))[0] < ACCURACY


def test_home_of_the_kuka_is_front_up(block: AnalyticalInverseKinematic, robot: BaseRobotModel):
    # Upper arm upright, forearm level: the wrist is in front, the elbow above.
    found = block.configuration(robot.home)
    assert (found.shoulder, found.elbow) == ('front', 'up')
    back = robot.home + np.array([0.0, -np.pi / 4, -np.pi / 2, 0.0, 0.0, 0.0])
    assert block.configuration(back).shoulder == 'back'


def test_turns_are_all_solutions_of_a_branch_inside_the_limits(
    robot: BaseRobotModel, block: AnalyticalInverseKinematic, pose: Pose
):
    axes = robot.axes_data
    branches, turned = block.solve_all(pose), block.solve_all(pose, turns=True)
    # Axes 4 and 6 turn by 350 degrees to either side: two turns each, the others one.
    assert len(turned) == 4 * len(branches)
    assert len(np.unique(turned.round(9), axis=0)) == len(turned)
    for q in turned:
        axes.check_position(q)
        assert max(pose.distance_to(Pose(*robot.direct_kinematics(q)))) < ACCURACY


@pytest.mark.parametrize('turn', [-1, 0, 1])
def test_the_turn_nearest_to_the_seed_is_chosen(block: AnalyticalInverseKinematic, pose: Pose, turn: int):
    seed = np.clip(Q + 2.0 * np.pi * turn * np.eye(6)[3], -6.1, 6.1)
    solution = block.solve(pose, seed, configuration=block.configuration(Q))
    allowed = [value for value in (0.7 - 2.0 * np.pi, 0.7) if abs(value) < 6.1]
    assert solution[3] == pytest.approx(min(allowed, key=lambda value: abs(value - seed[3])), abs=1e-9)
    np.testing.assert_allclose(np.delete(solution, 3), np.delete(Q, 3), atol=1e-9)


def test_tool_is_seen_from_tool0(robot: BaseRobotModel):
    tool = Pose.from_angles([0.2, -0.1, 0.35], [0.5, 1.0, -2.0])
    pose = Pose(*robot.direct_kinematics(Q)) @ tool
    np.testing.assert_allclose(AnalyticalInverseKinematic(robot, tool=tool).solve(pose, Q), Q, atol=ACCURACY)


def test_a_straight_wrist_stands_as_in_the_seed(robot: BaseRobotModel, block: AnalyticalInverseKinematic):
    q = np.array([0.4, -1.2, 1.3, 0.7, 0.0, -0.5])
    pose = Pose(*robot.direct_kinematics(q))
    np.testing.assert_allclose(block.solve(pose, q), q, atol=ACCURACY)
    other = block.solve(pose)
    assert other[3] == pytest.approx(robot.home[3], abs=ACCURACY)
    # Axes 4 and 6 turn about the same line, both against it at KUKA.
    assert other[3] + other[5] == pytest.approx(q[3] + q[5], abs=ACCURACY)


def test_a_wrist_on_axis_1_keeps_axis_1_of_the_seed(robot: BaseRobotModel, block: AnalyticalInverseKinematic):
    # The wrist centre is 1.22 m along and 0.115 m beside the forearm: turned until it is above axis 1.
    arm = [-2.0, 0.0]
    upper = 1.15 * np.exp(2.0j) + 0.33
    angle = np.angle((-upper.real + 1j * np.sqrt(1.22**2 + 0.115**2 - upper.real**2)) / (1.22 + 0.115j))
    arm[1] = -angle - arm[0]
    q = np.array([1.1, *arm, 0.3, 0.8, -0.2])
    pose = Pose(*robot.direct_kinematics(q))
    assert np.linalg.cond(robot.jacobian(q)) > 1e9
    solution = block.solve(pose, q)
    np.testing.assert_allclose(solution, q, atol=1e-6)
    free = block.solve_all(pose)
    assert len(free) > 0
    assert np.isfinite(free).all()


def test_out_of_reach_is_an_error(block: AnalyticalInverseKinematic):
    with pytest.raises(UnreachablePoseError, match='out of reach'):
        block.solve(Pose([5.0, 0.0, 1.0], np.eye(3)))
    assert block.solve_all(Pose([5.0, 0.0, 1.0], np.eye(3))).shape == (0, 6)
    assert block.solve_all(Pose([5.0, 0.0, 1.0], np.eye(3)), turns=True).shape == (0, 6)


def test_the_limit_in_the_way_is_named(robot: BaseRobotModel, block: AnalyticalInverseKinematic):
    beyond = Q.copy()
    beyond[1] = robot.axes_data.upper[1] + 0.05
    with pytest.raises(UnreachablePoseError, match=re.escape('A2 = -0.0372664626 rad')) as caught:
        block.solve(Pose(*robot.direct_kinematics(beyond)), configuration=block.configuration(beyond))
    assert caught.value.details['joint'] == 'A2'
    assert caught.value.details['upper'] == robot.axes_data.upper[1]


def test_no_solution_of_a_configuration_is_an_error(robot: BaseRobotModel, block: AnalyticalInverseKinematic):
    pose = Pose(*robot.direct_kinematics(Q))
    found = {block.configuration(q) for q in block.solve_all(pose)}
    absent = Configuration('back', 'up', 'flip')
    assert absent not in found
    with pytest.raises(UnreachablePoseError, match='in configuration back/up/flip'):
        block.solve(pose, configuration=absent)


@pytest.mark.parametrize(
    ('r', 'T', 'words'),
    [
        ([1.0, np.nan, 0.0], np.eye(3), r'r\[1\] is nan'),
        ([1.0, 0.0], np.eye(3), r'r must have shape \(3,\)'),
        ([1.0, 0.0, 1.0], 2.0 * np.eye(3), 'not a rotation matrix'),
        ([1.0, 0.0, 1.0], np.full((3, 3), np.nan), 'not a rotation matrix'),
        ([1.0, 0.0, 1.0], np.diag([1.0, 1.0, -1.0]), 'left-handed'),
        ([1.0, 0.0, 1.0], np.eye(4), r'T must have shape \(3, 3\)'),
        ([1.0, 0.0, 1.0], np.eye(4)[:3], r'T must have shape \(3, 3\)'),
    ],
)
@pytest.mark.parametrize('kind', [list, np.array])
def test_what_is_no_pose_is_refused(
    robot: BaseRobotModel, r: list[float], T: np.ndarray, words: str, kind: type
):
    with pytest.raises(InvalidInputError, match=words):
        robot.inverse_kinematics_analytic(kind(r), T)


def test_seeds_are_checked(block: AnalyticalInverseKinematic, pose: Pose):
    with pytest.raises(InvalidInputError, match=r'seed must have shape \(6,\)'):
        block.solve(pose, np.zeros(5))
    with pytest.raises(InvalidInputError, match=r'seed\[3\] is nan'):
        block.solve(pose, [0.0, 0.0, 0.0, np.nan, 0.0, 0.0])


def test_arrays_of_any_layout_and_kind_are_taken(robot: BaseRobotModel):
    r, T = robot.direct_kinematics(Q)
    expected = robot.inverse_kinematics_analytic(r, T)
    np.testing.assert_array_equal(robot.inverse_kinematics_analytic(r, np.asfortranarray(T)), expected)
    np.testing.assert_array_equal(robot.inverse_kinematics_analytic(list(r), T.tolist()), expected)
    np.testing.assert_array_equal(robot.inverse_kinematics_analytic(np.repeat(r, 2)[::2], T), expected)
    single = robot.inverse_kinematics_analytic(r.astype(np.float32), T.astype(np.float32))
    # Single precision: seven digits of a pose some metres away.
    np.testing.assert_allclose(single, expected, atol=1e-5)


def test_results_belong_to_the_caller(robot: BaseRobotModel):
    first = robot.inverse_kinematics_analytic(*robot.direct_kinematics(Q))
    kept = first.copy()
    robot.inverse_kinematics_analytic(*robot.direct_kinematics(Q + 0.1))
    np.testing.assert_array_equal(first, kept)


def test_robots_without_closed_form_are_refused_at_once():
    with pytest.raises(NoAnalyticInverseKinematicsError, match='it has 7 axes'):
        AnalyticalInverseKinematic(load_robot_model('franka_fr3'))


def test_angles_printed_with_few_digits_are_polished(tmp_path: Path):
    text = load_robot_model('kuka_kr210_r2700').description
    coarse = text.replace('1.57079632679', '1.5708').replace('3.14159265359', '3.14159')
    (tmp_path / 'coarse.urdf').write_text(coarse)
    robot = UrdfRobotModel(tmp_path / 'coarse.urdf')
    random = np.random.default_rng(9)
    for q in random.uniform(robot.axes_data.lower, robot.axes_data.upper, (50, 6)):
        pose = Pose(*robot.direct_kinematics(q))
        solutions = robot.inverse_kinematics_analytic(pose.r, pose.T, q_near=q)
        for solution in solutions:
            assert max(pose.distance_to(Pose(*robot.direct_kinematics(solution)))) < ACCURACY
        assert np.abs(solutions - q).max(axis=1).min() < 1e-6


def test_who_asks_for_no_closed_form_loads_no_compiler(tmp_path: Path):
    program = (
        'import sys; '
        'from robots_core import load_robot_model; '
        'load_robot_model("kuka_kr210_r2700"); '
        'sys.exit("numba" in sys.modules)'
    )
    # Elsewhere than in the repository, whose folders have the packages' names.
    assert subprocess.run([sys.executable, '-c', program], check=False, cwd=tmp_path).returncode == 0


def test_axes_without_limits_turn_to_the_seed(tmp_path: Path):
    text = load_robot_model('kuka_kr210_r2700').description
    for name in ('A4', 'A6'):
        text = text.replace(f'name="{name}" type="revolute"', f'name="{name}" type="continuous"')
    (tmp_path / 'endless.urdf').write_text(text)
    robot = UrdfRobotModel(tmp_path / 'endless.urdf')
    assert robot.axes_data.continuous.tolist() == [False, False, False, True, False, True]
    block = AnalyticalInverseKinematic(robot)
    pose = Pose(*robot.direct_kinematics(Q))
    seed = Q + np.array([0.0, 0.0, 0.0, 6.0 * np.pi, 0.0, -4.0 * np.pi])
    np.testing.assert_allclose(block.solve(pose, seed), seed, atol=ACCURACY)
    assert len(block.solve_all(pose, turns=True)) == len(block.solve_all(pose))
    with pytest.raises(UnreachablePoseError, match='out of reach'):
        block.solve(Pose([5.0, 0.0, 1.0], np.eye(3)))
    beyond = np.array([0.4, 0.0, 1.3, 0.7, 0.9, -0.5])
    with pytest.raises(UnreachablePoseError, match='A2 = '):
        block.solve(Pose(*robot.direct_kinematics(beyond)), configuration=block.configuration(beyond))
