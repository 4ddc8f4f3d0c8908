"""Texts in the results of motions."""

from typing import Final

PASSED: Final = 'passed'
"""The motion ran through to the next one."""
BLOCKED: Final = 'stopped before a collision'
"""Something is in the way: the motion goes around it, or ends here."""
