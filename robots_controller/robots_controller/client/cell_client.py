"""CellClient: a live cell from Python."""

import threading
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Final, Self

from diagnostic_msgs.msg import DiagnosticStatus
from numpy.typing import ArrayLike
from rcl_interfaces.srv import GetParameters
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool

from robots_controller.client.cell_services import Connection
from robots_controller.client.io_client import IoClient
from robots_controller.client.motion import Motion, MotionsUnderWay
from robots_controller.client.program_client import ProgramClient
from robots_controller.nodes.ports.commanded_motions import commanded_motions
from robots_controller.nodes.ports.program.planner_client import PlannerClient
from robots_controller.program.motions.modal_settings import BLEND_ZONES
from robots_controller.program.motions.motion_command import MotionCommand
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import CommandRefusedError, InvalidInputError, NoAnswerError
from robots_core.pose import Pose
from robots_core.robot_choice import load_robot_model
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.streams.polled_subscription import PolledSubscription
from robots_core.ros.streams.serialized_readers import JointStateReader
from robots_core.validation import Array, read_only
from robots_planning.motion_kinds import CIRCLE, JOINT, JOINT_TO_POSE, LINE, SPLINE, MotionKind
from robots_planning.motion_settings import DESCRIPTIONS, MotionSettings, frame, frame_numbers

WATCH_PERIOD: Final = 0.05  # s
PATIENCE: Final = 10.0  # s


