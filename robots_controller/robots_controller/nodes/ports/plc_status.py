"""What a scripted PLC will do, as the values of `plc_status`, and back."""

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any

from robots_controller.io.scripted_plc import Pending
from robots_core.errors import InvalidInputError

SHOWN = 60  # characters of a text that is refused


def pending_as_text(changes: Pending, start: float) -> str:
    """Changes as JSON; `start` is when their clock was 0 s, on the clock of the message."""
    return json.dumps([[start + time, line, inputs] for time, line, inputs in changes])


def pending_from_text(text: str, start: float) -> Pending:
    """Inverse of `pending_as_text`.

    Raises:
        InvalidInputError: text of another form.
    """
    try:
        return tuple(_pending(json.loads(text), start))
    except (ValueError, TypeError, AttributeError, RecursionError, OverflowError):
        raise InvalidInputError(f'pending = {text[:SHOWN]!r} is no list of [time, line, inputs]') from None


def _pending(rows: Any, start: float) -> Iterator[tuple[float, int, Mapping[str, float]]]:
    for time, line, inputs in rows:
        numbers = {str(name): float(value) for name, value in inputs.items()}
        if not all(map(math.isfinite, (time, *numbers.values()))):
            raise ValueError
        yield time - start, int(line), numbers
