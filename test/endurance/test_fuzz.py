"""make fuzz: its steps, its time, its counts, and what it says of failures."""

from __future__ import annotations

import random
import re
import time
from collections import Counter
from itertools import islice
from pathlib import Path

import pytest

from counted_cases import FILE, count_cases, counted_cases
from fuzz import DAMAGED, TESTS, Fuzz, Step, has_finding, result_table, steps

NODES = ['drive_node', 'planning_node', 'io_bridge_node']
KINDS = {'messages', 'damaged files', 'Lua', 'generated programs'}
SOON = 300.0  # s
SUPPORT = Path(__file__).parents[1] / 'support'


def fuzz(folder: Path, seconds: float = SOON) -> Fuzz:
    return Fuzz(time.monotonic() + seconds, folder)


def test_the_steps_follow_from_a_seed_and_come_to_every_kind_and_node() -> None:
    found, again = (list(islice(steps(random.Random(1), NODES), 15)) for _ in range(2))  # noqa: S311
    assert found == again
    assert {step.kind for step in found} == KINDS
    sent = [step.command[-1] for step in found if step.kind == 'messages']
    assert {text.partition('[')[2] for text in sent} == {f'{node}]' for node in NODES}
    for step in found:
        for argument in step.command:
            file, _, test = argument.partition('::')
            if file.startswith('/'):
                assert f'def {test.partition("[")[0]}' in Path(file).read_text()


def test_every_kind_of_damaged_file_has_its_turn() -> None:
    tests = (TESTS / 'property' / 'test_damaged_files.py').read_text()
    assert set(DAMAGED) == set(re.findall(r'def test_damaged_(\w+)', tests))


def test_cases_are_counted_from_any_process(tmp_path: Path) -> None:
    one = fuzz(tmp_path)
    for number in (3, 4):
        code = f'from counted_cases import count_cases; count_cases("Lua", {number})'
        one.run(Step('Lua', ('-c', code), {'PYTHONPATH': str(SUPPORT)}))
    assert [row.cells for row in one.table().rows] == [('Lua', '7', '2', '0'), ('all', '7', '2', '0')]


def test_nothing_is_counted_where_nobody_asks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(FILE, raising=False)
    count_cases('Lua')
    assert counted_cases(tmp_path / 'none') == Counter()


def test_a_failure_is_printed_with_the_command_that_tries_it_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = fuzz(tmp_path)
    one.run(Step('messages', ('-c', 'raise ValueError("found")'), {'FUZZ_SEED': '5'}))
    assert one.failures == {'messages': 1}
    text = capsys.readouterr().out
    assert 'ValueError: found' in text
    assert 'again: FUZZ_SEED=5 python -c' in text


def test_what_runs_when_the_time_is_over_is_ended_and_no_failure(tmp_path: Path) -> None:
    one = fuzz(tmp_path, seconds=0.0)
    one.run(Step('Lua', ('-c', f'import time; time.sleep({SOON})')))
    assert one.failures['Lua'] == 0
    assert one.processes['Lua'] == 1


def test_what_such_a_step_has_found_counts() -> None:
    assert not has_finding('3 passed\n4 FINISHED, 0 with problems\nKeyboardInterrupt')
    for output in ('1 failed, 2 passed', 'Falsifying example: check(', 'found:\nseed 7 (FAILED): late'):
        assert has_finding(output)


def test_no_step_begins_after_the_time(tmp_path: Path) -> None:
    one = fuzz(tmp_path, seconds=-1.0)
    one.work(iter(()))
    assert not one.processes


def test_the_table_has_the_failures_of_each_kind() -> None:
    table = result_table(Counter(Lua=5, messages=8), Counter(Lua=1), Counter(Lua=2, messages=1))
    assert [row.cells for row in table.rows] == [
        ('Lua', '5', '2', '1'),
        ('messages', '8', '1', '0'),
        ('all', '13', '3', '1'),
    ]
    assert [row.bad for row in table.rows] == [True, False, False]
