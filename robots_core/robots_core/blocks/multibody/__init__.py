"""Dynamics of the whole arm: on a base that stands, is moved or floats, with a payload."""
