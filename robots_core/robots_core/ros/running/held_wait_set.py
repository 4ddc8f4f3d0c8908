"""HeldWaitSet: entities of nodes, waited for together."""

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack, suppress
from typing import Any, Final

from rclpy.context import Context
from rclpy.exceptions import InvalidHandle
from rclpy.guard_condition import GuardCondition
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.waitable import NumberOfEntities

# In the order in which `WaitSet` takes their numbers, and in which it returns them.
KINDS: Final = ('subscription', 'guard_condition', 'timer', 'client', 'service')
# ns; a message takes 20 us of the processor, with the events of 20 subscriptions in each wait 47 us.
EVENT_PERIOD: Final = 100_000_000


class LatchedGuardCondition(GuardCondition):
    """Keeps that it was triggered until an executor takes it.

    With Fast DDS, a wait that ends resets all guard conditions after it has checked each of them: one that
    is triggered in between has never been triggered (ros2/rmw_fastrtps#895). As such a wait ends anyway,
    `LeanExecutor` takes what was triggered from here.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)  # type: ignore[no-untyped-call]
        self._triggered = False

    def trigger(self) -> None:
        """As `GuardCondition.trigger`; from any thread."""
        self._triggered = True
        super().trigger()  # type: ignore[no-untyped-call]

    def take(self) -> bool:
        """It was triggered since the last call."""
        if not self._triggered:
            return False
        self._triggered = False
        return True


class HeldWaitSet:
    """A wait set that is filled again for each wait; what is destroyed meanwhile is kept until `close`.

    Args:
        context: Of the entities.
        entities: By kind, one of `KINDS`.
        waitables: Each with any number of entities.
        events: Waitables that may be up to 0.1 s late while others are ready all the time.
    """

    def __init__(
        self,
        context: Context,
        entities: Mapping[str, Sequence[Any]],
        waitables: Sequence[Any] = (),
        events: Sequence[Any] = (),
    ) -> None:
        self._held = ExitStack()
        self._keep(context.handle)
        self._entities = {kind: self._hold(entities.get(kind, ())) for kind in KINDS}
        self._waitables, self._events = (
            [one for one in ones if _may_run(one) and self._keep(one)] for ones in (waitables, events)
        )
        self._events_due = 0
        self._waits_for_events = False
        total = NumberOfEntities(*(len(self._entities[kind]) for kind in KINDS))
        for waitable in (*self._waitables, *self._events):
            total += waitable.get_num_entities()
        counts = (getattr(total, name) for name in NumberOfEntities.__slots__)
        self._wait_set = rclpy_implementation.WaitSet(*counts, context.handle)
        self._adds: list[tuple[Callable[[Any], object], Any]] = [
            (getattr(self._wait_set, f'add_{kind}'), entity.handle)
            for kind in KINDS
            for entity in self._entities[kind].values()
        ]

    def wait(self, timeout: int) -> None:
        """Wait until anything is ready, or until events are due.

        Args:
            timeout: ns; negative: without end.
        """
        wait_set = self._wait_set
        wait_set.clear_entities()
        for add, handle in self._adds:
            add(handle)
        self._waitables = [one for one in self._waitables if _lives(one.add_to_wait_set, wait_set)]
        until_events = self._events_due - time.monotonic_ns()
        self._waits_for_events = until_events <= 0 and bool(self._events)
        if self._waits_for_events:
            self._events = [one for one in self._events if _lives(one.add_to_wait_set, wait_set)]
        elif self._events and not 0 <= timeout < until_events:
            timeout = until_events
        wait_set.wait(timeout)
        if self._waits_for_events:
            self._events_due = time.monotonic_ns() + EVENT_PERIOD

    def ready(self) -> list[tuple[str, Any]]:
        """Kinds and entities that the last wait has found ready, in the order of their kinds."""
        found: list[tuple[str, Any]] = []
        for kind, entities in self._entities.items():
            if entities:
                pointers = self._wait_set.get_ready_entities(kind)
                ready = [entities[pointer] for pointer in pointers if pointer in entities]
                if kind == 'guard_condition':
                    ready = _triggered(entities.values(), ready)
                found += [(kind, entity) for entity in ready]
        return found

    def take_waitables(self) -> list[tuple[Any, Any]]:
        """Waitables and events that the last wait has found ready, and what is taken from each."""
        found: list[tuple[Any, Any]] = []
        for waitable in (*self._waitables, *(self._events if self._waits_for_events else ())):
            if waitable.is_ready(self._wait_set):
                with suppress(InvalidHandle):
                    found.append((waitable, waitable.take_data()))
        return found

    def close(self) -> None:
        """Let go of all entities."""
        self._adds.clear()
        self._held.close()

    def _hold(self, entities: Sequence[Any]) -> dict[int, Any]:
        return {
            entity.handle.pointer: entity
            for entity in entities
            if _may_run(entity) and self._keep(entity.handle)
        }

    def _keep(self, handle: Any) -> bool:
        return _lives(self._held.enter_context, handle)


def _triggered(guard_conditions: Iterable[Any], ready: Sequence[Any]) -> list[Any]:
    return [
        one
        for one in guard_conditions
        if (one.take() if isinstance(one, LatchedGuardCondition) else one in ready)
    ]


def _may_run(entity: Any) -> bool:
    group = entity.callback_group
    return group is None or bool(group.can_execute(entity))


def _lives(use: Callable[[Any], object], argument: Any) -> bool:
    """Use an entity; False if it is destroyed, which another thread may do at any time."""
    try:
        use(argument)
    except InvalidHandle:
        return False
    return True
