"""Ports of a robot program: its controller, planner, feedback and clock, as topics, services and actions."""
