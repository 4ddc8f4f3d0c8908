"""The SimulationRun of what was recorded."""

from pathlib import Path

from robots_controller.simulation.cell_parts import CellParts
from robots_controller.simulation.cost import Cost
from robots_controller.simulation.record.motion_records import MotionRecords
from robots_controller.simulation.record.recording import Recording
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.errors import ProgramError


def simulation_run(
    parts: CellParts,
    recording: Recording,
    records: MotionRecords,
    *,
    state: str,
    error: ProgramError | None,
    interrupted: bool,
    bag: Path | None,
    cost: Cost,
) -> SimulationRun:
    """The run of a cell of these parts; for the other arguments see `SimulationRun`."""
    position, velocity, torque = recording.states
    return SimulationRun(
        program=parts.program,
        robot=parts.robot_name,
        drive=parts.drive,
        scene=parts.scene,
        io=parts.io,
        period=parts.period,
        axes=parts.robot.axes_data.names,
        time=recording.time,
        reference=recording.references,
        position=position,
        velocity=velocity,
        torque=torque,
        motions=records.all,
        events=tuple(recording.events),
        state=state,
        error=error,
        interrupted=interrupted,
        bag=bag,
        cost=cost.seconds,
        processor_time=cost.processor,
    )
