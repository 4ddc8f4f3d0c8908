"""The graph of a robot cell: which nodes it has, in one place, for `cell` and for ros2 launch."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from ament_index_python.packages import PackageNotFoundError, get_package_prefix

from robots_controller.cell.contact_setup import check_one_guide, read_contact
from robots_controller.control.speed.frame_speed_limit import checked_speed_limit
from robots_controller.defaults import RATE
from robots_controller.io.cell_io import CellIo, read_cell_io
from robots_controller.io.emergency_inputs import emergency_stop_texts
from robots_controller.io.fail_safe import fail_safe_texts
from robots_controller.io.zone_inputs import closing_inputs, closing_texts
from robots_controller.opcua.server_settings import read_server_settings
from robots_controller.pendant.page_access import read_access
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.blocks.drives.drive_choice import check_level
from robots_core.blocks.following.following_methods import METHODS
from robots_core.blocks.motion_cueing.cabin import read_cabin
from robots_core.cell_interface.driver_file import read_driver
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import InstallationError, OptionError
from robots_core.periodic.watchdog import LONGEST, WATCHDOG, checked_watchdog
from robots_planning.motion_settings import NOTHING

DEFAULT_ROBOT: Final = 'bello_bot'
"""Of a cell without a program that names its robot."""
COMPOSED: Final = 'composed_nodes'
"""Process of the nodes that share one."""
PAGE_PORTS: Final = 10
"""Ports between those that are tried for the 3D view and those for the operator's page."""
KEEP_TIME: Final = ('drive_node', 'hardware_node', 'controller_node')
"""Nodes with a loop that other nodes must not hold up."""
POSE_RATE: Final = 50.0
"""Of the tool's pose at most, Hz; never higher than that of references."""

_EMERGENCY_STOP_OF_PRIMITIVES: Final = (
    'a driver of motion primitives (--driver) excludes emergency_stop: {} would stop nothing, because no '
    "controller_node runs; wire the emergency stop to the robot's own controller, and remove emergency_stop "
    'from the files of --io and --io-map'
)


@dataclass(frozen=True)
class NodeDescription:
    """One node of the cell.

    Attributes:
        package: ROS package.
        executable: Executable in that package; also the node's name.
        parameters: ROS parameters.
        process: Name of its process; nodes with the same one share it.
    """

    package: str
    executable: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    process: str = ''

    def __post_init__(self) -> None:
        object.__setattr__(self, 'process', self.process or self.executable)

    @property
    def name(self) -> str:
        """The node's name."""
        return self.executable

    def as_dict(self) -> dict[str, Any]:
        """For JSON: package, executable, process and parameters."""
        return asdict(self)

    def executable_path(self) -> Path:
        """The executable as `ros2 run` finds it: prefix/lib/package/executable by the ament index.

        Raises:
            RobotsError: the package is not installed, or has no such executable.
        """
        try:
            prefix = Path(get_package_prefix(self.package))
        except PackageNotFoundError as error:
            raise InstallationError(
                f'package {self.package!r} is not in the ament index; build the workspace '
                f'(`make build`) and source install/setup.bash'
            ) from error
        path = prefix / 'lib' / self.package / self.executable
        if not path.is_file():
            raise InstallationError(
                f'package {self.package!r} has no executable {self.executable!r} in {path.parent}'
            )
        return path


