"""Options of drives and controller that share the interpreter of a test with much else."""

from typing import Any, Final

PATIENT: Final = 20.0  # s
LATE_DRIVES: Final[dict[str, Any]] = {'feedback_timeout': PATIENT, 'following_error': 100.0}
"""Of a controller whose feedback may come late, and by then be far from its reference."""

SPARSE: Final[dict[str, Any]] = {'rate': 50.0}
"""Of drives and controller: with the usual 250 references per second they take almost half of a processor."""
