"""Robots of the suite in MuJoCo, whose computations are an independent reference, under ControllerSixAxes."""

from __future__ import annotations

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

from mujoco_model import mujoco_model
from robots_core import load_robot_model
from robots_core.blocks.multibody.function_dynamics import FunctionDynamics
from robots_core.errors import InvalidInputError
from welding_in_mujoco import PERIOD, SUBSTEPS, run

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    'name', ['bello_bot', 'cello_bot', 'debris_arm?gravity=0,0,0', 'kuka_kr210_r2700', 'kinova_j2n6s300']
)
def test_the_torques_of_mujoco_are_ours(name: str):
    robot = load_robot_model(name)
    model = mujoco_model(robot, timestep=0.001)
    data, dynamics = mujoco.MjData(model), FunctionDynamics(robot)
    random = np.random.default_rng(1)
    for _ in range(5):
        q = random.uniform(*robot.axes_data.one_turn)
        q_dot, q_ddot = random.uniform(-2.0, 2.0, (2, robot.num_axes))
        data.qpos[:], data.qvel[:], data.qacc[:] = q, q_dot, q_ddot
        mujoco.mj_inverse(model, data)
        # The terms of the sums are up to a thousand times as large as they are.
        assert data.qfrc_inverse == pytest.approx(dynamics.torques(q, q_dot, q_ddot), rel=1e-9, abs=1e-9)


def test_inertias_that_no_body_can_have_are_refused():
    with pytest.raises(InvalidInputError, match=r'MuJoCo does not take manutec_r3: .*inertia'):
        mujoco_model(load_robot_model('manutec_r3'), timestep=0.001)


@pytest.mark.parametrize(
    ('name', 'text'),
    [
        ('bello_bot', 'ptpJointSpaceAngles(20, 30, 20, 60, 0, 20, 10)'),
        ('debris_arm?gravity=0,0,0', 'ptpJointSpaceAngles(20, 30, 40)'),
    ],
)
def test_robots_in_mujoco_follow(name: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    program = tmp_path / 'program.lua'
    program.write_text(f'print("begins")\n{text}\n')
    assert run(program, name) == 0
    out = capsys.readouterr().out
    assert out.startswith('begins\nFINISHED after ')
    # MuJoCo's integrator is of first order: positions are off by at most the way of one of its steps.
    axes = load_robot_model(name).axes_data
    errors = np.array([float(text) for text in re.findall(r'at most (\S+) from its reference', out)])
    assert errors.shape == (axes.num_axes,)
    assert (errors <= axes.velocity * PERIOD / SUBSTEPS).all()


def test_the_lines_of_the_documentation_weld(capsys: pytest.CaptureFixture[str]):
    (code,) = re.findall(
        r'```python\n(.*?)```', (ROOT / 'docs' / 'how_to' / 'own_physics.md').read_text(), re.DOTALL
    )
    exec(compile(code.replace('programs/', f'{ROOT}/programs/'), 'own_physics.md', 'exec'), {})  # noqa: S102
    assert capsys.readouterr().out == 'FINISHED after 9.4 s\n'
