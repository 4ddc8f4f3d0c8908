"""ControllerSixAxes: the robot controller as one block, for physics of your own (paper, section 4.2)."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Self

from numpy.typing import ArrayLike

from robots_controller.control.stops.stop_latch import StopState
from robots_controller.io.io_image import Channel
from robots_controller.io.scripted_plc import ScriptedPlc
from robots_controller.program.joint_feedback import JointFeedback
from robots_controller.program.run_state import RunState
from robots_controller.simulation.cell_parts import CellSetup, cell_parts
from robots_controller.simulation.in_process_cell import InProcessCell
from robots_controller.simulation.record.events import Event
from robots_controller.simulation.simulation_run import SimulatedMotion
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import InvalidInputError, NotNowError, ProgramError
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, finite_vector, positive, read_only
from robots_planning.motion_settings import NOTHING
from robots_planning.pathplanning import COLLISION_MARGIN
from robots_planning.robot_command_state import RobotCommandState


@dataclass(frozen=True, eq=False)
class ControllerStep:
    """What one period of the controller brought.

    Attributes:
        time: Of the references, s since the first step.
        references: Position, velocity and acceleration that the axes should have at the end of the period,
            (3, n), rad (m), s, read-only.
        outputs: Values of the outputs by name ('digital_output.1', and its label where it has one), as they
            are at the start of the period.
        command_state: What the robot is commanded to do.
        run_state: What the program does, or how it has ended.
        error: Why the program has failed; None if it has not.
        stop: The fault that holds the robot, with its reason; with `drives_on` False the axes have to brake,
            and the references follow the measured positions.
        running: The program has not ended, or the controller still moves the robot.
        events: What has happened since the step before: prints, lines, inputs, outputs, states.
    """

    time: float
    references: Array
    outputs: Mapping[str, float]
    command_state: RobotCommandState
    run_state: RunState
    error: ProgramError | None
    stop: StopState
    running: bool
    events: tuple[Event, ...]


class ControllerSixAxes:
    """A robot program with its planner, collision checks, controller and faults, stepped from outside.

    The name is the paper's; the robot has any number of axes. Physics and PLC are the caller's. Each `step`
    is one period, independent of the machine's clock: planning and the program's computing take no time, and
    the same measurements and inputs give the same references to the last bit. `simulate` runs the same cell
    with simulated drives and a scripted PLC. Call it from one thread; `close` it, or use a `with` statement.

    Args:
        robot: The robot, its name, or urdf:/path/to/robot.urdf.
        program: Lua robot program.
        period: Time between two steps, s.
        io: Names of inputs and outputs, values of inputs at the start, fail-safe values of outputs and inputs
            that stop the robot (YAML, see `read_plc_script`; its rules are not played); '' for none.
        scene: As of `simulate`; so are all arguments that follow it, but `io`.

    Raises:
        RobotsError: an unknown robot, a file that is not valid, a program that is not Lua, a number out of
            range.
    """

    def __init__(
        self,
        robot: BaseRobotModel | str,
        *,
        program: Path | str,
        period: float = 0.004,
        scene: Path | str = '',
        io: Path | str = '',
        points_file: Path | str = '',
        frames: Path | str = '',
        goal_tolerance: float | None = None,
        tool_speed_limit: float = 0.0,
        operating_mode: str = OperatingMode.AUTOMATIC,
        payload: tuple[float, ...] = NOTHING,
        collision_margin: float = COLLISION_MARGIN,
    ) -> None:
        setup = CellSetup(
            program=program,
            robot=robot,
            scene=scene,
            io=io,
            rate=1.0 / positive(period, 'period', 's'),
            goal_tolerance=goal_tolerance,
            tool_speed_limit=tool_speed_limit,
            operating_mode=operating_mode,
            payload=payload,
            collision_margin=collision_margin,
            points_file=points_file,
            frames=frames,
        )
        parts = cell_parts(setup)
        self.robot = parts.robot
        self._cell = InProcessCell(parts)
        self._io = self._cell.program.io
        outputs = [channel for channel in self._io.channels if channel.direction == 'output']
        self._outputs: dict[str, float] = dict.fromkeys(
            [name for channel in outputs for name in (channel.name, channel.label) if name], 0.0
        )
        self._cell.log.on_output = self._output_changed
        self._closed = False
        self._cell.begin(ScriptedPlc(parts.cell_io.offline).inputs)

    def step(
        self,
        positions: ArrayLike | None,
        inputs: Mapping[str, float] = MappingProxyType({}),
        *,
        velocities: ArrayLike | None = None,
        torques: ArrayLike | None = None,
    ) -> ControllerStep:
        """One period. The robot stands in the first step; the program starts with the second one.

        Invalid arguments change nothing, and the step can be repeated. Valid positions that cannot be right
        stop the robot as in any cell: see `ControllerStep.stop`.

        Args:
            positions: Measured joint positions at the start of the period, (n,), rad (m); None if nothing was
                measured, which is a fault if it lasts.
            inputs: Values of inputs that the program reads, by their names ('digital_input.1') or labels;
                others keep their values.
            velocities: Measured joint velocities, (n,), rad/s (m/s); None if they are not measured.
            torques: Measured torques at the joints, (n,), N m (N); None if they are not measured.

        Raises:
            InvalidInputError: another shape, NaN or infinity; an input that there is not, or a value that it
                cannot have; no positions in the first step.
            RobotsError: after `close`.
        """
        if self._closed:
            raise NotNowError('the controller is closed; a new run needs a new ControllerSixAxes')
        cell = self._cell
        feedback = self._feedback(positions, velocities, torques)
        changes = [self._change(name, value) for name, value in inputs.items()]
        cell.measure(feedback)
        cell.take_inputs(changes)
        if cell.cycle >= 0:
            cell.work()
        references = cell.step()
        assert references is not None
        events = tuple(cell.log.events)
        cell.log.events.clear()
        return ControllerStep(
            time=cell.clock.elapsed,
            references=read_only(references),
            outputs=MappingProxyType(self._outputs),
            command_state=cell.program.command_state,
            run_state=cell.run_state,
            error=cell.error,
            stop=cell.controller.stops.state,
            running=cell.cycle == 0 or cell.running or cell.log.motions.any_open or not cell.control.holding,
            events=events,
        )

    @property
    def motions(self) -> tuple[SimulatedMotion, ...]:
        """The motions of the program, in the order of their commands, and what became of them."""
        return self._cell.log.motions.all

    def close(self) -> None:
        """End the program, if it still runs."""
        self._closed = True
        self._cell.close()

    def __enter__(self) -> Self:
        """The controller itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()

    def _feedback(
        self, positions: ArrayLike | None, velocities: ArrayLike | None, torques: ArrayLike | None
    ) -> JointFeedback | None:
        measured = {'positions': positions, 'velocities': velocities, 'torques': torques}
        n = self.robot.num_axes
        q, q_dot, tau = (
            None if values is None else read_only(finite_vector(values, n, name))
            for name, values in measured.items()
        )
        if q is not None:
            return JointFeedback(q, q_dot, tau)
        if self._cell.cycle < 0:
            raise InvalidInputError('positions are needed in the first step: the references start from them')
        return None

    def _change(self, name: str, value: float) -> tuple[Channel, float]:
        channel = self._io.find(name)
        if channel.direction == 'output':
            raise InvalidInputError(f'{channel.name} is an output; only inputs can be set')
        return channel, channel.checked(float(finite_vector([value], 1, channel.name)[0]))

    def _output_changed(self, name: str, value: float) -> None:
        # Not in place: earlier steps keep theirs.
        label = self._io.find(name).label
        self._outputs = {**self._outputs, name: value} | ({label: value} if label else {})
