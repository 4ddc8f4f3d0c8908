"""LeanExecutor: takes messages and calls callbacks with a fraction of the cost of rclpy's executors."""

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from rclpy.context import Context
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.guard_condition import GuardCondition
from rclpy.node import Node
from rclpy.task import Task
from rclpy.utilities import timeout_sec_to_nsec

from robots_core.periodic.realtime import processor_share
from robots_core.periodic.watchdog import CHECKS, Watchdog
from robots_core.ros.peers.identified_messages import deliver
from robots_core.ros.running.held_wait_set import HeldWaitSet

TASK_PERIOD: Final = 0.005  # s between checks whether a coroutine that waits may go on
WITHOUT_END: Final = -1
HUNG: Final = 10.0
"""A callback that takes longer, s, waits for something that does not come."""


class SeldomReady:
    """Takes what is seldom ready out of the wait set that an executor fills and looks through in each round.

    The thread waits until anything is ready, or until `pause`; then it rests until `resume`. All methods are
    called in the executor's thread.

    Args:
        context: Of the entities.
        on_rest: Called in the thread whenever it begins to rest.
    """

    def __init__(self, context: Context, on_rest: Callable[[], None]) -> None:
        self._context, self._on_rest = context, on_rest
        self._guard = GuardCondition(None, None, context)
        self._wait_set = HeldWaitSet(context, {})
        self._error: BaseException | None = None
        self._closed = False
        self._going, self._resting = threading.Event(), threading.Event()
        self._resting.set()
        self._thread = threading.Thread(target=self._run, name='seldom ready', daemon=True)
        self._thread.start()

    @property
    def rests(self) -> bool:
        """The thread rests."""
        return self._resting.is_set()

    @property
    def wait_set(self) -> HeldWaitSet:
        """What the thread has waited for before it rested.

        Raises:
            Exception: what the thread has raised.
        """
        if self._error is not None:
            error, self._error = self._error, None
            raise error
        return self._wait_set

    def resume(self) -> None:
        """Let the thread wait again."""
        self._resting.clear()
        self._going.set()

    def pause(self) -> None:
        """Let the thread rest; what is ready stays so."""
        if not self._resting.is_set():
            self._guard.trigger()
            self._resting.wait()

    def replace(self, entities: Mapping[str, Sequence[Any]], waitables: Sequence[Any]) -> None:
        """Wait for these from now on, see `HeldWaitSet`."""
        self.pause()
        self._wait_set.close()
        self._wait_set = HeldWaitSet(self._context, {**entities, 'guard_condition': [self._guard]}, waitables)
        self.resume()

    def close(self) -> None:
        """End the thread and let go of all entities."""
        self.pause()
        self._closed = True
        self.resume()
        self._thread.join()
        self._wait_set.close()
        self._guard.destroy()

    def _run(self) -> None:
        while True:
            self._going.wait()
            self._going.clear()
            if self._closed:
                return
            try:
                self._wait_set.wait(WITHOUT_END)
            except BaseException as error:  # noqa: BLE001  # raised again in the executor's thread
                self._error = error
            self._resting.set()
            self._on_rest()


