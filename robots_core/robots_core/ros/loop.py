"""Loops of a node: what is called in each period."""

from collections.abc import Callable
from typing import Protocol

from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.node import Node

from robots_core.periodic_schedule import PeriodicSchedule
from robots_core.ros.lockstep.phases import NANOSECONDS


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


class ClockLoop:
    """Calls `work(now)` at the multiples of a period, as `/clock` reaches them.

    Args:
        work: Called with the time in s.
        period: ns.
    """

    realtime = False
    idle_latency_kept = False

    def __init__(self, work: Callable[[float], None], *, period: int) -> None:
        self._work = work
        self._schedule = PeriodicSchedule(period)
        self._alive = True

    @property
    def alive(self) -> bool:
        """It goes on."""
        return self._alive

    @property
    def missed(self) -> int:
        """Periods that the clock jumped over."""
        return self._schedule.missed

    def stop(self) -> None:
        """End it; called by its own work, that call is the last."""
        self._alive = False

    def run(self, now: int) -> None:
        """Do what is due at `now`, ns."""
        for time in self._schedule.due(now):
            if self._alive:
                self._work(time / NANOSECONDS)


class ClockLoops:
    """The loops of a node that follows `/clock`, called in the executor's thread as the clock advances."""

    def __init__(self, node: Node) -> None:
        self._clock = node.get_clock()
        self._loops: list[ClockLoop] = []
        self._advanced = node.create_guard_condition(self._run)
        threshold = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))
        self._jumps = self._clock.create_jump_callback(
            threshold, post_callback=lambda _: self._advanced.trigger()
        )

    def add(self, loop: ClockLoop) -> ClockLoop:
        """Run a loop from now on."""
        self._loops = [one for one in self._loops if one.alive] + [loop]
        return loop

    def _run(self) -> None:
        now = self._clock.now().nanoseconds
        for loop in self._loops:
            loop.run(now)
