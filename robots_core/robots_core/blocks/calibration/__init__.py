"""Tools, bases and payloads, measured with the robot itself."""
