"""Generated programs, simulated and in lock-step; `generated/run_seeds.py` runs many more."""

from pathlib import Path

import pytest

from .both_cells import check_both_cells
from .generated.program_generator import STARTS, generate
from .generated.run_laws import broken_laws, simulated
from .lockstep_runs import COMPARED_RATE, LockstepRuns

# About a second each on one core; together they use every robot, and end in both ways.
SEEDS = range(24)
# With all levels of drives, a PLC, an interrupt, blends, outputs on paths, and one that fails.
IN_LOCKSTEP = {3: 'ideal', 6: 'second_order', 14: 'rigid_body', 17: 'second_order'}


@pytest.mark.parametrize('seed', SEEDS)
def test_a_generated_program_keeps_its_places_limits_and_verdict(seed: int, tmp_path: Path) -> None:
    program = generate(seed)
    run, report = simulated(program, tmp_path)
    assert broken_laws(program, run, report) == []


@pytest.mark.parametrize(('seed', 'drive'), IN_LOCKSTEP.items())
def test_both_cells_do_the_same(seed: int, drive: str, lockstep_runs: LockstepRuns, tmp_path: Path) -> None:
    program = generate(seed).write(tmp_path)
    lockstep = lockstep_runs.run_file(program, '--drive', drive, rate=COMPARED_RATE)
    check_both_cells(lockstep, drive, tmp_path / 'bag')


def test_programs_follow_from_their_seeds_and_differ() -> None:
    programs = [generate(seed) for seed in SEEDS]
    assert programs == [generate(seed) for seed in SEEDS]
    assert len({program.text for program in programs}) == len(SEEDS)
    assert {program.robot for program in programs} == set(STARTS)
    assert {program.impossible for program in programs} == {False, True}
