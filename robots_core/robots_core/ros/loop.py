"""Loops of a node: what is called in each period."""

from collections.abc import Callable
from typing import Protocol

from rclpy.clock import Clock, JumpHandle, JumpThreshold
from rclpy.duration import Duration
from rclpy.node import Node

from robots_core.ros.lockstep.timed_work import ScheduledLoop


class Loop(Protocol):
    """Something that is called periodically until it is stopped."""

    @property
    def alive(self) -> bool:
        """It goes on."""

    @property
    def missed(self) -> int:
        """Periods given up: the machine was too busy, or the clock jumped."""

    @property
    def realtime(self) -> bool:
        """The system granted first-in-first-out scheduling."""

    @property
    def idle_latency_kept(self) -> bool:
        """The system keeps to the idle latency that was asked for."""

    def stop(self) -> None:
        """End it; called by its own work, that call is the last."""


def on_clock_set(clock: Clock, call: Callable[[], None]) -> JumpHandle:
    """Call a function whenever a simulated clock is set, as long as the handle is kept."""
    threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
    return clock.create_jump_callback(threshold, post_callback=lambda _: call())


class ClockLoops:
    """The loops of a node that follows `/clock`, called in the executor's thread as the clock advances."""

    def __init__(self, node: Node) -> None:
        self._clock = node.get_clock()
        self._loops: list[ScheduledLoop] = []
        self._advanced = node.create_guard_condition(self._run)
        self._jumps = on_clock_set(self._clock, self._advanced.trigger)

    def add(self, loop: ScheduledLoop) -> ScheduledLoop:
        """Run a loop from now on."""
        self._loops = [one for one in self._loops if one.alive] + [loop]
        return loop

    def _run(self) -> None:
        now = self._clock.now().nanoseconds
        for loop in self._loops:
            loop.run(now)
