"""Compiled functions that several blocks share."""
