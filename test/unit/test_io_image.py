"""Images of inputs and outputs."""

from __future__ import annotations

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robots_controller.io.io_image import IMAGES, IoImage
from robots_core.errors import InvalidInputError

LABELS = {'digital_inputs': ['press_ready', '', 'part_present'], 'analog_outputs': ['torch_current']}


def image(**options: object) -> IoImage:
    return IoImage(digital=4, analog=2, labels=LABELS, **options)  # type: ignore[arg-type]


def test_every_channel_is_found_by_each_of_its_names():
    io = image()
    assert len(io.channels) == 12
    for channel in io.channels:
        assert io.find(channel.name) is channel
        assert io.channel(channel.kind, channel.direction, channel.index) is channel
        assert channel.image in IMAGES
    first = io.channel('digital', 'input', 1)
    assert (
        io.find('press_ready') is io.find('digital_input.press_ready') is io.find('digital_input.1') is first
    )
    assert io.find('part_present').name == 'digital_input.3'
    assert io.find('torch_current').name == 'analog_output.1'


@pytest.mark.parametrize(
    'name', ['digital_input.0', 'digital_input.5', 'analog_input.3', '', 'digital_output.press_ready']
)
def test_an_unknown_name_is_refused_with_what_there_is(name: str):
    with pytest.raises(
        InvalidInputError, match=r'digital_input\.1\.\.4.*analog_output\.1\.\.2.*torch_current'
    ) as info:
        image().find(name)
    assert repr(name) in str(info.value)


@pytest.mark.parametrize(
    ('labels', 'message'),
    [
        ({'digital_inputs': ['a', 'b', 'a']}, "'a' names both digital_input.1 and digital_input.3"),
        (
            {'digital_inputs': ['a'], 'analog_outputs': ['', 'a']},
            "'a' names both digital_input.1 and analog_output.2",
        ),
        ({'digital_inputs': ['a.b']}, "'a.b' cannot name digital_input.1"),
        ({'analog_inputs': ['a', 'b', 'c']}, '3 names for 2 analog inputs'),
        ({'inputs': ['a']}, "'inputs' is no image"),
    ],
)
def test_wrong_labels_are_refused(labels: dict[str, list[str]], message: str):
    with pytest.raises(InvalidInputError, match=message.replace('.', r'\.')):
        IoImage(digital=4, analog=2, labels=labels)


def test_a_forced_input_shows_the_forced_value_until_it_is_released():
    io = image()
    ready = io.find('press_ready')
    io.force(ready, 1)
    assert not io.set_inputs('digital', [0, 0])
    assert io.value(ready) == 1.0
    assert io.forced() == {ready: 1.0}
    io.set_value(ready, 0)
    assert io.value(ready) == 1.0
    io.release(ready)
    assert io.value(ready) == 0.0
    assert not io.forced()
    io.release(ready)


def test_a_released_input_shows_what_came_from_outside_meanwhile():
    io = image()
    level = io.channel('analog', 'input', 2)
    io.force(level, 7.0)
    io.set_inputs('analog', [1.5, 2.5])
    assert io.numbers('analog_inputs').tolist() == [1.5, 7.0]
    io.release(level)
    assert io.numbers('analog_inputs').tolist() == [1.5, 2.5]


def test_outputs_cannot_be_forced():
    io = image()
    for change in (
        lambda: io.force(io.find('torch_current'), 1.0),
        lambda: io.release(io.find('torch_current')),
    ):
        with pytest.raises(
            InvalidInputError, match=r'analog_output\.1 is an output; only inputs can be forced'
        ):
            change()


@pytest.mark.parametrize(
    ('name', 'value', 'valid'),
    [
        ('digital_input.2', 2.0, '0 and 1'),
        ('digital_output.1', float('nan'), '0 and 1'),
        ('analog_input.1', float('inf'), 'a finite number'),
        ('analog_output.2', float('nan'), 'a finite number'),
    ],
)
def test_values_that_a_channel_cannot_have_change_nothing(name: str, value: float, valid: str):
    io = image()
    channel = io.find(name)
    with pytest.raises(InvalidInputError, match=f'valid (are|is) {valid}'):
        io.set_value(channel, value)
    if channel.direction == 'input':
        with pytest.raises(InvalidInputError, match=f'valid (are|is) {valid}'):
            io.force(channel, value)
    assert io.value(channel) == 0.0


def test_a_change_wakes_who_waits():
    condition = threading.Condition()
    io = image(condition=condition)
    seen: list[bool] = []

    def wait() -> None:
        with condition:
            seen.append(condition.wait_for(lambda: io.value(io.find('press_ready')) == 1.0, 120.0))

    thread = threading.Thread(target=wait)
    thread.start()
    io.set_inputs('digital', [1])
    thread.join(120.0)
    assert seen == [True]


CHANGES = st.lists(
    st.one_of(
        st.tuples(st.just('set'), st.integers(0, 3), st.booleans()),
        st.tuples(st.just('force'), st.integers(0, 3), st.booleans()),
        st.tuples(st.just('release'), st.integers(0, 3), st.just(value=False)),
    ),
    max_size=20,
)


@given(CHANGES)
def test_the_image_is_the_outside_with_the_forced_values_over_it(changes: list[tuple[str, int, bool]]):
    io = image()
    outside, forced = [False] * 4, {}
    for what, number, value in changes:
        channel = io.channel('digital', 'input', number + 1)
        before = io.bits('digital_inputs').tolist()
        if what == 'set':
            outside[number] = value
            changed = io.set_value(channel, value)
        elif what == 'force':
            forced[number] = value
            io.force(channel, value)
        else:
            forced.pop(number, None)
            io.release(channel)
        expected = [forced.get(i, outside[i]) for i in range(4)]
        assert io.bits('digital_inputs').tolist() == expected
        assert what != 'set' or changed == (expected != before)
        assert {channel.index - 1: bool(v) for channel, v in io.forced().items()} == forced
