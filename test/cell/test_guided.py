"""A recorded sensor or person guides a robot: nodes in lock-step and the simulation do the same."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from guiding_messages import DELAY, Row, stamp, times, twists
from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.simulate import simulate
from robots_controller.simulation.record.ros_messages import BUILD
from robots_core import Pose, load_robot_model
from written_bags import write_bag

from .lockstep_runs import LockstepRuns

ROBOT = load_robot_model('kuka_kr210_r2700')
READY = np.radians([0.0, -90.0, 90.0, 0.0, 90.0, 0.0])
MOVE = 'ptpJointSpaceAngles(0, -90, 90, 0, 90, 0)\n'
HEADER = f'-- Robot: {ROBOT.name}\n'
TURN, RADIUS = 1.5, 0.03  # s, m


def circle() -> list[Row]:
    """A sensor that leads the tool around a circle, from rest to rest."""
    r, _ = ROBOT.direct_kinematics(READY)
    rows: list[Row] = []
    for time in times(TURN):
        part = time / TURN
        angle = 2.0 * np.pi * part - np.sin(2.0 * np.pi * part)
        point = r + RADIUS * np.array([0.0, np.sin(angle), 1.0 - np.cos(angle)])
        message = BUILD.pose_stamped(stamp(time), Pose.from_quaternion(point, [0.0, 1.0, 0.0, 0.0]))
        rows.append((time + DELAY, '/reference_pose', message))
    return rows


def axes() -> list[Row]:
    """A person who jogs two axes."""
    velocity = np.array([0.1, 0.0, 0.0, 0.0, 0.0, -0.05])
    names = ROBOT.axes_data.names
    return [
        (time, '/teach_joints', BUILD.joint_state(stamp(time), names, q_dot=velocity)) for time in times(0.6)
    ]


GUIDED = {
    'poses': (circle(), f'followReference({TURN + 0.5})'),
    'twists': (twists('/reference_twist', 'base'), 'followReference(1)'),
    'tool': (twists('/teach_twist', 'tool'), 'jog(1)'),
    # Taken back while it is guided: what comes then moves nothing.
    'axes': (axes(), 'jog(0.3)'),
}


# Hz, of the references: of periods that are, and are not, multiples of those of guidance, 4 and 8 ms.
RATES = (50.0, 25.0, 100.0, 40.0)


@pytest.mark.parametrize(('guide', 'rate'), list(zip(GUIDED, RATES, strict=True)))
def test_references_are_those_of_the_simulation(
    lockstep_runs: LockstepRuns, tmp_path: Path, guide: str, rate: float
) -> None:
    messages, call = GUIDED[guide]
    sensor = write_bag(tmp_path / 'sensor', messages)
    program = tmp_path / 'guided.lua'
    program.write_text(f'{HEADER}{MOVE}{call}\n{MOVE}')
    cell = lockstep_runs.run_file(program, '--references', str(sensor), rate=rate)
    assert cell.returncode == 0, cell.text
    bag = tmp_path / 'simulated'
    run = simulate(program, robot=ROBOT.name, references=sensor, rate=rate, bag=bag)
    assert run.ok, run.error
    there, here = read_bag(cell.bag), read_bag(bag)
    for topic in ('/motion_result', '/command_state', '/guide'):
        assert texts(there, topic) == texts(here, topic)
    assert any(len(m.points) == 1 for _, m in here.deserialized(['/joint_trajectory'])['/joint_trajectory'])
    for topic in (messages[0][1], '/joint_trajectory', '/joint_reference'):
        nodes, simulation = rows(there, topic), rows(here, topic)
        # The nodes hold the robot for some periods more.
        stamps = [stamp for stamp in nodes if stamp in simulation]
        assert [*simulation] == stamps
        np.testing.assert_array_equal([nodes[s] for s in stamps], [simulation[s] for s in stamps], topic)


def texts(bag: Bag, topic: str) -> list[str]:
    found = bag.deserialized([topic])[topic]
    return [getattr(message, 'data', None) or message.message for _, message in found]


def rows(bag: Bag, topic: str) -> dict[int, Any]:
    """Numbers of all messages of a topic, by their stamps in ns."""
    return {
        message.header.stamp.sec * 1_000_000_000 + message.header.stamp.nanosec: numbers(message)
        for _, message in bag.deserialized([topic])[topic]
    }


def numbers(message: Any) -> Any:
    if hasattr(message, 'points'):
        point = message.points[-1]
        return [*point.positions, *point.velocities, *point.accelerations]
    if hasattr(message, 'velocity'):
        return list(message.velocity)
    if hasattr(message, 'pose'):
        return [message.pose.position.x, message.pose.position.y, message.pose.position.z]
    return [message.twist.linear.x, message.twist.linear.y, message.twist.linear.z]
