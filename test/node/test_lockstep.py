"""Lock-step with real nodes: bit-identical references, foreign participants, those that end, and /clock."""

from __future__ import annotations

import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Range
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from robots_controller.live_cell.cell_graph import NodeDescription
from robots_controller.nodes.controller_node import ControllerNode
from robots_core import load_robot_model
from robots_core.nodes.drive_node import DriveNode
from robots_core.ros.lockstep.agenda import LockstepError
from robots_core.ros.lockstep.participant import Participant
from robots_core.ros.lockstep.phases import START, Phase
from robots_core.ros.messages import doubles
from robots_core.ros.peers.presence import is_served, publishers_of, subscribers_of
from robots_core.ros.qos import COMMAND
from robots_core.ros.timed_node import TimedNode

NAME = 'kuka_kr210_r2700'
ROBOT = load_robot_model(NAME)
HOME = np.array(ROBOT.home)
AWAY = HOME + np.array([0.2, 0.1, -0.1, 0.3, 0.2, 0.1])
NODES = ('controller_node', 'drive_node')
EXECUTABLES = (('robots_controller', 'controller_node'), ('robots_core', 'drive_node'))
PERIOD = 4_000_000
SECONDS = 1.1


def test_the_page_names_the_phases_in_their_order() -> None:
    page = (Path(__file__).parents[2] / 'docs' / 'how_to' / 'lockstep.md').read_text()
    assert re.findall(r'^\| `([A-Z]+)` \|', page, re.MULTILINE) == [phase.name for phase in Phase]


class Sender(TimedNode):
    """Sends one motion at the start and collects the references until the end of the run."""

    def __init__(self, **options: Any) -> None:
        super().__init__('sender', **options)
        assert self.participant is not None
        self.references: list[tuple[float, ...]] = []
        self.ended = threading.Event()
        self._trajectories = self.create_publisher(JointTrajectory, 'joint_trajectory', COMMAND)
        self.create_subscription(JointTrajectory, 'joint_reference', self._on_reference, COMMAND)
        turn = self.participant.create_turn(self._send, phase=Phase.PROGRAM)
        turn.ask(1.0)
        self._end = self.participant.create_turn(lambda _: self.ended.set(), phase=Phase.PROGRAM)
        self._end.ask(1.0 + SECONDS)

    def _on_reference(self, message: JointTrajectory) -> None:
        if not self.ended.is_set():
            point, stamp = message.points[0], message.header.stamp
            row = (stamp.sec, stamp.nanosec, *point.positions, *point.velocities, *point.accelerations)
            self.references.append(row)

    def _send(self, _now: float) -> None:
        zero = doubles(np.zeros(HOME.size))
        message = JointTrajectory(joint_names=list(ROBOT.axes_data.names))
        message.header.stamp = self.get_clock().now().to_msg()
        for seconds, q in ((0, HOME), (1, AWAY)):
            point = JointTrajectoryPoint(positions=doubles(q), velocities=zero, accelerations=zero)
            point.time_from_start.sec = seconds
            message.points.append(point)
        self._trajectories.publish(message)


@contextmanager
def processes() -> Iterator[list[subprocess.Popen[bytes]]]:
    """Controller and drives in processes of their own."""
    parameters = ['--ros-args', '-p', 'lockstep:=true', '-p', f'robot_model:={NAME}']
    with ExitStack() as ending:
        started = []
        for package, name in EXECUTABLES:
            executable = NodeDescription(package, name).executable_path()
            process = subprocess.Popen([str(executable), *parameters])
            ending.callback(process.wait)
            ending.callback(process.terminate)
            started.append(process)
        yield started


@contextmanager
def one_process(nodes: Any) -> Iterator[None]:
    """Both in the process of the test."""
    options = nodes.options(lockstep=True, robot_model=NAME)
    started = [nodes.add(kind(**options)) for kind in (ControllerNode, DriveNode)]
    yield
    for node in started:
        nodes.destroy(node)


@contextmanager
def busy_processor() -> Iterator[None]:
    with subprocess.Popen([sys.executable, '-c', 'while True: pass']) as process:
        yield
        process.kill()


