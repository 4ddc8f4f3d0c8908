"""Simulations that let periods pass at once leave the same as those that step through each."""

from itertools import cycle
from pathlib import Path

import pytest
from numpy.typing import ArrayLike

from cell_options import simulate_options
from robots_controller.commands.cell_arguments import CELL_OPTIONS
from robots_controller.simulation import simulated_cell
from robots_controller.simulation.cell_parts import CellSetup, cell_parts
from robots_controller.simulation.simulated_cell import LONGEST_SPAN, SimulatedCell
from robots_controller.simulation.simulation_run import SimulationRun
from robots_core.blocks.drives.drive_levels import DRIVE_LEVELS
from robots_core.blocks.drives.drive_train import IdealDrive
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array
from short_programs import PROGRAMS, SHORTEST, short_copy

NAMES = sorted(file.name for file in PROGRAMS.glob('*.lua'))
LANGUAGE = sorted(f'language/{file.name}' for file in (PROGRAMS / 'language').glob('*.lua'))
# Each program once: that all levels of drives have the references of a cell that steps is a law of parity.
RATE = '100'  # Hz, of the references
CASES = list(zip([*NAMES, *LANGUAGE], cycle(DRIVE_LEVELS), strict=False))


def run(program: Path, drive: str, bag: Path, longest_span: int) -> SimulationRun:
    options = simulate_options([str(program), '--drive', drive, '--rate', RATE])
    names = [name for name in CELL_OPTIONS if name != 'drive']
    parts = cell_parts(CellSetup(program=program, **{name: getattr(options, name) for name in names}))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulated_cell, 'LONGEST_SPAN', longest_span)
        return SimulatedCell(parts, drive=drive, bag=bag, longest=options.longest).run()


def motions(run: SimulationRun) -> list[str]:
    return [f'{one.id} {one.commanded} {one.started} {one.ended} {one.message}' for one in run.motions]


def check_alike(program: Path, drive: str, folder: Path) -> SimulationRun:
    """Run with and without spans, and compare; returns the run with them."""
    bags = folder / 'with' / 'bag', folder / 'without' / 'bag'
    found, expected = (
        run(program, drive, bag, span) for bag, span in zip(bags, (LONGEST_SPAN, 0), strict=True)
    )
    for name in ('time', 'reference', 'position', 'velocity', 'torque'):
        values, others = getattr(found, name), getattr(expected, name)
        assert (values is None) == (others is None)
        assert values is None or values.tobytes() == others.tobytes(), name
    assert found.events == expected.events
    assert (found.state, str(found.error)) == (expected.state, str(expected.error))
    assert motions(found) == motions(expected)
    files = [{file.name: file.read_bytes() for file in bag.iterdir()} for bag in bags]
    assert files[0] == files[1]
    return found


@pytest.mark.parametrize(('name', 'drive'), CASES)
def test_programs_leave_the_same_with_and_without_spans(name: str, drive: str, tmp_path: Path) -> None:
    check_alike(short_copy(tmp_path / 'programs', name, SHORTEST), drive, tmp_path)


@pytest.mark.parametrize(('share', 'reason'), [(0.0, 'has not changed'), (0.005, 'behind its reference')])
def test_drives_that_do_not_follow_stop_the_robot_in_the_same_period(
    share: float, reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class SlowDrive(IdealDrive):
        """Follows by a share of the way that is left in each period."""

        def step(self, q_ref: ArrayLike, q_dot_ref: ArrayLike | None = None) -> tuple[Array, Array]:
            return super().step(self.position + share * (q_ref - self.position), q_dot_ref)

    def drives(_level: str, _robot: BaseRobotModel, q: Array, *, period: float, **_: object) -> SlowDrive:
        return SlowDrive(q, period=period)

    monkeypatch.setattr(simulated_cell, 'drive_train', drives)
    program = tmp_path / 'program.lua'
    program.write_text('-- Robot: kuka_kr210_r2700\nptpJointSpaceAngles(60, -60, 60, 30, 60, 90)\n')
    found = check_alike(program, 'ideal', tmp_path)
    assert reason in str(found.error)


def test_a_program_that_changes_the_speed_on_the_way_leaves_the_same(tmp_path: Path) -> None:
    program = tmp_path / 'program.lua'
    program.write_text(
        '-- Robot: kuka_kr210_r2700\n'
        'ptpJointSpaceAngles(60, -60, 60, 30, 60, 90, {blend = 20})\n'
        'wait(0.5)\n'
        'setOverride(0.4)\n'
        'ptpJointSpaceAngles(0, -90, 90, 0, 60, 0)\n'
    )
    check_alike(program, 'second_order', tmp_path)
