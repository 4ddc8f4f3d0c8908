"""CellParts: the blocks of a cell in one process, set up as the nodes of a live one set them up."""

from dataclasses import dataclass
from pathlib import Path

from robots_controller.cell.contact_setup import ContactSetup, check_one_guide, read_contact
from robots_controller.cell.guide_recording import GuideRecording, read_guide_recording
from robots_controller.control.command_authority import CommandAuthority
from robots_controller.control.controller import Controller
from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.control.speed.frame_speed_limit import FrameSpeedLimit, checked_speed_limit
from robots_controller.control.speed.speed_control import SpeedControl
from robots_controller.control.zones.zone_guard import ZoneGuard
from robots_controller.defaults import RATE
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
from robots_core.robot_choice import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import positive
from robots_planning.motion_settings import NOTHING
from robots_planning.pathplanning import PathPlanning

COLLISION_MARGIN = 0.005  # m; as planning_node


@dataclass(frozen=True, eq=False)
class CellParts:
    """Everything that one run needs but the drives; its blocks have a state and serve one run.

    Attributes:
        program: Path of the program.
        points_file: Taught points; None for the file beside the program.
        frames_file: Tools and bases; None for the file beside the program.
        robot_name: As it was asked for.
        robot: The robot.
        payload: What the robot carries until its program sets another payload.
        controller: The controller.
        planning: The planner, with the check for collisions.
        cell_io: The PLC, and what its files declare.
        emergency_stop: Inputs that stop the robot.
        zone_inputs: Inputs that close the borders of zones.
        scene: Path of the scene, '' for none.
        io: Path of the PLC's script, '' for none.
        references: What guides the robot; None for nothing.
        contact: What its tool touches, and the force control that guides it then; None for nothing.
        orbit: Path of the orbit in which the robot's base floats, '' for none.
        cabin: The cabin that it carries; None for none.
        guided: Inverse kinematics that follows `reference_pose`, one of `METHODS`.
        period: Of the controller, s.
        unguided: The robot stands while the program lets others guide it.
    """

    program: Path
    points_file: Path | None
    frames_file: Path | None
    robot_name: str
    robot: BaseRobotModel
    payload: tuple[float, ...]
    controller: Controller
    planning: PathPlanning
    cell_io: CellIo
    emergency_stop: Stopping
    zone_inputs: Closing
    scene: str
    io: str
    references: GuideRecording | None
    contact: ContactSetup | None
    orbit: str
    cabin: Cabin | None
    guided: str
    period: float
    unguided: bool = False


def cell_parts(
    program: Path | str,
    *,
    robot: BaseRobotModel | str,
    scene: Path | str = '',
    io: Path | str = '',
    io_map: Path | str = '',
    rate: float = RATE,
    goal_tolerance: float | None = None,
    tool_speed_limit: float = 0.0,
    operating_mode: str = OperatingMode.AUTOMATIC,
    payload: tuple[float, ...] = NOTHING,
    collision_margin: float = COLLISION_MARGIN,
    points_file: Path | str = '',
    frames: Path | str = '',
    references: Path | str = '',
    contact: Path | str = '',
    orbit: Path | str = '',
    cabin: Path | str = '',
    guided: str = METHODS[0],
) -> CellParts:
    """The parts of a cell; the arguments are those of `simulate`. The robot may be loaded already.

    Raises:
        RobotsError: an unknown robot or level, a file that is not valid, a number out of range.
    """
    period = 1.0 / positive(rate, 'rate', 'Hz')
    check_one_guide(references or cabin, contact, orbit)
    model = load_robot_model(robot) if isinstance(robot, str) else robot
    cell_io = read_cell_io(io, io_map, orbit=orbit)
    collision = CollisionDetection(model, scene=read_scene(scene) if scene else None)
    zones = collision.scene.zones
    tolerance = {} if goal_tolerance is None else {'goal_tolerance': goal_tolerance}
    authority = CommandAuthority(OperatingMode(operating_mode), hold_timeout=0.0)
    limit = authority.speed_limit(checked_speed_limit(tool_speed_limit))
    settings = ControllerSettings(period=period, **tolerance)
    speed = SpeedControl(
        model.axes_data,
        settings,
        frame_limit=FrameSpeedLimit(model, limit),
        authority=authority,
        zones=ZoneGuard(model, collision.scene) if zones else None,
    )
    return CellParts(
        program=Path(program),
        points_file=Path(points_file) if points_file else None,
        frames_file=Path(frames) if frames else None,
        robot_name=robot if isinstance(robot, str) else model.name,
        robot=model,
        payload=payload,
        controller=Controller(model.axes_data, settings, speed=speed),
        planning=PathPlanning(model, collision=collision, collision_margin=collision_margin),
        cell_io=cell_io,
        emergency_stop=parse_emergency_stop(emergency_stop_texts(cell_io.emergency_stop)),
        zone_inputs=closing_inputs(zones, cell_io.signals),
        scene=str(scene),
        io=str(io),
        references=_recording(references, model, cabin) if references else None,
        contact=read_contact(contact) if contact else None,
        orbit=str(orbit),
        cabin=read_cabin(cabin) if cabin else None,
        guided=guided,
        period=period,
    )


def _recording(path: Path | str, robot: BaseRobotModel, cabin: Path | str) -> GuideRecording:
    return read_guide_recording(path, robot.axes_data.names, base_link=robot.base_link, cabin=bool(cabin))
