"""pendant_node: a page in the browser to operate the cell: jog, programs, inputs and outputs, messages."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rcl_interfaces.msg import Log, ParameterEvent, ParameterValue
from rcl_interfaces.srv import GetParameters
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import QoSProfile, qos_profile_parameter_events
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Float64, String

from robots_controller.interpreter.debugger import breakpoints_by_file
from robots_controller.io.io_image import IMAGES
from robots_controller.nodes.io_images import image_message
from robots_controller.nodes.io_services import OUTPUTS
from robots_controller.nodes.pendant_link import PendantLink
from robots_controller.pendant.message_log import Level
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import WATCHED, JogSpeeds, ShownProgram
from robots_controller.program.run_state import RunState
from robots_controller.program.taught_points import SUFFIX
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.blocks.following.guide import Guide
from robots_core.errors import InstallationError, InvalidInputError
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.operating_modes import Commander, OperatingMode
from robots_core.pose import Pose
from robots_core.ros.heartbeat import HeartbeatWatch
from robots_core.ros.messages import (
    diagnostic_values,
    joint_values,
    number_in,
    seconds,
)
from robots_core.ros.qos import COMMAND, SENSOR, subscribe_state
from robots_core.ros.robot_node import RobotNode
from robots_core.ros.run import run
from robots_core.validation import fraction
from robots_planning.motion_settings import settings_from_text
from robots_planning.pathplanning import PathPlanning

RATE: Final = 10.0  # Hz, of what is shown
ASK_PERIOD: Final = 0.5  # s between requests to nodes that have not answered
ANSWER_TIME: Final = 5.0  # s
LOST_AFTER: Final = 1.0  # s
LOGS: Final = QoSProfile(depth=100)
LEVELS: Final = ((Log.ERROR, Level.ERROR), (Log.WARN, Level.WARNING))
PLANNER, PROGRAM, VIEW = 'planning_node', 'lua_program_node', 'visualizer_node'
LABELS: Final = {image: f'{image.removesuffix("s")}_names' for image in IMAGES}
ASKED: Final = ('program', 'points_file', 'breakpoints', *LABELS.values())


class PendantNode(RobotNode):
    """Serves the operator's page, and passes on what is pressed there.

    The page does nothing that other nodes could not do over the same topics and services.
    """

    takes_part = False  # a person does not hold time

    def __init__(self, **options: Any) -> None:
        super().__init__('pendant_node', **options)
        port = self.parameter('port', 8090, 'first port to try for the page; 0 lets the system choose')
        folder = self.parameter('programs', 'programs', 'folder of the robot programs that can be chosen')
        self._collision_scene = Scene()
        self._preview: PathPlanning | None = None
        self.operator = PendantOperator(self.robot, PendantLink(self), self.now, self._make_planning)
        WatchedScene(self, self._on_scene)
        self._seen: set[str] = set()
        self._asked: dict[str, float] = {}  # when, s
        self._joints_time = 0.0
        self._margin = 0.0
        self._subscribe()
        self._watch = HeartbeatWatch(self, WATCHED, LOST_AFTER, lambda *_: self._look_for_lost())
        self._questions: dict[str, tuple[Sequence[str], Callable[[list[Any]], None]]] = {
            PLANNER: (('teach_speed', 'teach_tool_speed', 'collision_margin'), self._on_jog_speeds),
            PROGRAM: (
                ('program', 'points_file', 'breakpoints', *LABELS.values()),
                self._on_program_parameters,
            ),
        }
        self._question_clients = {
            name: self.create_client(GetParameters, f'{name}/get_parameters') for name in self._questions
        }
        self._open_questions = {*self._questions}
        self.create_timer(ASK_PERIOD, self._ask)
        self._server = self._serve(port, Path(folder).resolve())
        self.journal.info(f'the robot is operated at {self.url}')
        self.ready(url=self.url)

    def _serve(self, port: int, folder: Path) -> Any:
        try:
            from robots_controller.pendant.page.page_server import PageServer  # noqa: PLC0415
            from robots_controller.pendant.page.pendant_page import PendantPage  # noqa: PLC0415
        except ImportError as error:
            raise InstallationError(
                f"the operator's page needs NiceGUI ({error}): pip install -r requirements-pendant.txt"
            ) from error
        build = partial(PendantPage, self.operator, folder)
        return PageServer(build, port=port, title=self.robot.name)

    @property
    def url(self) -> str:
        """Address of the page."""
        return str(self._server.url)

    def _subscribe(self) -> None:
        def text(topic: str, read: Callable[[str], Any]) -> None:
            subscribe_state(self, String, topic, lambda message: self._show(**{topic: read(message.data)}))

        def flag(topic: str) -> None:
            subscribe_state(self, Bool, topic, lambda message: self._show(**{topic: message.data}))

        text('commander', Commander)
        text('guide', Guide)
        subscribe_state(
            self, String, 'operating_mode', lambda message: self._show(mode=OperatingMode(message.data))
        )
        flag('run_enabled')
        flag('drives_on')
        subscribe_state(self, Float64, 'override', self._on_override)
        subscribe_state(self, DiagnosticStatus, 'stop_status', self._on_stop)
        subscribe_state(self, DiagnosticStatus, 'program_status', self._on_program)
        subscribe_state(self, DiagnosticStatus, 'motion_settings', self._on_settings)
        subscribe_state(self, DiagnosticStatus, 'forced_inputs', self._on_forced)
        for image in IMAGES:
            topic = image if image in OUTPUTS else f'{PROGRAM}/{image}'
            subscribe_state(self, image_message(image), topic, partial(self._on_image, image))
        self.poll(JointState, 'joint_states', self._on_joints, SENSOR, rate=RATE)
        self.create_subscription(DiagnosticArray, '/diagnostics', self._on_health, COMMAND)
        self.create_subscription(Log, '/rosout', self._on_log, LOGS)
        self.create_subscription(
            ParameterEvent, '/parameter_events', self._on_parameters, qos_profile_parameter_events
        )

    def _show(self, **changes: Any) -> None:
        self.operator.state = replace(self.operator.state, **changes)

    # -- previews of motions ------------------------------------------------------------------------------

    def _make_planning(self) -> PathPlanning:
        collision = CollisionDetection(self.robot)
        planning = PathPlanning(self.robot, collision=collision, collision_margin=self._margin)
        planning.set_scene(self._collision_scene)
        self._preview = planning
        return planning

    def _on_scene(self, scene: Scene) -> None:
        self._collision_scene = scene
        if self._preview is not None:
            self._preview.set_scene(scene)

    # -- what the nodes report ----------------------------------------------------------------------------

    def _on_override(self, message: Float64) -> None:
        self._show(override=fraction(message.data, 'override'))

    def _on_stop(self, message: DiagnosticStatus) -> None:
        self._show(fault='' if message.level == DiagnosticStatus.OK else message.message)

    def _on_program(self, message: DiagnosticStatus) -> None:
        values = diagnostic_values(message)
        before = self.operator.state.program
        program = ShownProgram(
            path=before.path,
            points_file=before.points_file,
            state=_run_state(values.get('state', '')),
            file=values.get('file', ''),
            line=int(number_in(values, 'line', 0.0)),
            motion_file=values.get('motion_file', ''),
            motion_line=int(number_in(values, 'motion_line', 0.0)),
            error=values.get('error', ''),
            hold=values.get('hold', ''),
        )
        if program.state in (RunState.OPENED, RunState.FAILED) and program != before:
            self._open_questions.add(PROGRAM)  # another one may be open
            self._asked.pop(PROGRAM, None)  # the answer to an earlier question may be older
            self._ask()
        self._show(program=program)

    def _on_settings(self, message: DiagnosticStatus) -> None:
        self._show(settings=settings_from_text(diagnostic_values(message)))

    def _on_parameters(self, event: ParameterEvent) -> None:
        if event.node != f'{self.get_namespace().rstrip("/")}/{PROGRAM}':
            return
        for parameter in event.changed_parameters:
            if parameter.name == 'breakpoints':
                self._show(breakpoints=breakpoints_by_file(parameter.value.string_array_value))

    def _on_forced(self, message: DiagnosticStatus) -> None:
        forced = frozenset(name.partition(' ')[0] for name in diagnostic_values(message))
        self._show(io=replace(self.operator.state.io, forced=forced))

    def _on_image(self, image: str, message: Any) -> None:
        io, values = self.operator.state.io, tuple(map(float, message.data))
        if io.values.get(image) != values:
            self._show(io=replace(io, values={**io.values, image: values}))

    def _on_joints(self, message: JointState) -> None:
        q = joint_values(message.name, message.position, self.robot.axes_data.names, 'joint_states')
        pose = Pose(*self.robot.direct_kinematics(q)) @ self.operator.state.settings.tool_pose
        time, before = seconds(message.header.stamp), self.operator.state.tool
        passed, self._joints_time = time - self._joints_time, time
        moved = 0.0 if before is None else float(np.linalg.norm(pose.r - before.r))
        self._show(q=q, tool=pose, **({'tool_speed': moved / passed} if passed > 0.0 else {}))

    def _on_health(self, message: DiagnosticArray) -> None:
        prefix = self.get_namespace().rstrip('/') + '/'
        for status in message.status:
            name = status.name.removeprefix(prefix)
            if name == PLANNER:
                self._show(hindrance='' if status.level == DiagnosticStatus.OK else status.message)
            elif name == VIEW:
                self._show(scene_url=diagnostic_values(status).get('url', ''))
            if name in WATCHED and name not in self._seen:
                self._seen.add(name)
                self._look_for_lost()

    def _look_for_lost(self) -> None:
        lost = {*WATCHED} - self._seen | {*self._watch.lost}
        self._show(lost=tuple(name for name in WATCHED if name in lost))

    def _on_log(self, message: Log) -> None:
        prefix = self.get_namespace().strip('/').replace('/', '.')
        if prefix and not message.name.startswith(f'{prefix}.'):
            return
        name = message.name.removeprefix(f'{prefix}.')
        if name == f'{PROGRAM}.print':
            self.operator.print(message.msg)
            return
        level = next((one for number, one in LEVELS if message.level >= number), Level.INFO)
        if message.level >= Log.INFO:
            self.operator.messages.add(seconds(message.stamp), level, name, message.msg)

    # -- what they are asked ------------------------------------------------------------------------------

    def _ask(self) -> None:
        """Ask nodes for parameters, until they answer."""
        for name in [*self._open_questions]:
            client = self._question_clients[name]
            # A node may die with the question.
            waiting = self.now() - self._asked.get(name, -math.inf) < ANSWER_TIME
            if not waiting and client.service_is_ready():
                request = GetParameters.Request(names=list(self._questions[name][0]))
                self._asked[name] = self.now()
                client.call_async(request).add_done_callback(partial(self._answered, name))

    def _answered(self, name: str, future: Any) -> None:
        self._asked.pop(name, None)
        self._open_questions.discard(name)
        values: list[ParameterValue] = future.result().values
        self._questions[name][1]([parameter_value_to_python(value) for value in values])

    def _on_jog_speeds(self, values: list[Any]) -> None:
        *speeds, self._margin = values
        self._show(jog_speeds=JogSpeeds(*speeds))

    def _on_program_parameters(self, values: list[Any]) -> None:
        path, points_file, breakpoints, *labels = values
        points_file = points_file or (str(Path(path).with_suffix(SUFFIX)) if path else '')
        state = self.operator.state
        named = {image: tuple(names or ()) for image, names in zip(LABELS, labels, strict=True)}
        program = replace(state.program, path=path or '', points_file=points_file)
        self._show(
            program=program,
            io=replace(state.io, labels=named),
            breakpoints=breakpoints_by_file(breakpoints or ()),
        )

    def destroy_node(self) -> None:
        """End the page with the node."""
        self._server.close()
        super().destroy_node()


def _run_state(text: str) -> RunState:
    if text not in [*RunState]:
        raise InvalidInputError(f'unknown run state {text!r}; valid are {", ".join(RunState)}')
    return RunState(text)


main: Final = partial(run, PendantNode)
