"""Rows of a map at a Modbus TCP server of pymodbus."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from plant_bench import PlantBench
from plant_partners import Line, ModbusPartner
from read_texts import parse_io_map
from robots_controller.io.plant.modbus import ModbusPlace, decoded, encoded
from robots_core.errors import InvalidInputError

MAP = """
modbus:
  press: {{host: 127.0.0.1, port: {port}, period: 0.01, response_timeout: {timeout}}}
"""

Start = Callable[..., PlantBench]


@pytest.fixture
def partner() -> Iterator[ModbusPartner]:
    partner = ModbusPartner()
    yield partner
    partner.end()


@pytest.fixture
def start(partner: ModbusPartner) -> Iterator[Start]:
    benches: list[PlantBench] = []

    def made(rows: str, timeout: float = 60.0, port: int = 0) -> PlantBench:
        benches.append(PlantBench(MAP.format(port=port or partner.port, timeout=timeout) + rows))
        return benches[-1]

    yield made
    for bench in benches:
        bench.close()


ROWS = """
inputs:
  - {channel: digital_input.1, modbus: {discrete_input: 3}, timeout: 1.0, fail_safe: true}
  - {channel: analog_input.1, modbus: {input_register: 2, type: float32, word_order: little}, scale: 2}
  - {bits: {0: digital_input.2, 15: digital_input.3}, modbus: {holding_register: 5}}
outputs:
  - {channel: digital_output.1, modbus: {coil: 7}}
  - {bits: {0: digital_output.2, 2: digital_output.3}, modbus: {holding_register: 8}}
  - {channel: analog_output.1, modbus: {holding_register: 10, type: int32}, scale: 10}
