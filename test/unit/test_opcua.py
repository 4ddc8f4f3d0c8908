"""Rows of a map at an OPC UA server of asyncua."""

from __future__ import annotations

import datetime as dt
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from asyncua import ua

from opcua_partners import OpcuaPartner, OverflowMarks, certificate
from plant_bench import PlantBench
from plant_partners import Babbler, Line, Listening
from read_texts import parse_io_map
from robots_core.errors import InvalidInputError

MAP = """
opcua:
  line: {{endpoint: '{endpoint}', period: 0.02, response_timeout: 60.0{more}}}
"""

VARIABLES = {'ready': False, 'force': 2500.0, 'word': 9, 'start': False, 'count': 0, 'other': 0.0}
OF_OTHER_TYPES = {'text': 'on', 'list': [1, 2], 'nan': float('nan'), 'huge': 1e300, 'half': 0.5}

ROWS = """
inputs:
  - {channel: digital_input.1, opcua: {node: ns=2;s=ready}, timeout: 1.0, fail_safe: true}
  - {channel: analog_input.1, opcua: {node: nsu=urn:robots:press;s=force}, scale: 0.001}
  - {bits: {0: digital_input.2, 3: digital_input.3}, opcua: {node: ns=2;s=word, type: int32}}
outputs:
  - {channel: digital_output.1, opcua: {node: ns=2;s=start}}
  - {channel: analog_output.1, opcua: {node: ns=2;s=count, type: int32}, scale: 10}
"""

CONNECTED = 'opcua line: connected'

Start = Callable[..., PlantBench]


@pytest.fixture
def start() -> Iterator[Start]:
    benches: list[PlantBench] = []

    def made(partner: OpcuaPartner | Listening, rows: str = ROWS, more: str = '') -> PlantBench:
        benches.append(
            PlantBench(MAP.format(endpoint=f'opc.tcp://127.0.0.1:{partner.port}', more=more) + rows)
        )
        return benches[-1]

    yield made
    for bench in benches:
        bench.close()


@pytest.fixture(scope='module')
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpcuaPartner]:
    folder = tmp_path_factory.mktemp('server')
    many = {f'v{n}': False for n in range(1, 1001)}
    variables = {**VARIABLES, **OF_OTHER_TYPES, **many}
    partner = OpcuaPartner(
        variables,
        certificate(folder, 'server'),
        {'robot': 'secret'},
        ('urn:stranger',),
    )
    yield partner
    partner.end()


@pytest.fixture
def partner(server: OpcuaPartner) -> Iterator[OpcuaPartner]:
    for name, value in VARIABLES.items():
        server.set(name, ua.Variant(value, ua.VariantType.Int32) if type(value) is int else value)
    yield server
    server.stop()


def test_variables_become_inputs_and_outputs_variables(partner: OpcuaPartner, start: Start):
    partner.start()
    bench = start(partner)
    wanted = {'digital_input.1': 0.0, 'digital_input.2': 1.0, 'digital_input.3': 1.0, 'analog_input.1': 2.5}
    bench.until(lambda: bench.inputs == wanted, 'the inputs')
    bench.switch(d1=1.0, a1=1.25)
    bench.until(lambda: partner.get('start') and partner.get('count') == 12, 'the outputs')
    partner.set('ready', value=True)
    bench.until(lambda: bench.inputs['digital_input.1'] == 1.0, 'the change')
    assert not str(bench.bridge.problems)


def test_the_time_of_the_source_is_kept(partner: OpcuaPartner, start: Start):
    partner.start()
    bench = start(partner)
    measured = dt.datetime(2020, 5, 17, 12, tzinfo=dt.UTC)
    partner.set('ready', ua.DataValue(ua.Variant(True), SourceTimestamp=measured))
    bench.until(lambda: measured.timestamp() in [stamp for _, _, stamp in bench.bridge.places()], 'the stamp')


def test_a_server_that_comes_late_goes_and_comes_again(partner: OpcuaPartner, start: Start):
    bench = start(partner)
    bench.until(lambda: 'opcua line: opc.tcp://127' in str(bench.bridge.problems), 'what is missing')
    bench.switch(d1=1.0, a1=1.0)
    for n in range(2):
        partner.start()
        bench.until(lambda count=10 * (n + 1): partner.get('count') == count, 'the outputs')  # type: ignore[misc]
        assert partner.get('start')
        bench.until(lambda: not str(bench.bridge.problems), 'no problem')
        bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the input')
        partner.stop()
        bench.until(lambda: 'connecting again' in str(bench.bridge.problems), 'the loss')
        bench.now += 2.0
        bench.step()
        assert bench.inputs['digital_input.1'] == 1.0
        bench.switch(a1=2.0)


