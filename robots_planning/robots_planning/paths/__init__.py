"""Geometric paths of the tool and of the axes over a path coordinate s from 0 to 1, without time."""
