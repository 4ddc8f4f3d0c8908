"""Outputs of a program's node that has died."""

from __future__ import annotations

from typing import Any

from std_msgs.msg import Float64MultiArray, UInt8MultiArray

from bench import EVERY_STATE, Bench
from robots_controller.live_cell.processes.node_restarts import OrphanedOutputs


def test_images_get_fail_safe_values_until_they_are_handed_back(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    digital = bench.collect('digital_outputs', UInt8MultiArray, EVERY_STATE, lambda m: list(m.data))
    analog = bench.collect('analog_outputs', Float64MultiArray, EVERY_STATE, lambda m: list(m.data))
    left = OrphanedOutputs(bench.peer, {'digital_output.2': None, 'analog_output.2': 2.5})
    left.take_over({'digital': UInt8MultiArray(data=[1, 1, 0]), 'analog': Float64MultiArray(data=[7.0, 0.0])})
    bench.wait(lambda: digital and analog, 'the images')
    assert (digital, analog) == ([[0, 1, 0]], [[0.0, 2.5]])
    assert left.hand_back() == ['digital_output.2=1.0', 'analog_output.2=2.5']
    bench.wait(lambda: bench.peer.count_publishers('digital_outputs') == 0, 'no publisher')