def test_variables_that_do_not_change_are_not_silent(partner: OpcuaPartner, start: Start):
    partner.start()
    bench = start(partner)
    bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the input')
    for _ in range(3):
        bench.now += 0.9
        bench.step()
        checks = bench.checks
        bench.until(lambda before=checks: bench.checks > before, 'a sign of life')  # type: ignore[misc]
        assert bench.inputs['digital_input.1'] == 0.0


def test_what_the_server_refuses_is_reported_and_tried_again(partner: OpcuaPartner, start: Start):
    partner.start()
    partner.protect('start', writable=False)
    bench = start(partner, ROWS.replace('s=force', 's=nothing').replace('s=count, type: int32', 's=count'))
    bench.switch(d1=1.0, a1=1.0)
    wanted = [
        'nsu=urn:robots:press;s=nothing: BadNodeIdUnknown; analog_input.1 keeps its value',
        'refuses ns=2;s=start and 1 more outputs, tried again and again: BadUserAccessDenied',
    ]
    bench.until(lambda: all(text in str(bench.bridge.problems) for text in wanted), 'the problems')
    partner.protect('start', writable=True)
    bench.until(lambda: partner.get('start'), 'the output')
    bench.until(lambda: 'refuses ns=2;s=count, tried' in str(bench.bridge.problems), 'another type')
    assert 'BadTypeMismatch' in str(bench.bridge.problems)


def test_values_out_of_range_and_of_another_type(partner: OpcuaPartner, start: Start):
    partner.start()
    bench = start(partner, ROWS.replace('type: int32}}', 'type: uint8}}'))
    bench.until(lambda: bench.inputs.get('digital_input.3') == 1.0, 'the word')
    partner.set('word', ua.Variant(300, ua.VariantType.Int32))
    problem = 'ns=2;s=word is 300; uint8 is a whole number in 0..255; digital_input.3 keeps its value'
    bench.until(lambda: problem in str(bench.bridge.problems), 'the range')
    assert bench.inputs['digital_input.3'] == 1.0


@pytest.mark.parametrize('name', OF_OTHER_TYPES)
def test_values_of_another_type_are_reported_once(partner: OpcuaPartner, start: Start, name: str):
    partner.start()
    bench = start(partner, ROWS.replace('s=word', f's={name}'))
    problem = 'digital_input.3 keeps its value'
    bench.until(lambda: problem in str(bench.bridge.problems), 'the problem')
    before = bench.bridge.problems.count
    bench.until(lambda: bench.inputs.get('digital_input.1') == 0.0, 'another input')
    assert before > 0
    assert len([text for text in bench.told if problem in text]) == 1
    assert bench.inputs.get('digital_input.3', 0.0) == 0.0


