"""Texts in the results of motions."""

from typing import Final

PASSED: Final = 'passed'
"""The motion ran through to the next one."""
