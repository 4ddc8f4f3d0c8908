"""lua_program_node: programs against a robot's side played by the test."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, Float64MultiArray, UInt8MultiArray
from trajectory_msgs.msg import JointTrajectory

from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core import Pose
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import diagnostic_status, diagnostic_values, pose_from_message, stamp_id
from robots_core.ros.qos import COMMAND, STATE, STREAM
from robots_planning import LinearJoint
from robots_planning.nodes.motion_messages import trajectory_message
from robots_planning.trajectory import Trajectory

from .lua_bench import MOVE, ROBOT, LuaBench, ignore


def test_program_moves_and_switches(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore  # each motion lasts until its effects were seen
    bench.start(f"""
        setDigitalOutput(2, 1)
        {MOVE}
        setDigitalOutput(2, 0)
        ptpCartesianSpace(0.37, -1.78, 1.21, -42.03, 117.47, -35.89)
        setAnalogOutput(1, 0.5)
        ptpJointSpacePosition(1, 0, 1, 0, 90, 0)
    """)
    for number, (state, digital, analog) in enumerate(
        (('PTPJOINT_JOINT', 1, 0.0), ('PTPCARTESIAN', 0, 0.0), ('PTPJOINT_CARTESIAN', 0, 0.5)), 1
    ):
        bench.wait(lambda number=number: len(bench.commands) == number, f'motion {number}')
        bench.wait(lambda state=state: bench.states[-1] == state, state)
        bench.wait(lambda value=digital: bench.digital[-1][1] == value, 'the digital output')
        bench.wait(lambda value=analog: bench.analog[-1][0] == value, 'the analog output')
        bench.answer(bench.command_id())
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.states[-1] == 'IDLE', 'the last command state')
    (topic, joint), (topic_2, line), (topic_3, pose) = bench.commands
    assert (topic, topic_2, topic_3) == ('ptpjoint_joint', 'ptpcartesian', 'ptpjoint_cartesian')
    assert list(joint.name) == ['A1', 'A2', 'A3', 'A4', 'A5', 'A6']
    np.testing.assert_array_equal(joint.position, np.radians([0.0, -90.0, 45.0, 0.0, 45.0, 0.0]))
    expected = Pose.from_angles([0.37, -1.78, 1.21], np.radians([-42.03, 117.47, -35.89]))
    # Through a quaternion: rounding of double precision.
    assert pose_from_message(line.pose).distance_to(expected) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert line.header.frame_id == pose.header.frame_id == 'base'
    assert len({stamp_id(message.header.stamp) for _, message in bench.commands}) == 3


def test_what_the_program_prints_goes_to_the_log(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    # /rosout keeps no message for longer than 10 s: a machine that is late for one has the next.
    bench.start("while true do print('hello') wait(0.2) end")
    printed = bench.wait(
        lambda: [log.msg for log in bench.log if log.name.endswith('lua_program_node.print')],
        'what the program prints',
    )
    assert set(printed) == {'hello'}


def test_status_names_line_source_and_error(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = lambda id_: bench.answer(
        id_,
        'A2 = 0.174532925 rad is outside its limits [-2.44346095, -0.0872664626] rad',
        ok=False,
        joint='A2',
        value=str(np.radians(10.0)),
        lower=str(np.radians(-140.0)),
        upper=str(np.radians(-5.0)),
        unit='rad',
    )
    bench.start(f'\n{MOVE}')
    failed = bench.wait_for_state('FAILED')
    assert failed == {
        'state': 'FAILED',
        'run': '1',
        'file': 'test.lua',
        'line': '2',
        'source': MOVE,
        'error': 'test.lua:2: ptpJointSpaceAngles: A2 = 10 deg is outside its limits [-140, -5] deg',
        'motion': bench.command_id(),
        'motion_file': 'test.lua',
        'motion_line': '2',
    }
    bench.wait(lambda: bench.status[-1].level == DiagnosticStatus.ERROR, 'its level')
    bench.on_command = bench.answer
    bench.start(MOVE)
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.status[-1].level == DiagnosticStatus.OK, 'its level')


def test_line_of_a_motion_is_reported_before_it_moves(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    bench.start(f'wait(0)\nwait(0)\n{MOVE}')
    bench.wait_for_command()
    bench.wait(lambda: diagnostic_values(bench.status[-1])['line'] == '3', 'line 3')
    assert diagnostic_values(bench.status[-1])['source'] == MOVE
    bench.answer(bench.command_id())
    bench.wait_for_state('FINISHED')


def test_results_of_other_commands_are_ignored(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    bench.start(f'{MOVE}\nsetDigitalOutput(1, 1)')
    bench.wait_for_command()
    bench.answer('1.000000000', 'failed', ok=False)
    bench.answer('2.000000000')
    bench.answer(bench.command_id())
    bench.wait_for_state('FINISHED')


def test_motion_without_planner_is_an_error_although_a_recorder_listens(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, planner=False, planner_timeout=0.3)
    bench.start(MOVE)
    error = bench.wait_for_state('FAILED')['error']
    assert error.startswith('test.lua:1: ptpJointSpaceAngles: no node plans ptpjoint_joint within 0.3 s')
    assert 'planning_node is not running' in error
    bench.start_planner()
    bench.start(MOVE)
    bench.wait_for_state('FINISHED')


def test_motion_waits_for_a_planner_that_comes_late(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, planner=False)
    bench.start(MOVE)
    bench.wait(lambda: 'PTPJOINT_JOINT' in bench.states, 'the command state')
    bench.start_planner()
    bench.wait_for_state('FINISHED')


@pytest.mark.parametrize('latched', [True, False])
def test_inputs_reach_the_program_from_any_publisher(ros_nodes: Any, tmp_path: Path, latched: bool):  # noqa: FBT001
    publisher = ros_nodes.create_node('plc')
    qos = STATE if latched else STREAM
    digital = publisher.create_publisher(UInt8MultiArray, 'digital_inputs', qos)
    analog = publisher.create_publisher(Float64MultiArray, 'analog_inputs', qos)
    if latched:
        digital.publish(UInt8MultiArray(data=[0, 1]))
        analog.publish(Float64MultiArray(data=[2.5]))
    bench = LuaBench(ros_nodes, tmp_path)
    bench.start("""
        while not getDigitalInput(2) or getAnalogInput(1) == 0 do wait(0.001) end
        setAnalogOutput(1, getAnalogInput(1))
    """)
    if not latched:
        for one in (digital, analog):
            bench.wait(lambda one=one: one.get_subscription_count(), 'a subscriber')
        digital.publish(UInt8MultiArray(data=[0, 1]))
        analog.publish(Float64MultiArray(data=[2.5]))
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: bench.analog and bench.analog[-1][0] == 2.5, 'the output')


def test_wrong_inputs_are_refused_and_reported(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    publisher = bench.peer.create_publisher(UInt8MultiArray, 'digital_inputs', STATE)
    publisher.publish(UInt8MultiArray(data=[0, 7]))
    bench.until_health(DiagnosticStatus.WARN, 'digital input 2 is 7; valid are 0 and 1')


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        (None, "parameter 'program' is empty"),
        ('x = ', 'test.lua:1: unexpected symbol near <eof>'),
        ('wait(1); // wait', "test.lua:1: '//' does not start a comment in Lua; write '--'"),
    ],
)
def test_program_that_cannot_be_opened_is_reported(
    ros_nodes: Any, tmp_path: Path, text: str | None, message: str
):
    bench = LuaBench(ros_nodes, tmp_path)
    if text is not None:
        bench.write(text)
    response = bench.ask('open')
    assert not response.success
    assert response.message.startswith(message)
    ros_nodes.wait_for(
        lambda: diagnostic_values(bench.status[-1])['error'].startswith(message), what='the status'
    )
    assert not bench.ask('run').success
    bench.start('wait(0)')
    bench.wait_for_state('FINISHED')


def test_services_without_a_running_program_say_so(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    for name in ('run', 'pause', 'resume', 'stop', 'reset', 'close'):
        response = bench.ask(name)
        assert not response.success
        assert response.message.startswith('no program is')
    assert bench.ask('get_command_state').message == 'IDLE'


def test_a_program_that_has_ended_is_closed(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.start('wait(1e6)')
    bench.wait_for_state('RUNNING')
    assert 'cannot close: ' in bench.ask('close').message
    assert bench.ask('stop').success
    bench.wait_for_state('STOPPED')
    assert bench.ask('close').message.endswith('is closed')
    bench.wait_for_state('IDLE')
    assert bench.ask('run').message.startswith('no program is open')


def test_autostart_runs_when_the_robot_can_move(ros_nodes: Any, tmp_path: Path):
    path = tmp_path / 'auto.lua'
    path.write_text(MOVE)
    bench = LuaBench(ros_nodes, tmp_path, planner=False, autostart=True, program=str(path))
    assert diagnostic_values(bench.status[-1])['state'] == 'IDLE'
    bench.start_planner()
    controller = bench.peer.create_publisher(JointTrajectory, 'joint_reference', STREAM)
    bench.peer.create_timer(0.01, lambda: controller.publish(JointTrajectory()))
    bench.wait_for_state('FINISHED')
    assert len(bench.commands) == 1


def test_the_first_motion_waits_until_the_program_has_the_robot(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    answered: list[float] = []
    sent: list[float] = []

    def take() -> None:
        time.sleep(0.2)  # a controller that takes its time
        answered.append(time.time())

    bench.on_taken = take
    bench.peer.create_subscription(
        JointState,
        'ptpjoint_joint',
        lambda _, info: sent.append(1e-9 * info['source_timestamp']),
        COMMAND,
    )
    bench.start(MOVE)
    bench.wait_for_state('FINISHED')
    bench.wait(lambda: sent, 'the motion')
    assert answered[0] < sent[0]


def test_autostart_runs_once_in_a_launch_however_often_the_node_is_started(
    ros_nodes: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv('XDG_RUNTIME_DIR', str(tmp_path))
    path = tmp_path / 'auto.lua'
    path.write_text(MOVE)
    options = {'autostart': True, 'launch': 'monday', 'program': str(path)}
    bench = LuaBench(ros_nodes, tmp_path, **options)
    controller = bench.peer.create_publisher(JointTrajectory, 'joint_reference', STREAM)
    bench.peer.create_timer(0.01, lambda: controller.publish(JointTrajectory()))
    bench.wait_for_state('FINISHED')
    ros_nodes.destroy(bench.node)
    bench.node = bench.start_node(LuaProgramNode, robot_model=ROBOT, **options)
    bench.wait(lambda: any('no autostart: this node has been started anew' in m.msg for m in bench.log), 'it')
    bench.start(MOVE)  # by a person
    bench.wait_for_state('FINISHED')
    assert len(bench.commands) == 2


def test_autostart_says_what_it_waits_for(ros_nodes: Any, tmp_path: Path):
    path = tmp_path / 'auto.lua'
    path.write_text(MOVE)
    bench = LuaBench(ros_nodes, tmp_path, planner=False, autostart=True, program=str(path))

    def wait_for(text: str) -> None:
        bench.wait(lambda: any(f'autostart waits for {text}' in one.msg for one in bench.log), text)

    wait_for('planning_node and controller_node')
    health = bench.publisher('/diagnostics', DiagnosticArray)
    wrong = diagnostic_status('/planning_node', 'waiting for joint_reference', level=DiagnosticStatus.WARN)
    health.publish(DiagnosticArray(status=[wrong]))
    controller = bench.peer.create_publisher(JointTrajectory, 'joint_reference', STREAM)
    bench.peer.create_timer(0.01, lambda: controller.publish(JointTrajectory()))
    bench.start_planner()
    wait_for('planning_node (waiting for joint_reference)')
    assert not bench.commands
    health.publish(DiagnosticArray(status=[diagnostic_status('/planning_node', 'ready')]))
    bench.wait_for_state('FINISHED')


def test_autostart_waits_for_expected_nodes_and_a_controller_that_is_ready(ros_nodes: Any, tmp_path: Path):
    path = tmp_path / 'auto.lua'
    path.write_text(MOVE)
    guarded = {'autostart': True, 'program': str(path), 'expected_nodes': ['collision_node']}
    bench = LuaBench(ros_nodes, tmp_path, **guarded)
    controller = bench.peer.create_publisher(JointTrajectory, 'joint_reference', STREAM)
    bench.peer.create_timer(0.01, lambda: controller.publish(JointTrajectory()))
    health = bench.publisher('/diagnostics', DiagnosticArray)

    def wait_for(text: str) -> None:
        bench.wait(lambda: any(f'autostart waits for {text}' in one.msg for one in bench.log), text)

    wait_for('controller_node and collision_node')
    unseen = diagnostic_status('/controller_node', 'no sign of life yet', level=DiagnosticStatus.WARN)
    health.publish(DiagnosticArray(status=[unseen]))
    wait_for('collision_node and controller_node (no sign of life yet)')
    health.publish(DiagnosticArray(status=[diagnostic_status('/collision_node', 'starting')]))
    wait_for('controller_node (no sign of life yet)')
    assert not bench.commands
    health.publish(DiagnosticArray(status=[diagnostic_status('/controller_node', 'ready')]))
    bench.wait_for_state('FINISHED')


@pytest.mark.parametrize(
    'parameters', [{'orientation_convention': 'abc'}, {'digital_size': 0}, {'planner_timeout': -1.0}]
)
def test_wrong_parameters_are_refused_at_start(ros_nodes: Any, tmp_path: Path, parameters: dict[str, Any]):
    with pytest.raises(InvalidInputError):
        LuaBench(ros_nodes, tmp_path, **parameters)


def test_override_is_published(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    overrides: list[float] = []
    bench.peer.create_subscription(Float64, 'override', lambda m: overrides.append(m.data), STATE)
    bench.start('setOverride(0.25)')
    bench.wait(lambda: overrides == [0.25], 'the override')


def test_outputs_switch_on_the_path(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path)
    bench.on_command = ignore
    trajectories = next(p for p in bench.planner.publishers if p.topic_name == '/joint_trajectory')
    plans = bench.peer.create_publisher(DiagnosticStatus, 'motion_plan', COMMAND)
    progress = bench.peer.create_publisher(Float64, 'motion_progress', STATE)
    for publisher in (trajectories, plans, progress):
        bench.wait(publisher.get_subscription_count, 'a subscriber')
    bench.start("""
        ptpJointSpaceAngles({10, -90, 90, 0, 45, 0}, {on_path = {
          {time_before_end = 1, output = 1, value = 1},
          {distance_before_end = 0, output = 2, value = 1}}})""")
    bench.wait_for_command()
    stamp = bench.commands[0][1].header.stamp
    q = np.radians([[0.0, -90.0, 90.0, 0.0, 45.0, 0.0], [10.0, -90.0, 90.0, 0.0, 45.0, 0.0]])
    rest = LinearJoint(bench.node.robot).generate(q[0], q[1])
    slow = Trajectory(
        rest.time / rest.duration * 4.0, rest.position, 0.0 * rest.velocity, 0.0 * rest.acceleration
    )
    trajectories.publish(trajectory_message(slow, list(bench.node.robot.axes_data.names), stamp))
    ends: dict[str, Any] = {'id': stamp_id(stamp), stamp_id(stamp): slow.duration}
    plans.publish(diagnostic_status('motion plan', '', **ends))
    bench.wait(lambda: bench.node.host.switching._planned, 'the planned motion')
    progress.publish(Float64(data=0.70))
    progress.publish(Float64(data=0.76))
    bench.wait(lambda: bench.digital[-1][:2] == [1, 0], 'the first output')
    bench.answer(bench.command_id())
    bench.wait(lambda: bench.digital[-1][:2] == [1, 1], 'the second output')
    bench.wait_for_state('FINISHED')


@pytest.mark.usefixtures('ros_domain')
def test_kinematics_are_loaded_with_the_node_not_in_its_first_motion():
    program = (
        'import sys, rclpy; from rclpy.parameter import Parameter;'
        'from robots_controller.nodes.lua_program_node import LuaProgramNode; rclpy.init();'
        'node = LuaProgramNode(parameter_overrides=[Parameter("robot_model", value="kuka_kr210_r2700")]);'
        'before = set(sys.modules); node.robot.direct_kinematics(node.robot.home);'
        'print(*sorted(set(sys.modules) - before))'
    )
    loaded = subprocess.run([sys.executable, '-P', '-c', program], capture_output=True, text=True, check=True)
    assert loaded.stdout.split() == []
