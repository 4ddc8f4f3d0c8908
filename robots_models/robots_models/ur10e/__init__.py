"""Universal Robots UR10e."""
