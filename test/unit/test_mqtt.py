"""Rows of a map at an MQTT broker of amqtt."""

from __future__ import annotations

import json
import socket
import ssl
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from opcua_partners import certificate
from plant_bench import DEADLINE, PlantBench
from plant_partners import Line, MqttPartner
from read_texts import parse_io_map
from robots_controller.io.plant.mqtt import JsonPointer
from robots_core.errors import InvalidInputError

MAP = """
mqtt:
  broker: {{host: 127.0.0.1, port: {port}, response_timeout: 60.0{more}}}
"""

Start = Callable[..., PlantBench]


@pytest.fixture
def start() -> Iterator[Start]:
    benches: list[PlantBench] = []

    def made(partner: MqttPartner | Line, rows: str, more: str = '') -> PlantBench:
        benches.append(PlantBench(MAP.format(port=partner.port, more=more) + rows))
        return benches[-1]

    yield made
    for bench in benches:
        bench.close()


@pytest.fixture
def partner() -> Iterator[MqttPartner]:
    partner = MqttPartner()
    yield partner
    partner.end()


ROWS = """
inputs:
  - {channel: digital_input.1, mqtt: {topic: plant/press, pointer: /ready}, timeout: 1.0, fail_safe: true}
  - {channel: analog_input.1, mqtt: {topic: plant/press, pointer: /axes/1/force}, scale: 0.001}
  - {channel: analog_input.2, mqtt: {topic: plant/speed}}
  - {bits: {0: digital_input.2, 3: digital_input.3}, mqtt: {topic: plant/word, type: uint8, qos: 0}}
outputs:
  - {channel: digital_output.1, mqtt: {topic: robot/torch, pointer: /on, retain: true}}
  - {channel: analog_output.1, mqtt: {topic: robot/torch, pointer: /current, type: uint8}}
  - {channel: digital_output.2, mqtt: {topic: robot/gripper}}
"""


def connected(bench: PlantBench) -> PlantBench:
    bench.until(lambda: 'mqtt broker: connected' in ' '.join(bench.told), 'the connection')
    return bench


def test_values_of_messages_and_messages_of_values(partner: MqttPartner, start: Start):
    partner.start()
    bench = connected(start(partner, ROWS))
    bench.until(lambda: not str(bench.bridge.problems), 'no problem')
    partner.publish('plant/press', '{"ready": false, "axes": [{"force": 1}, {"force": 2500}]}')
    partner.publish('plant/speed', '1.5e2')
    partner.publish('plant/word', '9')
    wanted = {
        'digital_input.1': 0.0,
        'digital_input.2': 1.0,
        'digital_input.3': 1.0,
        'analog_input.1': 2.5,
        'analog_input.2': 150.0,
    }
    bench.until(lambda: bench.inputs == wanted, 'the inputs')
    bench.switch(d1=1.0, d2=0.0)
    bench.until(lambda: len(partner.heard) == 2, 'what is known')
    assert partner.heard == [('robot/torch', {'on': True}), ('robot/gripper', False)]
    bench.switch(a1=12.4)
    bench.until(lambda: len(partner.heard) == 3, 'the current')
    assert partner.heard[-1] == ('robot/torch', {'on': True, 'current': 12})


def test_messages_that_are_not_understood_leave_the_inputs_and_are_reported_once(
    partner: MqttPartner, start: Start
):
    partner.start()
    bench = connected(start(partner, ROWS))
    partner.publish('plant/word', '8')
    bench.until(lambda: bench.inputs.get('digital_input.3') == 1.0, 'the word')
    payloads = [
        *('on', '"on"', '"8"', 'null', '[8]', 'NaN', '1e999', '256', '-1', '8.5', '1' + 400 * '0', ''),
        100_000 * '[',
    ]
    for n, payload in enumerate(payloads):
        partner.publish('plant/word', payload)
        bench.until(lambda lost=2 * (n + 1): bench.bridge.problems.count == lost, payload)  # type: ignore[misc]
    assert bench.inputs['digital_input.3'] == 1.0
    words = [text for text in bench.told if 'plant/word' in text]
    assert words == [
        f"mqtt broker: plant/word: 'on' is no JSON; digital_input.{n} keeps its value" for n in (2, 3)
    ]
    partner.publish('plant/press', '{"ready": 1}')
    problem = "plant/press: the message has no 'axes', which /axes/1/force needs; analog_input.1 keeps"
    bench.until(lambda: problem in str(bench.bridge.problems), 'what is missing')
    partner.publish('plant/word', '0')
    bench.until(lambda: bench.inputs['digital_input.3'] == 0.0, 'the next')
    assert 'plant/word' not in str(bench.bridge.problems)


def test_a_topic_that_falls_silent_though_its_broker_is_there(partner: MqttPartner, start: Start):
    partner.start()
    bench = connected(start(partner, ROWS))
    partner.publish('plant/press', '{"ready": 0, "axes": [1, {"force": 0}]}')
    bench.until(lambda: bench.inputs['digital_input.1'] == 0.0, 'the input')
    bench.now = 1.5
    bench.step()
    assert bench.inputs['digital_input.1'] == 1.0
    assert 'plant/press of mqtt broker has been silent for 1 s' in str(bench.bridge.problems)


