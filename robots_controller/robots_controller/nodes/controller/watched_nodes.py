"""What stops the robot from outside: the loss of nodes, inputs, and nodes that write beside the suite's."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Final

from std_msgs.msg import UInt8MultiArray

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.stops.faults import LOST_NODES, Fault
from robots_controller.control.stops.foreign_writers import ForeignWriters
from robots_controller.control.stops.watched_inputs import WatchedInputs, missing_signs
from robots_controller.io.stopping_inputs import Closing, Stopping, parse_emergency_stop, unknown_inputs
from robots_core.errors import InvalidInputError
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.peers.identified_messages import publishers_are_identified
from robots_core.ros.peers.presence import publishers_of
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.wording.safety_note import NOT_CERTIFIED

NODE_NAME: Final = re.compile(r'[A-Za-z][A-Za-z0-9_]*')


class WatchedNodes:
    """Stops the robot when a node is lost or by an input, and lets no motion start before both are there.

    Args:
        watchdog: Without a sign of life for this long a node is lost, s; 0: none is watched.
        zones: Inputs that close zones.
        changed: Called with the reason when the node with this name is lost, and with '' when it is back.

    Parameters:
        emergency_stop_inputs: Inputs that stop the robot.
        emergency_stop_source: Node that publishes them.
        expected_nodes: Nodes of the cell without whose first sign of life no motion starts.

    Raises:
        InvalidInputError: a parameter that is not valid.
    """

    def __init__(
        self,
        node: RobotNode,
        control: ControlLoop,
        watchdog: float,
        zones: Closing,
        changed: Mapping[str, Callable[[str], object]],
    ) -> None:
        self._control, self._changed = control, changed
        emergency: Stopping = node.parameter(
            'emergency_stop_inputs',
            [''],
            f"digital inputs that stop the robot, as 'digital_input.3=off'; {NOT_CERTIFIED}",
            read=parse_emergency_stop,
        )
        source: str = node.parameter(
            'emergency_stop_source',
            '',
            "node that publishes emergency_stop_inputs, as 'io_bridge_node': its loss stops the robot",
            read=checked_name,
        )
        self._faults = dict(LOST_NODES)
        if emergency and source:
            self._faults[source] = Fault.EMERGENCY_INPUTS_LOST
        self._expected: tuple[str, ...] = node.parameter(
            'expected_nodes',
            [''],
            "nodes without whose first sign of life no motion starts, as 'collision_node'",
            read=partial(expected_nodes, watched=tuple(self._faults)),
        )
        self._inputs = WatchedInputs(control, emergency, zones)
        self._image_awaited = bool(emergency) and not node.simulated_time
        self._awaited = ''
        if emergency or zones:
            subscribe(node, UInt8MultiArray, 'digital_inputs', self._on_inputs)
        self.heartbeats: Final = HeartbeatWatch(
            node,
            tuple(self._faults),
            watchdog,
            self._on_change,
            lambda _: self._wait(),
            loop_period=control.controller.settings.period,
        )
        """Their signs of life, for the loop."""
        self._wait()

    def _on_inputs(self, message: UInt8MultiArray) -> None:
        self._inputs.check(message.data, unknown_inputs(one.label for one in message.layout.dim))
        if self._image_awaited:
            self._image_awaited = False
            self._wait()

    def _on_change(self, name: str, reason: str) -> None:
        self._control.node_changed(self._faults[name], reason)
        if name in self._changed:
            self._changed[name](reason)

    def _wait(self) -> None:
        awaited = missing_signs(self._expected, self.heartbeats.unseen, image=self._image_awaited)
        if awaited != self._awaited:
            self._awaited = awaited
            self._control.wait_for(awaited)


class ForeignWriterWatch:
    """Looks for `ForeignWriters`."""

    def __init__(self, node: RobotNode, control: ControlLoop) -> None:
        self._node = node
        identified = publishers_are_identified()
        self._writers = ForeignWriters(control, node.get_namespace(), identified=identified)
        self._suspected = node.create_guard_condition(self._check)

    def poll(self) -> None:
        """Look, in the thread of a loop, whether there may be some, or no more."""
        if self._writers.suspected(self._node.count_publishers):
            self._suspected.trigger()

    def _check(self) -> None:
        self._writers.check(lambda topic: {*publishers_of(self._node, topic).values()})


def checked_name(text: str) -> str:
    """The name of a node, or '' for none.

    Raises:
        InvalidInputError: it cannot be one.
    """
    if text and not NODE_NAME.fullmatch(text):
        raise InvalidInputError(f"{text!r} is no name of a node; valid are 'io_bridge_node' and 'plc_node'")
    return text


def expected_nodes(names: Iterable[str], *, watched: Sequence[str]) -> tuple[str, ...]:
    """The names without empty ones; all have to be `watched`.

    Raises:
        InvalidInputError: one that is not watched.
    """
    found = tuple(filter(None, names))
    for name in found:
        if name not in watched:
            raise InvalidInputError(f'{name!r} is not watched; valid are {", ".join(watched)}')
    return found
