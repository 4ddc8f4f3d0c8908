"""Messages with the identity of their publisher, which rclpy leaves out.

The identity is the one that `Node.get_publishers_info_by_topic` has as `endpoint_gid`.
"""

from __future__ import annotations

import ctypes
from contextlib import suppress
from functools import cache
from typing import Any, Final

from rclpy.exceptions import InvalidHandle
from rclpy.serialization import deserialize_message
from rclpy.subscription import Subscription
from rclpy.utilities import get_rmw_implementation_identifier

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
    """Whether the middleware identifies the publisher of a message."""
    return get_rmw_implementation_identifier() in IDENTIFYING


class IdentifiedMessages:
    """Takes the messages of a subscription.

    Args:
        subscription: Whose messages nothing else takes.

    Raises:
        RuntimeError: the middleware lays out a message's info in another way.
    """

    def __init__(self, subscription: Subscription) -> None:
        self._subscription, self._handle = subscription, subscription.handle
        self._take, allocator = _functions()
        self._bytes, self._info = _Bytes(allocator=allocator()), _Info()
        self._arguments = (
            self._handle.pointer,
            ctypes.addressof(self._bytes),
            ctypes.addressof(self._info),
            None,
        )
        self._implementation = get_rmw_implementation_identifier().encode()
        self.sent = 0
        """When the message that was taken last was sent, ns on the clock of the sender's system."""
        self.received = 0
        """When it arrived, ns on the clock of this system."""

    def take(self) -> tuple[Any, bytes] | None:
        """The oldest message and its publisher's identity; None if there is none."""
        code = TAKE_FAILED
        with suppress(InvalidHandle), self._handle:  # destroyed by another thread
            code = self._take(*self._arguments)
        if code == TAKE_FAILED:
            return None
        if code != 0:
            raise RuntimeError(f'taking a message failed with code {code}')
        if self._info.implementation != self._implementation:
            raise RuntimeError(f"a message's info names {self._info.implementation!r} as the middleware")
        message = ctypes.string_at(self._bytes.buffer, self._bytes.length)
        if not self._subscription.raw:
            message = deserialize_message(message, self._subscription.msg_type)
        self.sent, self.received = int(self._info.source_timestamp), int(self._info.received_timestamp)
        return message, bytes(self._info.identity)


def identify(subscription: Any) -> Any:
    """The subscription, to which `deliver` gives messages with their publishers' identities from now on."""
    subscription.identified = IdentifiedMessages(subscription)
    return subscription


def deliver(subscription: Any) -> bool:
    """Call back with the oldest message; False if there is none."""
    identified = getattr(subscription, 'identified', None)
    if identified is not None:
        taken = identified.take()
    else:
        taken = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    if taken is None:
        return False
    if subscription._callback_type is Subscription.CallbackType.MessageOnly:  # noqa: SLF001
        subscription.callback(taken[0])
    else:
        subscription.callback(*taken)
    return True