class LeanExecutor(Executor):
    """Calls callbacks in the thread that spins; they are plain functions, those of waitables are coroutines.

    rclpy's `SingleThreadedExecutor` looks through all entities of its nodes and builds a wait set in every
    round. This one builds it when entities were created or destroyed, leaves what is seldom ready, services,
    clients and events of publishers, to another thread, and waits for events of subscriptions ten times a
    second while messages come. Any thread may create and destroy entities.

    rclpy's other executors are no choice: with the packages from PyPI, `MultiThreadedExecutor` takes many
    times the processor and `EventsExecutor` hangs.

    `shutdown` is called by the thread that spins, or after it has ended.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._changed = True
        self._often = HeldWaitSet(self.context, {})
        self._seldom = SeldomReady(self.context, self._guard.trigger)
        self._calls = {
            'timer': _call_timer,
            'subscription': deliver,
            'guard_condition': _call_guard_condition,
            'client': self._call_client,
            'service': _call_service,
        }

    def add_node(self, node: Node) -> bool:
        """As `Executor.add_node`."""
        self._changed = True
        return bool(super().add_node(node))

    def remove_node(self, node: Node) -> None:
        """As `Executor.remove_node`."""
        self._changed = True
        super().remove_node(node)

    def wake(self) -> None:
        """End a round that waits; entities were created or destroyed."""
        self._changed = True
        super().wake()

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """As `Executor.shutdown`."""
        self._seldom.close()
        self._often.close()
        return bool(super().shutdown(timeout_sec))

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait until anything is ready, and call back once for each that is.

        Raises:
            ExternalShutdownException: the context was shut down.
        """
        if self._tasks:
            self._run_tasks()
        if self._changed:
            self._gather()
        self._often.wait(timeout_sec_to_nsec(self._patience(timeout_sec)))
        if not self.context.ok():
            raise ExternalShutdownException
        self._call_ready(self._often)
        if self._seldom.rests:
            self._call_ready(self._seldom.wait_set)
            self._seldom.resume()

    def _patience(self, timeout_sec: float | None) -> float | None:
        """How long to wait, s; coroutines may wait for another thread, which does not end the wait."""
        if not self._tasks:
            return timeout_sec
        return TASK_PERIOD if timeout_sec is None or timeout_sec < 0.0 else min(timeout_sec, TASK_PERIOD)

    def _call_ready(self, wait_set: HeldWaitSet) -> None:
        for waitable, taken in wait_set.take_waitables():
            self._tasks.append((Task(waitable.execute, (taken,), executor=self), None, None))
        for kind, entity in wait_set.ready():
            self._calls[kind](entity)

    def _run_tasks(self) -> None:
        with self._tasks_lock:
            tasks, self._tasks = self._tasks, []
        for task, _, _ in tasks:
            task()
            if task.done():
                task.result()  # raises what the task has raised
            else:  # a coroutine waits
                with self._tasks_lock:
                    self._tasks.append((task, None, None))

    def _gather(self) -> None:
        """Wait for the entities that there are now."""
        self._changed = False
        nodes = self.get_nodes()
        often: dict[str, list[Any]] = {
            'timer': [one for node in nodes for one in node.timers],
            'subscription': [one for node in nodes for one in node.subscriptions],
            'guard_condition': [self._guard, *(one for node in nodes for one in node.guards)],
        }
        seldom: dict[str, list[Any]] = {
            'client': [one for node in nodes for one in node.clients],
            'service': [one for node in nodes for one in node.services],
        }
        # The middleware checks events of a subscription with each message: waiting for them in another
        # thread would end that wait with each.
        publishers: list[Any] = [one for node in nodes for one in node.publishers]
        received = [event for one in often['subscription'] for event in one.event_handlers]
        sent = [event for one in publishers for event in one.event_handlers]
        events = {*received, *sent}
        waitables = [one for node in nodes for one in node.waitables if one not in events]
        self._often.close()
        self._often = HeldWaitSet(self.context, often, waitables, received)
        self._seldom.replace(seldom, sent)

    def _call_client(self, client: Any) -> None:
        header, response = client.handle.take_response(client.srv_type.Response)
        if header is None:
            return
        try:
            future = client.get_pending_request(header.request_id.sequence_number)
        except KeyError:  # cancelled
            return
        future._set_executor(self)  # noqa: SLF001  # as rclpy's executors do
        future.set_result(response)


class ExecutorWatch:
    """Notices a callback that does not return, by a task that the executor is given now and then.

    Args:
        executor: The executor; it spins.
        on_hung: Called once when it calls nothing any more.
        timeout: A task that is not done by then never will be, s.
        share: See `Watchdog`.
    """

    def __init__(
        self,
        executor: Executor,
        on_hung: Callable[[], None],
        *,
        timeout: float = HUNG,
        share: Callable[[], float] = processor_share,
    ) -> None:
        self._executor, self._on_hung = executor, on_hung
        self._period = 0.5 * timeout / CHECKS
        self._watchdog = Watchdog(timeout, share)
        self._looking = threading.Lock()
        self._looked = -math.inf
        self._done = True

    def check(self, now: float) -> bool:
        """Whether callbacks return; from any thread, often within the timeout."""
        with self._looking:
            if now - self._looked >= self._period:
                self._looked = now
                if self._watchdog.check(now, alive=self._done):
                    self._on_hung()
                if self._done:
                    self._done = False
                    self._executor.create_task(self._finish)
            return not self._watchdog.lost

    def _finish(self) -> None:
        self._done = True


def _call_timer(timer: Any) -> None:
    if timer.handle.is_timer_ready():  # a cancelled one is not
        timer.handle.call_timer()
        timer.callback()


def _call_guard_condition(guard_condition: Any) -> None:
    if guard_condition.callback is not None:
        guard_condition.callback()


def _call_service(service: Any) -> None:
    request, header = service.handle.service_take_request(service.srv_type.Request)
    if header is not None:
        service.send_response(service.callback(request, service.srv_type.Response()), header)
