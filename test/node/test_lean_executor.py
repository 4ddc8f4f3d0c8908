"""LeanExecutor: what rclpy's executors promise, whichever thread creates and destroys entities."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.guard_condition import GuardCondition
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.waitable import NumberOfEntities, Waitable
from std_msgs.msg import Int64
from std_srvs.srv import Trigger

from bench import Bench
from robots_core.ros.running.held_wait_set import HeldWaitSet
from robots_core.ros.timed_node import TimedNode

UNACKNOWLEDGED = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)


class Intruder(Waitable):
    """Does once what another thread may do: while the executor puts entities into its wait set."""

    def __init__(self, node: Node) -> None:
        super().__init__(node.default_callback_group)
        self.action: Callable[[], object] = lambda: None

    def add_to_wait_set(self, _: Any) -> None:
        """Called in each round."""
        action, self.action = self.action, lambda: None
        action()

    def is_ready(self, _: Any) -> bool:
        """Never."""
        return False

    def get_num_entities(self) -> NumberOfEntities:
        """Of none."""
        return NumberOfEntities()

    def __enter__(self) -> None: ...

    def __exit__(self, *_: object) -> None: ...


def test_publishers_may_be_destroyed_at_any_time(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    received = bench.collect('steps', Int64, 1, lambda message: message.data)
    intruder = Intruder(bench.peer)
    ros_nodes.call(lambda: bench.peer.add_waitable(intruder))
    other = bench.peer.create_publisher(Int64, 'other', 1)
    ros_nodes.call(lambda: None)  # a round that waits for the publisher's events
    done: list[bool] = []
    intruder.action = lambda: done.append(bench.peer.destroy_publisher(other))
    bench.publish('steps', Int64(data=1))
    bench.wait(lambda: done == [True] and received == [1], 'a destroyed publisher and the step')


def test_a_destroyed_subscription_is_not_called_any_more(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    other: list[int] = []
    received = bench.collect('steps', Int64, 1, lambda message: message.data)
    subscription = bench.peer.create_subscription(
        Int64, 'steps', lambda message: other.append(message.data), 1
    )
    bench.publish('steps', Int64(data=1))
    bench.wait(lambda: received == [1] and other == [1], 'both')
    bench.peer.destroy_subscription(subscription)
    bench.wait(lambda: bench.publisher('steps', Int64).get_subscription_count() == 1, 'one subscriber')
    bench.publish('steps', Int64(data=2))
    bench.wait(lambda: received == [1, 2], 'the other')
    assert other == [1]


def test_a_timer_calls_until_it_is_cancelled(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    calls: list[int] = []

    def call() -> None:
        calls.append(len(calls))
        if len(calls) == 3:
            timer.cancel()

    timer = bench.peer.create_timer(1e-3, call)
    later: list[int] = []
    bench.wait(lambda: len(calls) == 3, 'three calls')
    bench.peer.create_timer(1e-3, lambda: later.append(1))
    bench.wait(lambda: len(later) > 3, 'another timer')
    assert calls == [0, 1, 2]


def test_a_guard_condition_is_called_when_it_is_triggered(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    calls: list[int] = []
    guard_condition = bench.peer.create_guard_condition(lambda: calls.append(1))
    guard_condition.trigger()
    bench.wait(lambda: calls == [1], 'a call')


def test_a_trigger_that_the_middleware_has_lost_is_called_in_the_next_round(ros_nodes: Any) -> None:
    node = ros_nodes.add(TimedNode('latched', context=ros_nodes.context))
    calls: list[int] = []
    guard_condition = node.create_guard_condition(lambda: calls.append(1))
    guard_condition._triggered = True  # as of `trigger`, without the middleware
    node.executor.wake()
    ros_nodes.wait_for(lambda: calls == [1], what='a call')
    guard_condition.trigger()
    ros_nodes.wait_for(lambda: calls == [1, 1], what='another call')
    ros_nodes.call(lambda: None)
    assert calls == [1, 1]


def test_a_guard_condition_that_is_triggered_by_its_callback_is_called_again(ros_nodes: Any) -> None:
    node = ros_nodes.add(TimedNode('latched', context=ros_nodes.context))
    calls: list[int] = []

    def call() -> None:
        calls.append(1)
        if len(calls) < 3:
            guard_condition.trigger()

    guard_condition = node.create_guard_condition(call)
    guard_condition.trigger()
    ros_nodes.wait_for(lambda: len(calls) == 3, what='three calls')


def test_a_cancelled_request_is_not_answered(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    asked: list[int] = []

    def answer(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        asked.append(len(asked))
        response.message = str(len(asked))
        return response

    bench.peer.create_service(Trigger, 'ask', answer)
    assert bench.call('ask').message == '1'
    client = bench.peer.create_client(Trigger, 'ask')
    bench.wait(client.service_is_ready, 'the service')

    futures: list[Any] = []

    def ask_and_cancel() -> None:
        futures.append(client.call_async(Trigger.Request()))
        client.remove_pending_request(futures[0])

    # In the thread that takes answers: none can come in between.
    ros_nodes.call(ask_and_cancel)
    assert bench.call('ask').message in ('2', '3')
    bench.wait(lambda: len(asked) == 3, 'three requests')
    assert not futures[0].done()


def test_a_coroutine_waits_without_holding_up_others(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)
    done: list[str] = []
    client = bench.peer.create_client(Trigger, 'ask')

    async def ask() -> None:
        await client.call_async(Trigger.Request())
        done.append('asked')

    bench.peer.create_service(Trigger, 'ask', lambda _, response: done.append('answered') or response)
    bench.wait(client.service_is_ready, 'the service')
    ros_nodes.call(lambda: bench.peer.executor.create_task(ask))
    bench.wait(lambda: 'asked' in done, 'the answer')
    assert done == ['answered', 'asked']


def test_what_a_callback_raises_is_raised_where_the_executor_spins(ros_nodes: Any) -> None:
    bench = Bench(ros_nodes)

    def fail() -> None:
        raise LookupError('of the callback')

    guard_condition = bench.peer.create_guard_condition(fail)
    guard_condition.trigger()
    with pytest.raises(LookupError, match='of the callback'):
        bench.wait(lambda: False, 'an error')


@pytest.mark.parametrize('busy', [True, False])
def test_events_of_a_subscription_are_called_beside_messages_and_without(
    ros_nodes: Any, *, busy: bool
) -> None:
    bench = Bench(ros_nodes)
    events: list[Any] = []
    if busy:
        received = bench.collect('steps', Int64, 1)
        sender = bench.publisher('steps', Int64)
        bench.peer.create_timer(1e-3, lambda: sender.publish(Int64()))
        bench.wait(lambda: received, 'messages')
    callbacks = SubscriptionEventCallbacks(incompatible_qos=events.append, use_default_callbacks=False)
    bench.peer.create_subscription(Int64, 'acknowledged', lambda _: None, 1, event_callbacks=callbacks)
    ros_nodes.call(lambda: None)
    ros_nodes.call(lambda: None)  # a round has waited for the subscription's events
    other = Node('other', context=ros_nodes.context)  # whose publishers do not rebuild the wait set
    for number in (1, 2):
        other.create_publisher(Int64, 'acknowledged', UNACKNOWLEDGED)
        bench.wait(lambda number=number: sum(one.total_count_change for one in events) == number, 'an event')
    other.destroy_node()


def test_a_wait_without_end_ends_for_events_that_it_has_not_waited_for(ros_context: Any) -> None:
    node = Node('held', context=ros_context)
    callbacks = SubscriptionEventCallbacks(incompatible_qos=print, use_default_callbacks=False)
    subscription = node.create_subscription(Int64, 'held', print, 1, event_callbacks=callbacks)
    guard = GuardCondition(None, None, ros_context)
    wait_set = HeldWaitSet(ros_context, {'guard_condition': [guard]}, events=subscription.event_handlers)
    guard.trigger()
    wait_set.wait(-1)  # for events too; the next one is sooner than they are due
    node.create_publisher(Int64, 'held', UNACKNOWLEDGED)
    while not (taken := wait_set.take_waitables()):
        wait_set.wait(-1)
    wait_set.close()
    node.destroy_node()
    assert [event.total_count for _, event in taken] == [1]
