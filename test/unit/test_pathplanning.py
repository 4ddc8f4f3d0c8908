"""PathPlanning: the right generator per kind of motion, settings, verified plans."""

from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError, PlanningError
from robots_planning import (
    LinearCartesianLimited,
    LinearJoint,
    LinearJointAxes,
    MotionSettings,
    PathPlanning,
)
from robots_planning.motion_kinds import CIRCLE, JOINT, JOINT_TO_POSE, LINE, SPLINE, MotionKind
from robots_planning.verification.trajectory_verification import LINE_TOLERANCE


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('bello_bot')


@pytest.fixture(scope='module')
def target(robot: BaseRobotModel) -> Pose:
    start = Pose(*robot.direct_kinematics(robot.home))
    return Pose(start.r - [0.0, 0.0, 0.15], start.T)


def test_each_kind_plans_its_motion(robot: BaseRobotModel, target: Pose) -> None:
    planning = PathPlanning(robot)
    joints = planning.plan(JOINT, robot.home, robot.home + 0.1)
    np.testing.assert_array_equal(joints.trajectory.position[-1], robot.home + 0.1)
    by_joints = planning.plan(JOINT_TO_POSE, robot.home, target)
    straight = planning.plan(LINE, robot.home, target)
    for motion in (by_joints, straight):
        reached = Pose(*robot.direct_kinematics(motion.trajectory.position[-1])).distance_to(target)
        assert reached[0] < 1e-9
        assert motion.report.ok
        assert motion.duration == motion.trajectory.duration
    assert straight.report.line_deviation is not None
    assert by_joints.report.line_deviation is None
    assert straight.kind is LINE


@pytest.mark.parametrize('planner', ['limited', 'dynamic_programming'])
@pytest.mark.parametrize('kind', [CIRCLE, SPLINE])
def test_curves_are_verified_against_their_path(
    robot: BaseRobotModel, kind: MotionKind, planner: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = MotionSettings(cartesian_planner=planner, tool=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0))
    planning = PathPlanning(robot)
    start = Pose(*robot.direct_kinematics(robot.home)) @ settings.tool_pose
    poses = tuple(Pose(start.r + step, start.T) for step in np.array([[0, 0.05, -0.05], [0, 0, -0.1]]))
    motion = planning.plan(kind, robot.home, poses, settings)
    assert motion.report.line_deviation is not None
    assert motion.report.line_deviation < LINE_TOLERANCE
    # A generator that goes somewhere else on its way to the same end is caught.
    generator = planning.generator(kind, settings)
    aside = Pose(poses[0].r + np.array([1e-3, 1e-3, 0.0]), start.T)
    detour = generator.generate(robot.home, (aside, poses[1]))
    monkeypatch.setattr(generator, 'generate', lambda *_: detour)
    with pytest.raises(PlanningError, match='the tool leaves its line by'):
        planning.plan(kind, robot.home, poses, settings)


def test_generators_are_those_of_the_design(robot: BaseRobotModel) -> None:
    planning, settings = PathPlanning(robot), MotionSettings()
    assert isinstance(planning.generator(JOINT, settings), LinearJoint)
    assert isinstance(planning.generator(JOINT_TO_POSE, settings), LinearJoint)
    assert isinstance(planning.generator(LINE, settings), LinearCartesianLimited)


def test_a_target_of_the_wrong_kind_is_refused(robot: BaseRobotModel, target: Pose) -> None:
    planning = PathPlanning(robot)
    with pytest.raises(InvalidInputError, match='needs joint positions'):
        planning.plan(JOINT, robot.home, target)
    with pytest.raises(InvalidInputError, match='needs a Pose'):
        planning.plan(JOINT_TO_POSE, robot.home, robot.home)
    with pytest.raises(InvalidInputError, match='PTPCARTESIAN circle needs poses'):
        planning.plan(CIRCLE, robot.home, target)


def test_limiting_axis_is_the_one_that_takes_longest(robot: BaseRobotModel) -> None:
    axes = robot.axes_data
    for axis in range(robot.num_axes):
        target = robot.home + 0.01
        target[axis] = robot.home[axis] + 0.2
        motion = PathPlanning(robot).plan(JOINT, robot.home, target)
        # Twenty times the travel, but no axis is twenty times as strong.
        assert motion.limiting_axis == axes.names[axis]


def test_joint_planner_and_configuration_are_chosen_by_name(robot: BaseRobotModel) -> None:
    planning = PathPlanning(robot)
    for name, planner in (('linear_joint', LinearJoint), ('linear_joint_axes', LinearJointAxes)):
        settings = MotionSettings(joint_planner=name)
        assert type(planning.generator(JOINT, settings)) is planner
    with pytest.raises(InvalidInputError, match='linear_joint_axes'):
        MotionSettings(joint_planner='linear')
    with pytest.raises(InvalidInputError, match='no_flip'):
        MotionSettings(configuration='upside/down')
    kuka = load_robot_model('kuka_kr210_r2700')
    q = np.array([0.3, -1.2, 1.5, 0.4, 0.7, -0.2])
    flipped = MotionSettings(configuration='front/up/no_flip'), MotionSettings(configuration='front/up/flip')
    pose = Pose(*kuka.direct_kinematics(q))
    ends = [PathPlanning(kuka).plan(JOINT_TO_POSE, q, pose, item).trajectory.position[-1] for item in flipped]
    assert np.sign(ends[0][4]) == -np.sign(ends[1][4])
    # Joint positions need no configuration; a robot without a closed form has none to offer.
    planning.plan(JOINT, robot.home, robot.home + 0.1, flipped[0])


NUMBERS = [
    field.name
    for field in fields(MotionSettings)
    # The budget of a search is no limit of a plan: test_collision_free_joint.py
    if isinstance(field.default, float) and 'zone' not in field.name and field.name != 'avoid_budget'
]


@pytest.mark.parametrize('name', NUMBERS)
def test_every_number_matters_and_is_checked(robot: BaseRobotModel, target: Pose, name: str) -> None:
    turned = Pose(target.r, Pose.from_angles([0.0] * 3, [0.3, 0.0, 0.0]).T @ target.T)
    default = MotionSettings()
    slow = replace(default, **{name: 0.02 * getattr(default, name)})
    planning = PathPlanning(robot)
    usual = planning.plan(LINE, robot.home, turned, default).duration
    assert planning.plan(LINE, robot.home, turned, slow).duration > 1.5 * usual
    for value in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InvalidInputError, match=name):
            replace(default, **{name: value})
    with pytest.raises(FrozenInstanceError):
        setattr(default, name, 1.0)


def test_warming_up_plans_for_any_home_and_leaves_nothing_behind() -> None:
    for name in ('kuka_kr210_r2700', 'bello_bot'):  # one home is singular, the other is not
        robot = load_robot_model(name)
        planning = PathPlanning(robot)
        planning.warm_up()
        target = 0.9 * robot.home
        cold = PathPlanning(robot).plan(JOINT, robot.home, target)
        warm = planning.plan(JOINT, robot.home, target)
        np.testing.assert_array_equal(warm.trajectory.position, cold.trajectory.position)
