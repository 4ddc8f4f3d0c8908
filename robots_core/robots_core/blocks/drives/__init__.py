"""Simulated drives: ideal, second-order, and rigid-body with motors, gears, friction and masses; faults."""
