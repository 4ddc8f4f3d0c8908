"""Programs to simulate in tests."""

from __future__ import annotations

from pathlib import Path

from robots_controller.simulate import simulate
from robots_controller.simulation.record.events import (
    OutputChanged,
)
from robots_controller.simulation.simulation_run import SimulationRun

PROGRAMS = Path(__file__).parents[2] / 'programs'
ROBOT = 'kuka_kr210_r2700'
PERIOD = 0.004


def run_text(tmp_path: Path, text: str, **options: object) -> SimulationRun:
    program = tmp_path / 'program.lua'
    program.write_text(text)
    wanted: dict[str, object] = {'robot': ROBOT, 'drive': 'ideal', **options}
    return simulate(program, **wanted)  # type: ignore[arg-type]


def outputs(run: SimulationRun) -> list[tuple[float, float]]:
    return [(event.time, event.value) for event in run.events if isinstance(event, OutputChanged)]
