"""Functional blocks: robot-independent, ROS-free, numpy in and out."""
