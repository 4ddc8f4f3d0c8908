"""Simulated drives, from ideal ones to motors, gears, friction and masses."""
