"""LinearCartesianLimited: a straight line of the tool inside the limits of velocity and acceleration."""

from robots_planning.trajectory_generators.line_generator import LineGenerator


class LinearCartesianLimited(LineGenerator):
    """The tool moves on a straight line and turns about one axis. Options: see `CartesianGenerator`."""
