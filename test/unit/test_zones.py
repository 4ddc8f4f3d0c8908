"""Zones: exact clearances, passages that miss nothing, and plans that cross no border."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from robots_core import Pose, load_robot_model
from robots_core.blocks import (
    CollisionDetection,
    HalfSpace,
    JointPath,
    PlacedBox,
    Zone,
    ZoneDetection,
    ZoneError,
    read_scene,
)
from robots_core.blocks.collision.robot_solids import robot_solids
from robots_core.blocks.collision.scene import AttachedObject, Scene
from robots_core.blocks.zones.zone import Keep, What
from robots_core.blocks.zones.zone_passages import MARGIN
from robots_core.errors import InvalidInputError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Box, Capsule, Cylinder, Mesh, Sphere
from robots_planning import LinearJoint, MotionSettings
from robots_planning.motion_kinds import JOINT
from robots_planning.pathplanning import PathPlanning

from .small_arms import small_arm, start_of

ROBOTS = ('kuka_kr210_r2700', 'ur5e')
TOOL = np.array([0.1, 0.0, 0.2])


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> BaseRobotModel:
    return robot_of(request.param)


@cache
def robot_of(name: str) -> BaseRobotModel:
    return load_robot_model(name)


def box(centre: object, size: tuple[float, float, float], angles: object = (0.0, 0.0, 0.0)) -> PlacedBox:
    return PlacedBox(Box(size), Pose.from_angles(centre, angles))  # type: ignore[arg-type]


def detection(
    robot: BaseRobotModel, *zones: Zone, attached: tuple[AttachedObject, ...] = ()
) -> ZoneDetection:
    return ZoneDetection(robot, Scene(attached=attached, zones=zones), TOOL)


def random_positions(robot: BaseRobotModel, count: int) -> np.ndarray:
    low, high = robot.axes_data.one_turn
    return np.random.default_rng(1).uniform(low, high, (count, robot.num_axes))


def tool_at(robot: BaseRobotModel, q: np.ndarray) -> np.ndarray:
    r, T = robot.direct_kinematics(q)
    return np.asarray(r + T @ TOOL)


def tool_reach(robot: BaseRobotModel) -> float:
    return float(np.linalg.norm(tool_at(robot, robot.home)))


def support(robot: BaseRobotModel, q: np.ndarray, direction: np.ndarray) -> float:
    """How far the bodies that axes move reach in a direction, m, by the formulas of their shapes."""
    r, T = robot.kinematic_model.frame_axes(q)
    reach = []
    for solid in robot_solids(robot):
        if solid.frame == 0:
            continue
        pose = Pose(r[solid.frame - 1], T[solid.frame - 1]) @ solid.pose
        d = pose.T.T @ direction
        match solid.geometry:
            case Box(size):
                own = 0.5 * float(np.abs(d) @ np.array(size))
            case Sphere(radius):
                own = radius
            case Cylinder(radius, length):
                own = radius * float(np.hypot(d[0], d[1])) + 0.5 * length * abs(d[2])
            case Capsule(radius, length):
                own = radius + 0.5 * length * abs(d[2])
            case Mesh(vertices):
                own = float((vertices @ d).max())
        reach.append(float(direction @ pose.r) + own)
    return max(reach)


def test_a_plane_is_as_far_as_the_bodies_reach(robot: BaseRobotModel) -> None:
    normal = np.array([1.0, -2.0, 0.5]) / np.linalg.norm([1.0, -2.0, 0.5])
    wall = Zone('wall', HalfSpace(np.array([0.3, 0.2, 0.1]), normal), 'out', 'bodies')
    found = detection(robot, wall)
    for q in random_positions(robot, 20):
        expected = normal @ wall.region.point - support(robot, q, normal)  # type: ignore[union-attr]
        assert found.clearance(wall).closest(q)[0] == pytest.approx(expected, abs=1e-9)


def test_keeping_in_is_keeping_out_of_the_other_side(robot: BaseRobotModel) -> None:
    point, normal = np.array([0.3, 0.2, 0.4]), np.array([0.0, 0.6, -0.8])
    inside = Zone('inside', HalfSpace(point, normal), 'in', 'bodies')
    outside = Zone('outside', HalfSpace(point, -normal), 'out', 'bodies')
    found = detection(robot, inside, outside)
    for q in random_positions(robot, 20):
        assert found.clearance(inside).closest(q)[0] == pytest.approx(found.clearance(outside).closest(q)[0])


def test_a_fence_is_as_far_as_its_nearest_wall(robot: BaseRobotModel) -> None:
    size, pose = (2.0, 3.0, 2.5), Pose.from_angles([0.1, 0.2, 0.9], [0.4, 0.1, -0.2])
    fence = Zone('fence', PlacedBox(Box(size), pose), 'in', 'bodies')
    found = detection(robot, fence)
    for q in random_positions(robot, 20):
        walls = [
            sign * pose.T[:, k] @ pose.r + 0.5 * size[k] - support(robot, q, sign * pose.T[:, k])
            for k in range(3)
            for sign in (1.0, -1.0)
        ]
        assert found.clearance(fence).closest(q)[0] == pytest.approx(min(walls), abs=1e-9)


@pytest.mark.parametrize('keep', ['in', 'out'])
def test_the_clearance_of_a_tool_is_that_of_its_point(robot: BaseRobotModel, keep: Keep) -> None:
    size, pose = (0.8, 1.0, 1.2), Pose.from_angles([0.5, 0.0, 0.6], [0.4, 0.1, -0.2])
    zone = Zone('press', PlacedBox(Box(size), pose), keep, 'tool')
    found = detection(robot, zone)
    for q in random_positions(robot, 30):
        outside = np.abs(pose.T.T @ (tool_at(robot, q) - pose.r)) - 0.5 * np.array(size)
        expected = -outside.max()
        if keep == 'out':
            expected = np.linalg.norm(outside.clip(min=0.0)) if outside.max() > 0.0 else outside.max()
        assert found.clearance(zone).closest(q)[0] == pytest.approx(expected, abs=1e-5)


def test_bodies_are_in_a_box_where_they_collide_with_it(robot: BaseRobotModel) -> None:
    reach = tool_reach(robot)
    region = box(0.7 * tool_at(robot, robot.home), (0.3 * reach, 0.3 * reach, 0.4 * reach), (0.3, 0.2, 0.1))
    press = Zone('press', region, 'out', 'bodies')
    found = detection(robot, press)
    sides = set()
    for q in random_positions(robot, 60):
        clearance, _ = found.clearance(press).closest(q)
        placed = found.clearance(press)._set  # the collision checker's own proof is the measure
        apart = placed.distances(np.arange(placed.first.size), np.full(placed.first.size, np.inf)).min()
        assert (clearance > 0.0) == (apart > 0.0)
        if apart > 0.0:
            assert clearance == pytest.approx(apart, abs=1e-6)
        sides.add(clearance > 0.0)
    assert sides == {True, False}


def test_what_is_attached_counts_and_the_base_does_not() -> None:
    robot = robot_of('ur5e')
    floor = Zone('floor', HalfSpace([0.0, 0.0, 0.0], [0.0, 0.0, -1.0]), 'out', 'bodies')
    bare = detection(robot, floor).clearance(floor).closest(robot.home)
    lance = AttachedObject('lance', Capsule(0.01, 3.0), Pose.identity())
    held = detection(robot, floor, attached=(lance,)).clearance(floor).closest(robot.home)
    assert bare[0] > 0.0  # although its base stands on the floor
    assert held[1] == 'lance'
    assert held[0] < bare[0]


def paths(robot: BaseRobotModel) -> list[JointPath]:
    """Between random joint positions inside the limits."""
    planner, low, high = LinearJoint(robot), *robot.axes_data.one_turn
    parts = np.random.default_rng(2).uniform(0.3, 0.7, (6, 2, robot.num_axes))
    motions = [planner.generate(*(low + pair * (high - low))) for pair in parts]
    return [JointPath(m.time, m.position, m.velocity, m.acceleration) for m in motions]


def crossed_region(robot: BaseRobotModel, path: JointPath, keep: Keep, what: What) -> PlacedBox:
    """A box around the robot where it starts, or in the way of its tool."""
    start, middle = path.sample(path.start), path.sample(0.5 * (path.start + path.end))
    if keep == 'out':
        place = tool_at(robot, middle) if what == 'tool' else robot.direct_kinematics(middle)[0]
        return box(place, (0.1 * tool_reach(robot),) * 3, (0.3, 0.2, 0.1))
    if what == 'tool':
        way = tool_at(robot, middle) - tool_at(robot, start)
        return box(tool_at(robot, start), (float(np.linalg.norm(way)),) * 3, (0.3, 0.2, 0.1))
    high = np.array([support(robot, start, axis) for axis in np.eye(3)]) + 0.01
    low = np.array([-support(robot, start, -axis) for axis in np.eye(3)]) - 0.01
    x, y, z = (high - low).tolist()
    return box(0.5 * (low + high), (x, y, z))


@pytest.mark.parametrize('what', ['tool', 'bodies'])
@pytest.mark.parametrize('keep', ['in', 'out'])
def test_passages_are_where_the_clearance_is_below_the_margin(
    robot: BaseRobotModel, keep: Keep, what: What
) -> None:
    crossings = 0
    for path in paths(robot):
        zone = Zone('zone', crossed_region(robot, path, keep, what), keep, what)
        found = detection(robot, zone)
        clearance = found.clearance(zone)
        if clearance.closest(path.sample(path.start))[0] < MARGIN:
            continue
        parts = found.passages(zone, path)
        crossings += len(parts)
        assert all(a.end <= b.start for a, b in pairwise(parts))
        for time in np.linspace(path.start, path.end, 200):
            across = any(part.start <= time <= part.end for part in parts)
            assert across or clearance.closest(path.sample(float(time)))[0] >= MARGIN
        for part in parts:
            # The robot that stops there has come near the border and not across.
            assert 0.0 < clearance.closest(path.sample(part.start))[0] < 3.0 * MARGIN
    assert crossings >= 2


def turned(angle: float) -> np.ndarray:
    return np.array([angle, 0.0, 0.0])


def test_a_robot_may_leave_and_not_go_further_in() -> None:
    robot, start = small_arm(3), start_of(3)
    r, _ = robot.direct_kinematics(start)
    press = Zone('press', box(r, (0.2, 0.2, 0.2)), 'out', 'tool')
    found = ZoneDetection(robot, Scene(zones=(press,)))
    out, inner = start + turned(1.0), start + turned(0.05)
    assert not found.passages(press, JointPath.straight(inner, out))
    (deeper,) = found.passages(press, JointPath.straight(inner, start))
    assert deeper.start == 0.0
    # Back in again after it was out counts.
    (again,) = found.passages(press, JointPath.straight(inner, inner + turned(2.0 * np.pi - 0.05)))
    assert again.start > 0.9


def test_a_plan_across_a_border_is_refused_with_zone_body_and_place() -> None:
    robot = robot_of('kuka_kr210_r2700')
    wall = HalfSpace([0.0, 1.0, 0.0], [0.0, 1.0, 0.0])
    for what, name in (('bodies', 'link_'), ('tool', 'the tool')):
        zone = Zone('neighbour', wall, 'out', what)  # type: ignore[arg-type]
        planning = PathPlanning(robot, collision=CollisionDetection(robot, scene=Scene(zones=(zone,))))
        planning.plan(JOINT, robot.home, robot.home + np.array([0.2, 0, 0, 0, 0, 0]))
        with pytest.raises(ZoneError, match=r"border of zone 'neighbour' after .* % of the path") as info:
            planning.plan(JOINT, robot.home, robot.home + np.array([-1.2, 0, 0, 0, 0, 0]))
        assert str(info.value.details['body']).startswith(name)
        assert "mm inside zone 'neighbour'" in str(info.value)
        assert float(info.value.details['time']) > 0.0
        assert float(info.value.details['clearance']) < -0.3


def test_a_longer_tool_is_refused_where_a_short_one_passes() -> None:
    robot = robot_of('kuka_kr210_r2700')
    reach = float(tool_at(robot, robot.home)[0])
    zone = Zone('column', HalfSpace([reach + 0.3, 0.0, 0.0], [1.0, 0.0, 0.0]), 'out', 'tool')
    planning = PathPlanning(robot, collision=CollisionDetection(robot, scene=Scene(zones=(zone,))))
    start = robot.home + np.array([0.8, 0, 0, 0, 0, 0])
    planning.plan(JOINT, start, robot.home, MotionSettings(tool=(0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 1.0)))
    with pytest.raises(ZoneError):
        planning.plan(JOINT, start, robot.home, MotionSettings(tool=(0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 1.0)))


def test_a_zone_that_an_input_opens_is_not_refused() -> None:
    robot = robot_of('ur5e')
    zone = Zone('press', box([0, 0, 0], (9, 9, 9)), 'out', 'tool', {'press_open': False})
    detection(robot, zone).check(JointPath.straight(robot.home, robot.home + 0.1))


def test_a_robot_without_bodies_keeps_none_in() -> None:
    zone = Zone('press', box([0, 0, 0], (1, 1, 1)), 'out', 'bodies')
    with pytest.raises(InvalidInputError, match=r"zone 'press' is for the bodies of .*, which has none"):
        detection(small_arm(3), zone)


@pytest.mark.parametrize('normal', [[0.0, 0.0, 0.0], [0.0, np.nan, 1.0], [1e-300, 0.0, 0.0]])
def test_a_plane_needs_a_direction(normal: list[float]) -> None:
    with pytest.raises(InvalidInputError, match='normal'):
        HalfSpace([0.0, 0.0, 0.0], normal)  # type: ignore[arg-type]


SCENE = """\
zones:
  - name: fence
    box: {size: [4, 4, 3]}
    pose: {position: [0, 0, 1.5]}
    keep: in
    what: bodies
  - name: press
    plane: {point: [1, 0, 0], normal: [2, 0, 0]}
    keep: out
    what: tool
    closed_by: {press_open: off, digital_input.2: on}
    shared_with: [/robot_b, /line/robot_c]
