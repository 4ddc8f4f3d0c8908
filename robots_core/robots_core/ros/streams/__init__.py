"""Messages of a robot at its own rate, read and written in microseconds."""
