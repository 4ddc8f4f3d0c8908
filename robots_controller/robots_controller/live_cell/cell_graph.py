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
ALONE: Final = ('pendant_node', 'opcua_node')
"""Nodes that share no process: one has a web application, of which a process can have one, the other makes
its address space for seconds."""
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
    primitives = bool(driver) and read_driver(driver).primitives is not None
    if driver and (lockstep or orbit):
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
    if guided and guided not in METHODS:
        raise OptionError(f'unknown inverse kinematics {guided!r}; valid are {", ".join(METHODS)}')
    cell_io = read_cell_io(io, io_map, orbit=orbit)
    if lockstep:
        cell_io.io_map.check_simulated_time()
    if primitives and cell_io.emergency_stop:
        raise OptionError(_EMERGENCY_STOP_OF_PRIMITIVES.format(', '.join(cell_io.emergency_stop)))
    access = read_access(host, password_file)
    if opcua and opcua_access:
        read_server_settings(opcua_access)
    source = _source_of_emergency_stop(cell_io)
    # In lock-step nobody is missed: a run ends without one of its participants.
    awaited = [] if lockstep else [*(['collision_node'] if scene else []), *([source] if source else [])]
    fail_safe = fail_safe_texts(cell_io.fail_safe) or ['']
    names = {f'{image.removesuffix("s")}_names': list(names) for image, names in cell_io.labels.items()}
    zones = read_scene(scene).zones if scene else ()
    closing = closing_texts(closing_inputs(zones, cell_io.signals)) or ['']
    watched = {'watchdog': checked_watchdog(watchdog)}
    programs = str(Path(program).parent) if program else None

    def node(package: str, executable: str, **parameters: Any) -> NodeDescription:
        """A node; parameters that are None have their defaults."""
        shared = composed and executable not in ALONE and (lockstep or executable not in KEEP_TIME)
        given = {'robot_model': robot, 'lockstep': lockstep or None, **parameters}
        given = {name: value for name, value in given.items() if value is not None}
        return NodeDescription(package, executable, given, COMPOSED if shared else executable)

    drives = {'rate': rate, 'level': drive, 'payload': list(payload), 'orbit': orbit or None}
    controller = node(
        'robots_controller',
        'controller_node',
        rate=rate,
        launch=launch,
        goal_tolerance=goal_tolerance,
        tool_speed_limit=checked_speed_limit(tool_speed_limit) if tool_speed_limit else None,
        operating_mode=OperatingMode(operating_mode).value,
        # The run button is not needed while time stands still.
        hold_timeout=0.0 if lockstep else None,
        emergency_stop_inputs=emergency_stop_texts(cell_io.emergency_stop) or [''],
        emergency_stop_source=source,
        expected_nodes=awaited or None,
        scene=scene if zones else None,
        zone_inputs=closing if zones else None,
        # In lock-step the controller is that of a simulation.
        feedback_timeout=None if lockstep else watchdog or LONGEST,
        **watched,
    )
    program_node = node(
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
        expected_nodes=awaited or None,
        driver=driver if primitives else None,
        **watched,
        **names,
    )
    page = {'host': access.host, 'password_file': password_file, 'recordings': str(record or 'out')}
    page_port = port and port + PAGE_PORTS
    own, core = 'robots_controller', 'robots_core'
    nodes = (
        (not driver, node(core, 'drive_node', **drives, **watched)),
        (driver and not primitives, node(core, 'hardware_node', rate=rate, driver=driver, **watched)),
        (not primitives, controller),
        (
            not primitives,
            node('robots_planning', 'planning_node', scene=scene, payload=list(payload), **watched),
        ),
        (True, program_node),
        (True, node(core, 'direct_kinematics_node', rate=min(POSE_RATE, rate))),
        (True, node(core, 'robot_state_node')),
        (not headless, node(core, 'visualizer_node', port=port, scene=scene)),
        (guided, node(core, 'inverse_kinematics_node', method=guided)),
        (references, node(own, 'guide_player_node', references=references, cabin=cabin)),
        (cabin, node(core, 'motion_cueing_node', cabin=cabin)),
        (contact, node(own, 'wheel_soil_node', contact=contact)),
        (contact, node(own, 'force_control_node', contact=contact)),
        (scene, node(core, 'collision_node', scene=scene)),
        (io, node(own, 'plc_node', script=io, cycle=1.0 / rate if lockstep else None)),
        (io_map, node(own, 'io_bridge_node', io_map=io_map, fail_safe=fail_safe, **watched)),
        (pendant, node(own, 'pendant_node', port=page_port, scene=scene, programs=programs, **page)),
        (opcua, node(own, 'opcua_node', port=opcua, access=opcua_access, programs=programs)),
    )
    return tuple(one for wanted, one in nodes if wanted)


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