def test_a_flood_of_changes_ends_with_the_newest(
    partner: OpcuaPartner, start: Start, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr('robots_controller.io.plant.plant_connection.MOST_ARRIVALS', 5)
    partner.start()
    bench = start(partner)
    bench.until(lambda: bench.inputs.get('digital_input.3') == 1.0, 'the inputs')
    for n in range(500):
        partner.set('force', float(n))
    bench.until(lambda: bench.inputs['analog_input.1'] == 0.499, 'the newest')
    told = [text for text in bench.told if 'came faster than they could be taken' in text]
    assert len(told) == (bench.bridge.problems.count > 0)


def test_values_that_the_server_drops_are_counted_and_reported_once(
    partner: OpcuaPartner, start: Start, monkeypatch: pytest.MonkeyPatch
):
    marks = OverflowMarks(monkeypatch)
    partner.start()
    bench = start(partner)
    bench.until(lambda: bench.inputs.get('analog_input.1') == 2.5, 'the input')
    for n in range(1, 4):
        partner.flood('force', [float(k) for k in range(200)] + [1000.0 * n])
        bench.until(lambda newest=n: bench.inputs['analog_input.1'] // 1.0 == newest, 'the newest')  # type: ignore[misc]
    assert marks.count > 500
    assert bench.bridge.problems.count == 3  # one mark, however many were dropped before
    told = [text for text in bench.told if 'came faster than they could be taken' in text]
    assert told == ['opcua line: values came faster than they could be taken; at least 1 lost']
    partner.set('word', ua.DataValue(ua.Variant(8, ua.VariantType.Int32), ua.StatusCode(0x0400)))
    bench.until(lambda: bench.inputs['digital_input.2'] == 0.0, 'a value with another mark')
    partner.set('word', ua.DataValue(ua.Variant(9, ua.VariantType.Int32), ua.StatusCode(0x808C0480)))
    problem = 'ns=2;s=word: BadSensorFailure; digital_input.2 keeps its value'
    bench.until(lambda: problem in str(bench.bridge.problems), 'a bad value with a mark')


def test_a_subscription_that_the_server_ends_is_made_again(partner: OpcuaPartner, start: Start):
    partner.start()
    bench = start(partner)
    bench.until(lambda: bench.inputs.get('analog_input.1') == 2.5, 'the input')
    bench.until(lambda: CONNECTED in bench.told, 'the connection')  # inputs may arrive before
    partner.end_subscriptions()
    partner.set('force', 1500.0)  # asyncua's server sends the end with the next change
    bench.until(lambda: bench.told.count(CONNECTED) == 2, 'another connection')
    bench.until(lambda: bench.inputs['analog_input.1'] == 1.5, 'the value')
    partner.set('force', 1000.0)
    bench.until(lambda: bench.inputs['analog_input.1'] == 1.0, 'the change')


ACKNOWLEDGE = struct.pack('<3scIIIIII', b'ACK', b'F', 28, 0, 65536, 65536, 0, 0)


@pytest.mark.parametrize(
    ('answer', 'end', 'problem'),
    [
        (1_000_000 * b'\xff', 'wait', 'sends what is not OPC UA'),
        (65536 * b'\xff', 'repeat', 'sends what is not OPC UA'),
        (b'HTTP/1.1 400 Bad Request\r\n\r\n', 'close', 'sends what is not OPC UA'),
        (struct.pack('<3scI', b'ACK', b'F', 0xFFFFFFFF), 'repeat', 'sends what is not OPC UA'),
        (struct.pack('<3scI', b'ACK', b'F', 7), 'wait', 'sends what is not OPC UA'),
        (ACKNOWLEDGE + struct.pack('<3scI', b'OPN', b'F', 1 << 30), 'wait', 'sends what is not OPC UA'),
        (ACKNOWLEDGE[:4], 'close', 'onnection'),
        (ACKNOWLEDGE[:12], 'close', 'onnection'),
        (ACKNOWLEDGE, 'close', 'onnection'),
        (ACKNOWLEDGE + struct.pack('<3scII', b'OPN', b'F', 100, 1) + 88 * b'\xff', 'wait', 'onnection'),
        (struct.pack('<3scIIi', b'ERR', b'F', 16, 0x80AC0000, -1), 'close', 'onnection'),
        (ACKNOWLEDGE[:12], 'wait', 'no answer within 0.5 s'),
        (b'', 'wait', 'no answer within 0.5 s'),
    ],
)
def test_a_server_that_sends_what_is_no_opc_ua_is_left_and_tried_again(answer: bytes, end: str, problem: str):
    babbler = Babbler(answer, end)
    babbler.start()
    text = MAP.replace('60.0', '0.5').format(endpoint=f'opc.tcp://127.0.0.1:{babbler.port}', more='')
    bench = PlantBench(text + ROWS)
    bench.until(lambda: babbler.clients >= 3, 'three attempts')
    bench.until(lambda: problem in str(bench.bridge.problems), 'the reason')
    *before, reason = [told for told in bench.told if told.startswith('opcua line: ')]
    # The first attempt may have failed before the bridge reads at all.
    assert before in ([], ['opcua line: not connected yet'])
    assert problem in reason
    bench.close()
    babbler.end()


def chunks(count: int, size: int) -> bytes:
    """The first chunks of a message that does not end, each as OPC UA has it."""
    body = (size - 24) * b'x'
    return b''.join(struct.pack('<3scIIIII', b'MSG', b'C', size, 0, 0, n, 1) + body for n in range(count))


@pytest.mark.parametrize(('count', 'size'), [(257, 65536), (2049, 24)])
def test_a_message_without_end_is_left_and_tried_again(start: Start, count: int, size: int):
    babbler = Babbler(ACKNOWLEDGE + chunks(count, size), 'wait')
    babbler.start()
    bench = start(babbler)
    problem = 'sends a message of more than 16 MiB or 2048 chunks'
    bench.until(lambda: babbler.clients >= 2, 'another attempt')
    bench.until(lambda: problem in str(bench.bridge.problems), 'the reason')
    bench.close()
    babbler.end()


@pytest.mark.parametrize('noise', [1_000_000 * b'\xff', struct.pack('<3scI', b'MSG', b'F', 0x7FFFFFFF)])
def test_noise_in_the_middle_of_a_connection_ends_it(partner: OpcuaPartner, start: Start, noise: bytes):
    partner.start()
    line = Line(partner.port)
    line.start()
    bench = start(line)
    bench.until(lambda: CONNECTED in bench.told, 'the connection')
    bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the input')
    line.shout(noise)
    bench.until(lambda: bench.told.count(CONNECTED) == 2, 'another connection')
    partner.set('ready', value=True)
    bench.until(lambda: bench.inputs['digital_input.1'] == 1.0, 'the input')
    line.end()


def test_late_answers_do_not_hold_up_the_loop(partner: OpcuaPartner, start: Start):
    partner.start()
    line = Line(partner.port, delay=0.5)
    line.start()
    bench = start(line)
    bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the input')
    bench.switch(d1=1.0, a1=1.0)
    bench.until(lambda: partner.get('count') == 10, 'the outputs')
    bench.works_while_it_waits('opcua line', lambda: line.hold(held=True), d1=0.0)
    line.hold(held=False)
    bench.until(lambda: not partner.get('start'), 'the next output')
    line.end()


def test_encryption_and_users(partner: OpcuaPartner, start: Start, tmp_path: Path):
    password = tmp_path / 'password.txt'
    password.write_text('secret\n')
    partner.start()

    def bench(application: str, user: str) -> PlantBench:
        own = certificate(tmp_path, application)
        secure = f', security: basic256sha256, certificate: {own[0]}, key: {own[1]}'
        return start(partner, more=f'{secure}, user: {user}, password_file: {password}')

    untrusted = bench('stranger', 'robot')
    untrusted.until(lambda: 'BadCertificateUntrusted' in str(untrusted.bridge.problems), 'the refusal')
    unknown = bench('cell', 'someone')
    unknown.until(lambda: 'BadUserAccessDenied' in str(unknown.bridge.problems), 'the refusal')
    known = bench('cell', 'robot')
    known.until(lambda: known.inputs['digital_input.1'] == 0.0, 'the input')


def test_a_thousand_variables(partner: OpcuaPartner, start: Start):
    partner.start()
    rows = [f'  - {{channel: digital_input.{n}, opcua: {{node: ns=2;s=v{n}}}}}\n' for n in range(1, 501)]
    more = [
        f'  - {{channel: digital_output.{n}, opcua: {{node: ns=2;s=v{500 + n}}}}}\n' for n in range(1, 501)
    ]
    bench = start(partner, f'inputs:\n{"".join(rows)}outputs:\n{"".join(more)}')
    bench.until(lambda: len(bench.inputs) == 500, 'the inputs')
    bench.switch(**{f'd{n}': 1.0 for n in range(1, 501)})
    bench.until(lambda: partner.get('v1000'), 'the outputs')


@pytest.mark.parametrize(
    ('row', 'message'),
    [
        ('{}', 'node is missing'),
        (
            '{node: Press.Ready}',
            "'Press.Ready' is no node id; they are like ns=2;s=Press.Ready or i=85",
        ),
        ('{node: ns=2;i=x}', "'ns=2;i=x' is no node id"),
        ('{node: i=1, type: word}', "type is 'word'; valid are bool, "),
        ('{node: i=1}, timeout: 0.01, fail_safe: 0', 'valid is more than the period, 0.02 s'),
    ],
)
def test_mistakes_are_reported_with_their_line(row: str, message: str):
    text = f'inputs:\n  - {{channel: digital_input.1, opcua: {row}}}\n'
    with pytest.raises(InvalidInputError) as info:
        parse_io_map(MAP.format(endpoint='opc.tcp://a', more='') + text)
    assert 'io_map.yaml:5: ' in str(info.value)
    assert message in str(info.value)


@pytest.mark.parametrize(
    ('endpoint', 'more', 'message'),
    [
        ('http://plc', '', "'http://plc' is no endpoint; endpoints are like opc.tcp://plc:4840"),
        ('opc.tcp://a', ', security: basic128', "security is 'basic128'; valid are none, basic256sha256"),
        (
            'opc.tcp://a',
            ', security: basic256sha256',
            'security basic256sha256 needs a certificate and its key',
        ),
        ('opc.tcp://a', f', trusted: {__file__}', 'trusted needs a security other than none'),
        ('opc.tcp://a', ', mode: sign', 'mode needs a security other than none'),
    ],
)
def test_mistakes_of_servers(endpoint: str, more: str, message: str):
    with pytest.raises(InvalidInputError, match=message):
        parse_io_map(MAP.format(endpoint=endpoint, more=more) + ROWS)
