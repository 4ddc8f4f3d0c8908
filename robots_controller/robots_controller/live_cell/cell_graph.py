"""The graph of a robot cell: which nodes it has, in one place, for `cell` and for ros2 launch."""

import argparse
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final
from uuid import uuid4

from ament_index_python.packages import PackageNotFoundError, get_package_prefix

from robots_controller.cell.contact_setup import check_one_guide, read_contact
from robots_controller.control.controller_settings import checked_speed_limit
from robots_controller.io.cell_io import CellIo, read_cell_io
from robots_controller.io.fail_safe import fail_safe_texts
from robots_controller.io.stopping_inputs import closing_inputs, closing_texts, emergency_stop_texts
from robots_controller.opcua.server_settings import read_server_settings
from robots_controller.pendant.page_access import read_access
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.blocks.motion_cueing.cabin import read_cabin
from robots_core.cell_interface.driver_file import read_driver
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import InstallationError, OptionError
from robots_core.periodic.watchdog import LONGEST, checked_watchdog

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
    """One node of the cell, which has the name of its executable; nodes of the same process share it."""

    package: str
    executable: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    process: str = ''

    def __post_init__(self) -> None:
        object.__setattr__(self, 'process', self.process or self.executable)

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


def cell_graph(options: argparse.Namespace) -> tuple[NodeDescription, ...]:
    """All nodes of a cell.

    Nodes that are only described have no cell that would start their program: they run it by themselves as
    soon as they can, once within the start of the cell that `launch` names, in which a controller that is
    started again also stays stopped until its reset.

    Args:
        options: Of the command `cell`, with what `complete_options` adds to them.

    Raises:
        RobotsError: options that exclude each other, a file that is not valid, or two files that set inputs
            of the same kind.
    """
    rate, scene, lockstep = options.rate, options.scene, options.lockstep
    primitives = bool(options.driver) and read_driver(options.driver).primitives is not None
    if options.driver and (lockstep or options.orbit):
        raise OptionError('a real robot (driver) excludes lock-step and orbits')
    if primitives:
        _check_for_primitives(options)
    check_one_guide(options.references or options.cabin, options.contact, options.orbit)
    if options.contact:
        read_contact(options.contact)
    if options.cabin:
        read_cabin(options.cabin)
    cell_io = read_cell_io(options.io, options.io_map, orbit=options.orbit)
    if lockstep:
        cell_io.io_map.check_simulated_time()
    if primitives and cell_io.emergency_stop:
        raise OptionError(_EMERGENCY_STOP_OF_PRIMITIVES.format(', '.join(cell_io.emergency_stop)))
    page = {
        'host': read_access(options.host, options.password_file).host,
        'password_file': options.password_file,
        'recordings': str(options.record or 'out'),
        'scene': scene,
    }
    if options.opcua and options.opcua_access:
        read_server_settings(options.opcua_access)
    source = _source_of_emergency_stop(cell_io)
    # In lock-step nobody is missed: a run ends without one of its participants.
    awaited = [] if lockstep else [*(['collision_node'] if scene else []), *([source] if source else [])]
    fail_safe = fail_safe_texts(cell_io.fail_safe) or ['']
    names = {f'{image.removesuffix("s")}_names': list(names) for image, names in cell_io.labels.items()}
    zones = read_scene(scene).zones if scene else ()
    closing = closing_texts(closing_inputs(zones, cell_io.signals)) or ['']
    watched = {'watchdog': checked_watchdog(options.watchdog)}
    programs = str(Path(options.program).parent) if options.program else None

    def node(package: str, executable: str, **parameters: Any) -> NodeDescription:
        """A node; parameters that are None have their defaults."""
        shared = options.composed and executable not in ALONE and (lockstep or executable not in KEEP_TIME)
        given = {'robot_model': options.robot, 'lockstep': lockstep or None, **parameters}
        given = {name: value for name, value in given.items() if value is not None}
        return NodeDescription(package, executable, given, COMPOSED if shared else executable)

    launch, payload = uuid4().hex if options.describe else '', list(options.payload)
    drives = {'rate': rate, 'level': options.drive, 'payload': payload, 'orbit': options.orbit or None}
    controller = node(
        'robots_controller',
        'controller_node',
        rate=rate,
        launch=launch,
        goal_tolerance=options.goal_tolerance,
        tool_speed_limit=checked_speed_limit(options.tool_speed_limit) if options.tool_speed_limit else None,
        operating_mode=OperatingMode(options.operating_mode).value,
        # The run button is not needed while time stands still.
        hold_timeout=0.0 if lockstep else None,
        emergency_stop_inputs=emergency_stop_texts(cell_io.emergency_stop) or [''],
        emergency_stop_source=source,
        expected_nodes=awaited or None,
        scene=scene if zones else None,
        zone_inputs=closing if zones else None,
        # In lock-step the controller is that of a simulation.
        feedback_timeout=None if lockstep else options.watchdog or LONGEST,
        **watched,
    )
    program_node = node(
        'robots_controller',
        'lua_program_node',
        program=options.program,
        frames_file=options.frames,
        autostart=options.describe and bool(options.program),
        launch=launch,
        debug_port=options.debug_port,
        debug_token=options.debug_token,
        payload=payload,
        fail_safe=fail_safe,
        expected_nodes=awaited or None,
        driver=options.driver if primitives else None,
        **watched,
        **names,
    )
    page_port = options.port and options.port + PAGE_PORTS
    own, core = 'robots_controller', 'robots_core'
    display = {'lockstep': None}  # takes no part, and never holds up a run
    nodes = (
        (not options.driver, node(core, 'drive_node', **drives, **watched)),
        (
            options.driver and not primitives,
            node(core, 'hardware_node', rate=rate, driver=options.driver, **watched),
        ),
        (not primitives, controller),
        (not primitives, node('robots_planning', 'planning_node', scene=scene, payload=payload, **watched)),
        (True, program_node),
        (True, node(core, 'direct_kinematics_node', rate=min(POSE_RATE, rate))),
        (True, node(core, 'robot_state_node', **display)),
        (not options.headless, node(core, 'visualizer_node', port=options.port, scene=scene, **display)),
        (options.guided, node(core, 'inverse_kinematics_node', method=options.guided)),
        (
            options.references,
            node(own, 'guide_player_node', references=options.references, cabin=options.cabin),
        ),
        (options.cabin, node(core, 'motion_cueing_node', cabin=options.cabin)),
        (options.contact, node(own, 'wheel_soil_node', contact=options.contact)),
        (options.contact, node(own, 'force_control_node', contact=options.contact)),
        (scene, node(core, 'collision_node', scene=scene)),
        (
            options.io,
            node(own, 'plc_node', script=options.io, cycle=1.0 / rate if lockstep else None),
        ),
        (options.io_map, node(own, 'io_bridge_node', io_map=options.io_map, fail_safe=fail_safe, **watched)),
        (options.pendant, node(own, 'pendant_node', port=page_port, programs=programs, **page)),
        (
            options.opcua,
            node(own, 'opcua_node', port=options.opcua, access=options.opcua_access, programs=programs),
        ),
    )
    return tuple(one for wanted, one in nodes if wanted)


def _check_for_primitives(options: argparse.Namespace) -> None:
    """Refuse what planner and controller of the suite would do."""
    given = {
        'scene': options.scene,
        'guided': options.guided,
        'view': options.pendant,
        'operating-mode': options.operating_mode != OperatingMode.AUTOMATIC,
        'tool-speed-limit': options.tool_speed_limit,
        'goal-tolerance': options.goal_tolerance,
    }
    for name, value in given.items():
        if value:
            raise OptionError(
                f'a driver of motion primitives (--driver) excludes --{name}: the '
                "robot's own controller plans and moves, without planning_node and controller_node"
            )


def _source_of_emergency_stop(cell_io: CellIo) -> str:
    """The node that publishes the inputs of the emergency stop; '' without such inputs."""
    if not cell_io.emergency_stop:
        return ''
    by_script = any(channel.image == 'digital_inputs' for channel in cell_io.script.inputs)
    return 'plc_node' if by_script else 'io_bridge_node'
