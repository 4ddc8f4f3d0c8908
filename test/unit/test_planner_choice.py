"""Planners are found by entry points; third-party ones need nothing but to be installed."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pytest

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.errors import InvalidInputError
from robots_planning import MotionSettings, PathPlanning
from robots_planning.commands.motion_chain import MotionChain
from robots_planning.commands.motion_plan import CommandChain, QueuedCommand
from robots_planning.motion_kinds import CIRCLE, JOINT, JOINT_TO_POSE, LINE, MOTION_KINDS, MotionKind
from robots_planning.planner_choice import (
    ENTRY_POINT_GROUP,
    available_planners,
    check_planner,
    load_planner,
    planner_for,
)

PAGE = (Path(__file__).parents[2] / 'docs' / 'how_to' / 'add_a_planner.md').read_text()
PLUGIN = """
from robots_planning import LinearCartesianLimited, TrajectoryGenerator

class SlowLine(LinearCartesianLimited):
    def __init__(self, robot, **options):
        super().__init__(robot, **options | {'cartesian_speed': 0.01})

class StrongLine(SlowLine):
    keeps_torque = True

class Misspelt(TrajectoryGenerator):
    kinds = ('lines',)

class Idle(TrajectoryGenerator):
    pass

stone = 'stone'
"""
ENTRY_POINTS = f"""
[{ENTRY_POINT_GROUP}]
slow = third_party_planners:SlowLine
strong = third_party_planners:StrongLine
misspelt = third_party_planners:Misspelt
idle = third_party_planners:Idle
stone = third_party_planners:stone
lost = third_party_planners_that_are_gone:Line
"""


@pytest.fixture(scope='module')
def robot() -> BaseRobotModel:
    return load_robot_model('ur10e')


@pytest.fixture
def start() -> np.ndarray:
    return np.array([0.2, -1.2, 1.6, -1.9, -1.4, 0.3])


@pytest.fixture
def third_party(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A distribution with planners of its own, beside that of the documentation."""
    (code,) = re.findall(r'```python\n(.*?)```', PAGE, re.DOTALL)
    (project,) = re.findall(r'```toml\n(.*?)```', PAGE, re.DOTALL)
    points = tomllib.loads(project)['project']['entry-points'][ENTRY_POINT_GROUP]
    (name, value), *others = points.items()
    assert not others
    (tmp_path / f'{value.partition(":")[0]}.py').write_text(code)
    (tmp_path / 'third_party_planners.py').write_text(PLUGIN)
    install(tmp_path, 'third-party-planners', f'{ENTRY_POINTS}{name} = {value}\n')
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    load_planner.cache_clear()
    check_planner.cache_clear()
    for module in ('third_party_planners', value.partition(':')[0]):
        sys.modules.pop(module, None)


def install(folder: Path, name: str, points: str) -> None:
    info = folder / f'{name.replace("-", "_")}-1.0.dist-info'
    info.mkdir()
    (info / 'METADATA').write_text(f'Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n')
    (info / 'entry_points.txt').write_text(points)


def test_our_planners_are_the_values_of_the_settings() -> None:
    assert available_planners('joint_planner') == ('collision_free', 'linear_joint', 'linear_joint_axes')
    assert available_planners('cartesian_planner') == ('dynamic_programming', 'limited')
    installed = {point.name for point in entry_points(group=ENTRY_POINT_GROUP)}
    curves = {kind.planner for kind in MOTION_KINDS if kind.planner}
    settings = {name for kind in MOTION_KINDS for name in available_planners(kind.setting)}
    assert installed == curves | settings


@pytest.mark.parametrize('setting', ['joint_planner', 'cartesian_planner'])
@pytest.mark.parametrize('value', ['fast', '', 'circular', 3])
def test_a_value_that_plans_no_such_motion_is_refused_with_the_valid_ones(
    setting: str, value: object
) -> None:
    valid = ', '.join(available_planners(setting))
    with pytest.raises(InvalidInputError, match=f"unknown {setting} '{value}'; valid are {valid}"):
        MotionSettings(**{setting: value})  # type: ignore[arg-type]


