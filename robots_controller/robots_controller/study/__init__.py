"""Studies: a program simulated over a grid of robots, drives, speeds and parameters, as one table."""
