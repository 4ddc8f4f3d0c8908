"""Signs of life between nodes."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any

import pytest

from robots_core.ros.peers.heartbeat import Heartbeat, HeartbeatWatch
from robots_core.ros.running.lean_executor import ExecutorWatch, LeanExecutor
from robots_core.ros.timed_node import TimedNode

LONG = 60.0  # s


def test_a_node_that_was_started_anew_was_lost_although_nobody_has_missed_it(ros_nodes: Any) -> None:
    changes: list[tuple[str, str]] = []
    watcher = ros_nodes.add(TimedNode('watcher', context=ros_nodes.context))
    seen: list[str] = []
    watch = HeartbeatWatch(
        watcher, ['drive'], LONG, lambda *change: changes.append(change), on_seen=seen.append
    )
    node = ros_nodes.add(TimedNode('drive', context=ros_nodes.context))
    first = Heartbeat(node)
    ros_nodes.wait_for(lambda: watch._processes, what='the first sign of life')
    assert (changes, seen) == ([], ['drive'])
    first.stop()
    second = Heartbeat(node)
    ros_nodes.wait_for(lambda: len(changes) == 2, what='both changes')
    second.stop()
    assert changes == [('drive', 'drive has died and was started anew'), ('drive', '')]
    assert seen == ['drive']
    assert watch.lost == ()


@pytest.mark.parametrize(
    ('timeout', 'remaining', 'seconds'),
    [
        # Nothing is silent, or for longer than a regular check; soon; at once.
        (0.5, math.inf, 0.1),
        (0.5, 0.25, 0.1),
        (0.5, 0.05, 0.05),
        (0.5, 0.0, 0.0125),
        # However long the timeout: less than a process takes to be started again.
        (LONG, math.inf, 0.2),
        (LONG, 0.0, 0.2),
    ],
)
def test_the_next_check_comes_when_the_silence_is_as_long_as_the_timeout(
    ros_nodes: Any, timeout: float, remaining: float, seconds: float
) -> None:
    watcher = ros_nodes.add(TimedNode('watcher', context=ros_nodes.context))
    watch = HeartbeatWatch(watcher, ['drive'], timeout, lambda *_: None)
    watch._check_again(remaining)
    assert 1e-9 * watch._timer.timer_period_ns == pytest.approx(seconds, abs=1e-8)  # whole nanoseconds


def test_a_fast_loop_looks_itself_and_the_executor_calls_back(ros_nodes: Any) -> None:
    called: list[tuple[str, ...]] = []
    threads: set[int] = set()

    def call_back(*what: str) -> None:
        called.append(what)
        threads.add(threading.get_ident())

    watcher = ros_nodes.add(TimedNode('watcher', context=ros_nodes.context))
    watch = HeartbeatWatch(watcher, ['drive'], 0.2, call_back, call_back, loop_period=0.004)
    node = ros_nodes.add(TimedNode('drive', context=ros_nodes.context))
    heartbeat = Heartbeat(node)
    now = watch.due = 100.0  # s, on a clock of its own

    def look_until(done: Callable[[], bool], what: str) -> None:
        def look() -> bool:
            nonlocal now
            now = watch.due
            watch.poll(now)
            assert 0.0 < watch.due - now <= 0.04
            return done()

        ros_nodes.wait_for(look, what=what)

    look_until(lambda: not watch.unseen, 'the first sign of life')
    heartbeat.stop()
    look_until(lambda: watch.lost == ('drive',), 'the loss')
    ros_nodes.wait_for(lambda: len(called) == 2, what='both calls')
    assert called == [('drive',), ('drive', 'no sign of life of drive for 0.2 s: is it still running?')]
    assert threading.get_ident() not in threads
    assert len(threads) == 1


def test_a_slow_loop_does_not_look(ros_nodes: Any) -> None:
    watcher = ros_nodes.add(TimedNode('watcher', context=ros_nodes.context))
    watch = HeartbeatWatch(watcher, ['drive'], 0.2, lambda *_: None, loop_period=0.04)
    assert watch.due == math.inf
    heartbeat = Heartbeat(ros_nodes.add(TimedNode('drive', context=ros_nodes.context)))
    ros_nodes.wait_for(lambda: not watch.unseen, what='the first sign of life, by a timer')
    heartbeat.stop()


def test_a_node_whose_callback_does_not_return_is_lost_until_it_does(ros_nodes: Any) -> None:
    watcher = ros_nodes.add(TimedNode('watcher', context=ros_nodes.context))
    watch = HeartbeatWatch(watcher, ['planner'], 0.2, lambda *_: None)
    ended, returns, hung = threading.Event(), threading.Event(), threading.Event()
    executor = LeanExecutor(context=ros_nodes.context)
    node = TimedNode('planner', context=ros_nodes.context)
    executor.add_node(node)

    def spin() -> None:
        while not ended.is_set():
            executor.spin_once(0.02)

    thread = threading.Thread(target=spin)
    thread.start()
    heartbeat = Heartbeat(node, ExecutorWatch(executor, hung.set, timeout=0.5).check)
    try:
        ros_nodes.wait_for(lambda: not watch.unseen, what='the first sign of life')
        executor.create_task(returns.wait)
        ros_nodes.wait_for(hung.is_set, what='the end of the signs of life')
        ros_nodes.wait_for(lambda: watch.lost == ('planner',), what='the loss')
        returns.set()
        ros_nodes.wait_for(lambda: watch.lost == (), what='the next sign of life')
    finally:
        returns.set()
        heartbeat.stop()
        ended.set()
        thread.join()
        executor.shutdown()
        node.destroy_node()
