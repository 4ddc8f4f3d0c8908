"""Simulated drives: ideal, second-order, rigid-body with motors, gears and masses; faults and brakes."""
