"""Zones: boxes and half-spaces that the tool or the bodies of a robot may not leave or enter."""
