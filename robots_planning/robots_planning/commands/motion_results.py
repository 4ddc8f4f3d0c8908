"""What results of motions say."""

from typing import Final

PASSED: Final = 'passed'
"""The motion ran through to the next one."""
BLOCKED: Final = 'stopped before a collision'
"""An obstacle is ahead: the motion goes around it, or ends here."""
