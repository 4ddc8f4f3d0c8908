"""Programs whose joint motions go around obstacles: simulated, walked, and refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.program_check.walk import walk_program

from .simulated_program import ROBOT, run_text

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
    result = walk_program(program, robot=ROBOT, scene=scene)
    (problem,) = map(str, result.problems)
    assert problem.startswith('walked.lua:5: ptpCartesianSpace: the motion collides: ')
    assert 'ptpJointSpacePosition leads there around it in ' in problem


def test_a_budget_that_is_none_is_refused(tmp_path: Path):
    run = run_text(tmp_path, 'setAvoid(true, 0)\n')
    assert run.error is not None
    assert 'setAvoid: budget = 0 s; valid is a finite number above 0' in run.error.reason
