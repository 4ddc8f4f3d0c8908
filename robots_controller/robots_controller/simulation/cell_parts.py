"""CellParts: the blocks of a cell in one process, set up as the nodes of a live one set them up."""

from dataclasses import dataclass
from pathlib import Path

from robots_controller.cell.contact_setup import ContactSetup, check_one_guide, read_contact
from robots_controller.cell.guide_recording import GuideRecording, read_guide_recording
from robots_controller.control.command_authority import CommandAuthority
from robots_controller.control.controller import Controller
from robots_controller.control.controller_settings import ControllerSettings, checked_speed_limit
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.zones.zone_guard import ZoneGuard
from robots_controller.io.cell_io import CellIo, read_cell_io
from robots_controller.io.stopping_inputs import (
    Closing,
    Stopping,
    closing_inputs,
    emergency_stop_texts,
    parse_emergency_stop,
)
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.blocks.following.following_methods import METHODS
from robots_core.blocks.motion_cueing.cabin import Cabin, read_cabin
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.defaults import RATE
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import positive
from robots_planning.motion_settings import NOTHING
from robots_planning.pathplanning import COLLISION_MARGIN, PathPlanning


@dataclass(frozen=True, kw_only=True)
class CellSetup:
    """A cell in one process as its user describes it; `simulate` explains each attribute.

    The robot may be loaded already.
    """

    program: Path | str
    robot: BaseRobotModel | str
    scene: Path | str = ''
    io: Path | str = ''
    io_map: Path | str = ''
    rate: float = RATE
    goal_tolerance: float | None = None
    tool_speed_limit: float = 0.0
    operating_mode: str = OperatingMode.AUTOMATIC
    payload: tuple[float, ...] = NOTHING
    collision_margin: float = COLLISION_MARGIN
    points_file: Path | str = ''
    frames: Path | str = ''
    references: Path | str = ''
    contact: Path | str = ''
    orbit: Path | str = ''
    cabin: Path | str = ''
    guided: str = METHODS[0]


@dataclass(frozen=True, eq=False)
class CellParts:
    """Everything that one run needs but the drives; its blocks have a state and serve one run.

    Attributes:
        setup: What they were made of.
        period: Of the controller, s.
        walked: As `walk_program` runs it: no guard stops the robot, which stands while others may guide it.
    """

    setup: CellSetup
    robot: BaseRobotModel
    controller: Controller
    planning: PathPlanning
    cell_io: CellIo
    emergency_stop: Stopping
    zone_inputs: Closing
    references: GuideRecording | None
    contact: ContactSetup | None
    cabin: Cabin | None
    period: float
    walked: bool = False

    @property
    def robot_name(self) -> str:
        """The robot as it was asked for."""
        return self.setup.robot if isinstance(self.setup.robot, str) else self.robot.name


def cell_parts(setup: CellSetup) -> CellParts:
    """The parts of a cell.

    Raises:
        RobotsError: an unknown robot or level, a file that is not valid, a number out of range.
    """
    period = 1.0 / positive(setup.rate, 'rate', 'Hz')
    check_one_guide(setup.references or setup.cabin, setup.contact, setup.orbit)
    robot = load_robot_model(setup.robot) if isinstance(setup.robot, str) else setup.robot
    cell_io = read_cell_io(setup.io, setup.io_map, orbit=setup.orbit)
    collision = CollisionDetection(robot, scene=read_scene(setup.scene) if setup.scene else None)
    zones = collision.scene.zones
    tolerance = {} if setup.goal_tolerance is None else {'goal_tolerance': setup.goal_tolerance}
    authority = CommandAuthority(OperatingMode(setup.operating_mode), hold_timeout=0.0)
    limit = authority.speed_limit(checked_speed_limit(setup.tool_speed_limit))
    settings = ControllerSettings(period=period, **tolerance)
    speed = SpeedControl(
        robot.axes_data,
        settings,
        frame_limit=FrameSpeedLimit(robot, limit),
        authority=authority,
        zones=ZoneGuard(robot, collision.scene) if zones else None,
    )
    return CellParts(
        setup=setup,
        robot=robot,
        controller=Controller(robot.axes_data, settings, speed=speed),
        planning=PathPlanning(robot, collision=collision, collision_margin=setup.collision_margin),
        cell_io=cell_io,
        emergency_stop=parse_emergency_stop(emergency_stop_texts(cell_io.emergency_stop)),
        zone_inputs=closing_inputs(zones, cell_io.signals),
        references=_recording(setup, robot) if setup.references else None,
        contact=read_contact(setup.contact) if setup.contact else None,
        cabin=read_cabin(setup.cabin) if setup.cabin else None,
        period=period,
    )


def _recording(setup: CellSetup, robot: BaseRobotModel) -> GuideRecording:
    names, base_link = robot.axes_data.names, robot.base_link
    return read_guide_recording(setup.references, names, base_link=base_link, cabin=bool(setup.cabin))
