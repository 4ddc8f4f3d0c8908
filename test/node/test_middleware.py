"""What the suite's processes choose of the middleware."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from robots_core.ros.running.middleware import (
    DISCOVERY,
    LOOPBACK,
    NETWORK,
    PROFILES,
    QOS_FROM_PROFILE,
    TRANSPORTS,
    choose_transports,
)

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


@pytest.fixture
def no_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing is chosen yet; what a test chooses is forgotten after it."""
    for name in (DISCOVERY, TRANSPORTS, QOS_FROM_PROFILE, 'RMW_IMPLEMENTATION', *PROFILES):
        monkeypatch.setenv(name, '')
        monkeypatch.delenv(name)


def chosen() -> dict[str, str]:
    return {name: os.environ[name] for name in (DISCOVERY, *PROFILES) if name in os.environ}


@pytest.mark.usefixtures('no_choice')
@pytest.mark.parametrize('reach', ['', 'SUBNET', 'SYSTEM_DEFAULT'])
def test_discovery_beyond_this_machine_keeps_its_range(monkeypatch: pytest.MonkeyPatch, reach: str) -> None:
    monkeypatch.setenv(DISCOVERY, reach)
    choose_transports()
    assert chosen() == {DISCOVERY: reach, **NETWORK}


@pytest.mark.usefixtures('no_choice')
def test_a_process_of_this_machine_alone_stays_on_the_loopback_interface_whoever_starts_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    choose_transports()
    assert chosen() == NETWORK
    monkeypatch.setenv(DISCOVERY, 'LOCALHOST')
    choose_transports()
    assert os.environ.items() >= LOOPBACK.items()
    choose_transports()  # in its children
    assert os.environ.items() >= LOOPBACK.items()


@pytest.mark.usefixtures('no_choice')
@pytest.mark.parametrize('name', PROFILES)
def test_a_profile_of_the_user_stays(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(DISCOVERY, 'LOCALHOST')
    monkeypatch.setenv(name, '/etc/mine.xml')
    choose_transports()
    assert chosen() == {DISCOVERY: 'LOCALHOST', name: '/etc/mine.xml'}


@pytest.mark.usefixtures('no_choice')
def test_another_middleware_gets_no_profile_of_fast_dds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_cyclonedds_cpp')
    choose_transports()
    assert chosen() == {}
