"""A recorded PLC, replayed into the real nodes in lock-step; their answers against expected ones."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from std_srvs.srv import Trigger

from robots_controller.nodes.bags.bag_player import BagPlayer
from robots_controller.nodes.bags.bag_recorder import BagRecorder
from robots_controller.nodes.io_bridge_node import IoBridgeNode
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_controller.recording.bag_file import read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_controller.testing import assert_bag_matches
from robots_core.ros.lockstep.phases import START
from robots_core.ros.timed_node import TimedNode
from written_bags import BAG_TYPES, write_bag

T = BAG_TYPES.types
IO_MAP = """
inputs:
  - topic: /plc/words
    type: UInt16MultiArray
    field: data[0]
    bits: {0: digital_input.1, 1: digital_input.2}
  - topic: /plc/words
    type: UInt16MultiArray
    field: data[0]
    bit: 8
    channel: digital_input.3
    debounce: 0.1
  - {topic: /plc/level, type: Float32, channel: analog_input.1, scale: 0.5}
outputs:
  - {topic: /plc/answer, type: UInt16, bit: 3, channel: digital_output.1, qos: {durability: transient_local}}
  - {topic: /plc/current, type: Float64, channel: analog_output.1, qos: {durability: transient_local}}
"""
# Answers every part: its number, and an acknowledgement by output 1 until it is gone, with the level doubled.
PROGRAM = """
for part = 1, 3 do
  while not getDigitalInput(1) do wait(0.005) end
  setAnalogOutput(1, 2 * getAnalogInput(1) + part)
  setDigitalOutput(1, true)
  while getDigitalInput(1) do wait(0.005) end
  setDigitalOutput(1, false)
end
while not getDigitalInput(3) do wait(0.005) end
setDigitalOutput(2, true)
"""
PARTS = ((0.4, 0.7, 3.0), (1.1, 1.3, 5.0), (1.7, 2.1, 7.0))  # there from, until, level
BOUNCES = ((2.3, 2.33), (2.36, 2.4), (2.45, 2.8))  # of the contact at bit 8; the last one lasts
DEBOUNCE = 0.1  # s
WORDS = 300  # of the PLC, at 100 Hz
END = 3.1  # s
# The bridge looks every 20 ms, the program every 5 ms.
DELAY = 0.025  # s
TOLERANCES = f"""
align: /plc/words
default: {{time: {DELAY}}}
ignore: [/plc/words]
"""


def words(value: int) -> Any:
    layout = T['std_msgs/msg/MultiArrayLayout']([], 0)
    return T['std_msgs/msg/UInt16MultiArray'](layout, np.array([value], dtype=np.uint16))


def plc_recording() -> Iterator[tuple[float, str, Any]]:
    """The messages of a PLC: a word at 100 Hz, and the level before each part."""
    for k in range(WORDS):
        t = 0.01 * k
        part = any(there <= t < gone for there, gone, _ in PARTS)
        contact = any(there <= t < gone for there, gone in BOUNCES)
        yield t, '/plc/words', words(part | contact << 8)
    for there, _, level in PARTS:
        yield there - 0.3, '/plc/level', T['std_msgs/msg/Float32'](level)


def expectation(*, first_level: float = 3.0) -> Iterator[tuple[float, str, Any]]:
    """What the nodes answer, worked out by hand from the recording; analog values are exact in binary."""

    def image(topic: str, values: list[float]) -> tuple[str, Any]:
        digital = topic.startswith('/digital')
        kind = T['std_msgs/msg/UInt8MultiArray' if digital else 'std_msgs/msg/Float64MultiArray']
        size = len(values)
        labels = [] if 'inputs' in topic else [f'{topic[1:-1]}.1..{size}']
        dims = [T['std_msgs/msg/MultiArrayDimension'](label, size, size) for label in labels]
        return topic, kind(
            T['std_msgs/msg/MultiArrayLayout'](dims, 0), np.array(values, 'u1' if digital else float)
        )

    yield 0.0, '/plc/words', words(0)  # aligns the bags
    yield -1.0, *image('/digital_inputs', [0, 0, 0])
    yield -1.0, *image('/analog_inputs', [0.0])
    yield -1.0, *image('/digital_outputs', [0, 0, 0])
    yield -1.0, *image('/analog_outputs', [0.0, 0.0])
    yield -1.0, '/plc/answer', T['std_msgs/msg/UInt16'](0)
    yield -1.0, '/plc/current', T['std_msgs/msg/Float64'](0.0)
    for number, (there, gone, level) in enumerate(PARTS, 1):
        shown = 0.5 * (first_level if number == 1 else level)
        yield there - 0.3, *image('/analog_inputs', [shown])
        yield there, *image('/digital_inputs', [1, 0, 0])
        yield there, *image('/analog_outputs', [2.0 * shown + number, 0.0])
        yield there, '/plc/current', T['std_msgs/msg/Float64'](2.0 * shown + number)
        yield there, *image('/digital_outputs', [1, 0, 0])
        yield there, '/plc/answer', T['std_msgs/msg/UInt16'](8)
        yield gone, *image('/digital_inputs', [0, 0, 0])
        yield gone, *image('/digital_outputs', [0, 0, 0])
        yield gone, '/plc/answer', T['std_msgs/msg/UInt16'](0)
    lasting, end = BOUNCES[-1]
    yield lasting + DEBOUNCE, *image('/digital_inputs', [0, 0, 1])
    yield lasting + DEBOUNCE, *image('/digital_outputs', [0, 1, 0])
    yield end + DEBOUNCE, *image('/digital_inputs', [0, 0, 0])


ANSWERS = (
    *(
        '/digital_inputs',
        '/analog_inputs',
        '/digital_outputs',
        '/analog_outputs',
        '/plc/answer',
        '/plc/current',
    ),
)


class Operator(TimedNode):
    """Calls the services of the program's node."""

    def __init__(self, **options: Any) -> None:
        super().__init__('operator', **options)
        self._program_services = {
            name: self.create_client(Trigger, f'lua_program_node/{name}') for name in ('open', 'run')
        }

    def ask(self, name: str) -> Any:
        return self._program_services[name].call_async(Trigger.Request())


