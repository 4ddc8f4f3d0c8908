"""CellReader: keeps the state of a cell, from what its nodes publish and answer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import ParameterEvent, ParameterValue
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String

from robots_controller.interpreter.debugger import breakpoints_by_file
from robots_controller.io.io_image import IMAGES
from robots_controller.nodes.io_services import OUTPUTS
from robots_controller.nodes.ports.io_images import image_message
from robots_controller.nodes.ports.plc_status import pending_from_text
from robots_controller.pendant.pendant_state import WATCHED, PendantState, ShownPlc, ShownProgram
from robots_controller.program.files.cell_frames import FRAMES_FILE
from robots_controller.program.files.taught_points import SUFFIX
from robots_controller.program.run_state import RunState
from robots_core.blocks.following.guide import Guide
from robots_core.blocks.multibody.payload import payload_of
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.errors import InvalidInputError
from robots_core.pose import Pose
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
    """Subscribes to the topics of a cell, and asks its nodes for parameters, again after each change.

    Args:
        node: In the cell's namespace.
        observer: Gets the state, which is replaced at every change.
    """

    def __init__(self, node: RobotNode, observer: StateObserver) -> None:
        self._node, self._observer = node, observer
        self._seen: set[str] = set()
        self._asked: dict[str, float] = {}  # when, s
        self._joints_time = 0.0
        self._questions: dict[str, tuple[Sequence[str], Callable[[list[Any]], None]]] = {}
        self._question_clients: dict[str, Any] = {}
        self._open_questions: set[str] = set()
        self._subscribe()
        self._watch = HeartbeatWatch(node, (*WATCHED, PLC), LOST_AFTER, lambda *_: self._check_lost())
        asked = ('program', 'points_file', 'frames_file', 'breakpoints', *LABELS.values())
        self.ask(PROGRAM, asked, self._on_program_parameters)
        node.create_timer(ASK_PERIOD, self._ask)

    def ask(self, name: str, parameters: Sequence[str], answered: Callable[[list[Any]], None]) -> None:
        """Ask a node for the values of parameters until it answers, and again when they have changed."""
        self._questions[name] = (parameters, answered)
        self._question_clients[name] = self._node.create_client(GetParameters, f'{name}/get_parameters')
        self._open_questions.add(name)

    def show(self, **changes: Any) -> None:
        """Change the state."""
        self._observer.state = replace(self._observer.state, **changes)

    def _subscribe(self) -> None:
        def text(topic: str, read: Callable[[str], Any]) -> None:
            subscribe(self._node, String, topic, lambda message: self.show(**{topic: read(message.data)}))

        def flag(topic: str) -> None:
            subscribe(self._node, Bool, topic, lambda message: self.show(**{topic: message.data}))

        text('commander', Commander)
        text('guide', Guide)
        subscribe(
            self._node, String, 'operating_mode', lambda message: self.show(mode=OperatingMode(message.data))
        )
        flag('run_enabled')
        flag('drives_on')
        subscribe(self._node, Float64, 'override', self._on_override)
        subscribe(self._node, Float64, 'min_distance', lambda message: self.show(distance=message.data))
        subscribe(self._node, DiagnosticStatus, 'stop_status', self._on_stop)
        subscribe(self._node, DiagnosticStatus, 'program_status', self._on_program)
        subscribe(self._node, DiagnosticStatus, 'forced_inputs', self._on_forced)
        subscribe(self._node, DiagnosticStatus, 'plc_status', self._on_plc)
        for image in IMAGES:
            topic = image if image in OUTPUTS else f'{PROGRAM}/{image}'
            subscribe(self._node, image_message(image), topic, partial(self._on_image, image))
        self._node.poll(JointState, 'joint_states', self._on_joints, rate=RATE)
        subscribe(self._node, DiagnosticArray, '/diagnostics', self._on_health)
        subscribe(self._node, DiagnosticStatus, 'motion_settings', self._on_settings)
        subscribe(self._node, ParameterEvent, '/parameter_events', self._on_parameters)

    # -- what the nodes report ----------------------------------------------------------------------------

    def _on_override(self, message: Float64) -> None:
        self.show(override=fraction(message.data, 'override'))

    def _on_stop(self, message: DiagnosticStatus) -> None:
        fault = '' if message.level == DiagnosticStatus.OK else message.message
        self.show(fault=fault, fault_kind=diagnostic_values(message).get('fault', '') if fault else '')

    def _on_program(self, message: DiagnosticStatus) -> None:
        values = diagnostic_values(message)
        before = self._observer.state.program
        program = ShownProgram(
            path=before.path,
            points_file=before.points_file,
            frames_file=before.frames_file,
            state=_run_state(values.get('state', '')),
            file=values.get('file', ''),
            line=int(number_in(values, 'line', 0.0)),
            motion_file=values.get('motion_file', ''),
            motion_line=int(number_in(values, 'motion_line', 0.0)),
            error=values.get('error', ''),
            hold=values.get('hold', ''),
        )
        if program.state in (RunState.OPENED, RunState.FAILED) and program != before:
            self._ask_again(PROGRAM)  # another one may be open
        self.show(program=program)

    def _on_settings(self, message: DiagnosticStatus) -> None:
        settings = settings_from_text(diagnostic_values(message))
        self.show(settings=settings, payload=payload_of(settings.payload))

    def _on_parameters(self, event: ParameterEvent) -> None:
        name = event.node.removeprefix(f'{self._node.get_namespace().rstrip("/")}/')
        wanted, _ = self._questions.get(name, ((), None))
        if any(one.name in wanted for one in (*event.new_parameters, *event.changed_parameters)):
            self._ask_again(name)

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
        pose = Pose(*self._node.robot.direct_kinematics(q)) @ self._observer.state.settings.tool_pose
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
        """Ask nodes for parameters, until they answer."""
        for name in [*self._open_questions]:
            client = self._question_clients[name]
            # A node may die with the question.
            waiting = self._node.now() - self._asked.get(name, -math.inf) < ANSWER_TIME
            if not waiting and client.service_is_ready():
                request = GetParameters.Request(names=list(self._questions[name][0]))
                self._asked[name] = self._node.now()
                client.call_async(request).add_done_callback(partial(self._answered, name))

    def _ask_again(self, name: str) -> None:
        self._open_questions.add(name)
        self._asked.pop(name, None)  # the answer to an earlier question may be older
        self._ask()

    def _answered(self, name: str, future: Any) -> None:
        self._asked.pop(name, None)
        self._open_questions.discard(name)
        values: list[ParameterValue] = future.result().values
        self._questions[name][1]([parameter_value_to_python(value) for value in values])

    def _on_program_parameters(self, values: list[Any]) -> None:
        path, points_file, frames_file, breakpoints, *labels = values
        points_file = points_file or (str(Path(path).with_suffix(SUFFIX)) if path else '')
        frames_file = frames_file or (str(Path(path).with_name(FRAMES_FILE)) if path else '')
        state = self._observer.state
        named = {image: tuple(names or ()) for image, names in zip(LABELS, labels, strict=True)}
        self.show(
            program=replace(state.program, path=path or '', points_file=points_file, frames_file=frames_file),
            io=replace(state.io, labels=named),
            breakpoints=breakpoints_by_file(breakpoints or ()),
        )


def _run_state(text: str) -> RunState:
    if text not in [*RunState]:
        raise InvalidInputError(f'unknown run state {text!r}; valid are {", ".join(RunState)}')
    return RunState(text)
