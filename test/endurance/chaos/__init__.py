"""Nodes killed and frozen at random moments, and what the robot and its outputs do then: make chaos."""
