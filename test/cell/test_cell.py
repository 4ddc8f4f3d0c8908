"""cell with what users do to it: other robots, wrong input, Ctrl-C, and nodes that die."""

from __future__ import annotations

import io
import os
import re
import select
import signal
from collections.abc import Callable
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import DurabilityPolicy, QoSProfile
from rich.console import Console
from std_msgs.msg import UInt8, UInt8MultiArray
from std_srvs.srv import Trigger

from cell_options import parse_options
from robots_controller.live_cell.cell_command import run_cell
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.crash_safe_writer import CHUNK_SIZE
from robots_core.errors import RobotsError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.timed_node import TimedNode
from short_programs import PROGRAMS
from written_bags import no_file_larger_than

from .bag_checks import read_messages
from .cell_process import DEADLINE, CellProcess, CellThread
from .lockstep_runs import LockstepRuns

StartCell = Callable[..., CellThread]
StartProcess = Callable[..., CellProcess]

WRONG_PROGRAMS = {
    'runtime': ('local x = nil\nx.y = 1', 'wrong.lua:2: '),
    'limit': (
        'ptpJointSpaceAngles(0, 10, 45, 0, 45, 0)',
        'A2 = 10 deg is outside its limits [-140, -5] deg',
    ),
}


def test_another_robot_changes_nothing_else(lockstep_runs: LockstepRuns) -> None:
    cell = lockstep_runs.run('bello_bot_tour.lua')
    assert cell.returncode == 0, cell.text
    assert 'every target reached, every limit kept' in cell.text


def test_a_wrong_option_is_reported_in_one_line(start_process: StartProcess) -> None:
    cell = start_process('--robot', 'no_such_robot')
    assert cell.wait() == 2
    assert len(cell.lines) == 1
    assert cell.lines[0].startswith("error: unknown robot 'no_such_robot'; robots are: ")


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        (('--program', 'no_such.lua'), "^program 'no_such.lua' not found"),
        (('--robot', 'urdf:/no/such.urdf'), '^there is no URDF file /no/such.urdf'),
        (('--once',), '^--once needs a --program'),
    ],
)
def test_every_wrong_option_is_explained(options: tuple[str, ...], message: str) -> None:
    with pytest.raises(RobotsError, match=message):
        run_cell(parse_options(options), Console(file=io.StringIO()))


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('wait(1 2)', "wrong.lua:1: ')' expected near '2'"),
        ('wait(0)\nwait(0) // weld', "wrong.lua:2: '//' does not start a comment in Lua"),
    ],
)
def test_a_program_that_is_not_lua_is_reported_before_anything_starts(
    tmp_path: Path, text: str, message: str
) -> None:
    program, out = tmp_path / 'wrong.lua', tmp_path / 'out'
    program.write_text(text + '\n')
    options = parse_options(['--program', str(program), '--record', str(out)])
    with pytest.raises(RobotsError, match=re.escape(message)):
        run_cell(options, Console(file=io.StringIO()))
    assert not out.exists()


@pytest.mark.parametrize('case', WRONG_PROGRAMS)
def test_a_wrong_program_is_reported_and_leads_to_an_error_code(
    lockstep_runs: LockstepRuns, tmp_path: Path, case: str
) -> None:
    text, message = WRONG_PROGRAMS[case]
    program = tmp_path / 'wrong.lua'
    program.write_text(text + '\n')
    cell = lockstep_runs.run_file(program, '--robot', 'kuka_kr210_r2700')
    assert cell.returncode == 1, cell.text
    assert message in cell.text
    assert 'Traceback' not in cell.text


@pytest.mark.parametrize(
    ('number', 'options', 'processes'),
    [(signal.SIGINT, (), 7), (signal.SIGTERM, ('--composed', '--headless'), 3)],
)
def test_ctrl_c_and_terminate_stop_all_nodes(
    start_process: StartProcess, number: signal.Signals, options: tuple[str, ...], processes: int
) -> None:
    cell = start_process('--robot', 'bello_bot', *options)
    cell.until_ready()
    pids = cell.node_pids()
    assert len(pids) == processes
    for pid in (cell.process.pid, *pids.values()):
        addresses = cell.udp_addresses(pid)
        assert '127.0.0.1' in addresses
        assert all(ip_address(one).is_loopback or ip_address(one).is_multicast for one in addresses)
    cell.process.send_signal(number)
    assert cell.wait() == 130
    assert not [name for name, pid in pids.items() if Path(f'/proc/{pid}').exists()]
    assert 'Traceback' not in cell.text
    assert 'Traceback' not in cell.logs


