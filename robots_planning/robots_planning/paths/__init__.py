"""Paths of the tool and of the axes, without time."""
