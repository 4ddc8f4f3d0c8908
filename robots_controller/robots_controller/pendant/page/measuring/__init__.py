"""Guided sequences that measure tools, bases and payloads."""
