"""Simulated time that advances when every node has done what was due."""
