"""Defaults that live and simulated cells share."""

from typing import Final

RATE: Final = 250.0
"""References per second, Hz: of controllers and drives."""
