"""Arguments of methods that clients call, and answers to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from asyncua import ua


def wrong_arguments(kinds: Sequence[ua.VariantType], given: Sequence[ua.Variant]) -> Any:
    """The answer to arguments of a wrong number or type; None where they are right.

    Args:
        kinds: Their types.
        given: As the client has sent them.
    """
    if len(given) != len(kinds):
        missing = len(given) < len(kinds)
        codes = ua.StatusCodes
        return ua.StatusCode(codes.BadArgumentsMissing if missing else codes.BadTooManyArguments)
    if all(_is(one, kind) for one, kind in zip(given, kinds, strict=True)):
        return None
    return _invalid(
        0 if _is(one, kind) else ua.StatusCodes.BadTypeMismatch
        for one, kind in zip(given, kinds, strict=True)
    )


def out_of_range(count: int) -> ua.CallMethodResult:
    """The answer to arguments that name nothing that is there."""
    return _invalid(ua.StatusCodes.BadOutOfRange for _ in range(count))


def answered(*outputs: ua.Variant) -> ua.CallMethodResult:
    """The answer of a method that was called."""
    result = ua.CallMethodResult()
    result.OutputArguments = list(outputs)
    return result


def _invalid(codes: Any) -> ua.CallMethodResult:
    result = ua.CallMethodResult()
    result.InputArgumentResults = [ua.StatusCode(code) for code in codes]
    result.StatusCode = ua.StatusCode(ua.StatusCodes.BadInvalidArgument)
    return result


def _is(given: ua.Variant, kind: ua.VariantType) -> bool:
    return given.VariantType is kind and given.Value is not None and not given.is_array