def cell_graph(
    *,
    robot: str,
    program: str = '',
    autostart: bool = False,
    launch: str = '',
    rate: float = RATE,
    drive: str = 'second_order',
    driver: str = '',
    goal_tolerance: float | None = None,
    tool_speed_limit: float = 0.0,
    operating_mode: str = OperatingMode.AUTOMATIC,
    watchdog: float = WATCHDOG,
    payload: tuple[float, ...] = NOTHING,
    port: int = 8080,
    io: str = '',
    io_map: str = '',
    frames: str = '',
    scene: str = '',
    guided: str = '',
    references: str = '',
    contact: str = '',
    orbit: str = '',
    cabin: str = '',
    debug_port: int = 0,
    debug_token: str = '',
    pendant: bool = False,
    host: str = '',
    password_file: str = '',
    record: Path | None = None,
    opcua: int = 0,
    opcua_access: str = '',
    lockstep: bool = False,
    composed: bool = False,
    headless: bool = False,
) -> tuple[NodeDescription, ...]:
    """All nodes of a cell with one simulated robot.

    Args:
        robot: The robot's name; all that depends on it.
        program: Robot program that the Lua node opens.
        autostart: The Lua node runs the program by itself as soon as it can.
        launch: Names this start of the cell: within it autostart runs the program once, and a controller that
            is started again stays stopped until its reset.
        rate: References per second, Hz.
        drive: Level of the drives, one of `DRIVE_LEVELS`.
        driver: Driver of a real robot, in the place of the drives (see `read_driver`); none by default.
        goal_tolerance: Largest error of an axis that has reached its target, rad (m); the controller's own by
            default. Elastic gears and friction of `rigid_body` drives can keep an axis from standing closer.
        tool_speed_limit: Highest speed of the tool and of the frames of all axes, m/s; 0 for none.
        operating_mode: One of `OperatingMode`.
        watchdog: How long a node that others depend on may give no sign of life, s; 0: any time.
        payload: What the robot carries until its program sets another payload, see `MotionSettings`.
        port: First port to try for the 3D view.
        io: Script of a PLC that is played (see `plc_script`); none without one.
        io_map: Map of inputs and outputs to topics of a PLC (see `io_map`); none without one.
        frames: Tools and bases by name (see `read_frames`); frames.yaml beside the program by default.
        scene: Scene that the robot keeps clear of (see `read_scene`); with one, the robot is watched too.
        guided: Inverse kinematics that follows `reference_pose` in `followReference`, one of `METHODS`;
            none by default.
        references: Recording of what guides or jogs the robot (see `read_guide_recording`); none by default.
        contact: What the tool touches, and force control that guides the robot there (see `read_contact`), in
            the place of a recording; none by default.
        orbit: Orbit in which the robot's base floats (see `read_orbit`), whose camera publishes what guides
            the robot; none by default.
        cabin: Cabin that the robot carries (see `read_cabin`): the recording then holds its driver's inputs,
            or the motion of a vehicle; none by default.
        debug_port: Port on this machine where editors debug the program; 0 for none.
        debug_token: What editors must give there; the program node makes one if it is empty.
        pendant: With the operator's page; its port is looked for from `PAGE_PORTS` above `port` on.
        host: Address of the operator's page; this machine alone by default.
        password_file: Its first line is the password of that page (see `read_access`).
        record: Folder below which the cell is recorded, and the page records; 'out' by default.
        opcua: TCP port at which the robot is an OPC UA server; 0 for none.
        opcua_access: Who may do what there (see `read_server_settings`); by default anyone may read.
        lockstep: All nodes take part in a lock-step run.
        composed: The nodes that do not keep time share a process; in lock-step none keeps time.
        headless: Without the 3D view.

    Raises:
        RobotsError: no such level or method, a file that is not valid, or both set inputs of the same kind.
    """
    check_level(drive)
    primitives = False
    if driver:
        primitives = read_driver(driver).primitives is not None
        if lockstep or orbit:
            raise OptionError('a real robot (driver) excludes lock-step and orbits')
    if primitives:
        _check_for_primitives(
            scene=scene,
            guided=guided,
            view=pendant,
            operating_mode=operating_mode != OperatingMode.AUTOMATIC,
            tool_speed_limit=tool_speed_limit,
            goal_tolerance=goal_tolerance,
        )
    check_one_guide(references or cabin, contact, orbit)
    if contact:
        read_contact(contact)
    if cabin:
        read_cabin(cabin)
    watched = {'watchdog': checked_watchdog(watchdog)}
    # In lock-step the controller is that of a simulation.
    feedback = {} if lockstep else {'feedback_timeout': watchdog or LONGEST}
    if guided and guided not in METHODS:
        raise OptionError(f'unknown inverse kinematics {guided!r}; valid are {", ".join(METHODS)}')
    tolerance = {} if goal_tolerance is None else {'goal_tolerance': goal_tolerance}
    # The run button is not needed while time stands still.
    held = {'hold_timeout': 0.0} if lockstep else {}
    mode = {'operating_mode': OperatingMode(operating_mode).value, **held}
    capped = {'tool_speed_limit': checked_speed_limit(tool_speed_limit)} if tool_speed_limit else {}
    cell_io = read_cell_io(io, io_map, orbit=orbit)
    if lockstep:
        cell_io.io_map.check_simulated_time()
    if primitives and cell_io.emergency_stop:
        raise OptionError(_EMERGENCY_STOP_OF_PRIMITIVES.format(', '.join(cell_io.emergency_stop)))
    source = _source_of_emergency_stop(cell_io)
    stopping = {
        'emergency_stop_inputs': emergency_stop_texts(cell_io.emergency_stop) or [''],
        'emergency_stop_source': source,
    }
    # In lock-step nobody is missed: a run ends without one of its participants.
    awaited = [] if lockstep else [*(['collision_node'] if scene else []), *([source] if source else [])]
    expected = {'expected_nodes': awaited} if awaited else {}
    labels, fail_safe = cell_io.labels, fail_safe_texts(cell_io.fail_safe) or ['']
    names = {f'{image.removesuffix("s")}_names': list(names) for image, names in labels.items()}
    zones = read_scene(scene).zones if scene else ()
    zoned = {'scene': scene, 'zone_inputs': closing_texts(closing_inputs(zones, cell_io.signals)) or ['']}
    drives = {'rate': rate, 'level': drive, 'payload': list(payload)} | ({'orbit': orbit} if orbit else {})
    played = {'references': references, 'cabin': cabin}
    plc_cycle = {'cycle': 1.0 / rate} if lockstep else {}

    def node(package: str, executable: str, **parameters: Any) -> NodeDescription:
        time = {'lockstep': True} if lockstep else {}
        shared = composed and (lockstep or executable not in KEEP_TIME)
        process = COMPOSED if shared else executable
        return NodeDescription(package, executable, {'robot_model': robot, **time, **parameters}, process)

    access = read_access(host, password_file)
    page = {'host': access.host, 'password_file': password_file, 'recordings': str(record or 'out')}
    bridge = node('robots_controller', 'io_bridge_node', io_map=io_map, fail_safe=fail_safe, **watched)
    moving = (
        node('robots_core', 'hardware_node', rate=rate, driver=driver, **watched)
        if driver
        else node('robots_core', 'drive_node', **drives, **watched),
        node(
            'robots_controller',
            'controller_node',
            rate=rate,
            launch=launch,
            **tolerance,
            **capped,
            **mode,
            **stopping,
            **expected,
            **(zoned if zones else {}),
            **watched,
            **feedback,
        ),
        node('robots_planning', 'planning_node', scene=scene, payload=list(payload), **watched),
    )
    return (
        *(() if primitives else moving),
        node(
            'robots_controller',
            'lua_program_node',
            program=program,
            frames_file=frames,
            autostart=autostart,
            launch=launch,
            debug_port=debug_port,
            debug_token=debug_token,
            payload=list(payload),
            fail_safe=fail_safe,
            **expected,
            **({'driver': driver} if primitives else {}),
            **watched,
            **names,
        ),
        node('robots_core', 'direct_kinematics_node', rate=min(POSE_RATE, rate)),
        node('robots_core', 'robot_state_node'),
        *([] if headless else [node('robots_core', 'visualizer_node', port=port, scene=scene)]),
        *([node('robots_core', 'inverse_kinematics_node', method=guided)] if guided else []),
        *([node('robots_controller', 'guide_player_node', **played)] if references else []),
        *([node('robots_core', 'motion_cueing_node', cabin=cabin)] if cabin else []),
        *(
            [
                node('robots_controller', name, contact=contact)
                for name in ('wheel_soil_node', 'force_control_node')
            ]
            if contact
            else []
        ),
        *([node('robots_core', 'collision_node', scene=scene)] if scene else []),
        *([node('robots_controller', 'plc_node', script=io, **plc_cycle)] if io else []),
        *([bridge] if io_map else []),
        *([_pendant(robot, program, port, scene, page)] if pendant else []),
        *([_opcua(robot, program, opcua, opcua_access)] if opcua else []),
    )


