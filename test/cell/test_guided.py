"""A recorded sensor guides a robot: over real topics in a live cell, and in a simulated one."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial import cKDTree

from robots_controller.recording.bag_file import read_bag
from robots_controller.simulate import simulate
from robots_controller.testing import BAG_START, BAG_TYPES, write_bag
from robots_core import load_robot_model
from robots_core.validation import Array

from .cell_process import CellProcess

T = BAG_TYPES.types
ROBOT = load_robot_model('kuka_kr210_r2700')
PROGRAM = """-- Robot: kuka_kr210_r2700
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
print('hands over')
followReference(30, 1)
ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)
"""
READY = np.radians([0.0, -90.0, 90.0, 0.0, 90.0, 0.0])
RATE, TURN, RADIUS = 50.0, 6.0, 0.05  # Hz, s, m
REST = 3.0  # s before the circle, in which all who listen have found the replay on a busy machine
# At up to 0.1 m/s: on a busy machine poses may come late by as much as the 0.2 s after which a reference is
# stale, and the robot leaves the circle for the straight way to where it should be then.
APART = 0.02  # m


def circle(time: float) -> Any:
    """A message of where the sensor wants the tool, from rest to rest."""
    r, matrix = ROBOT.direct_kinematics(READY)
    part = np.clip((time - REST) / TURN, 0.0, 1.0)
    angle = 2.0 * np.pi * part - np.sin(2.0 * np.pi * part)
    point = r + RADIUS * np.array([0.0, np.sin(angle), 1.0 - np.cos(angle)])
    assert np.allclose(matrix, np.diag([-1.0, 1.0, -1.0]))
    stamp = T['builtin_interfaces/msg/Time'](*divmod(BAG_START + round(1e9 * time), 1_000_000_000))
    pose = T['geometry_msgs/msg/Pose'](
        T['geometry_msgs/msg/Point'](*point), T['geometry_msgs/msg/Quaternion'](0.0, 1.0, 0.0, 0.0)
    )
    return T['geometry_msgs/msg/PoseStamped'](T['std_msgs/msg/Header'](stamp, 'base'), pose)


def guided_path(bag: Path) -> Array:
    """Where the references lead the tool while the sensor guides it, (k, 3) m."""
    found = read_bag(bag).deserialized(['/guide', '/joint_reference'])
    begin = next(stamp for stamp, guide in found['/guide'] if guide.data == 'SENSOR')
    end = next(stamp for stamp, guide in found['/guide'] if stamp > begin and guide.data == 'NONE')
    references = [m.points[0].positions for stamp, m in found['/joint_reference'] if begin < stamp < end]
    return np.array([ROBOT.direct_kinematics(np.array(q))[0] for q in references])


def states(bag: Path) -> list[str]:
    found = read_bag(bag).deserialized(['/command_state'])['/command_state']
    return [message.data for _, message in found]


@pytest.mark.timeout(240)
def test_a_sensor_guides_a_live_robot_as_a_simulated_one(
    start_cell: Callable[..., CellProcess], tmp_path: Path
) -> None:
    program = tmp_path / 'guided.lua'
    program.write_text(PROGRAM)
    end = REST + TURN + 1.5
    times = np.arange(0.0, end, 1.0 / RATE).tolist()
    layout = T['std_msgs/msg/MultiArrayLayout']([], 0)
    done = (end, '/digital_inputs', T['std_msgs/msg/UInt8MultiArray'](layout, np.array([1], np.uint8)))
    sensor = write_bag(
        tmp_path / 'sensor', [*((time, '/reference_pose', circle(time)) for time in times), done]
    )
    cell = start_cell('--program', str(program), '--guided', 'constrained', '--once')
    cell.until('hands over')
    command = [sys.executable, '-P', '-m', 'robots_controller.nodes.bags.replay_bag', str(sensor)]
    subprocess.run(command, check=True, capture_output=True, timeout=60.0)
    assert cell.wait() == 0, cell.text

    bag = tmp_path / 'simulated'
    run = simulate(program, robot=ROBOT.name, references=cell.bag, bag=bag)
    assert run.ok, run.error
    assert states(cell.bag) == states(bag)
    live, simulated = guided_path(cell.bag), guided_path(bag)
    for path in (live, simulated):
        np.testing.assert_allclose(np.ptp(path, axis=0), [0.0, 2.0 * RADIUS, 2.0 * RADIUS], atol=APART)
    for one, other in ((live, simulated), (simulated, live)):
        assert cKDTree(one).query(other)[0].max() < APART
    # At the end both stand where the sensor rests.
    np.testing.assert_allclose(live[-1], simulated[-1], atol=1e-6)