def test_nodes_end_with_a_cell_that_is_killed(start_process: StartProcess) -> None:
    cell = start_process('--robot', 'bello_bot', '--headless')
    cell.until_ready()
    pidfds = [os.pidfd_open(pid) for pid in cell.node_pids().values()]
    cell.process.kill()
    for pidfd in pidfds:
        assert select.select([pidfd], [], [], DEADLINE)[0]
        os.close(pidfd)
    assert 'Traceback' not in cell.logs


def test_nodes_end_with_a_lockstep_run_that_is_killed(start_process: StartProcess, tmp_path: Path) -> None:
    (tmp_path / 'endless.lua').write_text('print("begins") while true do wait(0.1) end')
    options = ('--robot', 'bello_bot', '--program', str(tmp_path / 'endless.lua'))
    cell = start_process(*options, '--lockstep', '--composed', '--headless')
    cell.until('begins')
    (pidfd,) = [os.pidfd_open(pid) for pid in cell.node_pids().values()]
    cell.process.kill()
    assert select.select([pidfd], [], [], DEADLINE)[0]
    os.close(pidfd)


def test_a_node_that_died_is_named_with_the_reason(start_cell: StartCell) -> None:
    cell = start_cell('--robot', 'bello_bot', '--no-restart')
    cell.until_ready()
    os.kill(cell.node_pids()['drive_node'], signal.SIGKILL)
    assert cell.wait() == 1
    assert 'drive_node killed by SIGKILL' in cell.text


def test_a_planner_killed_in_a_motion_leaves_the_robot_standing_on_its_path(
    start_cell: StartCell,
) -> None:
    options = ('--robot', 'kuka_kr210_r2700', '--program', str(PROGRAMS / 'welding.lua'), '--no-restart')
    cell = start_cell(*options)
    cell.until('PTPCARTESIAN to')
    os.kill(cell.node_pids()['planning_node'], signal.SIGKILL)
    cell.until('planning_node killed by SIGKILL')
    assert cell.wait() == 1
    assert 'stopped' in cell.text
    references = read_messages(cell.bag, ['/joint_reference'])['/joint_reference']
    assert not any(references[-1][1].points[0].velocities)


def test_a_second_cell_beside_the_first_ends_with_the_reason(
    start_cell: StartCell, start_process: StartProcess
) -> None:
    first = start_cell('--robot', 'bello_bot')
    first.until_ready()
    second = start_process('--robot', 'kuka_kr210_r2700')
    assert second.wait() == 1
    assert 'another cell is running' in second.text
    assert f'process {os.getpid()}' in second.text
    assert len(list(second.out.iterdir())) == 1  # the first one's: it has started nothing
    assert len(first.node_pids()) == 6


def test_a_cell_looks_for_nodes_that_others_have_started_before_it_starts_its_own(
    ros_nodes: Any, tmp_path: Path
) -> None:
    heartbeat = Heartbeat(ros_nodes.add(TimedNode('drive_node', context=ros_nodes.context)))
    text = io.StringIO()
    options = parse_options(['--robot', 'bello_bot', '--record', str(tmp_path)])
    assert run_cell(options, Console(file=text, width=200)) == 1
    heartbeat.stop()
    assert 'there is another drive_node in namespace /' in text.getvalue()
    assert not list(tmp_path.glob('*/log/*'))


