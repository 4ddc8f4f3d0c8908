"""Time laws: how fast a path can be followed inside the limits."""
