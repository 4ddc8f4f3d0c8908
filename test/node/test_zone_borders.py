"""controller_node holds the robot before the border of a zone that inputs close or another robot has."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from std_msgs.msg import UInt8MultiArray
from trajectory_msgs.msg import JointTrajectory

from bench import EVERY_STATE, Bench
from late_drives import LATE_DRIVES
from robots_controller.control.zones.shared_zone import Claim, ZoneState, parse_zone_state
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.messages import diagnostic_values, motion_result_from_message
from robots_core.ros.qos import COMMAND, STATE
from robots_planning import LinearJoint, Trajectory
from robots_planning.nodes.motion_messages import trajectory_message

NAME = 'kuka_kr210_r2700'
ROBOT = load_robot_model(NAME)
AWAY = ROBOT.home + np.array([0.06, 0.0, 0.0, 0.0, 0.0, 0.0])
# So slow that drives which a busy machine leaves without references for some periods stay before the border.
SPEED = 0.02  # of the axes
SCENE = """\
zones:
  - name: press
    plane: {{point: [0, {y}, 0], normal: [0, 1, 0]}}
    keep: out
    what: tool
"""


class ZoneBench(Bench):
    """A controller whose way to AWAY leads into a zone."""

    def __init__(self, runner: Any, scene: Path, **parameters: Any) -> None:
        super().__init__(runner)
        self.references = self.collect(
            'joint_reference', JointTrajectory, read=lambda message: message.points[0]
        )
        self.results = self.collect('motion_result', DiagnosticStatus, COMMAND, motion_result_from_message)
        self.claims = self.collect('zone_claims', DiagnosticStatus, EVERY_STATE, self._claim)
        self.start_node(DriveNode, robot_model=NAME, bandwidth=[40.0])
        self.controller = self.start_node(
            ControllerNode,
            robot_model=NAME,
            realtime_priority=0,
            **LATE_DRIVES,
            scene=str(scene),
            **parameters,
        )
        self.wait(lambda: self.references, 'a reference')

    @staticmethod
    def _claim(message: DiagnosticStatus) -> ZoneState:
        return parse_zone_state(diagnostic_values(message)['press'])

    def move(self, goal: np.ndarray) -> None:
        trajectory = LinearJoint(ROBOT, speed_fraction=SPEED).generate(ROBOT.home, goal)
        stamp = self.peer.get_clock().now().to_msg()
        self.send(trajectory, stamp)

    def send(self, trajectory: Trajectory, stamp: Time) -> None:
        message = trajectory_message(trajectory, ROBOT.axes_data.names, stamp)
        self.publisher('joint_trajectory', JointTrajectory).publish(message)

    def held(self, obstacle: str) -> None:
        self.wait(
            lambda: any(
                f'held before the border of zone {obstacle}' in status.message for status in self.health
            ),
            'a robot that is held',
        )
        self.until_standing(self.references)
        assert not self.results

    def reached(self) -> None:
        self.wait(lambda: self.results, 'the end of the motion')
        assert self.results[-1].ok, self.results[-1].message

    def publish_claims(self, state: ZoneState) -> None:
        values = [KeyValue(key='press', value=state.text())]
        self.publish('/other/zone_claims', DiagnosticStatus(values=values), STATE)


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    border = 0.5 * (ROBOT.direct_kinematics(ROBOT.home)[0] + ROBOT.direct_kinematics(AWAY)[0])
    path = tmp_path / 'scene.yaml'
    # The side that the robot turns to.
    text = (
        SCENE.format(y=border[1])
        if border[1] > 0.0
        else SCENE.format(y=border[1]).replace('1, 0]}', '-1, 0]}')
    )
    path.write_text(text)
    return path


def test_an_input_closes_and_opens_a_zone(ros_nodes: Any, scene: Path) -> None:
    scene.write_text(scene.read_text() + '    closed_by: {press_open: off}\n')
    bench = ZoneBench(ros_nodes, scene, zone_inputs=['digital_input.2=off press'])
    bench.publish('digital_inputs', UInt8MultiArray(data=[1, 0]), STATE)
    bench.move(AWAY)
    bench.held("'press', which is closed")
    bench.publish('digital_inputs', UInt8MultiArray(data=[0, 1]), STATE)
    bench.reached()


def test_a_robot_waits_for_another_one_and_says_what_it_does(ros_nodes: Any, scene: Path) -> None:
    scene.write_text(scene.read_text() + '    shared_with: [/other]\n')
    bench = ZoneBench(ros_nodes, scene)
    bench.publish_claims(ZoneState(Claim(1, 5)))
    bench.wait(lambda: any('/other' in state.granted for state in bench.claims), 'a grant')
    bench.move(AWAY)
    bench.held("'press', which /other has not granted")
    mine = bench.claims[-1].claim
    assert mine is not None
    assert mine.number > 1
    bench.publish_claims(ZoneState(None, {'/': mine}))
    bench.reached()


def test_a_trajectory_of_more_than_an_hour_is_refused(ros_nodes: Any, scene: Path) -> None:
    bench = ZoneBench(ros_nodes, scene)
    still = np.zeros((2, ROBOT.num_axes))
    slow = Trajectory(np.array([0.0, 4000.0]), np.array([ROBOT.home, ROBOT.home + 0.1]), still, still)
    stamp = bench.peer.get_clock().now().to_msg()
    bench.send(slow, stamp)
    bench.wait(lambda: bench.results, 'a refusal')
    assert 'the motion takes 4000 s; allowed are 3600 s' in bench.results[-1].message
