"""A whole robot cell on a simulated clock, in one process and without ROS."""
