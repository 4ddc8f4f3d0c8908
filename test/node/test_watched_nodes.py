"""controller_node: inputs that stop the robot, their source, and nodes without which it does not move."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Bool, UInt8MultiArray

from bench import EVERY_STATE, Bench
from robots_controller.nodes.controller_node import ControllerNode
from robots_controller.nodes.io_bridge_node import IoBridgeNode
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.peers.heartbeat import Heartbeat
from robots_core.ros.qos import STATE
from robots_core.ros.timed_node import TimedNode

from .controller_bench import AWAY, HOME, OPTIONS, ControllerBench

INPUTS = {'emergency_stop_inputs': ['digital_input.2=off']}
SOURCE = 'io_bridge_node'
SOURCED = {**INPUTS, 'emergency_stop_source': SOURCE, 'expected_nodes': [SOURCE]}


def show(bench: ControllerBench, *image: int) -> None:
    """Publish an image of the digital inputs."""
    bench.publish('digital_inputs', UInt8MultiArray(data=list(image)), STATE)


def until_nothing_is_awaited(bench: ControllerBench) -> None:
    bench.wait(lambda: not bench.controller._controller.awaited, 'all that the robot waits for')


def refusal(bench: ControllerBench) -> str:
    """The answer to a motion that is refused."""
    bench.send(bench.references[-1], HOME + 0.01)
    result = bench.result()
    assert not result.ok
    return result.message


@pytest.mark.parametrize(
    ('pressed', 'reason'),
    [
        ((1, 0), 'emergency stop by digital_input.2'),
        ((1,), 'emergency stop by digital_input.2 (unknown: digital_inputs is too short)'),
    ],
    ids=['pressed', 'too_short'],
)
def test_an_input_stops_the_robot_until_it_is_released_and_reset(
    ros_nodes: Any, pressed: tuple[int, ...], reason: str
) -> None:
    bench = ControllerBench(ros_nodes, controller=INPUTS)
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE)
    show(bench, 0, 1)
    until_nothing_is_awaited(bench)
    bench.send_slowly(AWAY)
    show(bench, *pressed)
    assert bench.result().message == reason
    bench.until_standing()
    assert diagnostic_values(stops[-1])['fault'] == 'emergency stop input'
    assert f'cannot reset: {reason}' in bench.call('controller_node/reset').message
    bench.override(1.0)
    show(bench, 0, 1)
    bench.wait(lambda: not bench.controller._controller.stops._causes, 'the release')
    assert refusal(bench) == f'{reason}; ~/reset lets the robot move again'
    bench.wait(lambda: bench.call('controller_node/reset').success, 'the reset')
    bench.wait(lambda: not bench.controller._controller.stops.latched, 'a robot that may move')
    bench.send(bench.references[-1], HOME)
    assert bench.result().ok


def test_a_plc_that_has_not_sent_yet_is_distinguished_from_a_button_and_one_reset_starts(
    ros_nodes: Any, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / 'map.yaml'
    row = '{channel: digital_input.2, topic: plc/e_stop, type: Bool, qos: {durability: transient_local}}'
    path.write_text(f'emergency_stop: {{digital_input.2: off}}\ninputs:\n  - {row}')
    bench = ControllerBench(ros_nodes, controller=INPUTS)
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE)
    bench.start_node(IoBridgeNode, io_map=str(path))
    reason = 'emergency stop by digital_input.2 (unknown: plc/e_stop has sent no value yet)'
    bench.wait(lambda: stops and stops[-1].message == reason, 'the stop')
    bench.until_health(DiagnosticStatus.ERROR, f'stopped until ~/reset: {reason}')
    assert bench.call('controller_node/reset').message == f'cannot reset: {reason}'
    assert f'stopped: {reason}' in capfd.readouterr().err
    bench.publish('plc/e_stop', Bool(data=False), STATE)  # somebody has pressed it
    pressed = 'cannot reset: emergency stop by digital_input.2'
    bench.wait(lambda: bench.call('controller_node/reset').message == pressed, 'the button')
    bench.publish('plc/e_stop', Bool(data=True), STATE)
    bench.wait(lambda: bench.call('controller_node/reset').success, 'the reset')
    bench.wait(lambda: not bench.controller._controller.stops.latched, 'a robot that may move')
    bench.send(HOME, AWAY)
    assert bench.result().ok


def test_nothing_moves_before_the_inputs_have_been_published(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes, controller=INPUTS)
    assert refusal(bench) == 'digital_inputs, in which the emergency stop is, has not been published yet'
    show(bench, 0, 1)
    until_nothing_is_awaited(bench)
    bench.send(HOME, AWAY)
    assert bench.result().ok


@pytest.mark.parametrize('state', ['moving', 'standing'])
def test_the_loss_of_the_node_that_publishes_the_inputs_is_a_fault(ros_nodes: Any, state: str) -> None:
    bench = ControllerBench(ros_nodes, watchdog=1.0, controller=SOURCED)
    stops = bench.collect('stop_status', DiagnosticStatus, EVERY_STATE)
    show(bench, 0, 1)
    node = ros_nodes.add(TimedNode(SOURCE, context=ros_nodes.context))
    heartbeat = Heartbeat(node)
    until_nothing_is_awaited(bench)
    lost = f'no sign of life of {SOURCE} for 1 s: is it still running?'
    if state == 'moving':
        bench.send_slowly(AWAY)
        heartbeat.stop()
        assert bench.result().message == lost
        bench.until_standing()
    else:
        heartbeat.stop()
    bench.wait(lambda: stops and diagnostic_values(stops[-1])['drives'] == 'off', 'drives that are off')
    assert {'fault': 'emergency inputs lost', 'category': '1'}.items() <= diagnostic_values(stops[-1]).items()
    bench.override(1.0)
    assert refusal(bench) == f'{lost}; ~/reset lets the robot move again'
    assert f'cannot reset: {lost}' in bench.call('controller_node/reset').message
    heartbeat = Heartbeat(node)
    bench.wait(lambda: bench.call('controller_node/reset').success, 'the reset')
    heartbeat.stop()


def test_a_source_is_not_watched_where_no_input_stops_the_robot(ros_nodes: Any) -> None:
    bench = ControllerBench(ros_nodes, controller={'emergency_stop_source': SOURCE})
    assert SOURCE not in bench.controller.watch.unseen


@pytest.mark.parametrize(
    ('name', 'parameters'),
    [('collision_node', {}), (SOURCE, {**INPUTS, 'emergency_stop_source': SOURCE})],
)
def test_an_expected_node_has_to_be_seen_before_the_robot_moves(
    ros_nodes: Any, name: str, parameters: dict[str, Any]
) -> None:
    bench = ControllerBench(ros_nodes, controller={**parameters, 'expected_nodes': [name]})
    if parameters:
        show(bench, 0, 1)
    reason = f'no sign of life of {name} yet: is it running?'
    assert reason in refusal(bench)
    bench.until_health(DiagnosticStatus.WARN, reason)
    heartbeat = Heartbeat(ros_nodes.add(TimedNode(name, context=ros_nodes.context)))
    until_nothing_is_awaited(bench)
    bench.send(HOME, AWAY)
    assert bench.result().ok
    heartbeat.stop()


@pytest.mark.parametrize(
    ('parameters', 'reason'),
    [
        ({'expected_nodes': [SOURCE]}, "'io_bridge_node' is not watched; valid are planning_node"),
        ({'emergency_stop_source': '/plc'}, "'/plc' is no name of a node"),
    ],
)
def test_what_cannot_be_watched_is_refused(ros_nodes: Any, parameters: dict[str, Any], reason: str) -> None:
    with pytest.raises(InvalidInputError, match=reason):
        Bench(ros_nodes).start_node(ControllerNode, **OPTIONS, **parameters)
