"""How fast a path is followed: override, caps of frames and tool, ramps."""
