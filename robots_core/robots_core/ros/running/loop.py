"""Loops of a node: what is called in each period."""

from collections.abc import Callable

from rclpy.clock import Clock, JumpHandle, JumpThreshold
from rclpy.duration import Duration

from robots_core.periodic.periodic_thread import PeriodicThread
from robots_core.ros.lockstep.timed_work import ScheduledLoop

Loop = PeriodicThread | ScheduledLoop
"""Called periodically until it is stopped: on the wall clock, or in simulated time."""


def on_clock_set(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Call a function whenever a simulated clock is set, as long as the handle is kept."""
    threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(threshold, post_callback=lambda _: call())
