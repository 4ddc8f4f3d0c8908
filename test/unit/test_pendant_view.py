"""What an operator's page shows: texts, messages, channels and programs."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from robots_controller.control.stops.faults import Fault
from robots_controller.pendant.message_log import LONGEST, Level, MessageLog
from robots_controller.pendant.pendant_state import PendantState, ShownIo, ShownProgram
from robots_controller.pendant.permissions import NotPermittedError
from robots_controller.pendant.programs import program_files, read_program
from robots_controller.pendant.texts import LANGUAGES, preferred_language, read_texts
from robots_controller.program.run_state import RunState
from robots_core.cell_interface.operating_modes import Commander
from robots_core.errors import InvalidInputError

OF_NODES = ('errors.', 'faults.')  # who say them in English


def test_the_languages_say_the_same() -> None:
    english = read_texts('en').texts
    for code in LANGUAGES:
        texts = {key: text for key, text in read_texts(code).texts.items() if not key.startswith(OF_NODES)}
        assert texts.keys() == english.keys()
        for key, text in texts.items():
            assert re.findall(r'{\w+}', text) == re.findall(r'{\w+}', english[key]), key


def test_every_fault_has_its_german_name() -> None:
    german = read_texts('de')
    known = {key.removeprefix('faults.') for key in german.texts if key.startswith('faults.')}
    assert known == {fault.label for fault in Fault}
    assert german.fault(Fault.FEEDBACK_LOST.label, 'no joint_states for 0.1 s') == (
        'Keine gemessenen Stellungen (no joint_states for 0.1 s)'
    )
    assert read_texts('en').fault(Fault.FEEDBACK_LOST.label, 'no joint_states') == 'no joint_states'


@pytest.mark.parametrize('code', ['en', 'de'])
def test_reasons_name_states_in_the_language_of_the_page(code: str) -> None:
    text = read_texts(code)
    said = text.error(NotPermittedError('commanded', **PendantState(commander=Commander.SENSOR).values))
    assert text('commanders.SENSOR') in said
    said = text.error(
        NotPermittedError('fault', **PendantState(fault='pressed', fault_kind='emergency stop').values)
    )
    assert ('Not-Halt (pressed)' if code == 'de' else 'stopped: pressed') in said


@pytest.mark.parametrize(
    ('header', 'language'),
    [('de-CH,de;q=0.9,en;q=0.8', 'de'), ('fr,de;q=0.5', 'de'), ('fr', 'en'), ('', 'en'), ('EN-us', 'en')],
)
def test_the_language_is_that_of_the_browser(header: str, language: str) -> None:
    assert preferred_language(header) == language


def test_a_language_without_texts_is_refused() -> None:
    with pytest.raises(InvalidInputError, match="language 'xx' is unknown; valid are en, de"):
        read_texts('xx')


def test_messages_that_repeat_are_counted_and_come_first() -> None:
    log = MessageLog()
    log.add(1.0, Level.WARNING, 'a_node', 'limit')
    log.add(2.0, Level.INFO, 'b_node', 'planned')
    log.add(3.0, Level.WARNING, 'a_node', 'limit')
    newest, other = log.shown()
    assert (newest.text, newest.time, newest.count, other.text) == ('limit', 3.0, 2, 'planned')
    assert [one.text for one in log.shown(Level.WARNING)] == ['limit']
    assert [one.text for one in log.shown(part='B_NODE')] == ['planned']
    assert log.pending == 1
    log.acknowledge(log.shown())
    assert log.pending == 0
    log.add(4.0, Level.WARNING, 'a_node', 'limit')
    assert (log.pending, log.shown()[0].count) == (1, 1)


def test_messages_that_come_while_others_are_acknowledged_stay_pending() -> None:
    log = MessageLog()
    for text in ('limit', 'lost'):
        log.add(1.0, Level.ERROR, 'a_node', text)
    seen = log.shown()
    log.add(2.0, Level.ERROR, 'a_node', 'limit')
    log.add(2.0, Level.ERROR, 'a_node', 'stopped')
    log.acknowledge(seen)
    assert {one.text: one.acknowledged for one in log.shown()} == {
        'stopped': False,
        'limit': False,
        'lost': True,
    }


def test_messages_have_the_line_of_the_program_that_ran() -> None:
    program = ShownProgram('/p/weld.lua', RunState.RUNNING, 'weld.lua', 14, 'seam.lua', 3)
    assert program.place(of_motion=False) == 'weld.lua:14'
    assert program.place(of_motion=True) == 'seam.lua:3'
    assert replace(program, motion_line=0).place(of_motion=True) == 'weld.lua:14'
    assert replace(program, state=RunState.PAUSED).place(of_motion=False) == ''
    log = MessageLog()
    for place in ('weld.lua:12', 'weld.lua:14'):
        log.add(1.0, Level.WARNING, 'a_node', 'limit', place)
    (found,) = log.shown(part='weld.lua:14')
    assert (found.place, found.count) == ('weld.lua:14', 2)


def test_only_the_newest_messages_are_kept() -> None:
    log = MessageLog()
    for number in range(LONGEST + 3):
        log.add(float(number), Level.INFO, 'node', str(number))
    assert len(log.shown()) == LONGEST
    assert log.shown()[-1].text == '3'


def test_channels_are_found_by_name_and_number() -> None:
    io = ShownIo({'digital_inputs': (0.0,) * 1000}, {'digital_inputs': ('', 'gripper_open', 'part_12')})
    assert len(io.found('digital_inputs')) == 1000
    assert [one.index for one in io.found('digital_inputs', 'GRIP')] == [2]
    assert [one.index for one in io.found('digital_inputs', ' 12 ')] == [3, 12]
    assert io.found('digital_inputs', 'nothing') == []
    assert io.found('analog_outputs') == []
    assert io.label('digital_input.2') == 'gripper_open'
    assert [io.label(f'digital_input.{one}') for one in (1, 4)] == [
        'digital_input.1',
        'digital_input.4',
    ]


def test_programs_are_found_and_read(tmp_path: Path) -> None:
    for name in ('b.lua', 'a.lua', 'parts/c.lua', 'library/help.lua', 'notes.txt'):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(f'-- {name}')
    assert program_files(tmp_path) == ['a.lua', 'b.lua', 'parts/c.lua']
    assert program_files(tmp_path / 'missing') == []
    assert read_program(str(tmp_path / 'a.lua'), 'b.lua') == '-- b.lua'
    with pytest.raises(InvalidInputError, match=r'c\.lua'):
        read_program(str(tmp_path / 'a.lua'), 'c.lua')