"""


def test_all_tables_and_types(partner: ModbusPartner, start: Start):
    partner.start()
    partner.set('discrete_input', 3, [True])
    partner.set('input_register', 2, [0x0000, 0x4048])  # 3.125, the low word first
    partner.set('holding_register', 5, [0x8000])
    bench = start(ROWS)
    wanted = {'digital_input.1': 1.0, 'digital_input.2': 0.0, 'digital_input.3': 1.0, 'analog_input.1': 6.25}
    bench.until(lambda: bench.inputs == wanted, 'the inputs')
    bench.switch(d1=1.0, d2=1.0, d3=1.0, a1=-0.1)
    bench.until(lambda: partner.get('holding_register', 8, 4) == [0b101, 0, 0xFFFF, 0xFFFF], 'the registers')
    assert partner.get('coil', 7) == [True]
    assert not str(bench.bridge.problems)


def test_changes_are_written_in_their_order_and_once(partner: ModbusPartner, start: Start):
    partner.start()
    bench = start('outputs:\n  - {channel: digital_output.1, modbus: {coil: 0}}\n')
    for n in range(20):
        bench.switch(d1=float(n % 2))
    bench.switch(d1=1.0)
    bench.until(lambda: partner.written and partner.written[-1][2] == [1], 'the last')
    bench.until(lambda: not bench.ports['modbus press']._waiting, 'the others')
    written = [values[0] for _, _, values in partner.written]
    assert written == [(n + written[0]) % 2 for n in range(len(written))]  # none twice


def test_a_server_that_comes_late_goes_and_comes_again_has_the_newest_outputs(
    partner: ModbusPartner, start: Start
):
    bench = start(ROWS)
    bench.until(lambda: 'cannot be reached' in str(bench.bridge.problems), 'what is missing')
    assert bench.inputs['digital_input.1'] == 1.0  # fail-safe
    bench.switch(d1=1.0, d2=0.0, d3=0.0, a1=1.0)
    bench.switch(a1=2.0)
    bench.switch(d1=0.0)
    for n in range(2):
        partner.written.clear()
        partner.start()
        bench.until(lambda: len(partner.written) == 3, 'the outputs')
        # Each place once, in the order of the last changes.
        assert partner.written[-2:] == [('holding_register', 10, [0, 20 + n]), ('coil', 7, [0])]
        bench.until(lambda: not str(bench.bridge.problems), 'no problem')
        partner.stop()
        bench.until(lambda: 'modbus press: ' in str(bench.bridge.problems), 'the loss')
        bench.switch(a1=2.1 + n)
        bench.switch(d1=1.0)
        bench.switch(d1=0.0)
    connected = [text for text in bench.told if 'connected' in text and 'values' in text]
    assert connected[0] == 'modbus press: connected; 2 values of outputs were overtaken by newer ones'


def test_inputs_of_a_server_that_is_gone_are_fail_safe_after_their_timeout(
    partner: ModbusPartner, start: Start
):
    partner.start()
    bench = start(ROWS)
    bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the input')
    partner.stop()
    bench.until(lambda: 'connecting again' in str(bench.bridge.problems), 'the loss')
    bench.now = 2.0
    bench.step()
    assert bench.inputs['digital_input.1'] == 1.0
    assert 'modbus press has been silent for 1 s; digital_input.1 is at its fail-safe value 1' in str(
        bench.bridge.problems
    )


def test_a_server_that_does_not_answer_is_left_and_tried_again(partner: ModbusPartner, start: Start):
    partner.start()
    partner.answers.clear()
    bench = start(ROWS, timeout=0.2)
    bench.until(lambda: 'no answer within 0.2 s' in str(bench.bridge.problems), 'the silence')
    assert not [text for text in bench.told if 'modbus press: connected' in text]
    partner.call(partner.answer())
    bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the answer')
    bench.until(lambda: not str(bench.bridge.problems), 'the end of the problem')


def test_late_answers_hold_up_neither_the_loop_nor_what_is_written(partner: ModbusPartner, start: Start):
    partner.start()
    partner.delay = 0.5
    bench = start(ROWS)
    bench.until(lambda: len(bench.inputs) == 4 and bench.inputs['digital_input.1'] == 0.0, 'the inputs')
    before = len(partner.requests)
    bench.switch(d1=1.0)
    bench.until(lambda: partner.written, 'the output')
    assert partner.written == [('coil', 7, [1])]
    # After the answer that it waits for, and perhaps one more; not after those of all three requests.
    assert 5 in partner.requests[before : before + 3]
    bench.works_while_it_waits('modbus press', partner.answers.clear, d1=0.0)
    partner.call(partner.answer())
    bench.until(lambda: partner.written[-1] == ('coil', 7, [0]), 'the next output')
    assert not str(bench.bridge.problems)


def test_a_server_that_sends_what_nobody_asked_for_is_left_and_tried_again(
    partner: ModbusPartner, start: Start
):
    partner.start()
    line = Line(partner.port)
    line.start()
    bench = start(ROWS, timeout=2.0, port=line.port)
    bench.until(lambda: 'modbus press: connected' in bench.told, 'the connection')
    line.shout(1_000_000 * b'\xff')
    bench.until(lambda: bench.told.count('modbus press: connected') == 2, 'another connection')
    partner.set('discrete_input', 3, [True])
    bench.until(lambda: bench.inputs['digital_input.1'] == 1.0, 'the input')
    bench.until(lambda: not str(bench.bridge.problems), 'no problem')
    line.end()


@pytest.mark.parametrize('words', [[0x0000, 0x7FC0], [0x0000, 0xFF80]])
def test_registers_that_hold_no_finite_number_leave_the_input(
    partner: ModbusPartner, start: Start, words: list[int]
):
    partner.start()
    partner.set('input_register', 2, [0x0000, 0x4048])
    bench = start(ROWS)
    bench.until(lambda: bench.inputs.get('analog_input.1') == 6.25, 'the value')
    partner.set('input_register', 2, words)
    bench.until(lambda: bench.bridge.problems.count > 2, 'values that are lost')
    assert bench.inputs['analog_input.1'] == 6.25
    assert len([text for text in bench.told if 'analog_input.1 keeps its value' in text]) == 1


def test_an_address_that_does_not_exist_leaves_its_neighbours_alone(partner: ModbusPartner, start: Start):
    partner.start()
    partner.set('input_register', 31, [7])
    rows = ''.join(
        f'  - {{channel: analog_input.{n}, modbus: {{input_register: {30 + n}}}}}\n' for n in (0, 1, 2)
    ).replace('analog_input.0', 'analog_input.4')
    bench = start(f'inputs:\n{rows}')
    bench.until(lambda: bench.inputs.get('analog_input.1') == 7.0, 'the neighbour')
    problem = 'input_register 32 of unit 1: exception 2, illegal data address; analog_input.2 keeps its value'
    bench.until(lambda: problem in str(bench.bridge.problems), 'the problem')
    assert bench.told.count(f'modbus press: {problem}') == 1
    before = bench.bridge.problems.count
    bench.until(lambda: bench.bridge.problems.count > before, 'more of them')
    assert bench.told.count(f'modbus press: {problem}') == 1


def test_an_output_that_is_refused_is_reported_and_tried_until_it_is_taken(
    partner: ModbusPartner, start: Start
):
    partner.start()
    partner.refuse = {1}
    rows = [f'  - {{channel: digital_output.{n + 1}, modbus: {{coil: {n}}}}}\n' for n in range(3)]
    bench = start(f'outputs:\n{"".join(rows)}')
    bench.switch(d1=1.0, d2=1.0, d3=1.0)
    refused = 'modbus press: refuses coil 1 of unit 1, tried again and again: exception 6, device busy'
    bench.until(lambda: refused in str(bench.bridge.problems), 'the refusal')
    assert partner.get('coil', 0, 3) == [True, False, True]
    partner.refuse = set()
    bench.until(lambda: not str(bench.bridge.problems), 'the acceptance')
    assert partner.get('coil', 0, 3) == [True, True, True]


def test_a_thousand_channels_are_few_requests():
    partner = ModbusPartner(size=1024)
    partner.start()
    partner.set('discrete_input', 0, [n % 3 == 0 for n in range(1000)])
    rows = ''.join(
        f'  - {{channel: digital_input.{n + 1}, modbus: {{discrete_input: {n}}}}}\n' for n in range(1000)
    )
    more = ''.join(f'  - {{channel: digital_output.{n + 1}, modbus: {{coil: {n}}}}}\n' for n in range(1000))
    bench = PlantBench(MAP.format(port=partner.port, timeout=60.0) + f'inputs:\n{rows}outputs:\n{more}')
    bench.switch(**{f'd{n + 1}': float(n % 7 == 0) for n in range(1000)})
    bench.until(lambda: sum(bench.inputs.values()) == 334, 'the inputs')
    bench.until(lambda: partner.written, 'the outputs')
    assert partner.written == [('coil', 0, [int(n % 7 == 0) for n in range(1000)])]
    assert partner.requests.count(2) < 1000
    bench.close()
    partner.end()


@pytest.mark.parametrize(
    ('kind', 'value', 'words'),
    [
        ('uint16', 65535, [65535]),
        ('int16', -2, [65534]),
        ('uint32', 0x12345678, [0x1234, 0x5678]),
        ('int64', -1, [65535] * 4),
        ('double', 1.0, [0x3FF0, 0, 0, 0]),
    ],
)
def test_a_value_comes_back_from_its_registers(kind: str, value: float, words: list[int]):
    for little in (False, True):
        place = ModbusPlace('modbus press', kind, 1, 'holding_register', 0, little=little)
        assert encoded(place, value) == (words[::-1] if little else words)
        assert decoded(place, encoded(place, value)) == value


@pytest.mark.parametrize(
    ('row', 'message'),
    [
        ('{}', 'modbus needs one of coil, discrete_input, holding_register, input_register; here are none'),
        ('{coil: 1, input_register: 1}', 'here are coil, input_register'),
        ('{coil: 65536}', 'coil is 65536; valid is a whole number in 0..65535'),
        (
            '{input_register: 65535, type: int32}',
            'input_register is 65535; valid is a whole number in 0..65534',
        ),
        ('{coil: 1, type: int32}', 'type is for registers; coil is one bit'),
        ('{holding_register: 1, type: int8}', "type is 'int8'; valid are int16, "),
        ('{coil: 1, unit: 256}', 'unit is 256'),
        ('{coil: 1, server: pres}', "server is 'pres'; valid are press"),
        ('{coil: 1, adress: 1}', "unknown key 'adress'"),
        ('{coil: 1}, topic: a', 'modbus and topic exclude each other; a row has one place'),
        ('{coil: 1}, bit: 0', "coil 1 of unit 1 is 'boolean'; a bit needs a whole number"),
        ('{holding_register: 1}, bit: 16', "'uint16' with bits 0..15, not 16"),
        (
            '{coil: 1}, timeout: 0.005, fail_safe: 0',
            'timeout is 0.005 s; valid is more than the period, 0.01 s',
        ),
    ],
)
def test_mistakes_are_reported_with_their_line(row: str, message: str):
    text = f'inputs:\n  - {{channel: digital_input.1, modbus: {row}}}\n'
    refused(MAP.format(port=502, timeout=1) + text, message, 5)


OUT = 'outputs:\n  - {channel: analog_output.1, modbus: %s}\n'
TWO = '  - {channel: analog_output.2, modbus: {holding_register: 2}}\n'


@pytest.mark.parametrize(
    ('text', 'message', 'line'),
    [
        (OUT % '{holding_register: 1}', 'there is no server below modbus', 2),
        ('modbus: {a: {port: 502}}\n', 'host is missing', 1),
        ('modbus: {a: {host: b, port: 0}}\n', 'port is 0', 1),
        ('modbus: {a: {host: b, prt: 0}}\n', "unknown key 'prt'; did you mean 'port'?", 1),
        (
            'modbus: {a: {host: b}}\n' + OUT % '{discrete_input: 1}',
            'discrete_input cannot be written; outputs go to coil or holding_register',
            3,
        ),
        ('modbus: {a: {host: b}, c: {host: d}}\n' + OUT % '{coil: 1}', 'server is missing', 3),
        (
            'modbus: {a: {host: b}}\n' + OUT % '{holding_register: 1, type: int32}' + TWO,
            'holding_register 2 of unit 1 of modbus a is set in line 3 already',
            4,
        ),
    ],
)
def test_mistakes_of_servers_and_outputs(text: str, message: str, line: int):
    refused(text, message, line)


def refused(text: str, message: str, line: int) -> None:
    with pytest.raises(InvalidInputError) as info:
        parse_io_map(text)
    assert f'io_map.yaml:{line}: ' in str(info.value)
    assert message in str(info.value)
