"""What the suite's processes choose of the middleware."""

from __future__ import annotations

import subprocess
import sys

import pytest

LONG = 300_000  # bytes
QUEUED = 40
# Prints how many bytes of the heap are in use more after the last queue than after the first ones.
GROWTH = f"""
import ctypes, time
from robots_core.ros.running.middleware import choose_transports
choose_transports()
import rclpy
from rclpy.qos import QoSProfile
from robots_core.ros.streams.polled_subscription import PolledSubscription
from std_msgs.msg import String

class Heap(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_size_t)
        for name in 'arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost'.split()
    ]

def used():
    heap = mallinfo2()
    return heap.uordblks + heap.hblkhd

mallinfo2 = ctypes.CDLL(None).mallinfo2
mallinfo2.restype = Heap
contexts = [rclpy.Context(), rclpy.Context()]
for context in contexts:
    rclpy.init(context=context)
sender, receiver = (rclpy.create_node(name, context=context) for name, context in zip('ab', contexts))
publisher = sender.create_publisher(String, 'plan', QoSProfile(depth=100))
plans = PolledSubscription(receiver, String, 'plan', QoSProfile(depth=100), raw=True)
while not (plans.publishers and publisher.get_subscription_count()):
    time.sleep(0.001)
short, long = String(data='x'), String(data='x' * {LONG})
for place in range({QUEUED}):
    for number in range({QUEUED}):
        publisher.publish(long if number == place else short)
    taken = 0
    while taken < {QUEUED}:
        taken += sum(1 for _ in plans.take_all())
    if place == 1:
        before = used()
print(used() - before)
"""


@pytest.mark.usefixtures('ros_domain')
def test_a_queue_keeps_no_memory_of_long_messages_that_once_waited_in_it(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    done = subprocess.run([sys.executable, '-P', '-c', GROWTH], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 5 * LONG
