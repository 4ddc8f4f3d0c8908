"""The program of the rover: payloads that it cannot hold, contact that was not planned, signals that stop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from robots_controller.simulate import simulate
from robots_core import load_robot_model
from robots_core.blocks import NumericalDynamics, Payload
from robots_core.blocks.multibody.loaded_robot import LoadedRobot
from robots_core.errors import PlanningError
from robots_planning import LinearJoint
from robots_planning.verification.payload_weight import check_weight

from .simulated_program import PROGRAMS

PROGRAM = PROGRAMS / 'rover_placement.lua'
SCENE = PROGRAMS / 'scenes' / 'rover_placement.yaml'
IO = PROGRAMS / 'io' / 'rover_placement.yaml'


@pytest.mark.parametrize(
    ('old', 'new', 'message'),
    [
        ('PACKAGE = {1.4', 'PACKAGE = {30', 'the robot cannot hold its payload of 30 kg: joint_2 needs 1'),
        ('DOWN, PATIENCE = 0.15', 'DOWN, PATIENCE = 0.17', 'package'),
        (
            'waitDigitalInput(1, closed',
            'waitDigitalInput(2, closed',
            'the hand reports no package',
        ),
    ],
)
def test_what_cannot_be_done_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = PROGRAM.read_text()
    assert text.count(old) == 1
    (tmp_path / 'program.lua').write_text(text.replace(old, new))
    run = simulate(tmp_path / 'program.lua', robot='rover_jaco', drive='ideal', rate=50.0, scene=SCENE, io=IO)
    assert message in str(run.error)
    assert not run.ok


def test_the_weight_that_is_refused_is_that_of_the_bodies() -> None:
    robot = load_robot_model('rover_jaco')
    home = np.array(robot.home)
    over = np.array([0.27, *np.radians([4.8, 226.1, 79.7, -10.0, 39.0, -44.2])])
    motion = LinearJoint(robot).generate(home, over)
    load = Payload(30.0, np.array([0.0, 0.0, 0.09]))
    places = motion.sample(np.linspace(0.0, motion.duration, 20))[0]
    dynamics = NumericalDynamics(robot, payload=load, friction=False)
    weight = np.array([dynamics.bias_torques(q, np.zeros(7)) for q in places])
    used = np.abs(weight) / robot.axes_data.effort
    place, axis = np.unravel_index(int(used.argmax()), used.shape)
    assert used.max() > 1.0
    with pytest.raises(PlanningError, match='cannot hold its payload of 30 kg') as error:
        check_weight(motion, LoadedRobot(robot, load), 30.0)
    assert f'{robot.axes_data.names[axis]} needs {abs(weight[place, axis]):.4g} N m' in str(error.value)
    check_weight(motion, LoadedRobot(robot, Payload(1.4)), 1.4)
    check_weight(motion, robot, 0.0)
