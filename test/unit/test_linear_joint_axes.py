"""LinearJointAxes and what it shares with LinearJoint: axes on their own, poses, configurations, motion."""

from itertools import product

import numpy as np
import pytest

from robots_core import BaseRobotModel, Configuration, Pose, load_robot_model
from robots_core.blocks import AnalyticalInverseKinematic
from robots_core.errors import InvalidInputError, PlanningError, UnreachablePoseError
from robots_planning import LinearJoint, LinearJointAxes, Trajectory, verify
from robots_planning.trajectory_generators.joint_space import JointSpaceGenerator

BOTH = pytest.mark.parametrize('planner', [LinearJoint, LinearJointAxes])


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('kuka_kr210_r2700')


@pytest.fixture(scope='module')
def jaco() -> BaseRobotModel:
    return load_robot_model('kinova_j2n6s300')


def test_each_axis_moves_as_if_it_were_alone(robot: BaseRobotModel) -> None:
    planner = LinearJointAxes(robot)
    q = np.zeros(robot.num_axes)
    q[1], q[2] = -1.0, 1.0
    goal = q + np.array([1.0, -0.3, 0.2, 0.0, -0.05, 1e-4])
    together = planner.generate(q, goal)
    assert verify(together, robot, torque=False).ok
    t = np.linspace(0.0, together.duration, 400)
    for axis in range(robot.num_axes):
        target = q.copy()
        target[axis] = goal[axis]
        alone = planner.generate(q, target)
        # Switches of jerk are on common ticks: at most four of them.
        ticks = 4e-9 * planner.shortest * robot.axes_data.velocity[axis]
        np.testing.assert_allclose(together.sample(t)[0][:, axis], alone.sample(t)[0][:, axis], atol=ticks)
    assert not together.velocity[:, 3].any()


def test_axes_are_never_later_than_on_one_line(robot: BaseRobotModel) -> None:
    goal = robot.home + np.array([0.5, 0.2, -0.3, 0.1, 0.4, -0.2])
    line, axes = (
        LinearJoint(robot).generate(robot.home, goal),
        LinearJointAxes(robot).generate(robot.home, goal),
    )
    assert axes.duration <= line.duration + 4e-9 * LinearJointAxes(robot).shortest


@BOTH
def test_jerk_is_constant_between_points(robot: BaseRobotModel, planner: type[JointSpaceGenerator]) -> None:
    goal = robot.home + np.array([0.5, 0.2, -0.3, 0.1, 0.4, -0.2])
    trajectory = planner(robot).generate(robot.home, goal)
    c = trajectory.coefficients
    h = np.diff(trajectory.time)[:, None]
    # Jerk at both ends and in the middle of every quintic.
    jerks = [6.0 * c[:, 3] + x * (24.0 * c[:, 4] + x * 60.0 * c[:, 5]) for x in (0.0 * h, 0.5 * h, h)]
    spread = np.ptp(jerks, axis=0) / robot.axes_data.jerk
    assert spread.max() < 2e-4  # rounding of positions, which `shortest` keeps below twice 1e-4


@BOTH
def test_axes_without_limits_take_the_short_way(
    jaco: BaseRobotModel, planner: type[JointSpaceGenerator]
) -> None:
    start = np.array(jaco.home)
    start[0] = 3.0
    target = start.copy()
    target[0] = -3.0
    trajectory = planner(jaco).generate(start, target)
    assert trajectory.position[-1, 0] == pytest.approx(2.0 * np.pi - 3.0)
    target[0] = 3.0 + 20.0 * np.pi
    np.testing.assert_allclose(planner(jaco).generate(start, target).position[-1], start, atol=1e-12)


@BOTH
def test_pose_of_a_tool_is_reached(robot: BaseRobotModel, planner: type[JointSpaceGenerator]) -> None:
    tool = Pose.from_angles([0.1, 0.02, 0.3], [0.4, -0.2, 1.0])
    goal = robot.home + 0.1
    pose = Pose(*robot.direct_kinematics(goal)) @ tool
    trajectory = planner(robot, tool=tool).generate(robot.home, pose)
    np.testing.assert_allclose(trajectory.position[-1], goal, atol=1e-8)