"""


def test_zones_are_read_from_scene_files(tmp_path: Path) -> None:
    (tmp_path / 'scene.yaml').write_text(SCENE)
    fence, press = read_scene(tmp_path / 'scene.yaml').zones
    assert (fence.name, fence.keep, fence.what, fence.always_closed) == ('fence', 'in', 'bodies', True)
    assert isinstance(fence.region, PlacedBox)
    assert fence.region.box.size == (4.0, 4.0, 3.0)
    np.testing.assert_array_equal(fence.region.pose.r, [0.0, 0.0, 1.5])
    assert isinstance(press.region, HalfSpace)
    np.testing.assert_array_equal(press.region.normal, [1.0, 0.0, 0.0])
    assert (press.keep, press.what) == ('out', 'tool')
    assert press.shared_with == ('/robot_b', '/line/robot_c')
    assert press.closed_by == {'press_open': False, 'digital_input.2': True}


@pytest.mark.parametrize(
    ('good', 'bad', 'line', 'reason'),
    [
        ('    box: {size: [4, 4, 3]}\n', '', 2, "zone 'fence' has neither box nor plane"),
        ('keep: in', 'keep: inside', 5, "keep is 'inside'; valid are in, out"),
        ('    keep: in\n', '', 2, 'keep is missing'),
        ('what: bodies', 'what: all', 6, "what is 'all'; valid are tool, bodies"),
        ('size: [4, 4, 3]', 'size: [4, 4, 0]', 3, 'above 0'),
        ('normal: [2, 0, 0]', 'normal: [0, 0, 0]', 8, 'has no direction'),
        ('normal: [2, 0, 0]', 'normal: up', 8, 'must be 3 numbers'),
        ('plane: {', 'pose: {position: [0, 0, 0]}\n    plane: {', 8, "unknown key 'pose'"),
        ('press_open: off', 'press_open: half', 11, "press_open is 'half'; valid are true and false"),
        ('{press_open: off, digital_input.2: on}', '{}', 11, 'names no input'),
        ('name: press', 'name: fence', 7, "the name 'fence' is used in line 2 already"),
        ('/line/robot_c', 'robot_c', 12, "'robot_c' is no namespace of a robot"),
        ('/line/robot_c', '/robot_b', 12, '/robot_b stands twice'),
        ('[/robot_b, /line/robot_c]', '[]', 12, 'shared_with names no robot'),
        ('[/robot_b, /line/robot_c]', '{/robot_b: 1}', 12, 'shared_with must be a list'),
        ('closed_by', 'closed', 11, "unknown key 'closed'; did you mean 'closed_by'?"),
    ],
)
def test_a_mistake_in_a_zone_is_reported_with_its_line(
    tmp_path: Path, good: str, bad: str, line: int, reason: str
) -> None:
    assert good in SCENE
    path = tmp_path / 'scene.yaml'
    path.write_text(SCENE.replace(good, bad, 1))
    with pytest.raises(InvalidInputError) as info:
        read_scene(path)
    assert str(info.value).startswith(f'{path}:{line}: '), info.value
    assert reason in str(info.value)
