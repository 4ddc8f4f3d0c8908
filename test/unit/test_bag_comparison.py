"""Recorded bags against expected ones."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from robots_controller.commands.command_table import CHECK_BAG
from robots_controller.recording.bag_comparison import Comparison, compare_bags
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_tolerances import BagTolerances, TopicTolerance, read_tolerances
from robots_controller.testing import assert_bag_matches
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.exit_codes import ExitCode
from written_bags import BAG_START, BAG_TYPES, write_bag, write_plant_bag

SECOND = 1_000_000_000
ANOTHER_DAY = BAG_START + 987_654_321_012  # ns


T = BAG_TYPES.types


def number(value: float) -> Any:
    return T['std_msgs/msg/Float64'](value)


def text(value: str) -> Any:
    return T['std_msgs/msg/String'](value)


def switch(value: bool) -> Any:  # noqa: FBT001
    return T['std_msgs/msg/Bool'](value)


Rows = Iterable[tuple[float, str, Any]]


def joints(*position: float, stamp: float = 0.0) -> Any:
    time = T['builtin_interfaces/msg/Time'](*divmod(BAG_START + round(stamp * SECOND), SECOND))
    header = T['std_msgs/msg/Header'](time, 'base')
    empty = np.array([])
    return T['sensor_msgs/msg/JointState'](header, ['a', 'b'], np.array(position), empty, empty)


def status(**values: str) -> Any:
    pairs = [T['diagnostic_msgs/msg/KeyValue'](key, value) for key, value in values.items()]
    return T['diagnostic_msgs/msg/DiagnosticStatus'](0, 'motion', 'reached', '', pairs)


@pytest.fixture
def compare(tmp_path: Path) -> Any:
    def run(
        recorded: Rows, expected: Rows, tolerances: str = '', *, latched: Iterable[str] = ()
    ) -> Comparison:
        # Recorded on another day: only the time since the beginning counts.
        folder = tmp_path / str(len(list(tmp_path.iterdir())))
        folder.mkdir()
        bags = [
            read_bag(write_bag(folder / name, rows, latched=latched, start=start))
            for name, rows, start in (
                ('r', recorded, ANOTHER_DAY),
                ('e', expected, BAG_START),
            )
        ]
        (folder / 't.yaml').write_text(tolerances or 'default: {}\n')
        return compare_bags(bags[0], bags[1], read_tolerances(folder / 't.yaml'))

    return run


RISE = [(0.0, '/a', number(0.0)), (0.5, '/a', number(1.0)), (1.0, '/a', number(2.0))]


def test_the_same_messages_of_another_day_agree(compare: Any):
    comparison = compare(RISE, RISE)
    assert comparison.ok
    assert comparison.describe() == '1 topics with 3 messages agree'


def test_a_difference_names_topic_time_field_and_both_values(compare: Any):
    changed = [*RISE[:1], (0.5, '/a', number(1.25)), RISE[2]]
    (difference,) = [result.difference for result in compare(changed, RISE).topics]
    assert str(difference) == '/a at 0.5000 s, data: expected 1.0, recorded 1.25'
    assert compare(changed, RISE, 'topics: {/a: {absolute: 0.25}}').ok
    assert compare(changed, RISE, 'topics: {a: {relative: 0.25}}').ok
    assert not compare(changed, RISE, 'topics: {a: {absolute: 0.24}, b: {absolute: 1}}').ok


def test_the_first_difference_is_the_earliest_of_all_topics(compare: Any):
    expected = [*RISE, (0.2, '/b', number(0.0)), (0.3, '/b', number(0.0))]
    recorded = [*RISE[:2], (1.0, '/a', number(7.0)), (0.2, '/b', number(0.0)), (0.3, '/b', number(1.0))]
    comparison = compare(recorded, expected)
    assert comparison.first.topic == '/b'
    assert comparison.describe().splitlines() == [
        'first difference: /b at 0.3000 s, data: expected 0.0, recorded 1.0',
        'also: /a at 1.0000 s, data: expected 2.0, recorded 7.0',
        '0 of 2 topics agree',
    ]


@pytest.mark.parametrize(
    ('recorded', 'message'),
    [
        (RISE[:2], '/a at 1.0000 s: expected 3 messages, recorded 2'),
        ([*RISE, (1.5, '/a', number(3.0))], '/a at 1.5000 s: expected 3 messages, recorded 4'),
        (
            [*RISE[:2], (1.2, '/a', number(2.0))],
            '/a at 1.0000 s: expected a message within 0.1 s, recorded one 0.2000 s late',
        ),
        ([*RISE[:2], (0.8, '/a', number(2.0))], 'recorded one 0.2000 s early'),
        ([(0.0, '/b', number(0.0))], '/a at 0.0000 s: expected this topic, recorded none'),
        ([(0.0, '/a', switch(True))], 'expected std_msgs/msg/Float64, recorded std_msgs/msg/Bool'),
        ([*RISE[:2], (1.0, '/a', number(float('nan')))], 'data: expected 2.0, recorded nan'),
    ],
)
def test_messages_that_are_missing_too_much_late_or_of_another_type(
    compare: Any, recorded: Rows, message: str
):
    comparison = compare(recorded, RISE)
    assert message in str(comparison.first)


def test_not_a_number_agrees_with_itself(compare: Any):
    rows = [(0.0, '/a', number(float('nan')))]
    assert compare(rows, rows).ok


def test_fields_have_tolerances_of_their_own(compare: Any):
    expected, recorded = (
        [(0.0, '/j', joints(1.0, 2.0))],
        [(0.0, '/j', joints(1.0, 2.01, stamp=987.654321012))],
    )
    assert (
        str(compare(recorded, expected).first) == '/j at 0.0000 s, position[1]: expected 2.0, recorded 2.01'
    )
    assert not compare(recorded, expected, 'topics: {/j: {fields: {"position[0]": 1}}}').ok
    assert compare(recorded, expected, 'topics: {/j: {fields: {"position[*]": 0.02}}}').ok
    assert compare(recorded, expected, 'topics: {/j: {fields: {position: ignore}}}').ok
    assert not compare(
        recorded, expected, 'default: {fields: {position: 1}}\ntopics: {/j: {fields: {"position[1]": 0}}}'
    ).ok


def test_stamps_count_from_time_zero(compare: Any):
    expected = [(0.0, '/j', joints(0.0, 0.0, stamp=0.25))]
    same = [(0.0, '/j', joints(0.0, 0.0, stamp=987.654321012 + 0.25))]
    assert compare(same, expected).ok
    other = [(0.0, '/j', joints(0.0, 0.0, stamp=987.654321012 + 0.75))]
    assert compare(other, expected).first.field == 'header.stamp'


def test_key_value_pairs_are_compared_by_key(compare: Any):
    expected = [(0.0, '/m', status(id='1.5', line='3'))]
    recorded = [(0.0, '/m', status(line='4', id='99.0'))]
    ignored = 'topics: {/m: {fields: {values.id: ignore}}}'
    assert (
        str(compare(recorded, expected, ignored).first)
        == "/m at 0.0000 s, values.line: expected '3', recorded '4'"
    )
    assert compare(recorded, expected, 'topics: {/m: {fields: {values: ignore}}}').ok


def test_state_is_primed_and_repetitions_do_not_count(compare: Any):
    moving = [(1.0, '/a', number(0.0)), (2.0, '/a', number(0.0))]
    expected = [(0.0, '/s', text('x')), (0.5, '/s', text('idle')), (1.5, '/s', text('run')), *moving]
    recorded = [(0.9, '/s', text('idle')), (1.52, '/s', text('run')), (1.8, '/s', text('run')), *moving]
    assert compare(recorded, expected, latched=['/s']).ok
    # Who was started a moment late says its state after time zero.
    late = [(1.05, '/s', text('idle')), *recorded[1:]]
    assert compare(late, expected, latched=['/s']).ok
    wrong = [(0.9, '/s', text('x')), *recorded[1:]]
    assert "expected 'idle', recorded 'x'" in str(compare(wrong, expected, latched=['/s']).first)
    assert not compare(recorded, expected, 'topics: {/s: {mode: sequence}}', latched=['/s']).ok


def test_streams_are_compared_sample_by_sample(compare: Any):
    def ramp(offset: float, rate: float) -> Rows:
        times = np.arange(0.0, 1.0, 1.0 / rate)
        return [(t, '/a', number(float(t + offset))) for t in times]

    tolerance = 'topics: {/a: {mode: samples, time: 0.02, absolute: 0.03}}'
    assert compare(ramp(0.0, 97.0), ramp(0.0, 50.0), tolerance).ok
    assert not compare(ramp(0.1, 97.0), ramp(0.0, 50.0), tolerance).ok
    gap = [row for row in ramp(0.0, 97.0) if not 0.4 < row[0] < 0.6]
    assert 'expected a message within 0.02 s, recorded none' in str(
        compare(gap, ramp(0.0, 50.0), tolerance).first
    )


def test_bags_are_aligned_by_a_topic(compare: Any):
    expected = [(0.0, '/noise', number(0.0)), (1.0, '/start', switch(True)), (1.5, '/a', number(1.0))]
    recorded = [(0.0, '/noise', number(0.0)), (3.0, '/start', switch(True)), (3.5, '/a', number(1.0))]
    assert compare(recorded, expected, 'align: /start\nignore: [/noise]').ok
    assert not compare(recorded, expected, 'ignore: /noi*\nalign: noise').ok
    with pytest.raises(RobotsError, match='has no message of /nothing, by which'):
        compare(RISE, RISE, 'align: /nothing')


def test_all_but_the_named_topics_can_be_ignored(compare: Any):
    expected = [*RISE, (0.0, '/b', number(0.0))]
    recorded = [*RISE, (0.0, '/b', number(1.0))]
    comparison = compare(recorded, expected, 'ignore: ["*"]\ntopics: {a: {time: 1}}')
    assert [result.topic for result in comparison.topics] == ['/a']
    assert compare(recorded, expected, 'ignore: [b]').ok
    assert not compare(recorded, expected, 'ignore: ["*"]\ntopics: {b: {time: 1}}').ok
    with pytest.raises(RobotsError, match='has no topic to compare'):
        compare(recorded, expected, 'ignore: ["*"]')


def test_topics_that_are_new_do_not_count_but_are_reported(compare: Any):
    comparison = compare([*RISE, (0.0, '/new', number(0.0))], RISE)
    assert comparison.ok
    assert comparison.unexpected == ('/new',)


@pytest.mark.parametrize(
    ('content', 'line', 'message'),
    [
        ('topics:\n  /a: {absolut: 1}\n', 2, "unknown key 'absolut'; did you mean 'absolute'?"),
        ('topics:\n  /a: {time: -1}\n', 2, 'time is -1'),
        ('topics:\n  /a: {mode: some}\n', 2, "mode is 'some'; valid are sequence, changes, samples, ignore"),
        ('topics:\n  /a:\n    fields: {x: -1}\n', 3, 'x is -1'),
        ('topics:\n  /a: 3\n', 2, '/a must be a mapping'),
        ('tolerance: 1\n', 1, "unknown key 'tolerance'"),
    ],
)
def test_mistakes_in_tolerances_are_reported_with_their_line(
    tmp_path: Path, content: str, line: int, message: str
):
    path = tmp_path / 't.yaml'
    path.write_text(content)
    with pytest.raises(InvalidInputError) as info:
        read_tolerances(path)
    assert str(info.value).startswith(f't.yaml:{line}: {message}')


def test_the_example_of_the_documentation_is_valid(tmp_path: Path):
    page = (Path(__file__).parents[2] / 'docs' / 'how_to' / 'bags.md').read_text()
    (example,) = (text for text in re.findall(r'```yaml\n(.*?)```', page, re.DOTALL) if 'align:' in text)
    (tmp_path / 't.yaml').write_text(example)
    tolerances = read_tolerances(tmp_path / 't.yaml')
    assert tolerances.of_topic('/rosout', latched=True).mode == 'ignore'
    assert tolerances.of_topic('/joint_states', latched=True).mode == 'samples'
    assert tolerances.of_topic('/motion_result', latched=False).of_field('values.id') is None


def test_the_command_says_what_differs_and_writes_junit(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    expected = str(write_bag(tmp_path / 'e', [*RISE, (0.0, '/b', text('x\x07'))]))
    recorded = str(
        write_bag(tmp_path / 'r', [*RISE[:2], (1.0, '/a', number(7.0)), (0.0, '/b', text('x\x07'))])
    )
    junit = tmp_path / 'junit.xml'
    assert CHECK_BAG.run([recorded, '--against', expected, '--junit', str(junit)]) == 1
    assert 'first difference: /a at 1.0000 s, data: expected 2.0, recorded 7.0' in capsys.readouterr().out
    suite = ET.parse(junit).getroot()  # noqa: S314  # our own file
    assert (suite.get('tests'), suite.get('failures')) == ('2', '1')
    assert [(case.get('name'), len(case)) for case in suite] == [('/a', 1), ('/b', 0)]
    assert CHECK_BAG.run([expected, '--against', expected]) == 0


def test_a_bag_that_was_cut_off_is_refused_unless_accepted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    expected, recorded = (write_bag(tmp_path / name, RISE) for name in 'er')
    file = recorded / 'r.mcap'
    file.write_bytes(file.read_bytes()[:-50])
    assert CHECK_BAG.run([str(recorded), '--against', str(expected)]) == ExitCode.BAD_INPUT
    assert re.search(
        r'is incomplete: r\.mcap is damaged|is incomplete: .*3 messages could', capsys.readouterr().err
    )
    assert CHECK_BAG.run([str(recorded), '--against', str(expected), '--partial']) == 0
    with pytest.raises(AssertionError, match='is incomplete'):
        assert_bag_matches(recorded, expected)


def test_the_helper_for_tests_fails_with_the_first_difference(tmp_path: Path):
    expected = write_bag(tmp_path / 'e', RISE)
    recorded = write_bag(tmp_path / 'r', [*RISE[:2], (1.0, '/a', number(7.0))])
    with pytest.raises(
        AssertionError, match=r'first difference: /a at 1\.0000 s, data: expected 2\.0, recorded 7\.0'
    ):
        assert_bag_matches(recorded, expected)
    assert assert_bag_matches(recorded, expected, BagTolerances(TopicTolerance(absolute=5.0))).ok
    (tmp_path / 't.yaml').write_text('default: {absolute: 5}')
    assert assert_bag_matches(recorded, expected, tmp_path / 't.yaml').ok


BASE = [
    *((0.1 * k, '/joints', joints(0.1 * k, -0.2 * k, stamp=0.1 * k)) for k in range(8)),
    *((0.25 * k, '/result', status(id=str(k), line=str(2 * k))) for k in range(3)),
    *(
        (
            0.3 * k,
            '/out',
            T['std_msgs/msg/UInt8MultiArray'](
                T['std_msgs/msg/MultiArrayLayout']([], 0), np.array([k, 1], dtype=np.uint8)
            ),
        )
        for k in range(3)
    ),
]


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, len(BASE) - 1), st.data())
def test_one_changed_field_of_one_message_is_found(tmp_path: Path, index: int, data: st.DataObject):
    time, topic, message = BASE[index]
    if topic == '/joints':
        axis = data.draw(st.integers(0, 1))
        # Beyond the tolerance of 1e-6, and what double precision can tell of numbers up to 2.
        change = data.draw(st.floats(1.1e-6, 10.0)) * data.draw(st.sampled_from([-1.0, 1.0]))
        position = message.position.copy()
        position[axis] += change
        changed, field = joints(*position, stamp=time), f'position[{axis}]'
    elif topic == '/result':
        key = data.draw(st.sampled_from(['id', 'line']))
        values = {pair.key: pair.value for pair in message.values} | {key: 'other'}
        changed, field = status(**values), f'values.{key}'
    else:
        row = np.array(message.data)
        place = data.draw(st.integers(0, 1))
        row[place] += 1
        changed, field = T['std_msgs/msg/UInt8MultiArray'](message.layout, row), f'data[{place}]'
    name = str(len(list(tmp_path.iterdir())))
    expected = read_bag(write_bag(tmp_path / f'e{name}', BASE))
    recorded = read_bag(
        write_bag(tmp_path / f'r{name}', [*BASE[:index], (time, topic, changed), *BASE[index + 1 :]])
    )
    comparison = compare_bags(recorded, expected, BagTolerances(TopicTolerance(absolute=1e-6)))
    assert [r.topic for r in comparison.topics if r.difference] == [topic]
    assert comparison.first is not None
    assert comparison.first.field == field
    assert comparison.first.time == pytest.approx(time, abs=1e-9)  # ns


def test_messages_of_unknown_types_are_compared_byte_by_byte(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    first, same, other = (
        write_plant_bag(tmp_path / name, levels, defined=False)
        for name, levels in (('first', [1.0, 2.0]), ('same', [1.0, 2.0]), ('other', [1.0, 3.0]))
    )
    assert CHECK_BAG.run([str(same), '--against', str(first)]) == 0
    assert 'compared byte by byte, as their types are not known: /level' in capsys.readouterr().out
    assert CHECK_BAG.run([str(other), '--against', str(first)]) == 1
    assert '/level at 0.1000 s' in capsys.readouterr().out
