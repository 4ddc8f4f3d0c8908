"""The operator's page: what it shows, what may be pressed, and the page itself; no ROS."""
