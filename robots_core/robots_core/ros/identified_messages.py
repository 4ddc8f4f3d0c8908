"""Messages with the identity of their publisher, which rclpy leaves out.

The identity is the one that `Node.get_publishers_info_by_topic` has as `endpoint_gid`.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any, Final

from rclpy.callback_groups import CallbackGroup
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from rclpy.utilities import get_rmw_implementation_identifier
from rclpy.waitable import NumberOfEntities, Waitable

IDENTIFYING: Final = ('rmw_fastrtps_cpp', 'rmw_fastrtps_dynamic_cpp')
"""Middlewares whose messages come with the identities that the graph has."""
TAKE_FAILED: Final = 401  # RCL_RET_SUBSCRIPTION_TAKE_FAILED: there is none


class _Allocator(ctypes.Structure):  # rcutils_allocator_t
    _fields_ = [(name, ctypes.c_void_p) for name in ('allocate', 'free', 'reallocate', 'zero', 'state')]


class _Bytes(ctypes.Structure):  # rcutils_uint8_array_t
    _fields_ = [
        ('buffer', ctypes.c_void_p),
        ('length', ctypes.c_size_t),
        ('capacity', ctypes.c_size_t),
        ('allocator', _Allocator),
    ]


class _Info(ctypes.Structure):  # rmw_message_info_t
    _fields_ = [
        ('source_timestamp', ctypes.c_int64),
        ('received_timestamp', ctypes.c_int64),
        ('publication_sequence_number', ctypes.c_uint64),
        ('reception_sequence_number', ctypes.c_uint64),
        ('implementation', ctypes.c_char_p),
        ('identity', ctypes.c_uint8 * 16),
        ('from_intra_process', ctypes.c_bool),
    ]


@cache
def _functions() -> tuple[Any, Any]:
    take = ctypes.CDLL('librcl.so').rcl_take_serialized_message  # loaded by rclpy already
    take.argtypes, take.restype = [ctypes.c_void_p] * 4, ctypes.c_int
    allocator = ctypes.CDLL('librcutils.so').rcutils_get_default_allocator
    allocator.restype = _Allocator
    return take, allocator


def publishers_are_identified() -> bool:
    """Whether the middleware is one that says whose a message is."""
    return get_rmw_implementation_identifier() in IDENTIFYING


class IdentifiedMessages:
    """Takes serialized messages of a subscription.

    Args:
        subscription: Whose messages nothing else takes.

    Raises:
        RuntimeError: the middleware lays out a message's info in another way.
    """

    def __init__(self, subscription: Subscription) -> None:
        self._handle = subscription.handle
        self._take, allocator = _functions()
        self._bytes, self._info = _Bytes(allocator=allocator()), _Info()
        self._arguments = (
            self._handle.pointer,
            ctypes.addressof(self._bytes),
            ctypes.addressof(self._info),
            None,
        )
        self._checked = False

    def take(self) -> tuple[bytes, bytes] | None:
        """The oldest message and its publisher's identity; None if there is none."""
        with self._handle:
            code = self._take(*self._arguments)
        if code == TAKE_FAILED:
            return None
        if code != 0:
            raise RuntimeError(f'taking a message failed with code {code}')
        if not self._checked:
            self._check()
        return ctypes.string_at(self._bytes.buffer, self._bytes.length), bytes(self._info.identity)

    def _check(self) -> None:
        implementation, expected = self._info.implementation, get_rmw_implementation_identifier()
        if implementation != expected.encode():
            raise RuntimeError(f"a message's info names {implementation!r}, the middleware is {expected}")
        self._checked = True


class IdentifiedSubscription(Waitable):
    """Has an executor call back with messages and their publishers' identities.

    Args:
        subscription: The subscription, which no executor takes messages from.
        callback_group: Of the callbacks.
        callback: Gets a message, and its publisher's identity.
    """

    def __init__(
        self,
        subscription: Subscription,
        callback_group: CallbackGroup,
        callback: Callable[[Any, bytes], None],
    ) -> None:
        super().__init__(callback_group)  # type: ignore[no-untyped-call]
        self._subscription, self._callback = subscription, callback
        self._messages = IdentifiedMessages(subscription)
        self._index: int | None = None

    def __enter__(self) -> None:
        self._subscription.handle.__enter__()

    def __exit__(self, *exception: object) -> None:
        self._subscription.handle.__exit__(*exception)

    def get_num_entities(self) -> NumberOfEntities:
        """See `Waitable`."""
        return NumberOfEntities(num_subs=1)

    def add_to_wait_set(self, wait_set: Any) -> None:
        """See `Waitable`."""
        self._index = wait_set.add_subscription(self._subscription.handle)

    def is_ready(self, wait_set: Any) -> bool:
        """See `Waitable`."""
        return bool(wait_set.is_ready('subscription', self._index))

    def take_data(self) -> tuple[bytes, bytes] | None:
        """See `Waitable`."""
        return self._messages.take()

    async def execute(self, taken_data: tuple[bytes, bytes] | None) -> None:
        """See `Waitable`."""
        if taken_data is not None:
            self._deliver(*taken_data)

    def deliver_waiting(self) -> None:
        """Call back with all messages that have come, now."""
        while (taken := self._messages.take()) is not None:
            self._deliver(*taken)

    def _deliver(self, data: bytes, identity: bytes) -> None:
        subscription = self._subscription
        self._callback(
            data if subscription.raw else deserialize_message(data, subscription.msg_type), identity
        )