def _check_for_primitives(**options: object) -> None:
    """Refuse what planner and controller of the suite would do, by the options' names."""
    for name, value in options.items():
        if value:
            raise OptionError(
                f'a driver of motion primitives (--driver) excludes --{name.replace("_", "-")}: the '
                "robot's own controller plans and moves, without planning_node and controller_node"
            )


def _source_of_emergency_stop(cell_io: CellIo) -> str:
    """The node that publishes the inputs of the emergency stop; '' without such inputs."""
    if not cell_io.emergency_stop:
        return ''
    by_script = any(channel.image == 'digital_inputs' for channel in cell_io.script.inputs)
    return 'plc_node' if by_script else 'io_bridge_node'


def _pendant(robot: str, program: str, port: int, scene: str, page: dict[str, str]) -> NodeDescription:
    # In a process of its own: there is one web application in a process, and others must not wait for it.
    parameters = {'robot_model': robot, 'port': port and port + PAGE_PORTS, 'scene': scene}
    return NodeDescription('robots_controller', 'pendant_node', parameters | page | _folder_of(program))


def _opcua(robot: str, program: str, port: int, access: str) -> NodeDescription:
    # In a process of its own: making the address space takes seconds, and others must not wait for it.
    if access:
        read_server_settings(access)
    parameters = {'robot_model': robot, 'port': port, 'access': access}
    return NodeDescription('robots_controller', 'opcua_node', parameters | _folder_of(program))


def _folder_of(program: str) -> dict[str, str]:
    return {'programs': str(Path(program).parent)} if program else {}