def test_a_broker_that_starts_again_gets_the_newest_outputs(partner: MqttPartner, start: Start):
    bench = start(partner, ROWS)
    bench.switch(d1=1.0, d2=1.0, a1=1.0)
    bench.switch(a1=2.0)
    bench.until(lambda: 'cannot be reached' in str(bench.bridge.problems), 'what is missing')
    for _ in range(2):
        partner.heard.clear()
        partner.start()
        bench.until(lambda: len(partner.heard) == 2, 'the outputs')
        assert sorted(partner.heard, key=str) == [
            ('robot/gripper', True),
            ('robot/torch', {'on': True, 'current': 2}),
        ]
        bench.until(lambda: not str(bench.bridge.problems), 'no problem')
        partner.stop()
        bench.until(lambda: 'connecting again' in str(bench.bridge.problems), 'the loss')


def test_a_flood_is_taken_and_what_is_lost_is_counted(
    partner: MqttPartner, start: Start, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr('robots_controller.io.plant.plant_connection.MOST_ARRIVALS', 50)
    monkeypatch.setattr('robots_controller.io.plant.plant_connection.MOST_TAKEN', 10)
    partner.start()
    bench = connected(start(partner, ROWS))
    taken = 0
    receive = bench.bridge._receive

    def count(arrival: Any, now: float) -> Any:
        nonlocal taken
        taken += 1
        return receive(arrival, now)

    bench.bridge._receive = count  # type: ignore[method-assign]
    for n in range(3):
        partner.publish('plant/speed', *(str(200 * n + k) for k in range(200)))
        bench.until(lambda newest=200.0 * n + 199.0: bench.inputs.get('analog_input.2') == newest, 'all')  # type: ignore[misc]
    told = [text for text in bench.told if 'came faster than they could be taken' in text]
    assert len(told) == 1
    assert told[0].startswith('mqtt broker: ')
    assert bench.bridge.problems.count == 600 - taken


def test_the_loop_has_its_turn_between_parts_of_a_flood(
    partner: MqttPartner, start: Start, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr('robots_controller.io.plant.plant_connection.MOST_TAKEN', 10)
    partner.start()
    bench = connected(start(partner, ROWS))
    partner.publish('plant/speed', *(str(n) for n in range(25)))
    port = bench.ports['mqtt broker']
    end = time.monotonic() + DEADLINE
    while len(port._arrivals) < 25:  # the loop does not take them yet
        assert time.monotonic() < end
    bench.woken()
    sizes = []
    while arrivals := port.arrivals():
        sizes.append(len(arrivals))
        assert bench.woken() == (len(sizes) < 3)
    assert sizes == [10, 10, 5]


def test_late_answers_do_not_hold_up_the_loop(partner: MqttPartner, start: Start):
    partner.start()
    line = Line(partner.port, delay=0.5)
    line.start()
    bench = connected(start(line, ROWS))
    partner.publish('plant/speed', '7')
    bench.until(lambda: bench.inputs.get('analog_input.2') == 7.0, 'the input')
    bench.switch(d1=1.0, d2=1.0, a1=1.0)
    bench.until(lambda: len(partner.heard) == 2, 'the outputs')
    bench.works_while_it_waits('mqtt broker', lambda: line.hold(held=True), d2=0.0)
    line.hold(held=False)
    bench.until(lambda: partner.heard[-1] == ('robot/gripper', False), 'the next output')
    bench.until(lambda: not bench.ports['mqtt broker']._busy, 'the confirmation')
    assert not str(bench.bridge.problems)
    line.end()


def test_a_broker_that_sends_what_is_no_mqtt_is_left_and_tried_again(partner: MqttPartner, start: Start):
    partner.start()
    line = Line(partner.port)
    line.start()
    bench = connected(start(line, ROWS))
    line.shout(1_000_000 * b'\xff')
    bench.until(lambda: bench.told.count('mqtt broker: connected') == 2, 'another connection')
    partner.publish('plant/speed', '8')
    bench.until(lambda: bench.inputs.get('analog_input.2') == 8.0, 'the input')
    line.end()


def test_messages_do_not_wait_for_acknowledgements_of_the_network(partner: MqttPartner, start: Start):
    partner.start()
    bench = connected(start(partner, ROWS))
    client = bench.ports['mqtt broker']._link._client
    assert client.socket().getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_a_broker_that_asks_for_a_user(start: Start):
    partner = MqttPartner(users=True)
    partner.start()
    stranger = start(partner, ROWS)
    stranger.until(lambda: 'the broker refuses the connection' in str(stranger.bridge.problems), 'why')
    connected(start(partner, ROWS, ', user: robot'))
    partner.end()


def pem(folder: Path, name: str) -> tuple[str, str]:
    """Files of a certificate of localhost and its key."""
    made, key = certificate(folder, name)
    Path(made).with_suffix('.crt').write_text(ssl.DER_cert_to_PEM_cert(Path(made).read_bytes()))
    return str(Path(made).with_suffix('.crt')), key


def test_a_broker_that_encrypts_and_one_whose_certificate_is_not_trusted(tmp_path: Path):
    own = pem(tmp_path, 'broker')
    partner = MqttPartner(certificate=own)
    partner.start()

    def bench(trusted: str) -> PlantBench:
        text = MAP.format(port=partner.port, more=f', tls: true, trusted: {trusted}')
        return PlantBench(text.replace('127.0.0.1', 'localhost') + ROWS)

    untrusting = bench(pem(tmp_path, 'other')[0])
    untrusting.until(lambda: 'certificate verify failed' in str(untrusting.bridge.problems), 'the refusal')
    known = connected(bench(own[0]))
    partner.publish('plant/speed', '8')
    known.until(lambda: known.inputs.get('analog_input.2') == 8.0, 'the input')
    untrusting.step()
    assert untrusting.inputs['analog_input.2'] == 0.0
    for one in (untrusting, known):
        one.close()
    partner.end()


def test_a_thousand_topics(partner: MqttPartner, start: Start):
    partner.start()
    inputs = [f'  - {{channel: digital_input.{n}, mqtt: {{topic: plant/{n}}}}}\n' for n in range(1, 501)]
    outputs = [f'  - {{channel: digital_output.{n}, mqtt: {{topic: robot/{n}}}}}\n' for n in range(1, 501)]
    bench = connected(start(partner, f'inputs:\n{"".join(inputs)}outputs:\n{"".join(outputs)}'))
    bench.switch(**{f'd{n}': float(n % 2) for n in range(1, 501)})
    bench.until(lambda: len(partner.heard) == 500, 'the outputs')
    assert dict(partner.heard) == {f'robot/{n}': n % 2 == 1 for n in range(1, 501)}
    partner.publish_each({f'plant/{n}': 'true' for n in range(1, 501)})
    bench.until(lambda: sum(bench.inputs.values()) == 500.0, 'the inputs')


@given(st.lists(st.text(alphabet='ab~/01', max_size=4), max_size=4), st.integers())
def test_a_pointer_finds_what_it_has_put(steps: list[str], value: int):
    text = ''.join('/' + step.replace('~', '~0').replace('/', '~1') for step in steps)
    pointer = JsonPointer.parse(text)
    document = json.loads(json.dumps(pointer.put({'other': 1} if steps else None, value)))
    assert pointer.get(document) == value
    assert pointer.excludes(pointer)


@pytest.mark.parametrize(
    ('row', 'message'),
    [
        ('{}', 'topic is missing'),
        ('{topic: plant/#}', "'plant/#' is no topic; topics are like plant/press, without + and #"),
        ('{topic: a, pointer: ready}', "'ready' is no JSON pointer; pointers are like '', /force or"),
        ('{topic: a, pointer: /a~2}', 'is no JSON pointer'),
        ('{topic: a, qos: 3}', 'qos is 3; valid is a whole number in 0..2'),
        ('{topic: a, type: word}', "type is 'word'; valid are bool, "),
        ('{topic: a, retain: true}', 'retain is not for inputs'),
        ('{topic: a}, period: 1', 'period is not for inputs'),
        ('{topic: a}, bit: 1', "a is 'boolean'; a bit needs a whole number"),
    ],
)
def test_mistakes_are_reported_with_their_line(row: str, message: str):
    text = f'inputs:\n  - {{channel: digital_input.1, mqtt: {row}}}\n'
    with pytest.raises(InvalidInputError) as info:
        parse_io_map(MAP.format(port=1883, more='') + text)
    assert 'io_map.yaml:5: ' in str(info.value)
    assert message in str(info.value)


@pytest.mark.parametrize(
    ('more', 'message'),
    [
        (', password_file: /no/such', 'there is no password_file /no/such'),
        (', trusted: /no/such', 'there is no trusted /no/such'),
        (f', certificate: {__file__}', 'certificate and key need each other'),
        (f', trusted: {__file__}', 'trusted needs tls: true'),
        (f', password_file: {__file__}', 'password_file needs a user'),
    ],
)
def test_mistakes_of_credentials(more: str, message: str):
    with pytest.raises(InvalidInputError, match=message):
        parse_io_map(MAP.format(port=1883, more=more) + ROWS)


def test_outputs_that_one_message_cannot_hold(partner: MqttPartner, start: Start):
    rows = ''.join(
        f'  - {{channel: analog_output.{n}, mqtt: {{topic: a, pointer: {pointer}}}}}\n'
        for n, pointer in ((1, '/a/b'), (2, '/a'))
    )
    with pytest.raises(InvalidInputError, match=r"io_map.yaml:5: a: one message cannot hold '/a' and '/a/b'"):
        start(partner, f'outputs:\n{rows}')