@BOTH
def test_named_configurations_are_ended_in(robot: BaseRobotModel, planner: type[JointSpaceGenerator]) -> None:
    q = np.array([0.3, -1.2, 1.5, 0.4, 0.7, -0.2])
    pose = Pose(*robot.direct_kinematics(q))
    kinematics = AnalyticalInverseKinematic(robot)
    reached = 0
    for words in product(('front', 'back'), ('up', 'down'), ('no_flip', 'flip')):
        configuration = Configuration.parse('/'.join(words))
        generator = planner(robot, configuration=configuration)
        try:
            end = generator.generate(q, pose).position[-1]
        except UnreachablePoseError as error:
            assert str(configuration) in str(error)  # noqa: PT017  # some branches are outside the limits
            continue
        reached += 1
        assert kinematics.configuration(end) == configuration
    assert reached == 2  # the wrist turned over; the others are outside the limits
    np.testing.assert_allclose(planner(robot).generate(q, pose).position[-1], q, atol=1e-8)


def test_a_configuration_needs_a_closed_form(jaco: BaseRobotModel) -> None:
    with pytest.raises(InvalidInputError, match='closed-form'):
        LinearJoint(jaco, configuration=Configuration.parse('front/up/flip'))
    pose = Pose(*jaco.direct_kinematics(jaco.home + 0.05))
    end = LinearJointAxes(jaco).generate(jaco.home, pose).position[-1]
    assert max(Pose(*jaco.direct_kinematics(end)).distance_to(pose)) < 1e-7  # the angle of two matrices


@pytest.mark.parametrize('words', ['front', 'front/up', 'front/up/no', 'up/front/flip', 'front/up/flip/flip'])
def test_unknown_words_are_refused(words: str) -> None:
    with pytest.raises(InvalidInputError, match='no_flip or flip'):
        Configuration.parse(words)


@BOTH
def test_a_stop_from_motion_to_where_it_stands(
    robot: BaseRobotModel, planner: type[JointSpaceGenerator]
) -> None:
    q_dot = 0.5 * robot.axes_data.velocity
    trajectory = planner(robot).generate_moving((robot.home, q_dot, 0.0 * q_dot), robot.home)
    np.testing.assert_array_equal(trajectory.position[[0, -1]], np.stack([robot.home, robot.home]))
    np.testing.assert_array_equal(trajectory.velocity[0], q_dot)


def test_from_motion_axes_arrive_together_or_on_their_own(robot: BaseRobotModel) -> None:
    goal = robot.home + np.array([0.6, 0.2, -0.3, 0.1, 0.05, -0.2])
    q_dot = np.array([0.2, -0.1, 0.1, 0.0, 0.3, 0.0])

    def last_motion(trajectory: Trajectory) -> np.ndarray:
        return np.array([trajectory.time[np.flatnonzero(v)[-1] + 1] for v in trajectory.velocity.T])

    motion = robot.home, q_dot, 0.0 * q_dot
    together = last_motion(LinearJoint(robot).generate_moving(motion, goal))
    np.testing.assert_allclose(together, together[0], atol=1e-12)
    alone = last_motion(LinearJointAxes(robot).generate_moving(motion, goal))
    assert alone.min() < 0.7 * alone.max()


@BOTH
def test_impossible_starts_are_refused_by_name(
    robot: BaseRobotModel, planner: type[JointSpaceGenerator]
) -> None:
    axes, generator = robot.axes_data, planner(robot)
    start, still = robot.home.copy(), np.zeros(robot.num_axes)
    fast, strong = still.copy(), still.copy()
    fast[2], strong[2] = 1.01 * axes.velocity[2], -1.01 * axes.acceleration[2]
    with pytest.raises(InvalidInputError, match=f'q_dot_start of {axes.names[2]}'):
        generator.generate_moving((start, fast, still), start)
    with pytest.raises(InvalidInputError, match=f'q_ddot_start of {axes.names[2]}'):
        generator.generate_moving((start, still, strong), start)
    with pytest.raises(PlanningError, match='before its acceleration can end'):
        generator.generate_moving((start, 0.99 * fast, -0.9 * strong), start)
    start[2], fast[2] = axes.upper[2] - 0.01, 0.9 * axes.velocity[2]
    with pytest.raises(PlanningError, match=f'{axes.names[2]} .* cannot stop before its limit') as caught:
        generator.generate_moving((start, fast, still), robot.home)
    assert float(caught.value.details['value']) > axes.upper[2]
    with pytest.raises(InvalidInputError, match='nan'):
        generator.generate_moving((robot.home, np.full(robot.num_axes, np.nan), still), robot.home)
    with pytest.raises(InvalidInputError, match='shape'):
        generator.generate_moving((robot.home, still, [0.0]), robot.home)
