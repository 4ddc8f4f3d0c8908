"""Verification: independent checks of a trajectory against limits, its path, tool speeds and the payload."""
