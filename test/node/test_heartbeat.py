"""Signs of life between nodes."""

from __future__ import annotations

from typing import Any

from robots_core.ros.peers.heartbeat import Heartbeat, HeartbeatWatch
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
    # LOOKS looks within the timeout are too few for a test.
    look = watcher.create_timer(0.01, watch._look)
    ros_nodes.wait_for(lambda: watch._processes, what='the first sign of life')
    assert (changes, seen) == ([], ['drive'])
    first.stop()
    second = Heartbeat(node)
    ros_nodes.wait_for(lambda: len(changes) == 2, what='both changes')
    second.stop()
    look.cancel()
    assert changes == [('drive', 'drive has died and was started anew'), ('drive', '')]
    assert seen == ['drive']
    assert watch.lost == ()