def references(
    nodes: Any, robot: AbstractContextManager[Any], meanwhile: AbstractContextManager[None]
) -> list[tuple[float, ...]]:
    """The references of one run."""
    errors: list[LockstepError] = []
    sender = nodes.add(Sender(**nodes.options(lockstep=True)))
    run = nodes.coordinate(*NODES, 'sender', on_error=errors.append)
    with robot:
        nodes.wait_for(lambda: errors or run.started, what='the run')
        with meanwhile:
            nodes.wait_for(lambda: errors or sender.ended.is_set(), what='the end of the run')
            nodes.call(run.end)
    assert not errors
    for node in [*nodes._nodes]:
        nodes.destroy(node)
    return list(sender.references)


def test_references_are_the_same_bit_by_bit_in_one_process_and_in_several_on_a_busy_machine(
    ros_nodes: Any,
) -> None:
    quiet = references(ros_nodes, one_process(ros_nodes), nullcontext())
    busy = references(ros_nodes, processes(), busy_processor())
    # One in each period from the start on; that of the end was sent before the turn that ends the run.
    assert len(quiet) == round(SECONDS * 250) + 1
    assert quiet == busy
    np.testing.assert_allclose(quiet[-1][2:8], AWAY, atol=1e-12)


def test_a_foreign_participant_holds_time_until_it_has_done_its_part(ros_nodes: Any) -> None:
    foreign = Node('bridge', context=ros_nodes.context)
    part = Participant(foreign)
    done = threading.Event()
    works: list[int] = []

    def work(_now: float) -> None:
        works.append(part.time)
        if len(works) == 3:
            threading.Thread(target=hold).start()
            holding.wait()

    def hold() -> None:
        with part.busy():
            holding.set()
            done.wait()

    holding = threading.Event()
    part.start_loop(work, period=PERIOD / START, phase=Phase.ENVIRONMENT)
    ros_nodes.add(foreign)
    run = ros_nodes.coordinate('bridge')
    ros_nodes.wait_for(lambda: len(works) == 3, what='three periods')
    assert run.time == START + 2 * PERIOD
    done.set()
    ros_nodes.wait_for(lambda: len(works) > 3, what='further periods')
    ros_nodes.call(run.end)
    assert works == [START + k * PERIOD for k in range(len(works))]


def test_time_stands_still_while_messages_and_services_are_under_way(ros_nodes: Any) -> None:
    """Every message of an instant is handled at that instant, and so is the reply to a request."""
    asker, server = (TimedNode(name, **ros_nodes.options(lockstep=True)) for name in ('asker', 'server'))
    sent: list[tuple[float, float]] = []
    replied: list[tuple[float, float]] = []
    publisher = asker.create_publisher(Float64, 'number', COMMAND)
    client = asker.create_client(Trigger, 'ask')

    def work(now: float) -> None:
        publisher.publish(Float64(data=now))
        client.call_async(Trigger.Request()).add_done_callback(lambda _: replied.append((now, asker.now())))

    server.create_subscription(Float64, 'number', lambda m: sent.append((m.data, server.now())), COMMAND)
    server.create_service(Trigger, 'ask', lambda _, response: response)
    asker.start_loop(work, period=PERIOD / START, name='asker')
    ros_nodes.add(asker)
    ros_nodes.add(server)
    run = ros_nodes.coordinate('asker', 'server')
    ros_nodes.wait_for(lambda: len(replied) > 20 and len(sent) > 20, what='twenty periods')
    ros_nodes.call(run.end)
    assert all(at == handled for at, handled in [*sent, *replied])


def test_participants_alone_are_present(ros_nodes: Any) -> None:
    """Other nodes are found, and missed, in the middleware's time."""
    asker, server = (TimedNode(name, **ros_nodes.options(lockstep=True)) for name in ('asker', 'server'))
    stranger = ros_nodes.create_node('stranger')
    for node in (asker, stranger):
        node.create_publisher(Float64, 'number', COMMAND)
    for node in (server, stranger):
        node.create_subscription(Float64, 'number', lambda _: None, COMMAND)
    stranger.create_service(Trigger, 'strange', lambda _, response: response)
    server.create_service(Trigger, 'ask', lambda _, response: response)
    clients = [asker.create_client(Trigger, name) for name in ('ask', 'strange')]
    asker.start_loop(lambda _: None, period=PERIOD / START, name='asker')
    ros_nodes.add(asker)
    ros_nodes.add(server)
    ros_nodes.wait_for(lambda: server.count_publishers('number') == 2, what='both publishers')
    ros_nodes.wait_for(clients[1].service_is_ready, what='the other service')
    run = ros_nodes.coordinate('asker', 'server')
    ros_nodes.wait_for(lambda: run.started, what='the run')
    assert [*publishers_of(server, 'number').values()] == ['/asker']
    assert subscribers_of(asker, 'number') == {'/server'}
    assert [is_served(asker, client) for client in clients] == [True, False]
    ros_nodes.call(run.end)