def test_a_full_disk_is_reported_while_the_cell_runs_on_and_leads_to_an_error_code(
    session_ros_domain: int, tmp_path: Path
) -> None:
    del session_ros_domain
    (tmp_path / 'wait.lua').write_text('wait(12)\nprint("still here")')
    options = ('--program', str(tmp_path / 'wait.lua'), '--once', '--lockstep', '--composed', '--headless')
    text = io.StringIO()
    with no_file_larger_than(3 * CHUNK_SIZE // 2):  # of more than two
        code = run_cell(
            parse_options([*options, '--record', str(tmp_path / 'out')]), Console(file=text, width=200)
        )
    assert code == 1
    assert text.getvalue().count('cannot take more: File too large; it ends early') == 1
    assert 'recording: ' in text.getvalue()
    assert 'still here' in text.getvalue()
    (bag,) = tmp_path.glob('out/*/bag')
    assert read_bag(bag).messages  # a full chunk is written at once, however fast simulated time passes


def test_a_cell_that_does_not_record_gives_its_verdict_too(
    session_ros_domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    del session_ros_domain
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'turn.lua').write_text('-- Robot: bello_bot\nptpJointSpaceAngles(5, 0, 0, 40, 0, 0, 0)\n')
    options = ('--program', 'turn.lua', '--once', '--lockstep', '--composed', '--headless', '--rate', '50')
    text = io.StringIO()
    assert run_cell(parse_options(options), Console(file=text, width=80)) == 0
    assert 'reference' in text.getvalue()
    assert 'program finished: 1 motion, every target reached, every limit kept' in text.getvalue()
    assert 'bag:' not in text.getvalue()
    assert not list(tmp_path.glob('out/*/bag'))


PROGRAM = 'setDigitalOutput(1, true) setDigitalOutput(2, true)\nptpJointSpaceAngles(%s)\n'
OUTPUTS = """
fail_safe: {digital_output.2: hold}
inputs:
  - {channel: digital_input.1, topic: plc/none, type: Bool, timeout: 0.5, fail_safe: false}
outputs:
  - {bits: {0: digital_output.1, 1: digital_output.2}, topic: plc/word, type: UInt8}
"""


def reset_controller(ros_nodes: Any) -> None:
    """Reset controller_node, as soon as it permits that."""
    reset = ros_nodes.create_node('operator').create_client(Trigger, 'controller_node/reset')
    ros_nodes.wait_for(reset.service_is_ready, what='the service')

    def succeeds() -> bool:
        future = reset.call_async(Trigger.Request())
        ros_nodes.wait_for(future.done, what='the answer')
        return bool(future.result().success)

    ros_nodes.wait_for(succeeds, what='a reset')


def collected(
    runner: Any, topic: str, kind: type, read: Callable[[Any], Any], *, latched: bool = True
) -> Any:
    """What comes on a topic from now on."""
    found: list[Any] = []
    durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
    qos = QoSProfile(depth=1000, durability=durability)
    node = runner.create_node(f'peer_of_{kind.__name__}')
    node.create_subscription(kind, topic, lambda message: found.append(read(message)), qos)
    return found


def test_a_program_s_node_that_is_killed_leaves_fail_safe_outputs_and_comes_back_without_its_program(
    start_cell: StartCell, ros_nodes: Any, tmp_path: Path
) -> None:
    """With a PLC that is silent from the start. Nothing but a whole cell has processes to kill."""
    words = collected(ros_nodes, 'plc/word', UInt8, lambda m: m.data, latched=False)
    images = collected(ros_nodes, 'digital_outputs', UInt8MultiArray, lambda m: list(m.data[:2]))
    status = collected(ros_nodes, 'program_status', DiagnosticStatus, diagnostic_values)
    stops = collected(ros_nodes, 'stop_status', DiagnosticStatus, diagnostic_values)
    wait = ros_nodes.wait_for
    (tmp_path / 'map.yaml').write_text(OUTPUTS)
    (tmp_path / 'far.lua').write_text(f'setSpeed(0.001)\n{PROGRAM % "0, -60, 60, 0, 45, 0"}')
    options = ('--robot', 'kuka_kr210_r2700', '--program', str(tmp_path / 'far.lua'))
    cell = start_cell(*options, '--io-map', str(tmp_path / 'map.yaml'))
    cell.until('plc/none has been silent', 'PTPJOINT_JOINT to')
    wait(lambda: words and images and words[-1] == 0b11 and images[-1] == [1, 1], what='outputs')
    before = len(images)
    os.kill(cell.node_pids()['lua_program_node'], signal.SIGKILL)
    cell.until('lua_program_node is started again in 0.5 s')
    wait(lambda: words[-1] == 0b10 and images[-1] == [0, 1], what='fail-safe outputs')
    cell.until('far.lua was interrupted at line 3: lua_program_node killed by SIGKILL', 'ready')
    state = wait(lambda: status[-1] if status[-1]['state'] == 'OPENED' else None, what='the new process')
    assert state['error'] == 'far.lua was interrupted at line 3: lua_program_node killed by SIGKILL'
    # Old process, cell and new process: what is held is held all the time.
    assert {tuple(image) for image in images[before:]} <= {(1, 1), (0, 1)}
    assert images[-1] == [0, 1]
    operator = ros_nodes.create_node('operator')

    def call(service: str) -> Trigger.Response:
        client = operator.create_client(Trigger, service)
        wait(client.service_is_ready, what=service)
        answer = client.call_async(Trigger.Request())
        wait(answer.done, what='the answer')
        return answer.result()

    wait(lambda: stops and 'fault' in stops[-1], what='the stop')
    refused = call('lua_program_node/run')
    assert not refused.success
    assert 'controller_node/reset lets the robot move again' in refused.message
    wait(lambda: call('controller_node/reset').success, what='a reset of the robot that stands')
    wait(lambda: call('lua_program_node/run').success, what='a program that may run')
    wait(lambda: status[-1]['state'] == 'RUNNING', what='the program, started by a person')
    cell.interrupt()
    assert cell.wait() == 130
    wait(lambda: words[-1] == 0b10, what='fail-safe outputs at the end of the cell')


FILES = {'program': 'far.lua', 'io': 'plc.yaml', 'scene': 'scene.yaml'}


def test_a_cell_stops_without_the_node_of_its_emergency_stop_and_starts_with_its_collision_guard(
    start_cell: StartCell, ros_nodes: Any, tmp_path: Path
) -> None:
    stops = collected(ros_nodes, 'stop_status', DiagnosticStatus, diagnostic_values)
    wait = ros_nodes.wait_for
    (tmp_path / 'plc.yaml').write_text(
        'initial: {digital_input.2: on}\nemergency_stop: {digital_input.2: off}\n'
    )
    (tmp_path / 'scene.yaml').write_text(
        'objects:\n  - {name: far, sphere: {radius: 0.1}, pose: {position: [9, 9, 9]}}\n'
    )
    (tmp_path / 'far.lua').write_text('setSpeed(0.001)\nptpJointSpaceAngles(0, -60, 60, 0, 45, 0)\n')
    files = [f'--{option}={tmp_path / name}' for option, name in FILES.items()]
    cell = start_cell('--robot', 'kuka_kr210_r2700', *files)
    cell.until('PTPJOINT_JOINT to')
    assert 'fault' not in wait(lambda: stops and stops[-1], what='the state')
    os.kill(cell.node_pids()['plc_node'], signal.SIGKILL)
    cell.until('plc_node is started again in 0.5 s')
    wait(lambda: stops[-1].get('fault') == 'emergency inputs lost', what='the fault')
    reset_controller(ros_nodes)
    wait(lambda: 'fault' not in stops[-1], what='a robot that may move')
    cell.interrupt()
    assert cell.wait() == 130


def test_nodes_that_share_a_process_come_back_together_although_the_folder_of_the_run_is_gone(
    start_cell: StartCell, tmp_path: Path
) -> None:
    cell = start_cell('--robot', 'bello_bot', '--composed')
    cell.until_ready()
    cell.out.rename(tmp_path / 'elsewhere')
    cell.until('bag cannot take more: No such file or directory; it ends early')
    pids = cell.node_pids()
    assert set(pids) == {'controller_node', 'drive_node', 'composed_nodes'}
    os.kill(pids['composed_nodes'], signal.SIGKILL)
    cell.until('composed_nodes killed by SIGKILL')
    cell.until('composed_nodes is started again in 0.5 s')
    for _ in range(4):
        cell.until('ready')
    now = cell.node_pids()
    assert now.pop('composed_nodes') != pids.pop('composed_nodes')
    assert now == pids
    cell.interrupt()
    assert cell.wait() == 130
    assert not any('Traceback' in file.read_text() for file in tmp_path.rglob('*.log'))


def test_a_frozen_controller_is_killed_and_comes_back_stopped(start_cell: StartCell, ros_nodes: Any) -> None:
    """In an operating mode in which a person starts the program."""
    stops = collected(ros_nodes, 'stop_status', DiagnosticStatus, diagnostic_values)
    wait = ros_nodes.wait_for
    program = str(PROGRAMS / 'bello_bot_tour.lua')
    cell = start_cell('--program', program, '--operating-mode', 'T1', '--watchdog', '1')
    cell.until('in operating mode T1 lua_program_node/run starts it while run is held')
    wait(lambda: stops, what='the state')
    os.kill(cell.node_pids()['controller_node'], signal.SIGSTOP)
    cell.until('controller_node gives no sign of life for 10 s: it is killed')
    cell.until('controller_node is started again in 0.5 s')
    wait(lambda: stops[-1].get('fault') == 'controller lost', what='the fault of the new process')
    reset_controller(ros_nodes)
    wait(lambda: 'fault' not in stops[-1], what='a robot that may move')
