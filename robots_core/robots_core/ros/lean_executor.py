"""LeanExecutor: takes messages and calls callbacks with a fraction of the cost of rclpy's executors."""

from contextlib import ExitStack, suppress
from typing import Any

from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.subscription import Subscription
from rclpy.task import Task
from rclpy.utilities import timeout_sec_to_nsec

_KINDS = ('timer', 'subscription', 'guard_condition', 'client', 'service')


class LeanExecutor(Executor):
    """Calls callbacks in the thread that spins; they are plain functions, those of waitables are coroutines.

    rclpy's `SingleThreadedExecutor` looks through all entities of its nodes and builds a wait set in every
    round. This one does so when entities were created or destroyed; a destroyed one is kept until then.
    Any thread may create and destroy them. rclpy's other executors are no choice: with the packages from
    PyPI, `MultiThreadedExecutor` takes many times the processor and `EventsExecutor` hangs.

    `shutdown` is called by the thread that spins, or after it has ended.
    """

    def __init__(self, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._changed = True
        self._held = ExitStack()
        self._entities: dict[str, dict[int, Any]] = {}  # by kind and pointer
        self._adds: list[tuple[Any, Any]] = []  # how to put an entity into the wait set, and its handle
        self._waitables: list[Any] = []
        self._wait_set: Any = None
        self._calls = {
            'timer': _call_timer,
            'subscription': _call_subscription,
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
        self._held.close()
        self._adds.clear()
        return bool(super().shutdown(timeout_sec))

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Wait until anything is ready, and call back once for each that is.

        Args:
            timeout_sec: s; without end by default.

        Raises:
            ExternalShutdownException: the context was shut down.
        """
        if self._tasks:
            self._run_tasks()
        if self._changed:
            self._changed = False
            self._gather()
        self._wait(0 if self._tasks else timeout_sec_to_nsec(timeout_sec))
        ready = {kind: self._wait_set.get_ready_entities(kind) for kind in _KINDS}
        with suppress(InvalidHandle):  # destroyed by another thread
            for waitable in self._waitables:
                if waitable.is_ready(self._wait_set):
                    taken = waitable.take_data()
                    self._tasks.append((Task(waitable.execute, (taken,), executor=self), None, None))
        for kind, pointers in ready.items():
            entities, call = self._entities[kind], self._calls[kind]
            for pointer in pointers:
                if (entity := entities.get(pointer)) is not None:
                    call(entity)

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

    def _wait(self, timeout: int) -> None:
        while not self._fill():
            self._gather()
        self._wait_set.wait(timeout)
        if not self.context.ok():
            raise ExternalShutdownException

    def _fill(self) -> bool:
        """Put all entities into the wait set; False if another thread has destroyed one of them."""
        wait_set = self._wait_set
        wait_set.clear_entities()
        for add, handle in self._adds:
            add(handle)
        try:
            for waitable in self._waitables:
                waitable.add_to_wait_set(wait_set)
        except InvalidHandle:
            return False
        return True

    def _gather(self) -> None:
        """Hold all entities, in a wait set of their number."""
        self._held.close()
        found: dict[str, list[Any]] = {kind: [] for kind in _KINDS}
        waitables: list[Any] = []
        for node in self.get_nodes():
            found['timer'] += node.timers
            found['subscription'] += node.subscriptions
            found['guard_condition'] += node.guards
            found['client'] += node.clients
            found['service'] += node.services
            waitables += node.waitables
        self._entities = {kind: self._hold(entities) for kind, entities in found.items()}
        self._waitables = [
            one for one in waitables if one.callback_group.can_execute(one) and self._keep(one)
        ]
        self._keep(self._guard.handle)
        self._keep(self.context.handle)
        counts = [len(self._entities[kind]) for kind in ('subscription', 'guard_condition', 'timer')]
        counts += [len(self._entities[kind]) for kind in ('client', 'service')] + [0]
        counts[1] += 1
        for waitable in self._waitables:
            number = waitable.get_num_entities()
            more = (
                number.num_subscriptions,
                number.num_guard_conditions,
                number.num_timers,
                number.num_clients,
                number.num_services,
                number.num_events,
            )
            counts = [count + one for count, one in zip(counts, more, strict=True)]
        self._wait_set = rclpy_implementation.WaitSet(*counts, self.context.handle)
        self._adds = [(self._wait_set.add_guard_condition, self._guard.handle)]
        for kind, entities in self._entities.items():
            add = getattr(self._wait_set, f'add_{kind}')
            self._adds += [(add, entity.handle) for entity in entities.values()]

    def _hold(self, entities: list[Any]) -> dict[int, Any]:
        return {
            entity.handle.pointer: entity
            for entity in entities
            if entity.callback_group.can_execute(entity) and self._keep(entity.handle)
        }

    def _keep(self, handle: Any) -> bool:
        """Keep it from being destroyed meanwhile; False if it is destroyed already."""
        try:
            self._held.enter_context(handle)
        except InvalidHandle:
            return False
        return True

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


def _call_timer(timer: Any) -> None:
    if timer.handle.is_timer_ready():  # a cancelled one is not
        timer.handle.call_timer()
        timer.callback()


def _call_subscription(subscription: Any) -> None:
    taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is None:
        return
    if subscription._callback_type is Subscription.CallbackType.MessageOnly:  # noqa: SLF001
        subscription.callback(taken[0])
    else:
        subscription.callback(*taken)


def _call_guard_condition(guard_condition: Any) -> None:
    if guard_condition.callback is not None:
        guard_condition.callback()


def _call_service(service: Any) -> None:
    request, header = service.handle.service_take_request(service.srv_type.Request)
    if header is not None:
        service.send_response(service.callback(request, service.srv_type.Response()), header)
