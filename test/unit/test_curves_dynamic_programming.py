"""Arcs and splines by dynamic programming: out of singularities, and along self-motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import PlanningError, UnreachablePoseError
from robots_planning import CircularCartesian, SplineCartesian, verify
from robots_planning.trajectory_generators.curves_cartesian import PosesGenerator

CURVES = (CircularCartesian, SplineCartesian)


def poses_from(pose: Pose, offsets: Sequence[Sequence[float]], turn: Sequence[float]) -> list[Pose]:
    """Poses that are moved by `offsets`, m, and turned by `turn` from one to the next, rad."""
    poses, T = [], pose.T
    for offset in offsets:
        T = Rotation.from_rotvec(turn).as_matrix() @ T
        poses.append(Pose(pose.r + offset, T))
    return poses


def planned(generator: PosesGenerator, q: np.ndarray, poses: list[Pose]) -> np.ndarray:
    """The end of a plan that keeps all limits and its path."""
    robot = generator.robot
    trajectory = generator.generate(q, poses)
    path = generator.path(Pose(*robot.direct_kinematics(q)), poses)
    report = verify(trajectory, robot, path=path)
    assert report.ok, report.describe()
    np.testing.assert_array_equal(trajectory.position[0], q)
    end: np.ndarray = trajectory.position[-1]
    # The inverse kinematics of the end converges to 1e-10.
    assert max(Pose(*robot.direct_kinematics(end)).distance_to(poses[-1])) < 1e-9
    return end


@pytest.mark.parametrize('curve', CURVES)
@pytest.mark.parametrize(
    'offsets', [[[0.0, 0.1, 0.05], [0.1, 0.2, 0.0]], [[0.0, -0.1, -0.1], [-0.1, -0.2, 0.0]]]
)
def test_out_of_a_straight_wrist(curve: type[PosesGenerator], offsets: list[list[float]]) -> None:
    """Home is singular: 'limited' cannot leave it; here the wrist turns first, the tool stands still."""
    robot = load_robot_model('kuka_kr210_r2700')
    poses = poses_from(Pose(*robot.direct_kinematics(robot.home)), offsets, [0.1, 0.0, 0.2])
    with pytest.raises(PlanningError, match=r'singularity at 0\.0 %'):
        curve(robot).generate(robot.home, poses)
    generator = curve(robot, keeps_torque=True)
    planned(generator, robot.home, poses)
    path = generator.path(Pose(*robot.direct_kinematics(robot.home)), poses)
    assert generator.follow(path, robot.home) is None


@pytest.mark.parametrize('curve', CURVES)
def test_self_motion_keeps_a_seventh_axis_inside_its_limits(curve: type[PosesGenerator]) -> None:
    """Curves on which the least joint motion runs into a limit that self-motion avoids."""
    robot = load_robot_model('franka_fr3')
    rescued, rng = 0, np.random.default_rng(4)
    least, chosen = curve(robot), curve(robot, keeps_torque=True)
    for _ in range(80):
        q, poses = _random_curve(robot, rng)
        try:
            least.generate(q, poses)
        except UnreachablePoseError:
            continue
        except PlanningError as error:
            if 'bound' not in error.details:
                continue
            try:
                planned(chosen, q, poses)
            except PlanningError:
                continue
            rescued += 1
            if rescued == 2:
                return
    pytest.fail(f'only {rescued} of 80 curves')


def _random_curve(robot: BaseRobotModel, rng: np.random.Generator) -> tuple[np.ndarray, list[Pose]]:
    axes = robot.axes_data
    q = np.clip(robot.home + 0.5 * rng.normal(size=7), axes.lower + 0.03, axes.upper - 0.03)
    offsets = rng.uniform(-0.2, 0.2, (2, 3))
    return q, poses_from(Pose(*robot.direct_kinematics(q)), offsets, [0.1, 0.0, 0.1])


def test_a_spline_of_thousands_of_poses_is_planned_or_refused_with_how_far_it_goes():
    robot = load_robot_model('kuka_kr210_r2700')
    q = np.radians([0.0, -90.0, 90.0, 0.0, 60.0, 0.0])
    start = Pose(*robot.direct_kinematics(q))

    def poses(number: int) -> list[Pose]:
        angles = np.linspace(0.0, 6.0, number + 1)[1:]
        return [Pose(start.r + 0.1 * np.array([0.0, np.sin(a), np.cos(a) - 1.0]), start.T) for a in angles]

    few, many = (SplineCartesian(robot).generate(q, poses(number)) for number in (100, 3000))
    # The same circle, sampled by more poses.
    assert many.duration == pytest.approx(few.duration, rel=1e-2)
    with pytest.raises(PlanningError, match=r'more than 4000 path samples.* 80.0 % of its 0.600 m') as caught:
        SplineCartesian(robot).generate(q, poses(5000))
    assert caught.value.details['fraction'] == pytest.approx(0.8, abs=1e-3)
