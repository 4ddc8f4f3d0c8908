"""CellReader: keeps the state of a cell, from what its nodes publish and answer."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import ParameterEvent
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import Trigger

from robots_controller.interpreter.debugger import breakpoints_by_file
from robots_controller.io.io_image import IMAGES
from robots_controller.io.scripted_plc import pending_from_text
from robots_controller.nodes.io_services import OUTPUTS
from robots_controller.nodes.ports.io_images import image_message
from robots_controller.pendant.pendant_state import WATCHED, PendantState, ShownPlc
from robots_controller.program.files.cell_frames import FRAMES_FILE
from robots_controller.program.files.taught_points import SUFFIX
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.multibody.payload import payload_of
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.ros.messages import (
    diagnostic_values,
    joint_values,
    number_in,
    seconds,
)
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.validation import Array, fraction
from robots_planning.motion_settings import settings_from_text

RATE: Final = 10.0  # Hz, of what is shown
ASK_PERIOD: Final = 0.5  # s between requests to nodes that have not answered
ANSWER_TIME: Final = 5.0  # s
LOST_AFTER: Final = 1.0  # s
PLANNER, PROGRAM, VIEW, PLC = 'planning_node', 'lua_program_node', 'visualizer_node', 'plc_node'
LABELS: Final = {image: f'{image.removesuffix("s")}_names' for image in IMAGES}


class StateObserver(Protocol):
    """Has the state of the cell as an attribute."""

    state: PendantState


class CellReader:
    """Subscribes to the topics of a cell, and asks its nodes for what has changed.

    Args:
        node: In the cell's namespace.
        observer: Gets the state, which is replaced at every change.
    """

    def __init__(self, node: RobotNode, observer: StateObserver) -> None:
        self._node, self._observer = node, observer
        self._seen: set[str] = set()
        self._joints_time = 0.0
        self._questions: list[_Question] = []
        self._program = self._put(Trigger, f'{PROGRAM}/get_program', Trigger.Request(), self._on_files)
        self._subscribe()
        self._watch = HeartbeatWatch(node, (*WATCHED, PLC), LOST_AFTER, lambda *_: self._check_lost())
        self.ask(PROGRAM, ('breakpoints', *LABELS.values()), self._on_program_parameters)
        node.create_timer(ASK_PERIOD, self._ask)

    def ask(self, name: str, parameters: Sequence[str], answered: Callable[[list[Any]], None]) -> None:
        """Ask a node for the values of parameters until it answers, and again when they have changed."""

        def read(answer: Any) -> None:
            answered([parameter_value_to_python(value) for value in answer.values])

        request = GetParameters.Request(names=list(parameters))
        self._put(GetParameters, f'{name}/get_parameters', request, read)

    def _put(self, kind: Any, service: str, request: Any, answered: Callable[[Any], None]) -> _Question:
        question = _Question(service, self._node.create_client(kind, service), request, answered)
        self._questions.append(question)
        return question

    def show(self, **changes: Any) -> None:
        """Change the state."""
        self._observer.state = replace(self._observer.state, **changes)

    def _subscribe(self) -> None:
        shown: tuple[tuple[str, Any, str, Callable[[Any], object]], ...] = (
            ('commander', String, 'commander', Commander),
            ('guide', String, 'guide', Guide),
            ('operating_mode', String, 'mode', OperatingMode),
            ('run_enabled', Bool, 'run_enabled', bool),
            ('drives_on', Bool, 'drives_on', bool),
            ('override', Float64, 'override', lambda value: fraction(value, 'override')),
            ('min_distance', Float64, 'distance', float),
        )
        for topic, kind, name, read in shown:
            subscribe(self._node, kind, topic, partial(self._show_value, name, read))
        statuses = {
            'stop_status': self._on_stop,
            'program_status': self._on_program,
            'forced_inputs': self._on_forced,
            'plc_status': self._on_plc,
            'motion_settings': self._on_settings,
        }
        for topic, take in statuses.items():
            subscribe(self._node, DiagnosticStatus, topic, take)
        for image in IMAGES:
            topic = image if image in OUTPUTS else f'{PROGRAM}/{image}'
            subscribe(self._node, image_message(image), topic, partial(self._on_image, image))
        self._node.poll(JointState, 'joint_states', self._on_joints, rate=RATE)
        subscribe(self._node, DiagnosticArray, '/diagnostics', self._on_health)
        subscribe(self._node, ParameterEvent, '/parameter_events', self._on_parameters)

    # -- what the nodes report ----------------------------------------------------------------------------

    def _show_value(self, name: str, read: Callable[[Any], object], message: Any) -> None:
        self.show(**{name: read(message.data)})

    def _on_stop(self, message: DiagnosticStatus) -> None:
        fault = '' if message.level == DiagnosticStatus.OK else message.message
        self.show(fault=fault, fault_kind=diagnostic_values(message).get('fault', '') if fault else '')

    def _on_program(self, message: DiagnosticStatus) -> None:
        values = diagnostic_values(message)
        program = replace(
            self._observer.state.program,
            state=RunState(values.get('state', '')),
            file=values.get('file', ''),
            line=int(number_in(values, 'line', 0.0)),
            motion_file=values.get('motion_file', ''),
            motion_line=int(number_in(values, 'motion_line', 0.0)),
            error=values.get('error', ''),
            hold=values.get('hold', ''),
        )
        if program.state in (RunState.IDLE, RunState.OPENED, RunState.FAILED):
            self._ask_again(self._program)  # another one may be open, or another text of it
        self.show(program=program)

    def _on_settings(self, message: DiagnosticStatus) -> None:
        settings = settings_from_text(diagnostic_values(message))
        self.show(settings=settings, payload=payload_of(settings.payload))

    def _on_parameters(self, event: ParameterEvent) -> None:
        name = event.node.removeprefix(f'{self._node.get_namespace().rstrip("/")}/')
        changed = {one.name for one in (*event.new_parameters, *event.changed_parameters)}
        for one in self._questions:
            if one.service == f'{name}/get_parameters' and not changed.isdisjoint(one.request.names):
                self._ask_again(one)

    def _on_forced(self, message: DiagnosticStatus) -> None:
        forced = frozenset(name.partition(' ')[0] for name in diagnostic_values(message))
        self.show(io=replace(self._observer.state.io, forced=forced))

    def _on_plc(self, message: DiagnosticStatus) -> None:
        values = diagnostic_values(message)
        error = '' if message.level == DiagnosticStatus.OK else message.message
        start = 1e-9 * self._node.get_clock().now().nanoseconds - self._node.now()
        pending = pending_from_text(values.get('pending', '[]'), start)
        self.show(plc=ShownPlc(values.get('script', ''), error, pending=pending))

    def _on_image(self, image: str, message: Any) -> None:
        io, values = self._observer.state.io, tuple(map(float, message.data))
        if io.values.get(image) != values:
            self.show(io=replace(io, values={**io.values, image: values}))

    def _on_joints(self, message: JointState) -> None:
        def values(given: Any) -> Array | None:
            names = self._node.robot.axes_data.names
            return joint_values(message.name, given, names, 'joint_states') if len(given) else None

        q = values(message.position)
        self.show(q=q, q_dot=values(message.velocity), torque=values(message.effort))
        if q is not None:
            self._show_tool(q, seconds(message.header.stamp))

    def _show_tool(self, q: Array, time: float) -> None:
        before, passed = self._observer.state.tool, time - self._joints_time
        self._joints_time = time
        pose = self._node.robot.pose(q) @ self._observer.state.settings.tool_pose
        moved = 0.0 if before is None else float(np.linalg.norm(pose.r - before.r))
        self.show(tool=pose, **({'tool_speed': moved / passed} if passed > 0.0 else {}))

    def _on_health(self, message: DiagnosticArray) -> None:
        prefix = self._node.get_namespace().rstrip('/') + '/'
        for status in message.status:
            name = status.name.removeprefix(prefix)
            if name == PLANNER:
                good = status.level == DiagnosticStatus.OK
                limits = tuple(filter(None, diagnostic_values(status).get('limits', '').split(', ')))
                self.show(hindrance='' if good else status.message, limits=limits)
            elif name == VIEW:
                self.show(scene_url=diagnostic_values(status).get('url', ''))
            if name in WATCHED and name not in self._seen:
                self._seen.add(name)
                self._check_lost()

    def _check_lost(self) -> None:
        lost = {*WATCHED} - self._seen | {*self._watch.lost}
        plc = replace(self._observer.state.plc, lost=PLC in lost)
        self.show(lost=tuple(name for name in WATCHED if name in lost), plc=plc)

    # -- what they are asked ------------------------------------------------------------------------------

    def _ask(self) -> None:
        """Ask what has not been answered yet."""
        for question in self._questions:
            # A node may die with the question.
            waiting = self._node.now() - question.asked < ANSWER_TIME
            if question.open and not waiting and question.client.service_is_ready():
                question.asked = self._node.now()
                future = question.client.call_async(question.request)
                future.add_done_callback(partial(self._answered, question))

    def _ask_again(self, question: _Question) -> None:
        # The answer to an earlier question may be older.
        question.open, question.asked = True, -math.inf
        self._ask()

    def _answered(self, question: _Question, future: Any) -> None:
        question.open, question.asked = False, -math.inf
        question.answered(future.result())

    def _on_files(self, answer: Trigger.Response) -> None:
        files = json.loads(answer.message)
        path, program = files['program'], self._observer.state.program
        points_file = files['points_file'] or (str(Path(path).with_suffix(SUFFIX)) if path else '')
        frames_file = files['frames_file'] or (str(Path(path).with_name(FRAMES_FILE)) if path else '')
        found = {'points_file': points_file, 'frames_file': frames_file, 'written': files['written']}
        self.show(program=replace(program, path=path, **found))

    def _on_program_parameters(self, values: list[Any]) -> None:
        breakpoints, *labels = values
        named = {image: tuple(names or ()) for image, names in zip(LABELS, labels, strict=True)}
        self.show(
            io=replace(self._observer.state.io, labels=named),
            breakpoints=breakpoints_by_file(breakpoints or ()),
        )


@dataclass(eq=False)
class _Question:
    """What a node is asked, until it answers."""

    service: str
    client: Any
    request: Any
    answered: Callable[[Any], None]
    open: bool = True
    asked: float = -math.inf  # when, s
