"""Timing: speed profiles and time laws that follow a path inside the limits of axes, torques and tool."""
