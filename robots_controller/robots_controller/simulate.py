"""simulate: run a robot program in a simulated cell, faster than real time."""

import math
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from robots_controller.defaults import LONGEST_TIME
from robots_controller.simulation.cell_parts import CellSetup, cell_parts
from robots_controller.simulation.simulated_cell import SimulatedCell
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.blocks.following.following_methods import METHODS
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.defaults import RATE
from robots_core.errors import InvalidInputError
from robots_core.validation import positive
from robots_planning.motion_settings import NOTHING
from robots_planning.pathplanning import COLLISION_MARGIN


def simulate(
    program: Path | str,
    *,
    robot: str,
    drive: str = 'second_order',
    scene: Path | str = '',
    io: Path | str = '',
    io_map: Path | str = '',
    bag: Path | str | None = None,
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
    longest: float = LONGEST_TIME,
    patience: float = math.inf,
    on_progress: Callable[[float, int], None] | None = None,
) -> SimulationRun:
    """Run a program in a simulated cell from the robot's home position.

    It has the same blocks as a live cell: Lua program, planner with its check for collisions, controller,
    drives and scripted PLC. Nothing depends on the machine's clock: two runs are the same to the last bit,
    except for the time that they take. Ctrl-C in the main thread ends the run early; it returns what was
    recorded so far.

    Args:
        program: Lua robot program.
        robot: The robot's name, or urdf:/path/to/robot.urdf.
        drive: How much of a machine the drives are: `ideal`, `second_order` or `rigid_body`.
        scene: What the robot keeps clear of (YAML, see `read_scene`); '' for nothing but itself.
        io: Script of the PLC that the program works with (YAML, see `read_plc_script`); '' for none.
        io_map: Map of inputs and outputs to topics of a PLC (YAML, see `read_io_map`); '' for none. Channels
            have its names; its inputs keep their fail-safe values, as those topics have no publisher.
        bag: Folder to write a bag to, with the topics of a live recording; must not exist.
        rate: References per second, Hz.
        goal_tolerance: Largest error of an axis that has reached its target, rad (m); the controller's own by
            default.
        tool_speed_limit: Highest speed of the tool and of the frames of all axes, m/s; 0 for none.
        operating_mode: One of `OperatingMode`; in T1 and T2 run is held all the time.
        payload: What the robot carries until its program sets another payload, see `MotionSettings`.
        collision_margin: Distance that motions keep, m.
        points_file: Taught points; '' for the file beside the program.
        frames: Tools and bases (YAML, see `read_frames`); '' for frames.yaml beside the program.
        references: Bag of what guides the robot where the program lets others guide it, see
            `read_guide_recording`; '' for nothing.
        contact: What the robot's tool touches, and force control that guides it there (YAML, see
            `read_contact`), in the place of a recording; '' for nothing.
        orbit: Orbit in which the robot's base floats, and what it is to grasp there (YAML, see `read_orbit`);
            '' for a robot that stands.
        cabin: Cabin that the robot carries (YAML, see `read_cabin`): the recording then holds its driver's
            inputs, or the motion of a vehicle; '' for none.
        guided: Inverse kinematics that follows its `reference_pose`, one of `METHODS`.
        longest: The program fails if it has not ended after this simulated time, s.
        patience: It fails, too, if that has taken more of this machine's time, s; names the line.
        on_progress: Called about 25 times a simulated second with the time in s and the line of the program.

    Returns:
        The recorded run, also of a program that fails; see `SimulationRun.error`.

    Raises:
        RobotsError: an unknown robot, a file that is not valid, a program that is not Lua, a bag that exists
            or cannot be written: a full disk; it keeps what was recorded until then.
    """
    positive(longest, 'longest', 's')
    if not patience > 0.0:
        raise InvalidInputError(f'patience = {patience!r} s must be above 0')
    setup = CellSetup(
        program=program,
        robot=robot,
        scene=scene,
        io=io,
        io_map=io_map,
        rate=rate,
        goal_tolerance=goal_tolerance,
        tool_speed_limit=tool_speed_limit,
        operating_mode=operating_mode,
        payload=payload,
        collision_margin=collision_margin,
        points_file=points_file,
        frames=frames,
        references=references,
        contact=contact,
        orbit=orbit,
        cabin=cabin,
        guided=guided,
    )
    cell = SimulatedCell(
        cell_parts(setup),
        drive=drive,
        bag=None if bag is None else Path(bag),
        longest=longest,
        patience=patience,
        on_progress=on_progress,
    )
    with _stopped_by_interrupt(cell):
        return cell.run()


@contextmanager
def _stopped_by_interrupt(cell: SimulatedCell) -> Iterator[None]:
    """Ctrl-C stops the cell between two periods, and not in the middle of writing a bag."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(_signal: int, _frame: FrameType | None) -> None:
        cell.stop()

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
