"""What results of motions say."""

from typing import Final

PASSED: Final = 'passed'
"""The motion ran through to the next one."""