@pytest.mark.parametrize('kind', MOTION_KINDS, ids=lambda kind: kind.name)
def test_every_kind_has_a_planner_under_every_setting(kind: MotionKind, robot: BaseRobotModel) -> None:
    for name in available_planners(kind.setting):
        settings = MotionSettings(**{kind.setting: name})
        assert kind.name in planner_for(kind, settings).kinds
        PathPlanning(robot).generator(kind, settings)


@pytest.mark.usefixtures('third_party')
def test_the_planner_of_the_readme_moves_a_robot(robot: BaseRobotModel, start: np.ndarray) -> None:
    planning = PathPlanning(robot)
    settings = MotionSettings(joint_planner='smooth', tool=(0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0))
    target = start + 0.4
    by_joints = planning.plan(JOINT, start, target, settings)
    assert type(planning.generator(JOINT, settings)).__name__ == 'SmoothJoint'
    assert by_joints.report.ok
    np.testing.assert_array_equal(by_joints.trajectory.position[-1], target)
    assert by_joints.duration > planning.plan(JOINT, start, target).duration
    pose = Pose(*robot.direct_kinematics(target)) @ settings.tool_pose
    q = planning.plan(JOINT_TO_POSE, start, pose, settings).trajectory.position[-1]
    assert max((Pose(*robot.direct_kinematics(q)) @ settings.tool_pose).distance_to(pose)) < 1e-8
    # It has no path to run through, and starts from rest only.
    blended = MotionSettings(joint_planner='smooth', joint_blend_zone=0.1)
    orders = tuple(
        QueuedCommand(str(number), JOINT, q, blended, 0.0) for number, q in enumerate((target, start))
    )
    plan = MotionChain(planning).plan(CommandChain(orders), start)
    motion, ends = plan.motion, tuple(plan.ends.values())
    assert ends == pytest.approx((0.5 * motion.duration, motion.duration))
    still = np.zeros(robot.num_axes)
    with pytest.raises(InvalidInputError, match='SmoothJoint cannot start from a robot that moves'):
        planning.plan_moving(JOINT, (start, still, still), target, blended)


@pytest.mark.usefixtures('third_party')
def test_curves_have_their_own_planner_and_keep_torque_where_that_of_lines_does(
    robot: BaseRobotModel, start: np.ndarray
) -> None:
    planning, settings = PathPlanning(robot), MotionSettings(cartesian_planner='slow')
    assert 'slow' in available_planners('cartesian_planner')
    pose = Pose(*robot.direct_kinematics(start))
    below = Pose(pose.r - [0.0, 0.0, 0.01], pose.T)
    motion = planning.plan(LINE, start, below, settings)
    assert motion.duration > 1.0
    assert motion.report.line_deviation is not None
    via = Pose(pose.r + np.array([0.0, 0.005, -0.005]), pose.T)
    for name in ('slow', 'strong'):
        settings = MotionSettings(cartesian_planner=name)
        assert planning.plan(CIRCLE, start, (via, below), settings).duration < 1.0
        assert planning.generator(CIRCLE, settings).keeps_torque == (name == 'strong')


@pytest.mark.usefixtures('third_party')
@pytest.mark.parametrize(
    ('name', 'message'),
    [
        ('misspelt', r"'misspelt' has kinds = \('lines',\); valid are circle, joint, "),
        ('idle', r"'idle' has kinds = \(\)"),
        ('stone', "'stone' is 'stone', not a class of TrajectoryGenerator"),
        ('lost', r"'lost' .*third-party-planners 1.0\) cannot be loaded: ModuleNotFoundError"),
    ],
)
def test_a_broken_planner_is_refused_and_others_stay(name: str, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        MotionSettings(cartesian_planner=name)
    assert available_planners('cartesian_planner') == ('dynamic_programming', 'limited', 'slow', 'strong')


def test_two_planners_of_one_name_are_refused(third_party: Path) -> None:
    install(third_party, 'others', f'[{ENTRY_POINT_GROUP}]\nslow = others:Slow\n')
    with pytest.raises(InvalidInputError, match=r"planner 'slow' is offered by several distributions"):
        MotionSettings(cartesian_planner='slow')
