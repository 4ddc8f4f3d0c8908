"""Clocks of nodes that are set to simulated times."""

from collections.abc import Callable

from rclpy.clock import Clock, JumpHandle, JumpThreshold, ROSClock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.time import Time


def set_clock(clock: Clock, time: int) -> None:
    """Set a node's clock to a simulated time, ns."""
    assert isinstance(clock, ROSClock)
    clock.set_ros_time_override(Time(nanoseconds=time, clock_type=ClockType.ROS_TIME))
    if not clock.ros_time_is_active:
        clock._set_ros_time_is_active(True)  # noqa: SLF001  # as rclpy's TimeSource does


def on_clock_set(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Call a function whenever a simulated clock is set, as long as the handle is kept."""
    threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(threshold, post_callback=lambda _: call())
