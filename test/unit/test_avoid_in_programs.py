"""Programs whose joint motions go around obstacles: simulated, walked, and refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from robots_controller.program_check.walk import walk_program
from robots_controller.simulation.cell_parts import CellSetup, cell_parts
from robots_controller.simulation.simulated_cell import SimulatedCell
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core import Pose, load_robot_model
from robots_core.blocks import CollisionDetection, Scene, SceneObject
from robots_core.orientation import rotation_from_vector
from robots_core.robot_model.shapes import Box, Capsule

from .simulated_program import ROBOT, outputs, run_text

SCENE = """objects:
  - {name: post, capsule: {radius: 0.05, length: 1.6}, pose: {position: [1.2, -1.2, 1.0]}}
"""
THERE = 'ptpJointSpaceAngles(15, -70, 90, 0, 70, 0)\n'
AROUND = 'ptpJointSpaceAngles({75, -70, 90, 0, 70, 0}, {avoid = true})\n'
BACK = 'ptpJointSpaceAngles(15, -70, 90, 0, 70, 0)\n'


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / 'scene.yaml').write_text(SCENE)
    return tmp_path / 'scene.yaml'


def test_the_option_holds_for_one_motion_and_the_setting_for_those_that_follow(tmp_path: Path, scene: Path):
    run = run_text(tmp_path, THERE + AROUND + 'setAvoid(true)\n' + BACK + AROUND, scene=scene)
    assert run.error is None
    assert [motion.settings.avoid for motion in run.motions] == [False, True, True, True]
    forth, again = run.motions[1].plan, run.motions[3].plan
    assert forth is not None
    assert again is not None
    # The second start is where the controller's reference has arrived, except for rounding.
    np.testing.assert_allclose(forth.trajectory.position, again.trajectory.position, atol=1e-6)
    refused = run_text(tmp_path, THERE + AROUND + BACK, scene=scene)
    assert refused.error is not None
    assert refused.error.line == 3
    assert 'the motion collides' in refused.error.reason


def test_a_pose_is_reached_around_an_obstacle_too(tmp_path: Path, scene: Path):
    pose = 'local p = forwardKinematics(75, -70, 90, 0, 70, 0)\n'
    refused = run_text(tmp_path, THERE + pose + 'ptpJointSpacePosition(p)\n', scene=scene)
    assert refused.error is not None
    assert 'the motion collides' in refused.error.reason
    run = run_text(tmp_path, THERE + pose + 'ptpJointSpacePosition(p, {avoid = true})\n', scene=scene)
    assert run.error is None
    robot = load_robot_model(ROBOT)
    reached, wanted = (
        Pose(*robot.direct_kinematics(q)) for q in (run.position[-1], np.radians([75, -70, 90, 0, 70, 0]))
    )
    assert max(reached.distance_to(wanted)) < 1e-6


def test_blended_motions_run_through_where_the_corner_is_free(tmp_path: Path, scene: Path):
    around = AROUND.replace('avoid = true', 'avoid = true, jointBlend = 3')
    run = run_text(tmp_path, THERE + around + 'ptpJointSpaceAngles(80, -75, 90, 0, 70, 0)\n', scene=scene)
    assert run.error is None
    first, second = run.motions[1:]
    assert first.plan is second.plan


def test_a_walk_plans_the_way_and_reports_lines_that_collide_with_it(tmp_path: Path, scene: Path):
    program = tmp_path / 'walked.lua'
    line = 'setAvoid(true)\nlocal p = forwardKinematics(15, -70, 90, 0, 70, 0)\nptpCartesianSpace(p)\n'
    program.write_text(THERE + AROUND + line)
    result = walk_program(CellSetup(program=program, robot=ROBOT, scene=scene))
    (path,) = map(str, result.paths)
    found = re.fullmatch(
        r'walked.lua:2: ptpJointSpaceAngles: goes around via \(.* deg\), [\d.]+ s; smallest distance: '
        r'\S+ comes to ([\d.]+) mm from post after [\d.]+ s',
        path,
    )
    assert found is not None, path
    assert 5.0 <= float(found[1]) < 100.0
    (problem,) = map(str, result.problems)
    assert problem.startswith('walked.lua:5: ptpCartesianSpace: the motion collides: ')
    assert 'ptpJointSpacePosition leads there around it in ' in problem


def test_a_budget_that_is_none_is_refused(tmp_path: Path):
    run = run_text(tmp_path, 'setAvoid(true, 0)\n')
    assert run.error is not None
    assert 'setAvoid: budget = 0 s; valid is a finite number above 0' in run.error.reason


# -- obstacles that come into the path ------------------------------------------------------------------

POST = SceneObject('post', Capsule(0.05, 1.6), Pose(np.array([1.2, -1.2, 1.0]), np.eye(3)))
TURNED = rotation_from_vector(np.array([0.0, 0.0, np.radians(-65.0)]))
WALL = SceneObject('wall', Box((4.0, 0.05, 8.0)), Pose(TURNED @ [2.8, 0.0, 0.0], TURNED))  # across the way
REPLANS = AROUND.replace('true', "true, on_blocked = 'replan'")


def run_into(tmp_path: Path, text: str, *coming: tuple[float, SceneObject]) -> SimulationRun:
    """Run a program with objects that come into its scene at times, s."""
    (tmp_path / 'scene.yaml').write_text(SCENE.replace('1.2, -1.2, 1.0', '5.0, 0.0, 0.0'))
    (tmp_path / 'program.lua').write_text(text)
    parts = cell_parts(
        CellSetup(program=tmp_path / 'program.lua', robot=ROBOT, scene=tmp_path / 'scene.yaml')
    )
    waiting = list(coming)

    def check(time: float, _line: int) -> None:
        if waiting and time >= waiting[0][0]:
            guard.set_scene(Scene((waiting.pop(0)[1],)))

    cell = SimulatedCell(parts, drive='ideal', longest=60.0, on_progress=check)
    guard = cell._cell._guard
    assert guard is not None
    return cell.run()


def test_a_robot_that_an_obstacle_stops_goes_around_it_and_the_program_goes_on(tmp_path: Path):
    switch = REPLANS.replace('})', ', on_path = {time_after_start = 0.1, output = 1, value = true}})')
    text = THERE + switch + 'ptpJointSpaceAngles(75, -80, 90, 0, 70, 0)\n'
    run = run_into(tmp_path, text, (2.2, POST))
    assert run.error is None
    assert [motion.message for motion in run.motions] == ['reached'] * 3
    around = run.motions[1]
    assert around.plan is not None
    assert around.started > 2.2  # its last plan
    np.testing.assert_allclose(np.degrees(run.position[-1]), [75, -80, 90, 0, 70, 0], atol=1e-6)
    collision = CollisionDetection(load_robot_model(ROBOT), scene=Scene((POST,)))
    assert all(not collision.in_contact(q) for q in run.position[::10])
    assert [value for _, value in outputs(run)] == [1.0]  # once, on the first way


def test_without_the_setting_the_program_fails_with_what_has_come_into_the_path(tmp_path: Path):
    run = run_into(tmp_path, THERE + AROUND, (2.2, POST))
    assert run.error is not None
    assert 'ptpJointSpaceAngles: stopped before a collision: ' in run.error.reason
    assert ' mm from post after ' in run.error.reason
    assert run.error.line == 2
    assert run.motions[1].message.startswith('stopped before a collision: ')


def test_a_program_cannot_move_a_robot_on_that_stands_before_an_obstacle(tmp_path: Path):
    caught = f'pcall(function() {AROUND.strip()} end)\n'
    run = run_into(tmp_path, THERE + caught + 'wait(1)\n' + THERE, (2.2, POST))
    assert run.error is not None
    assert re.search('stopped before a collision: .* from post', run.error.reason)
    assert run.error.line == 3  # where it was stopped, after the caught error
    stands = np.degrees(run.position[:, 0])
    assert 15.0 < stands[-1] < 75.0
    assert stands[-1] == pytest.approx(stands.max())


def test_a_way_that_is_blocked_for_ever_is_refused_with_what_blocks_it_and_the_attempts(tmp_path: Path):
    text = THERE + 'setAvoid(true, 0.05, "replan", 3)\n' + BACK.replace('15', '75')
    run = run_into(tmp_path, text, (2.2, POST), (3.2, WALL))
    assert run.error is not None
    reason = run.error.reason
    assert 'mm from wall after' in reason
    assert re.search(r'; attempt [12] of 3 to go around it failed: (no free path found|the target)', reason)
    assert 'wall' in reason.rsplit('failed: ', maxsplit=1)[1]


def test_a_target_that_collides_now_is_refused(tmp_path: Path):
    r, _ = load_robot_model(ROBOT).direct_kinematics(np.radians([75, -70, 90, 0, 70, 0]))
    there = SceneObject('crate', Box((0.5, 0.5, 0.5)), Pose(r, np.eye(3)))
    run = run_into(tmp_path, THERE + REPLANS, (2.2, there))
    assert run.error is not None
    assert 'attempt 1 of 5 to go around it failed: the target collides: ' in run.error.reason
    assert ' meets crate' in run.error.reason


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        (
            REPLANS.replace('replan', 'wait'),
            "options.on_blocked = the string 'wait'; valid is 'stop', 'replan'",
        ),
        (REPLANS.replace('avoid = true, ', ''), "on_blocked = 'replan' leads around .* needs avoid = true"),
        ("ptpCartesianSpace({1, 0, 1, 0, 0, 0}, {on_blocked = 'stop'})\n", 'options has no on_blocked'),
        ("setAvoid(true, 1, 'wait')\n", "setAvoid: on_blocked = the string 'wait'"),
        ("setAvoid(true, 1, 'replan', 1.5)\n", 'setAvoid: most = 1.5; valid is a whole number'),
        ("setAvoid(true, 1, 'replan', 101)\n", r'most_replans = 101 must be a whole number in \[1, 100\]'),
    ],
)
def test_options_that_are_none_are_refused(tmp_path: Path, text: str, reason: str):
    run = run_text(tmp_path, text)
    assert run.error is not None
    assert re.search(reason, run.error.reason), run.error.reason