def record_answers(ros_nodes: Any, folder: Path) -> Path:
    """Replay the recording into the nodes in lock-step; returns the bag of all messages."""
    (folder / 'map.yaml').write_text(IO_MAP)
    (folder / 'parts.lua').write_text(PROGRAM)
    plan = replay_plan(read_bag(write_bag(folder / 'plc', plc_recording())))
    recorder = ros_nodes.add(
        BagRecorder(folder / 'recorded', namespace='/', lockstep=True, context=ros_nodes.context)
    )
    operator = ros_nodes.add(Operator(**ros_nodes.options(lockstep=True)))
    player = ros_nodes.add(BagPlayer(plan, wait=0.0, **ros_nodes.options(lockstep=True)))
    held = threading.Event()
    io_map, program = str(folder / 'map.yaml'), str(folder / 'parts.lua')
    ros_nodes.add(IoBridgeNode(**ros_nodes.options(io_map=io_map, lockstep=True)))
    sizes = {'digital_size': 3, 'analog_size': 2}
    ros_nodes.add(LuaProgramNode(**ros_nodes.options(program=program, lockstep=True, **sizes)))
    names = ('operator', 'bag_player', 'io_bridge_node', 'lua_program_node')
    run = ros_nodes.coordinate(*names, held=True, on_held=held.set, recorder=recorder)
    ros_nodes.wait_for(held.is_set, what='the first instant')
    for name in ('open', 'run'):
        future = operator.ask(name)
        ros_nodes.wait_for(future.done, what=f'the answer of {name}')
        assert future.result().success, future.result().message
    ros_nodes.call(run.release)
    ros_nodes.wait_for(lambda: run.time > START + round(1e9 * END), what='the end of the recording')
    ros_nodes.call(run.end)
    assert player.complete
    ros_nodes.wait_for(lambda: not recorder.missing(run.sent), what='the whole bag')
    # Before the program's node ends, which sets outputs to their fail-safe values.
    recorder.close()
    return recorder.path


def test_the_nodes_answer_a_recorded_plc_as_expected(ros_nodes: Any, tmp_path: Path) -> None:
    recorded = record_answers(ros_nodes, tmp_path)
    (tmp_path / 'tolerances.yaml').write_text(TOLERANCES)
    expected = write_bag(tmp_path / 'expected', expectation(), latched=ANSWERS)
    comparison = assert_bag_matches(recorded, expected, tmp_path / 'tolerances.yaml')
    assert {result.topic for result in comparison.topics} == set(ANSWERS)

    # The same comparison finds one value that is another, and says where.
    other = write_bag(tmp_path / 'other', expectation(first_level=3.5), latched=ANSWERS)
    with pytest.raises(
        AssertionError, match=r'/analog_inputs at 0\.1000 s, data\[0\]: expected 1\.75, recorded 1\.5'
    ):
        assert_bag_matches(recorded, other, tmp_path / 'tolerances.yaml')
