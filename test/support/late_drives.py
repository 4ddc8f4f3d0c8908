"""Options of nodes beside drives that a busy machine delays."""

from typing import Any, Final

PATIENT: Final = 20.0  # s
LATE_DRIVES: Final[dict[str, Any]] = {'feedback_timeout': PATIENT, 'following_error': 100.0}
"""Of a controller whose feedback may come late, and by then be far from its reference."""