class CellClient:
    """A client of the live cell in a namespace: commands motions, reads and sets I/O, runs programs.

    For example::

        with CellClient() as cell:
            cell.change_settings(speed_fraction=0.3)
            cell.move_joint(cell.robot.home).wait()
            cell.io['gripper'] = True
            for progress in cell.move_line(cell.tool_pose @ BACK).updates():
                print(f'{progress:.0%}')
            cell.program.open('programs/welding.lua')
            cell.program.run()
            cell.program.wait()

    Motions run like those of robot programs: planning_node plans them with the settings given here, the
    collision check comes before them, and controller_node executes them in their order. They may be commanded
    ahead; those whose settings have a blend zone run through to the next one. When one fails, the robot
    stops, those commanded for after it fail too, and the next one is refused if no `Motion.wait` has raised
    the error. The client is the commander REMOTE: a free robot follows it at once; `take_command` keeps
    others away. Robot programs need the robot free.

    All methods may be called from any thread, and raise a RobotsError if a node refuses or does not answer.
    A cell in lock-step is driven by a robot program or `ControllerSixAxes` instead.

    Args:
        namespace: Namespace of the cell.
        domain: Its ROS domain; that of the environment (ROS_DOMAIN_ID) by default.
        patience: Longest wait for an answer of the cell, s.

    Raises:
        RobotsError: there is no such cell, or its robot is not installed here.
    """

    def __init__(self, namespace: str = '', *, domain: int | None = None, patience: float = PATIENCE) -> None:
        self._connection = Connection(namespace, domain, patience)
        try:
            self._connect(patience)
        except BaseException:
            self._connection.close()
            raise

    def _connect(self, patience: float) -> None:
        request = GetParameters.Request(names=['robot_model', 'tool', 'base'])
        answer = self._connection.answer('planning_node/get_parameters', GetParameters, request)
        robot, tool, base = answer.values
        self.robot = load_robot_model(robot.string_value)
        """The robot of the cell."""
        self._frames = {'tool': tuple(tool.double_array_value), 'base': tuple(base.double_array_value)}
        self.io = IoClient(self._connection)
        self.program = ProgramClient(self._connection)
        node, names = self._connection.node, self.robot.axes_data.names
        self._settings: dict[str, object] = {}
        self._zones: dict[str, object] = {}  # blend zones of the motion before
        self._states = PolledSubscription(node, JointState, 'joint_states', raw=True)
        self._reader = JointStateReader(names)
        self._position: Array | None = None
        self._taking = threading.Lock()
        self._latched: dict[str, str] = {}
        self._override = make_publisher(node, Float64, 'override')
        self._planner = PlannerClient(node, names)
        self._queue = commanded_motions(
            self._connection, self._planner, lambda _, command, error: self._motions.end(command, error)
        )
        self._motions = MotionsUnderWay(self._queue.cancel, self._flush, patience)
        subscribe(node, Float64, 'motion_progress', lambda message: self._motions.advance(message.data))
        for topic in ('commander', 'operating_mode'):
            subscribe(node, String, topic, partial(self._on_text, topic))
        subscribe(node, DiagnosticStatus, 'stop_status', self._on_stop)
        node.create_timer(WATCH_PERIOD, self._queue.watch)

    def close(self) -> None:
        """Take back the settings and end the connection; motions that were sent continue."""
        if self._planner.differs({}):
            done = threading.Event()
            self._planner.configure({}, lambda _: done.set(), moving=False)
            done.wait(self._connection.patience)
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # -- motions --------------------------------------------------------------------------------------

    def change_settings(self, **settings: Any) -> None:
        """Change settings of all motions that follow.

        Args:
            settings: By the names of `MotionSettings`, SI; `tool` and `base` may be Poses. What is not set is
                as planning_node has it.

        Raises:
            InvalidInputError: no such setting, or a value that is not valid.
        """
        checked = _checked(settings)
        self._settings |= checked
        self._frames |= {name: checked[name] for name in self._frames.keys() & checked.keys()}

    def move_joint(self, q: ArrayLike, **settings: Any) -> Motion:
        """Move all axes together to joint positions.

        Args:
            q: Target, (n,), rad (m).
            settings: For this motion alone, see `change_settings`; so in all other motions.

        Raises:
            JointLimitError: a position outside its limits; so InvalidInputErrors of all motions are raised
                here, and what planner and controller refuse by `Motion.wait`.
        """
        return self._move(JOINT, settings, q=read_only(self.robot.axes_data.check_position(q, 'q')))

    def move_joint_to_pose(self, pose: Pose, **settings: Any) -> Motion:
        """Move all axes together to a pose of the tool, seen from the base that is set."""
        return self._move(JOINT_TO_POSE, settings, pose=pose)

    def move_line(self, pose: Pose, **settings: Any) -> Motion:
        """Move the tool on a straight line to a pose, seen from the base that is set."""
        return self._move(LINE, settings, pose=pose)

    def move_circle(self, via: Pose, end: Pose, **settings: Any) -> Motion:
        """Move the tool on an arc through `via` to `end`."""
        return self._move(CIRCLE, settings, pose=end, path=(via, end))

    def move_spline(self, poses: Sequence[Pose], **settings: Any) -> Motion:
        """Move the tool on a smooth curve through poses."""
        if not poses:
            raise InvalidInputError('a spline needs at least one pose, got none')
        return self._move(SPLINE, settings, pose=poses[-1], path=tuple(poses))

    def pause(self) -> None:
        """Hold the robot on its path."""
        self._connection.trigger('controller_node/pause')

    def resume(self) -> None:
        """Go on after `pause`."""
        self._connection.trigger('controller_node/resume')

    def cancel(self) -> None:
        """Stop the robot on its path and give up all motions."""
        self._motions.expect_failures()
        self._queue.cancel()

    def stop(self) -> None:
        """Stop the robot on its path, whatever commanded it, until `reset`."""
        self._motions.expect_failures()
        self._connection.trigger('controller_node/stop')

    def set_override(self, value: float) -> None:
        """Scale the speed of all motions, 0..1, at once."""
        if not 0.0 <= value <= 1.0:
            raise InvalidInputError(f'override = {value:g} must be in [0, 1]')
        self._override.publish(Float64(data=float(value)))

    def _move(self, kind: MotionKind, settings: Mapping[str, Any], **target: Any) -> Motion:
        wanted = self._settings | _checked(settings)
        for pose in [] if kind is JOINT else [*target.get('path', ()), target['pose']]:
            if not isinstance(pose, Pose):
                raise InvalidInputError(f'{pose!r} is no Pose')
        zones = {name: wanted[name] for name in BLEND_ZONES if wanted.get(name)}
        # Blending that is switched off before the last motion would end the chain before that.
        command = MotionCommand(
            kind=kind, line=0, function='', settings=wanted | ({} if zones else self._zones), **target
        )
        motion = self._motions.begin(command)
        self._queue.send(command)
        self._motions.sent(motion)
        if zones:
            self._zones = zones
        else:
            self._flush()
        return motion

    def _flush(self) -> None:
        """No motion follows that the last one could blend into."""
        if self._zones:
            self._zones = {}
            self._queue.flush()

    # -- robot ----------------------------------------------------------------------------------------

    @property
    def q(self) -> Array:
        """Newest measured joint positions, (n,), rad (m), read-only.

        Raises:
            RobotsError: none have come yet.
        """
        with self._taking:
            raw = self._states.take()
            if raw is not None:
                self._position = read_only(self._reader.position(raw))
            if self._position is None:
                raise NoAnswerError('no joint_states have come yet: are the drives running?')
            return self._position

    @property
    def tool_pose(self) -> Pose:
        """Pose of the tool that is set, seen from the base that is set, at the measured positions."""
        tool, base = (frame(values, name) for name, values in self._frames.items())
        return base.inverse() @ self.robot.pose(self.q) @ tool

    @property
    def commander(self) -> Commander:
        """The commander of the robot."""
        return Commander(self._latched.get('commander', Commander.NOBODY))

    @property
    def operating_mode(self) -> str:
        """The operating mode; '' before the controller has reported it."""
        return self._latched.get('operating_mode', '')

    @property
    def fault(self) -> str:
        """Why the robot is stopped until `reset`; '' if it is not."""
        return self._latched.get('fault', '')

    def take_command(self) -> None:
        """Take the robot, which must stand and be free, so that no other commander moves it.

        Raises:
            CommandRefusedError: another commander has it, or the operating mode excludes REMOTE.
        """
        self._set_commander(taken=True)

    def give_back_command(self) -> None:
        """Give the robot back."""
        self._set_commander(taken=False)

    def take_over(self) -> None:
        """Stop the robot and take it from its present commander."""
        self._motions.expect_failures()
        self._connection.trigger('controller_node/take_over/remote')

    def emergency_stop(self) -> None:
        """Stop the robot and switch its drives off. This is not a certified safety function."""
        self._motions.expect_failures()
        self._connection.trigger('controller_node/emergency_stop')

    def reset(self) -> None:
        """Permit motion again after a fault."""
        self._motions.expect_failures()
        self._connection.trigger('controller_node/reset')

    def _set_commander(self, *, taken: bool) -> None:
        service = 'controller_node/commander/remote'
        answer = self._connection.answer(service, SetBool, SetBool.Request(data=taken))
        if not answer.success:
            raise CommandRefusedError(answer.message)

    # -- the connection's thread ----------------------------------------------------------------------

    def _on_text(self, topic: str, message: String) -> None:
        self._latched[topic] = message.data

    def _on_stop(self, message: DiagnosticStatus) -> None:
        self._latched['fault'] = '' if message.level == DiagnosticStatus.OK else message.message


def _checked(settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings as MotionSettings has them."""
    values: dict[str, Any] = {
        name: frame_numbers(value) if isinstance(value, Pose) else value for name, value in settings.items()
    }
    unknown = values.keys() - DESCRIPTIONS.keys()
    if unknown:
        raise InvalidInputError(
            f'unknown setting {", ".join(sorted(unknown))}; settings are {", ".join(DESCRIPTIONS)}'
        )
    MotionSettings(**values)
    return values
