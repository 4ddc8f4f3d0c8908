"""Actions of control_msgs, which is no part of the common interfaces."""

from importlib import import_module
from typing import Any


def action_type(name: str) -> Any:
    """An action of control_msgs; None where the package is not installed, or has no such action."""
    try:
        return getattr(import_module('control_msgs.action'), name, None)
    except ImportError:
        return None