def test_a_participant_that_was_killed_is_named(ros_nodes: Any) -> None:
    errors: list[LockstepError] = []
    run = ros_nodes.coordinate(*NODES, on_error=errors.append, patience=8.0)
    with processes() as (_, drives):
        ros_nodes.wait_for(lambda: run.started and run.instants > 10, what='a run')
        drives.kill()
        ros_nodes.wait_for(lambda: errors, what='an error')
    assert 'drive_node did not do what was due at' in str(errors[0])


def test_a_participant_that_does_not_come_is_named(ros_nodes: Any) -> None:
    errors: list[LockstepError] = []
    ros_nodes.coordinate('controller_node', on_error=errors.append, joining_patience=0.2)
    ros_nodes.wait_for(lambda: errors, what='an error')
    assert str(errors[0]).startswith('/controller_node did not join the lock-step run within 0.2 s')


def test_a_held_run_stands_at_its_start(ros_nodes: Any) -> None:
    held = threading.Event()
    node = TimedNode('looper', **ros_nodes.options(lockstep=True))
    times: list[float] = []
    node.start_loop(times.append, period=PERIOD / START, name='looper')
    ros_nodes.add(node)
    run = ros_nodes.coordinate('looper', held=True, on_held=held.set)
    ros_nodes.wait_for(held.is_set, what='the hold')
    assert times == [1.0]
    ros_nodes.call(run.release)
    ros_nodes.wait_for(lambda: len(times) > 5, what='periods')
    ros_nodes.call(run.end)


def test_without_a_coordinator_nodes_follow_the_clock(ros_nodes: Any) -> None:
    options = [Parameter('robot_model', value=NAME), Parameter('use_sim_time', value=True)]
    drive = ros_nodes.add(DriveNode(context=ros_nodes.context, parameter_overrides=options))
    controller = ros_nodes.add(ControllerNode(context=ros_nodes.context, parameter_overrides=options))
    stamps: list[int] = []
    node = ros_nodes.create_node()
    node.create_subscription(
        JointTrajectory,
        'joint_reference',
        lambda m: stamps.append(m.header.stamp.sec * START + m.header.stamp.nanosec),
        QoSProfile(depth=1000),
    )
    clock = node.create_publisher(Clock, '/clock', 1)
    wanted = {'drive_node', 'controller_node'}
    ros_nodes.wait_for(
        lambda: {one.node_name for one in node.get_subscriptions_info_by_topic('/clock')} >= wanted,
        what='both nodes',
    )
    message = Clock()
    for period in range(1, 50):
        now = START + period * PERIOD
        message.clock.sec, message.clock.nanosec = divmod(now, START)

        def reached(now: int = now) -> bool:
            clock.publish(message)  # /clock is best effort
            return bool(drive.now() == controller.now() == now / START)

        ros_nodes.wait_for(reached, what='the time')
    ros_nodes.wait_for(lambda: stamps and stamps[-1] == START + 49 * PERIOD, what='the last reference')
    assert sorted(set(stamps)) == stamps


def test_the_example_of_the_documentation_publishes(ros_nodes: Any) -> None:
    page = (Path(__file__).parents[2] / 'docs' / 'how_to' / 'lockstep.md').read_text()
    (code,) = re.findall(r'```python\n(.*?)```', page, re.DOTALL)
    names: dict[str, Any] = {}
    exec(compile(code, 'lockstep.md', 'exec'), names)  # noqa: S102  # our own page
    distances: list[float] = []
    peer = ros_nodes.create_node('peer')
    peer.create_subscription(Range, 'distance', lambda message: distances.append(message.range), 10)
    ros_nodes.add(names['Distance'](context=ros_nodes.context))
    ros_nodes.wait_for(lambda: distances == [0.5] * len(distances) and distances, what='a distance')
