"""Arguments of methods that clients call, and answers to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from asyncua import ua

MISMATCH: Final = ua.StatusCodes.BadTypeMismatch


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
    codes = [
        0 if one.VariantType is kind and one.Value is not None and not one.is_array else MISMATCH
        for one, kind in zip(given, kinds, strict=True)
    ]
    return _invalid(codes) if any(codes) else None


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
